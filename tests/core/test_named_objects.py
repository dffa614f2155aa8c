# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of several named objects: each comes back by `layer`, in every format that names them."""

import json
import struct

import numpy as np
import pytest
from object_models import SHIFT, crossing_surfaces
from realmodel.core import InputRefused, Project, Rock, UsageError, build, read_mesh, read_points
from realmodel.core.base.triangles import open_edges
from realmodel.core.exporters.shapes.shape_parts import model_parts
from realmodel.core.readers import is_mesh_file
from realmodel.core.readers.contents import layer_names


def surface(number, rng):
    """Vertices (9, 3) and triangles (8, 3) of a wavy square; numbers that 32 bits have."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(3.0), np.arange(3.0)))
    z = rng.integers(-500, 500, 9) / 8.0 + 100.0 * number
    corners = [(k, k + 1, k + 4, k + 3) for k in (0, 1, 3, 4)]
    triangles = [part for a, b, c, d in corners for part in ((a, b, c), (a, c, d))]
    return np.column_stack([x + 10.0 * number, y, z]), np.array(triangles)


def dxf(parts):
    text = "0\nSECTION\n2\nENTITIES\n"
    for name, (vertices, triangles) in parts.items():
        for corners in vertices[triangles].tolist():
            places = [*corners, corners[-1]]
            values = "".join(
                f"{10 * (a + 1) + k}\n{p[a]!r}\n" for k, p in enumerate(places) for a in range(3)
            )
            text += f"0\n3DFACE\n8\n{name}\n{values}"
    return (text + "0\nENDSEC\n0\nEOF\n").encode()


def dxf_blocks(parts):
    """Each surface a block, inserted with a shift that its faces are moved back by."""
    blocks, inserts = "", ""
    for name, (vertices, triangles) in parts.items():
        faces = dxf({"0": (vertices - [8.0, -4.0, 2.0], triangles)}).decode()
        faces = faces.partition("ENTITIES\n")[2].partition("0\nENDSEC")[0]
        blocks += f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n30\n0\n{faces}0\nENDBLK\n"
        inserts += f"0\nINSERT\n8\nsite\n2\n{name}\n10\n8\n20\n-4\n30\n2\n"
    text = f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{inserts}0\nENDSEC\n0\nEOF\n"
    return text.encode()


def dxf_polyfaces(parts):
    text = "0\nSECTION\n2\nENTITIES\n"
    for name, (vertices, triangles) in parts.items():
        text += f"0\nPOLYLINE\n8\n{name}\n66\n1\n70\n64\n"
        for x, y, z in vertices.tolist():
            text += f"0\nVERTEX\n8\n{name}\n70\n192\n10\n{x!r}\n20\n{y!r}\n30\n{z!r}\n"
        for a, b, c in (triangles + 1).tolist():
            text += f"0\nVERTEX\n8\n{name}\n70\n128\n71\n{a}\n72\n{-b}\n73\n{c}\n"
        text += "0\nSEQEND\n"
    return (text + "0\nENDSEC\n0\nEOF\n").encode()


def dxf_meshes(parts):
    text = "0\nSECTION\n2\nENTITIES\n"
    for name, (vertices, triangles) in parts.items():
        places = "".join(f"10\n{x!r}\n20\n{y!r}\n30\n{z!r}\n" for x, y, z in vertices.tolist())
        faces = "".join(f"90\n3\n90\n{a}\n90\n{b}\n90\n{c}\n" for a, b, c in triangles.tolist())
        text += f"0\nMESH\n100\nAcDbEntity\n8\n{name}\n100\nAcDbSubDMesh\n71\n2\n72\n0\n91\n1\n92\n{len(vertices)}\n"  # noqa: E501
        text += f"{places}93\n{4 * len(triangles)}\n{faces}94\n1\n90\n0\n90\n1\n95\n1\n140\n0.0\n90\n0\n"
    return (text + "0\nENDSEC\n0\nEOF\n").encode()


def binary_dxf(parts):
    """The tags of the text, as a release from 13 on writes them."""
    words = dxf(parts).decode().split("\n")[:-1]
    content = b"AutoCAD Binary DXF\r\n\x1a\0"
    for code, value in zip(words[::2], words[1::2], strict=True):
        content += struct.pack("<h", int(code))
        content += struct.pack("<d", float(value)) if int(code) >= 10 else value.encode() + b"\0"
    return content


def landxml(parts):
    text = '<LandXML><Units><Metric linearUnit="meter"/></Units><Surfaces>'
    for name, (vertices, triangles) in parts.items():
        text += f'<Surface name="{name}"><Definition surfType="TIN"><Pnts><P id="99">9e5 0 1</P>'
        text += "".join(f'<P id="{k}">{y!r} {x!r} {z!r}</P>' for k, (x, y, z) in enumerate(vertices.tolist()))
        faces = "".join(f"<F>{a} {b} {c}</F>" for a, b, c in triangles.tolist())
        text += f"</Pnts><Faces>{faces}</Faces></Definition></Surface>"
    return (text + "</Surfaces></LandXML>").encode()


def gocad(parts):
    text = ""
    for name, (vertices, triangles) in parts.items():
        text += f"GOCAD TSurf 1\nHEADER {{\nname:{name}\n}}\nTFACE\n"
        text += "".join(f"VRTX {k} {x!r} {y!r} {z!r}\n" for k, (x, y, z) in enumerate(vertices.tolist(), 1))
        text += "".join(f"TRGL {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist()) + "END\n"
    return text.encode()


def obj(key, negative=False):
    def written(parts):
        text, first = "", 1
        for name, (vertices, triangles) in parts.items():
            text += f"{key} {name}\n" + "".join(
                f"v {x!r} {y!r} \\\n {z!r}\n" for x, y, z in vertices.tolist()
            )
            numbers = triangles - len(vertices) if negative else triangles + first
            text += "".join(f"f {a} {b}/7 {c}//3\n" for a, b, c in numbers.tolist())
            first += len(vertices)
        return text.encode()

    return written


def stl(parts):
    text = ""
    for name, (vertices, triangles) in parts.items():
        text += f"solid {name}\n"
        for corners in vertices[triangles].tolist():
            text += "FACET NORMAL 0 0 1\n outer loop\n"
            text += "".join(f"  Vertex {x!r} {y!r} {z!r}\n" for x, y, z in corners) + " endloop\nendfacet\n"
        text += f"endsolid {name}\n"
    return text.encode()


def glb(parts):
    """Y up, each in a node of a group that is moved."""
    content, binary = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}]}, b""
    content |= {name: [] for name in ("meshes", "accessors", "bufferViews")}
    content["nodes"] = [{"name": "all", "translation": [1.0, 2.0, 4.0], "children": []}]
    for name, (vertices, triangles) in parts.items():
        turned = np.column_stack([vertices[:, 0], vertices[:, 2], -vertices[:, 1]]) - [1.0, 2.0, 4.0]
        for array, kind, columns in (
            (turned.astype("<f4"), 5126, "VEC3"),
            (triangles.astype("<u2"), 5123, "SCALAR"),
        ):
            raw = array.tobytes()
            content["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(raw)})
            view = len(content["bufferViews"]) - 1
            count = len(array) if columns == "VEC3" else array.size
            content["accessors"].append(
                {"bufferView": view, "componentType": kind, "count": count, "type": columns}
            )
            binary += raw + bytes(-len(raw) % 4)
        number = len(content["accessors"])
        content["meshes"].append(
            {"primitives": [{"attributes": {"POSITION": number - 2}, "indices": number - 1}]}
        )
        content["nodes"][0]["children"].append(len(content["nodes"]))
        content["nodes"].append({"name": name, "mesh": len(content["meshes"]) - 1})
    content["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<2I", len(text), 0x4E4F534A)
        + text
        + struct.pack("<2I", len(binary), 0x004E4942)
        + binary
    )
    return struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks


def gmsh(version):
    def written(parts):
        names = "".join(f'2 {k} "{name}"\n' for k, name in enumerate(parts, 1))
        text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(parts)}\n{names}$EndPhysicalNames\n"  # noqa: E501
        nodes = [
            (10 * k + 3, place)
            for k, place in enumerate(np.concatenate([v for v, _ in parts.values()]).tolist())
        ]
        firsts = np.cumsum([0, *(len(v) for v, _ in parts.values())])
        faces = [
            [[10 * int(n + first) + 3 for n in face] for face in triangles]
            for first, (_, triangles) in zip(firsts, parts.values(), strict=False)
        ]
        count = sum(map(len, faces))
        if version == 2.2:
            rows = "".join(f"{tag} {x!r} {y!r} {z!r}\n" for tag, (x, y, z) in nodes)
            text += f"$Nodes\n{len(nodes)}\n{rows}$EndNodes\n$Elements\n{count}\n"
            for k, some in enumerate(faces, 1):
                text += "".join(f"7 2 2 {k} {k + 20} {a} {b} {c}\n" for a, b, c in some)
            return (text + "$EndElements\n").encode()
        text += f"$Entities\n1 0 {len(parts)} 0\n"
        text += "5 0 0 0 0\n" if version == 4.1 else "5 0 0 0 0 0 0 0\n"
        text += (
            "".join(f"{k + 20} 0 0 0 1 1 1 1 {k} 0\n" for k in range(1, len(parts) + 1)) + "$EndEntities\n"
        )
        if version == 4.1:
            tags = "".join(f"{tag}\n" for tag, _ in nodes)
            rows = "".join(f"{x!r} {y!r} {z!r} 0.5 0.25\n" for _, (x, y, z) in nodes)
            text += f"$Nodes\n1 {len(nodes)} 1 999\n2 21 1 {len(nodes)}\n{tags}{rows}$EndNodes\n"
            text += f"$Elements\n{len(parts)} {count} 1 {count}\n"
        else:
            rows = "".join(f"{tag} {x!r} {y!r} {z!r} 0.5 0.25\n" for tag, (x, y, z) in nodes)
            text += f"$Nodes\n1 {len(nodes)}\n21 2 1 {len(nodes)}\n{rows}$EndNodes\n$Elements\n{len(parts)} {count}\n"  # noqa: E501
        for k, some in enumerate(faces, 1):
            text += (f"2 {k + 20}" if version == 4.1 else f"{k + 20} 2") + f" 2 {len(some)}\n"
            text += "".join(f"7 {a} {b} {c}\n" for a, b, c in some)
        return (text + "$EndElements\n").encode()

    return written


FORMATS = {
    "layers.dxf": dxf,
    "polyfaces.dxf": dxf_polyfaces,
    "meshes.dxf": dxf_meshes,
    "binary.dxf": binary_dxf,
    "m.xml": landxml,
    "m.ts": gocad,
    "o.obj": obj("o"),
    "g.obj": obj("g", negative=True),
    "m.stl": stl,
    "m.glb": glb,
    "2.msh": gmsh(2.2),
    "40.msh": gmsh(4.0),
    "41.msh": gmsh(4.1),
}


def corners(vertices, triangles):
    return sorted(map(sorted, np.asarray(vertices)[triangles].tolist()))


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("seed", range(3))
def test_each_surface_comes_back_by_its_name(tmp_path, name, seed):
    rng = np.random.default_rng(seed)
    names = rng.permutation(["Top of clay", "F-1", "Base", "Übergang"])[: seed + 2].tolist()
    if name == "g.obj":
        names = [text.replace(" ", "_") for text in names]
    parts = {text: surface(number, rng) for number, text in enumerate(names)}
    path = tmp_path / name
    path.write_bytes(FORMATS[name](parts))
    assert is_mesh_file(path)
    assert layer_names(path) == names
    with pytest.raises(InputRefused) as refused:
        read_mesh(path)
    assert all(text in str(refused.value) for text in names)
    for text, (vertices, triangles) in parts.items():
        for layer in (text, text.upper()):
            mesh = read_mesh(path, layer=layer)
            assert corners(mesh.vertices, mesh.triangles) == corners(vertices, triangles)
            assert mesh.vertices.dtype == np.float64 and mesh.triangles.dtype == np.int32
        points = read_points(path, layer=text)
        assert sorted(points.xyz.tolist()) == sorted(vertices.tolist())
    with pytest.raises(InputRefused, match="it has no object 'no such'; it has "):
        read_mesh(path, layer="no such")


@pytest.mark.parametrize("name", FORMATS)
def test_one_surface_needs_no_name(tmp_path, name):
    vertices, triangles = surface(1, np.random.default_rng(5))
    (path := tmp_path / name).write_bytes(FORMATS[name]({"only": (vertices, triangles)}))
    assert corners(*(lambda m: (m.vertices, m.triangles))(read_mesh(path))) == corners(vertices, triangles)


def test_blocks_of_a_drawing_are_parts_of_its_layers(tmp_path):
    rng = np.random.default_rng(3)
    parts = {name: surface(number, rng) for number, name in enumerate("AB")}
    (path := tmp_path / "m.dxf").write_bytes(dxf_blocks(parts))
    assert layer_names(path) == ["site", "A", "B"]
    assert len(read_mesh(path).triangles) == 16  # one layer
    for name, (vertices, triangles) in parts.items():
        mesh = read_mesh(path, layer=name)
        assert corners(mesh.vertices, mesh.triangles) == corners(vertices, triangles)


def test_keys_of_read_mesh(tmp_path):
    vertices, triangles = surface(0, np.random.default_rng(1))
    (path := tmp_path / "m.xml").write_bytes(landxml({"a": (vertices, triangles)}))
    assert np.allclose(read_mesh(path, units="ft").vertices * 0.3048, vertices)
    deep = read_mesh(path, file_units={"xy": "m", "z": "km"}, z_axis="down")
    assert np.allclose(deep.vertices, vertices * [1, 1, -1000])
    with pytest.raises(UsageError, match="there is no key 'column'"):
        read_mesh(path, column=1)
    with pytest.raises(UsageError, match="unknown unit"):
        read_mesh(path, units="rods")


@pytest.mark.parametrize("ending", [".obj", ".dxf", ".ts", ".glb"])
def test_each_block_that_we_write_is_read_by_its_name(tmp_path, ending):
    model = build(Project("crossing", [Rock("rock", crossing_surfaces(SHIFT), base_elevation=-2.0)]))
    model.save(path := tmp_path / f"m{ending}")
    parts = list(model_parts(model))
    names = layer_names(path)
    assert len(names) == len(parts) == 4
    with pytest.raises(InputRefused, match="it has 4 surfaces"):
        read_mesh(path)
    for name, part in zip(names, parts, strict=True):
        assert name[0].lower() == part.name[0].lower()
        mesh = read_mesh(path, layer=name)
        assert len(open_edges(mesh.vertices, mesh.triangles)) == 0
        assert len(mesh.triangles) == len(part.triangles)
        low, high = (end(part.vertices, axis=0) for end in (np.min, np.max))
        assert np.allclose([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)], [low, high], atol=1e-6)
