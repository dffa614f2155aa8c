# SPDX-License-Identifier: GPL-3.0-or-later
"""Dialects of formats of meshes, as many programs write them; concave faces."""

import base64
import json
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Boreholes, InputRefused, PointFile, read_mesh, read_points
from realmodel.core.readers import UnitNames, is_mesh_file, read_picks
from realmodel.core.readers.contents import layer_names
from realmodel.core.readers.fault_input import read_fault_points
from realmodel.core.readers.meshes.triangle_mesh import mesh_of_faces


def triangles_of(path, **keys):
    mesh = read_mesh(path, **keys)
    return mesh.vertices[mesh.triangles].tolist()


@pytest.fixture
def put(tmp_path):
    def written(name, content):
        (path := tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return written


# concave faces


def vector_areas(vertices, triangles):
    a, b, c = np.asarray(vertices)[triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a) / 2


def star(rng, corners):
    """A polygon of which the origin sees all; its radii jump."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, corners)) + np.linspace(0, 1e-3, corners)
    widest = np.diff(np.append(angles, angles[0] + 2 * np.pi)).max()
    radii = np.exp(rng.uniform(-2, 2, corners)) if widest < 3 else np.full(corners, 3.0)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), np.zeros(corners)])


def comb(rng, teeth):
    x = np.arange(2.0 * teeth + 1)
    top = np.where(np.arange(len(x)) % 2, rng.uniform(0.1, 0.4, len(x)), rng.uniform(2, 9, len(x)))
    return np.array([*zip(x, top, 0 * x, strict=True), (x[-1], -1.0, 0), (0, -1.0, 0)])


def as_file(name, polygon):
    places, count = polygon.tolist(), len(polygon)
    rows = [" ".join(map(repr, place)) for place in places]
    if name == "m.obj":
        return "".join(f"v {row}\n" for row in rows) + "f " + " ".join(map(str, range(1, count + 1))) + "\n"
    if name == "m.off":
        return (
            f"OFF\n{count} 1 0\n" + "\n".join(rows) + f"\n{count} " + " ".join(map(str, range(count))) + "\n"
        )
    if name == "m.ply":
        head = f"ply\nformat ascii 1.0\nelement vertex {count}\nproperty double x\nproperty double y\n"
        head += "property double z\nelement face 1\nproperty list uint int vertex_index\nend_header\n"
        return head + "\n".join(rows) + f"\n{count} " + " ".join(map(str, range(count))) + "\n"
    if name == "m.vtk":
        head = f"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS {count} double\n"
        return (
            head + "\n".join(rows) + f"\nPOLYGONS 1 {count + 1}\n{count} " + " ".join(map(str, range(count)))
        )
    text = f"0\nSECTION\n2\nENTITIES\n0\nMESH\n8\na\n91\n0\n92\n{count}\n"
    text += "".join(f"10\n{x!r}\n20\n{y!r}\n30\n{z!r}\n" for x, y, z in places)
    text += f"93\n{count + 1}\n90\n{count}\n" + "".join(f"90\n{k}\n" for k in range(count))
    return text + "94\n0\n0\nENDSEC\n0\nEOF\n"


@settings(derandomize=True, max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    kind=st.sampled_from([star, comb]),
    size=st.integers(4, 14),
    plane=st.sampled_from(["plan", "wall", "tilted", "folded"]),
    backward=st.booleans(),
)
def test_a_concave_face_is_divided_within_itself(seed, kind, size, plane, backward):
    """Whatever corner comes first, and whichever way round."""
    rng = np.random.default_rng(seed)
    polygon = kind(rng, size)
    if plane == "wall":
        polygon = polygon[:, [0, 2, 1]]
    elif plane != "plan":
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        polygon = polygon @ turn + rng.uniform(-1e6, 1e6, 3)
    if plane == "folded":
        polygon = polygon + rng.normal(0, 1e-3, polygon.shape)
    polygon = polygon[::-1] if backward else polygon
    newell = vector_areas(polygon, [[0, k, k + 1] for k in range(1, len(polygon) - 1)]).sum(axis=0)
    for first in range(0, len(polygon), max(len(polygon) // 4, 1)):
        mesh = mesh_of_faces("x", np.roll(polygon, first, axis=0), [list(range(len(polygon)))])
        assert len(mesh.triangles) == len(polygon) - 2 and mesh.warnings == ()
        areas = vector_areas(mesh.vertices, mesh.triangles)
        unit = newell / np.linalg.norm(newell)
        assert (areas @ unit > -1e-9 * np.linalg.norm(newell)).all()
        assert np.abs(areas @ unit).sum() == pytest.approx(np.linalg.norm(newell), rel=1e-6)


@pytest.mark.parametrize("name", ["m.obj", "m.off", "m.ply", "m.vtk", "m.dxf"])
@pytest.mark.parametrize("first", range(5))
def test_a_concave_face_in_each_format(put, name, first):
    polygon = np.roll([[0.0, 0, 1], [4, 0, 1], [4, 4, 2], [2, 1, 1.25], [0, 4, 2]], first, axis=0)
    mesh = read_mesh(put(name, as_file(name, polygon)))
    areas = vector_areas(mesh.vertices, mesh.triangles)[:, 2]
    assert len(areas) == 3 and (areas > 0).all() and areas.sum() == pytest.approx(10.0)


def test_convex_faces_stay_fans_and_crossing_ones_are_said(put):
    square = as_file("m.obj", np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]))
    assert read_mesh(put("m.obj", square)).triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    bow = as_file("m.obj", np.array([[0.0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 3, 0]]))
    mesh = read_mesh(path := put("b.obj", bow))
    assert mesh.warnings == [f"{path}: 1 face cannot be divided rightly: its border crosses itself"]


# DXF


def drawing(entities, blocks="", header=""):
    text = f"0\nSECTION\n2\nHEADER\n{header}0\nENDSEC\n" if header else ""
    text += f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n" if blocks else ""
    return text + f"0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"


def tags(*pairs):
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


CONTOUR = tags((0, "LWPOLYLINE"), (90, 2), (70, 0), (38, 125), (10, 0), (20, 0), (10, 10), (20, 5))
SPOT = tags((0, "POINT"), (10, 3), (20, 4), (30, 120))
FACE = tags(
    (0, "3DFACE"), (8, 0), (10, 0), (20, 0), (30, 5), (11, 2), (21, 0), (31, 5), (12, 0), (22, 1), (32, 5)
)


def test_contours_and_points_of_a_drawing(put):
    path = put("c.dxf", drawing(CONTOUR + SPOT))
    assert read_points(path).xyz.tolist() == [[0, 0, 125], [10, 5, 125], [3, 4, 120]]
    assert not is_mesh_file(path)
    with pytest.raises(
        InputRefused, match="it has no faces; if it holds points, read it as points: it has 0"
    ):
        read_mesh(path)
    line = tags((0, "LINE"), (8, "w"), (10, 1), (20, 2), (30, 3), (11, 4), (21, 5), (31, 6))
    old = tags((0, "POLYLINE"), (8, "o"), (70, 0), (30, 7)) + tags((0, "VERTEX"), (10, 1), (20, 2), (30, 9))
    in_space = tags((0, "POLYLINE"), (8, "s"), (70, 8)) + tags((0, "VERTEX"), (10, 1), (20, 2), (30, 9))
    end = tags((0, "SEQEND"))
    path = put("c.dxf", drawing(line + old + end + in_space + end + tags((0, "SPLINE"), (8, "s"))))
    assert layer_names(path) == ["w", "o", "s"]
    with pytest.raises(InputRefused, match="it has w, o, s"):
        read_points(path)
    assert read_points(path, layer="w").xyz.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert read_points(path, layer="o").xyz.tolist() == [[1, 2, 7]]
    points = read_points(path, layer="s")
    assert points.xyz.tolist() == [[1, 2, 9]]
    assert points.warnings == [f"{path}: 's' has 1 SPLINE, which are not read"]


def test_a_layer_of_faces_and_lines_is_two_objects(put):
    path = put("c.dxf", drawing(CONTOUR.replace("90\n2\n", "8\n0\n90\n2\n") + FACE))
    assert layer_names(path) == ["0"]
    assert len(read_mesh(path).triangles) == 1
    assert len(read_points(path).xyz) == 2


def inserted(*pairs):
    block = tags((0, "BLOCK"), (2, "b"), (70, 0), (10, 1), (20, 0), (30, 0)) + FACE + tags((0, "ENDBLK"))
    return drawing(tags((0, "INSERT"), (8, "L"), (2, "B"), *pairs), block)


@pytest.mark.parametrize(
    ("pairs", "change"),
    [
        ((), lambda p: p - [1, 0, 0]),
        (((10, 5), (20, 6), (30, 7)), lambda p: p + np.array([4, 6, 7])),
        (((41, 2), (42, 3), (43, -1)), lambda p: (p - [1, 0, 0]) * [2, 3, -1]),
        (((50, 90), (10, 1)), lambda p: np.column_stack([1 - p[:, 1], p[:, 0] - 1, p[:, 2]])),
        (((210, 0), (220, 0), (230, -1), (10, 1)), lambda p: (p - [1, 0, 0]) * [-1, 1, -1] + [-1, 0, 0]),
        (((210, 0), (220, -1), (230, 0)), lambda p: np.column_stack([p[:, 0] - 1, -p[:, 2], p[:, 1]])),
    ],
)
def test_a_block_stands_where_it_is_inserted(put, pairs, change):
    path = put("i.dxf", inserted(*pairs))
    assert layer_names(path) == ["L", "b"]
    wanted = change(np.array([[0.0, 0, 5], [2, 0, 5], [0, 1, 5]]))
    for layer in (None, "l", "B"):
        mesh = read_mesh(path, layer=layer)
        assert sorted(mesh.vertices.tolist()) == sorted(wanted.tolist())


def test_arrays_and_blocks_in_blocks(put):
    mesh = read_mesh(put("i.dxf", inserted((70, 3), (71, 2), (44, 10), (45, 20))))
    assert len(mesh.triangles) == 6 and mesh.vertices.max(axis=0).tolist() == [21, 21, 5]
    inner = tags((0, "BLOCK"), (2, "in")) + FACE + tags((0, "ENDBLK"))
    outer = tags((0, "BLOCK"), (2, "out"), (0, "INSERT"), (8, 0), (2, "in"), (10, 10), (0, "ENDBLK"))
    path = put("n.dxf", drawing(tags((0, "INSERT"), (8, "L"), (2, "out"), (41, 2)), inner + outer))
    assert layer_names(path) == ["L", "out", "in"]
    assert read_mesh(path).vertices[:, 0].tolist() == [20, 20, 24]
    loop = tags((0, "BLOCK"), (2, "in"), (0, "INSERT"), (8, 0), (2, "in"), (0, "ENDBLK"))
    with pytest.raises(InputRefused, match="block 'in' is inserted into itself"):
        read_mesh(put("l.dxf", drawing(tags((0, "INSERT"), (2, "in")), loop)))
    many = inserted((70, 30000), (71, 30000))
    with pytest.raises(InputRefused, match="more than 100,000 times"):
        read_mesh(put("m.dxf", many))


def test_extrusion_names_and_groups_of_a_drawing(put):
    contour = CONTOUR + tags((210, 0), (220, 0), (230, -1))
    assert read_points(put("e.dxf", drawing(contour))).xyz.tolist() == [[0, 0, -125], [-10, 5, -125]]
    more = tags((1001, "APP"), (1010, 9), (1020, 9), (1030, 9), (1040, 9))
    quad = FACE.replace("8\n0\n", "8\n\\U+00DCber\n") + tags((13, 0), (23, 1), (33, 5), (70, 5)) + more
    path = put("q.dxf", drawing(quad))
    assert layer_names(path) == ["Über"]
    assert triangles_of(path) == [[[0, 0, 5], [2, 0, 5], [0, 1, 5]]]
    russian = drawing(FACE.replace("8\n0\n", "8\nСлой\n"), header=tags((9, "$DWGCODEPAGE"), (3, "ANSI_1251")))
    assert layer_names(put("r.dxf", russian.encode("cp1251"))) == ["Слой"]
    assert layer_names(put("r.dxf", russian.replace("\n", "\r\n"))) == ["Слой"]


# STL


def facets(count):
    return b"".join(struct.pack("<12fH", 0, 0, 1, k, 0, 0, k + 1, 0, 0, k, 1, 0, 0) for k in range(count))


@pytest.mark.parametrize(
    ("content", "count"),
    [
        (b"solid x".ljust(80, b" ") + struct.pack("<I", 2) + facets(2), 2),
        (b"solid x".ljust(80, b"\0") + struct.pack("<I", 2) + facets(2) + bytes(20), 2),
        (b"made".ljust(80, b"\0") + struct.pack("<I", 2) + facets(2) + bytes(20), 2),
        (b"made".ljust(80, b"\0") + struct.pack("<I", 0) + facets(3), 3),
        (b"solid".ljust(80, b"\0") + struct.pack("<I", 0xFFFFFFFF) + facets(3), 3),
        (
            b"SOLID a\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\n",  # noqa: E501
            1,
        ),
        (
            b"solid\nfacet normal 0 0 1\r\nouter loop\rvertex 0 0 0 vertex 1e0 0 0 vertex 0 1 0 endloop endfacet",  # noqa: E501
            1,
        ),
    ],
)
def test_habits_of_stl(put, content, count):
    mesh = read_mesh(path := put("m.stl", content))
    assert len(mesh.triangles) == count
    assert is_mesh_file(path)


# PLY


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("types", [("uchar", "int"), ("uint", "short"), ("int32", "int32")])
def test_strips_of_ply(put, kind, types):
    places, strip = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (5, 5, 5)], [0, 1, 2, 3, -1, 4, 3, 2]
    head = f"ply\nformat {kind} 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element tristrips 1\nproperty list {types[0]} {types[1]} vertex_indices\nend_header\n"
    mark = ">" if "big" in kind else "<"
    codes = {"uchar": "B", "int": "i", "uint": "I", "short": "h", "int32": "i"}
    body = b"".join(struct.pack(f"{mark}3f", *place) for place in places)
    body += struct.pack(f"{mark}{codes[types[0]]}8{codes[types[1]]}", 8, *strip)
    if kind == "ascii":
        body = "\n".join(" ".join(map(str, row)) for row in [*places, (8, *strip)]).encode()
    mesh = read_mesh(put("m.ply", head.encode() + body))
    assert mesh.triangles.tolist() == [[0, 1, 2], [2, 1, 3], [4, 3, 2]]


@pytest.mark.parametrize("kind", ["ascii", "binary_big_endian"])
def test_points_of_ply(put, kind):
    head = (
        f"ply\nformat {kind} 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
    )
    head += "property uchar class\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [(1, 2, 3, 7), (4, 5, 6, 8)]
    body = "".join(f"{a} {b} {c} {d}\n" for a, b, c, d in rows).encode()
    if kind != "ascii":
        body = b"".join(struct.pack(">3dB", *row) for row in rows)
    path = put("p.ply", head.encode() + body)
    points = read_points(path)
    assert points.xyz.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert points.columns["class"].tolist() == [7, 8]
    assert read_points(path, where={"class": 8}).xyz.tolist() == [[4, 5, 6]]
    assert not is_mesh_file(path)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_lists_among_the_properties_of_vertices_of_ply(put, kind):
    """Vertices with lists of any length at any place, with faces and without."""
    rng = np.random.default_rng(7)
    mark = ">" if "big" in kind else "<"
    for _ in range(20):
        places = rng.integers(-9, 9, (3, 3)).tolist()
        names = list(rng.permutation(["x", "y", "z", "tags", "more"]))
        head = f"ply\nformat {kind} 1.0\nelement vertex 3\n"
        head += "".join(f"property {'float' if n in 'xyz' else 'list uchar int'} {n}\n" for n in names)
        faces = bool(rng.integers(2))
        head += "element face 1\nproperty list uchar int vertex_indices\n" * faces + "end_header\n"
        words, body = [], b""
        for place in places:
            for name in names:
                values = [place["xyz".index(name)]] if name in "xyz" else [5] * int(rng.integers(4))
                length = [] if name in "xyz" else [len(values)]
                words += [*length, *values]
                body += struct.pack(
                    f"{mark}{len(length)}B{len(values)}{'f' if not length else 'i'}", *length, *values
                )
        words += [3, 0, 1, 2] * faces
        body += struct.pack(f"{mark}B3i", 3, 0, 1, 2) * faces
        path = put("m.ply", head.encode() + (" ".join(map(str, words)).encode() if kind == "ascii" else body))
        assert read_points(path).xyz.tolist() == places
        assert not faces or read_mesh(path).triangles.tolist() == [[0, 1, 2]]


# glTF


@pytest.mark.parametrize("with_view", [True, False])
def test_sparse_accessors_of_gltf(put, with_view):
    """Places that differ from those of the view, or from 0 without one."""
    dense = np.array([[0, 0, 0], [1, 0, 0], [0, 0, -1]], "<f4") * with_view
    buffer = (
        dense.tobytes()
        + np.array([1, 2], "<u4").tobytes()
        + np.array([[5, 1, 0], [0, 1, -6]], "<f4").tobytes()
    )
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    sparse = {"count": 2, "indices": {"bufferView": 1, "componentType": 5125}, "values": {"bufferView": 2}}
    places = {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse}
    content = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [places | ({"bufferView": 0} if with_view else {})],
        "bufferViews": [
            {"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in ((0, 36), (36, 8), (44, 24))
        ],
        "buffers": [{"byteLength": len(buffer), "uri": uri}],
    }
    assert triangles_of(put("s.gltf", json.dumps(content))) == [[[0, 0, 0], [5, 0, 1], [0, 6, 1]]]


# OBJ


def test_lines_and_groups_of_obj(put):
    text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 \\\n 4\nv 0.0 1.0 \\\n2.0\n"
    mesh = read_mesh(put("m.obj", text))
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a b\nf 1 2 3\ng a\nf 1 2 3\nf 1 3 2\ng\nf 3 2 1\n"
    path = put("g.obj", text)
    assert layer_names(path) == ["a b", "a", "object 3", "b"]
    assert [len(read_mesh(path, layer=name).triangles) for name in layer_names(path)] == [1, 3, 1, 1]
    with pytest.raises(InputRefused, match="it has 3 surfaces"):
        read_mesh(path)
    path = put("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no one\ng x\nf 1 2 3\ng y\nf 1 3 2\n")
    assert layer_names(path) == ["one", "x", "y"]
    assert len(read_mesh(path).triangles) == 2  # one object with two groups
    assert len(read_mesh(path, layer="y").triangles) == 1
    assert read_points(put("p.obj", "v 1 2 3\nv 4 5 6\n")).xyz.tolist() == [[1, 2, 3], [4, 5, 6]]


# GOCAD


GOCAD = """GOCAD VSet 1
HEADER {
name:tops
}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
AXIS_UNIT "m" "m" "ft"
ZPOSITIVE Depth
END_ORIGINAL_COORDINATE_SYSTEM
PROPERTIES age
NO_DATA_VALUES -99999
PVRTX 1 10 20 1000 5
PVRTX 2 11 20 2000 -99999
END
GOCAD PLine 1
HEADER {name: "a fault"}
ZPOSITIVE Elevation
ILINE
VRTX 1 0 0 1
VRTX 2 1 0 2
SEG 1 2
ILINE
VRTX 3 5 0 1
ATOM 4 2
SEG 3 4
END
GOCAD TSurf 1
HEADER { name: top }
VRTX 1 0 0 1
VRTX 2 1 0 2
VRTX 3 0 1 3
TRGL 1 2 3
END
"""


def test_objects_of_gocad(put):
    path = put("m.ts", GOCAD)
    assert layer_names(path) == ["tops", "a fault", "top"]
    points = read_points(path, layer="tops")
    assert np.allclose(points.xyz, [[10, 20, -304.8], [11, 20, -609.6]])
    assert points.columns["age"].tolist()[:1] == [5] and np.isnan(points.columns["age"][1])
    assert any("ft" in text and "units" in text for text in points.warnings)
    assert read_points(path, layer="a fault").xyz.tolist() == [[0, 0, 1], [1, 0, 2], [5, 0, 1]]
    sticks, _ = read_fault_points(PointFile(path, layer="a fault"))
    assert [stick.tolist() for stick in sticks] == [[[0, 0, 1], [1, 0, 2]], [[5, 0, 1]]]
    assert len(read_mesh(path).triangles) == 1  # the only surface
    with pytest.raises(InputRefused, match="it has tops, a fault, top"):
        read_points(path)


WELL = """GOCAD Well 1
HEADER {
name:W1
}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
ZPOSITIVE Elevation
END_ORIGINAL_COORDINATE_SYSTEM
WREF 100 200 50
PATH 0 50 0 0
PATH 50 10 30 0
MRKR "Top A" 1 25
MRKR B 2 100
ZONE sand 0 25 1
ZONE clay 25 60 2
END
"""


def test_wells_of_gocad(put):
    """Below its path a well goes straight on."""
    path = put("w.wl", WELL)
    picks = read_picks(Boreholes(picks=path))
    collar, places = picks.holes["W1"]
    assert np.allclose(collar, [100, 200, 50])
    assert [(name, place.tolist()) for name, place in places] == [
        ("Top A", pytest.approx([115, 200, 30])),
        ("B", pytest.approx([160, 200, -30])),
    ]
    feet = WELL.replace("ZPOSITIVE", 'AXIS_UNIT "ft" "ft" "ft"\nZPOSITIVE')
    in_feet = read_picks(Boreholes(picks=put("f.wl", feet)))
    assert np.allclose(in_feet.holes["W1"][0], np.array([100, 200, 50]) * 0.3048)
    assert any("ft" in text and "units" in text for text in in_feet.warnings)
    units = UnitNames(["sand", "clay"], ["sand", "clay"])
    logged = read_picks(Boreholes(intervals=path), units=units, plan_step=1000.0)
    assert [(name, place.tolist()) for name, place in logged.holes["W1"][1]] == [
        ("sand", pytest.approx([100, 200, 50])),
        ("clay", pytest.approx([115, 200, 30])),
    ]


# VTK


def legacy(kind, version, binary):
    """Two triangles and a square of a PolyData or an UnstructuredGrid, with an array before and behind
    them."""
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 5], [2, 1, 5]], float)
    rows = [[0, 1, 2, 3], [1, 4, 2], [4, 5, 2]]

    def numbers(values, form):
        values = np.asarray(values)
        return (
            values.astype(form).tobytes() + b"\n"
            if binary
            else " ".join(map(str, values.ravel())).encode() + b"\n"
        )

    content = (
        f"# vtk DataFile Version {version}\nsurface POINTS 3\n{'BINARY' if binary else 'ASCII'}\n".encode()
    )
    content += f"DATASET {kind}\nFIELD FieldData 1\nTIME 1 1 double\n".encode() + numbers([7.0], ">f8")
    content += b"POINTS 6 float\n" + numbers(places, ">f4")
    content += b"METADATA\nINFORMATION 0\n\n"
    key = b"POLYGONS" if kind == "POLYDATA" else b"CELLS"
    ends = np.cumsum([0, *map(len, rows)])
    if version >= 5:
        content += key + b" 4 10\nOFFSETS vtktypeint64\n" + numbers(ends, ">i8")
        content += b"CONNECTIVITY vtktypeint64\n" + numbers(np.concatenate(rows), ">i8")
    else:
        content += key + b" 3 13\n" + numbers(np.concatenate([[len(row), *row] for row in rows]), ">i4")
    if kind != "POLYDATA":
        content += b"CELL_TYPES 3\n" + numbers([9, 5, 5], ">i4")
    return content + b"CELL_DATA 3\nSCALARS a int 1\nLOOKUP_TABLE default\n" + numbers([1, 2, 3], ">i4")


@pytest.mark.parametrize("kind", ["POLYDATA", "UNSTRUCTURED_GRID"])
@pytest.mark.parametrize("version", [2.0, 3.0, 4.2, 5.1])
@pytest.mark.parametrize("binary", [False, True])
def test_older_files_of_vtk(put, kind, version, binary):
    mesh = read_mesh(put("m.vtk", legacy(kind, version, binary)))
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2], [4, 5, 2]]
    assert mesh.vertices[5].tolist() == [2, 1, 5]


def test_strips_points_grids_and_blocks_of_vtk(put):
    head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
    points = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\n"
    strips = put("s.vtk", f"{head}POLYDATA\n{points}TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n")
    assert read_mesh(strips).triangles.tolist() == [[0, 1, 2], [2, 1, 3]]
    cloud = put("p.vtk", f"{head}POLYDATA\n{points}VERTICES 1 5\n4 0 1 2 3\n")
    assert len(read_points(cloud).xyz) == 4 and not is_mesh_file(cloud)
    grid = put("g.vtk", f"{head}STRUCTURED_GRID\nDIMENSIONS 2 1 2\n{points}")
    assert read_mesh(grid).triangles.tolist() == [[0, 1, 3], [0, 3, 2]]
    with pytest.raises(InputRefused, match="its data set is a STRUCTURED_POINTS, which is no surface"):
        read_mesh(put("v.vtk", f"{head}STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n"))
    with pytest.raises(InputRefused, match="the file is cut off"):
        read_mesh(put("c.vtk", f"{head}POLYDATA\nPOINTS 4 float\n0 0 0"))
    text = '<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>'
    text += '<DataSet index="0" name="A" file="s.vtk"/><Block index="1"><DataSet index="0" name="B" file="g.vtk"/>'  # noqa: E501
    path = put("m.vtm", text + "</Block></vtkMultiBlockDataSet></VTKFile>")
    assert layer_names(path) == ["A", "B"]
    assert read_mesh(path, layer="b").triangles.tolist() == [[0, 1, 3], [0, 3, 2]]


# Mines


STRINGS = """top,12-Jan-24,,ssi_styles:styles.ssi
0, 0.000, 0.000, 0.000, 0.000, 0.000, 0.000
1, 100.0, 10.0, 5.0, d1
1, 100.0, 20.0, 6.0,
0, 0.000, 0.000, 0.000,
32000, 110.0, 10.0, 7.0,
32000, 110.0, 20.0, 8.0,
0, 0.000, 0.000, 0.000,
0, 0.000, 0.000, 0.000, END
"""
DTM = """top.str,
0, 0.000, 0.000, 0.000, END
OBJECT, 1,
TRISOLATION, 1, neighbours=no,validated=true,closed=no
1, 1, 2, 3, 0, 0, 0,
2, 2, 4, 3, 0, 0, 0,
END
"""


def test_surfaces_of_surpac(put):
    path = put("top.dtm", DTM)
    with pytest.raises(InputRefused, match=r"'top\.str', which is not beside it"):
        read_mesh(path)
    strings = put("top.str", STRINGS)
    table = put("t.csv", "id,x,y,z,a,b,c\n0,1,2,3,4,5,6\n1,2,3,4,5,6,7\n")
    assert read_points(table).xyz.tolist() == [[1, 2, 3], [2, 3, 4]]  # a table alike
    mesh = read_mesh(path)
    assert mesh.vertices.tolist() == [[10, 100, 5], [20, 100, 6], [10, 110, 7], [20, 110, 8]]
    assert mesh.triangles.tolist() == [[0, 1, 2], [1, 3, 2]]
    assert layer_names(strings) == ["1", "32000"]
    assert read_points(strings, layer="32000").xyz.tolist() == [[10, 110, 7], [20, 110, 8]]
    path = put("top.dtm", DTM.replace("2, 2, 4", "OBJECT, 2,\nTRISOLATION, 1,\n2, 2, 4"))
    assert layer_names(path) == ["object 1, trisolation 1", "object 2, trisolation 1"]
    with pytest.raises(InputRefused, match=r"top\.dtm:6: face 2 has a corner that is no vertex"):
        read_mesh(put("top.dtm", DTM.replace("2, 2, 4, 3", "2, 2, 5, 3")))


def datamine(fields, rows, size):
    """A table in the binary format: fields are stored one after another."""
    form = f"<f{size}"

    def word(value):
        return np.array([value], form).tobytes()

    def text(value):
        return value.encode().ljust(4).ljust(size, b"\0") if size == 8 else value.encode().ljust(4)

    head = b"".join(text("name"[:4]) for _ in range(4)) + b"".join(text("d") for _ in range(20))
    per_page = 508 // len(fields)
    pages = -(-len(rows) // per_page)
    head += b"".join(map(word, (20240101, len(fields), pages + 1, len(rows) - per_page * (pages - 1))))
    for number, name in enumerate(fields, 1):
        head += text(name[:4]) + text(name[4:8]) + text("N") + word(number) + word(1) + word(0) + word(0)
    content = head.ljust(512 * size, b"\0")
    for page in range(pages):
        some = np.array(rows[page * per_page : (page + 1) * per_page], form).tobytes()
        content += some.ljust(512 * size, b"\0")
    return content


@pytest.mark.parametrize("size", [0, 4, 8])
@pytest.mark.parametrize("names", [("toppt", "toptr"), ("pttop", "trtop"), ("top_pt", "TOP_TR")])
def test_wireframes_of_datamine(put, size, names):
    rng = np.random.default_rng(7)
    places = rng.integers(0, 4000, (300, 3)) / 4.0
    numbers = rng.permutation(300) * 3 + 1
    corners = np.array([rng.permutation(300)[:3] for _ in range(400)])
    tables = ("PID", "XP", "YP", "ZP"), ("TRIANGLE", "PID1", "PID2", "PID3")
    rows = np.column_stack([numbers, places]), np.column_stack([np.arange(400), numbers[corners]])
    ending = "dm" if size else "csv"
    paths = []
    for name, fields, values in zip(names, tables, rows, strict=True):
        content = ",".join(fields) + "\n" + "".join(",".join(map(str, row)) + "\n" for row in values.tolist())
        paths.append(put(f"{name}.{ending}", datamine(fields, values, size) if size else content))
    for path in paths:
        assert is_mesh_file(path)
        mesh = read_mesh(path)
        assert np.array_equal(mesh.vertices[mesh.triangles], places[corners])
    paths[0].unlink()
    with pytest.raises(InputRefused, match="its points are in another table"):
        read_mesh(paths[1])


@pytest.mark.parametrize("release", ["R12", "R2000", "R2018"])
@pytest.mark.parametrize("seed", range(4))
def test_drawings_of_ezdxf_with_blocks_anyhow(tmp_path, release, seed):
    """Its own places of what is inserted: turned, scaled, mirrored, extruded, in blocks of blocks."""
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed: scripts/test.sh installs it")
    rng = np.random.default_rng(seed)
    document = ezdxf.new(release)

    def fill(space, layer):
        space.add_3dface(rng.uniform(-9, 9, (4, 3)).tolist(), dxfattribs={"layer": layer})
        space.add_line(*rng.uniform(-9, 9, (2, 3)).tolist(), dxfattribs={"layer": layer})
        space.add_point(rng.uniform(-9, 9, 3).tolist(), dxfattribs={"layer": layer})
        space.add_polyline3d(rng.uniform(-9, 9, (4, 3)).tolist(), dxfattribs={"layer": layer})
        if release != "R12":
            more = {"layer": layer, "elevation": 3.5, "extrusion": rng.normal(size=3).tolist()}
            space.add_lwpolyline(rng.uniform(-9, 9, (5, 2)).tolist(), dxfattribs=more)

    def insert(space, name, layer):
        scale = float(rng.choice([1.0, 2.0, 0.5]))  # one for all axes, so that others have a right answer
        more = {
            "rotation": float(rng.uniform(0, 360)),
            "extrusion": rng.normal(size=3).tolist(),
            "layer": layer,
        }
        more |= {"xscale": scale, "yscale": scale, "zscale": scale}
        space.add_blockref(name, rng.uniform(-99, 99, 3).tolist(), dxfattribs=more)

    for name in ("in", "out"):
        block = document.blocks.new(name, base_point=rng.uniform(-5, 5, 3).tolist())
        fill(block, "0" if name == "in" else "own")
    insert(document.blocks.get("out"), "in", "0")
    space = document.modelspace()
    fill(space, "plain")
    for name in ("in", "out", "in"):
        insert(space, name, "site")
    document.saveas(path := tmp_path / "m.dxf")
    expected = {}

    def add(entity, on):
        layer = on if entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() == "INSERT":
            for part in entity.virtual_entities():
                add(part, layer)
            return
        kind = entity.dxftype()
        places = {
            "3DFACE": lambda: [tuple(corner) for corner in entity.wcs_vertices()],
            "LINE": lambda: [tuple(entity.dxf.start), tuple(entity.dxf.end)],
            "POINT": lambda: [tuple(entity.dxf.location)],
            "POLYLINE": lambda: [tuple(vertex.dxf.location) for vertex in entity.vertices],
            "LWPOLYLINE": lambda: [tuple(place) for place in entity.vertices_in_wcs()],
        }[kind]()
        expected.setdefault((layer, kind == "3DFACE"), []).extend(places)

    for entity in space:
        add(entity, "0")
    assert set(layer_names(path)) == {"plain", "site", "own", "in", "out"}
    for (layer, is_face), places in expected.items():
        if is_face:
            mesh = read_mesh(path, layer=layer)
            read = np.unique(mesh.vertices, axis=0)
            places = np.unique(np.round(places, 9), axis=0)
        else:
            read = read_points(path, layer=layer).xyz
        assert np.allclose(np.sort(read, axis=0), np.sort(places, axis=0), atol=1e-8)


def test_formats_that_are_not_public_say_what_to_export(put):
    with pytest.raises(InputRefused, match="export it from Vulcan as DXF or OBJ"):
        read_mesh(put("top.00t", b"\1\2\3\0"))
