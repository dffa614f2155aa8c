# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces in DXF, VTK's XML, Gmsh's MSH, Leapfrog's and LandXML, as others write them."""

from pathlib import Path

import numpy as np
import pytest
from realmodel.core import InputRefused, MeshFile, Project, Rock, Surface, build
from realmodel.core.readers import is_mesh_file, read_mesh

WHY = "is not installed: scripts/test.sh installs it"
VERTICES = np.array([[0.5, 0, 1], [1.5, 0, 2], [1.5, 1, 3], [0.5, 1, 4], [2.5, 0.5, 0.25]])
SQUARE, TRIANGLE = [0, 1, 2, 3], [1, 4, 2]


def facets(mesh):
    """The corners of each triangle, each beginning with the least, sorted."""
    found = []
    for corners in mesh.vertices[mesh.triangles].tolist():
        begin = corners.index(min(corners))
        found.append(corners[begin:] + corners[:begin])
    return sorted(found)


def expected(faces=((0, 1, 2), (0, 2, 3), (1, 4, 2))):
    class Given:
        vertices, triangles = VERTICES, np.array(faces)

    return facets(Given)


@pytest.mark.parametrize("release", ["R12", "R2000", "R2018"])
def test_dxf_of_ezdxf(tmp_path, release):
    ezdxf = pytest.importorskip("ezdxf", reason=f"ezdxf {WHY}")
    document = ezdxf.new(release)
    space = document.modelspace()
    space.add_line((0, 0), (1, 1))
    space.add_3dface(VERTICES[SQUARE].tolist(), dxfattribs={"layer": "Ground"})
    space.add_3dface(VERTICES[TRIANGLE].tolist(), dxfattribs={"layer": "GROUND"})
    document.saveas(tmp_path / "m.txt")
    assert facets(read_mesh(tmp_path / "m.txt")) == expected()


def test_dxf_polyface_and_polygon_meshes(tmp_path):
    ezdxf = pytest.importorskip("ezdxf", reason=f"ezdxf {WHY}")
    document = ezdxf.new("R2000")
    face = document.modelspace().add_polyface()
    face.append_faces([VERTICES[SQUARE].tolist(), VERTICES[TRIANGLE].tolist()])
    document.saveas(tmp_path / "f.dxf")
    assert facets(read_mesh(tmp_path / "f.dxf")) == expected()
    document = ezdxf.new("R2000")
    grid = document.modelspace().add_polymesh((2, 3))
    for m in range(2):
        for n in range(3):
            grid.set_mesh_vertex((m, n), (m, n, m + n))
    document.saveas(tmp_path / "g.dxf")
    mesh = read_mesh(tmp_path / "g.dxf")
    assert (len(mesh.vertices), len(mesh.triangles)) == (6, 4)


def vtk_grid(vtk, kind):
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.InsertNextPoint(9, 9, 9)  # used by nothing
    for place in VERTICES.tolist():
        points.InsertNextPoint(place)
    grid = vtk.vtkPolyData() if kind == "vtp" else vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.Allocate(2)
    for cell, corners in ((9, SQUARE), (5, TRIANGLE)):
        ids = vtk.vtkIdList()
        for corner in corners:
            ids.InsertNextId(corner + 1)
        grid.InsertNextCell(cell, ids)
    return grid


@pytest.mark.parametrize("kind", ["vtp", "vtu"])
@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("wide", [False, True])
def test_vtk_xml_of_vtk(tmp_path, kind, mode, compressed, wide):
    vtk = pytest.importorskip("vtk", reason=f"VTK {WHY}")
    writer = vtk.vtkXMLPolyDataWriter() if kind == "vtp" else vtk.vtkXMLUnstructuredGridWriter()
    for encoded in (True, False):
        writer.SetInputData(vtk_grid(vtk, kind))
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetEncodeAppendedData(encoded)
        writer.SetCompressor(vtk.vtkZLibDataCompressor() if compressed else None)
        writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
        writer.SetFileName(str(tmp_path / "m.xyz"))
        writer.Write()
        mesh = read_mesh(tmp_path / "m.xyz")
        assert facets(mesh) == expected()
        assert len(mesh.vertices) == 5


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_msh_of_gmsh(tmp_path, version, binary):
    gmsh = pytest.importorskip("gmsh", reason=f"Gmsh {WHY}", exc_type=ImportError)
    gmsh.initialize(interruptible=False)  # or Ctrl-C would end Python from then on
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.addDiscreteEntity(2, 1)
        tags = [11, 12, 3, 40, 5]
        gmsh.model.mesh.addNodes(2, 1, tags, VERTICES.ravel().tolist())
        gmsh.model.mesh.addElements(
            2, 1, [3, 2], [[1], [2]], [[tags[k] for k in SQUARE], [tags[k] for k in TRIANGLE]]
        )
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.option.setNumber("Mesh.SaveAll", 1)
        gmsh.write(str(tmp_path / "m.msh"))
    finally:
        gmsh.finalize()
    (tmp_path / "m.msh").rename(tmp_path / "m")
    assert facets(read_mesh(tmp_path / "m")) == expected()


def landxml(unit='<Imperial linearUnit="foot"/>'):
    points = "".join(f'<P id="{k + 7}">{y} {x} {z}</P>' for k, (x, y, z) in enumerate(VERTICES.tolist()))
    return (
        '<?xml version="1.0"?>\n<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2">\n'
        f'<Units>{unit}</Units>\n<Surfaces><Surface name="Top"><Definition surfType="TIN"><Pnts>{points}</Pnts>'  # noqa: E501
        '<Faces><F>7 8 9</F><F n="1 2">7 9 10</F><F>8 11 9</F><F i="1">7 8 11</F></Faces>'
        "</Definition></Surface></Surfaces></LandXML>"
    )


def test_landxml_and_its_unit(write):
    path = write("m.xml", landxml())
    mesh = read_mesh(path)
    assert facets(mesh) == expected()
    vertices, warnings = mesh.in_model(MeshFile(path), "m")
    assert vertices == pytest.approx(VERTICES * 0.3048)
    said = f"{path}: the header says ft for 'x and y' and 'z', "
    assert warnings == [f"{said}converted to m: if that is wrong, set units"]
    vertices, warnings = mesh.in_model(MeshFile(path, units="m"), "m")
    assert vertices == pytest.approx(VERTICES)
    assert warnings == [f"{said}but the unit is m by 'units': correct one of them if it is wrong"]
    model = build(Project("x", [Rock("r", [Surface("S", mesh=path)])]))
    assert any("the header says ft" in str(warning) for warning in model.warnings)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
PLY += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
MSH = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n"
MSH += "2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
MSH += "$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
VTP = '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData><Piece><Points><DataArray '
VTP += 'type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></Points><Polys>'
VTP += '<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray><DataArray type="Int32" '
VTP += 'Name="offsets" format="ascii">3</DataArray></Polys></Piece></PolyData></VTKFile>'


def test_a_unit_in_the_header_of_dxf_is_a_warning_and_converts_nothing(write):
    face = "0\n3DFACE\n10\n0\n11\n1\n12\n0\n22\n1\n"
    header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n2\n0\nENDSEC\n"
    text = f"{header}0\nSECTION\n2\nENTITIES\n{face}0\nENDSEC\n0\nEOF\n"
    path = write("m.dxf", text)
    mesh = read_mesh(path)
    for given, unit, count in (
        (MeshFile(path), "m", 1),
        (MeshFile(path), "ft", 0),
        (MeshFile(path, "ft"), "m", 0),
    ):
        vertices, warnings = mesh.in_model(given, unit)
        assert len(warnings) == count
        assert vertices.max() == (0.3048 if given.units else 1.0)
        assert all(
            'its header says ft; it is read in the unit of the model, m: write units = "ft"' in w
            for w in warnings
        )


@pytest.mark.parametrize(
    ("axes", "top", "said"),
    [
        ('"ft" "ft" "ft"', (0.3048, 0.3048), ["'x and y' and 'z'"]),
        ('" m " " m " " m "', (1.0, 1.0), []),
        ('"Metres" "METERS" "Feet"', (1.0, 0.3048), ["'z'"]),
        ('"none" "none" "none"', (1.0, 1.0), []),
        ("m m m", (1.0, 1.0), []),
    ],
)  # fmt: skip
def test_each_unit_of_an_axis_of_gocad_is_obeyed(write, axes, top, said):
    path = write("m.ts", TSURF_AXES.replace("AXES", axes))
    vertices, warnings = read_mesh(path).in_model(MeshFile(path), "m")
    assert (vertices[:, 0].max(), vertices[:, 2].max()) == top
    what = "converted to m: if that is wrong, set units"
    assert warnings == [f"{path}: the header says ft for {axes}, {what}" for axes in said]


def test_an_unknown_unit_is_refused_and_one_that_is_said_is_used(write):
    path = write("m.ts", TSURF_AXES.replace("AXES", '"furlongs" "furlongs" "furlongs"'))
    with pytest.raises(InputRefused, match="unit 'furlongs' of 'x and y' is not known; set units"):
        read_mesh(path).in_model(MeshFile(path), "m")
    vertices, _ = read_mesh(path).in_model(MeshFile(path, units="km"), "m")
    assert vertices[:, 2].max() == 1000.0


TSURF_AXES = """GOCAD TSurf 1
HEADER {
name: a
}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
NAME Default
AXIS_NAME "X" "Y" "Z"
AXIS_UNIT AXES
ZPOSITIVE Elevation
END_ORIGINAL_COORDINATE_SYSTEM
TFACE
VRTX 1 0 0 1
VRTX 2 1 0 1
VRTX 3 0 1 1
TRGL 1 2 3
END
"""


def test_properties_of_tsurf_are_a_warning(write):
    text = (
        'GOCAD TSurf 1\nHEADER {\nname:a\n}\nGOCAD_ORIGINAL_COORDINATE_SYSTEM\nAXIS_UNIT "ft" "ft" "ft"\n'
        "ZPOSITIVE Depth\nEND_ORIGINAL_COORDINATE_SYSTEM\nPROPERTIES age porosity\nTFACE\n"
        "PVRTX 1 0 0 1 5 6\nPVRTX 2 1 0 1 5 6\nPVRTX 3 0 1 1 5 6\nTRGL 1 2 3\nEND\n"
    )
    path = write("m.ts", text)
    mesh = read_mesh(path)
    assert mesh.vertices[:, 2].tolist() == [-1, -1, -1]
    assert mesh.unit == "ft"
    _, warnings = mesh.in_model(MeshFile(path), "ft")
    assert warnings == [f"{path}: its properties age, porosity are not read"]


def test_tsurf_of_loopstructural():
    """Written by LoopStructural 1.9 (its export/gocad.py), with a property."""
    path = Path(__file__).parents[1] / "data" / "meshes" / "loopstructural.ts"
    mesh = read_mesh(path)
    assert facets(mesh) == expected()
    assert mesh.unit == "m"
    assert mesh.warnings == ("its properties val are not read",)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("obj", b"# by hand\n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("obj", b"mtllib a.mtl\no a b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        (
            "stl",
            b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",  # noqa: E501
        ),
    ],
)
def test_the_format_of_a_mesh_is_detected_from_its_content(write, name, content):
    assert is_mesh_file(write(f"{name}.txt", content))
    assert not is_mesh_file(write("p.txt", "x y z\n0 0 1\n1 0 1\n"))
    assert len(read_mesh(write(f"{name}.txt", content)).triangles) == 1


MARK = bytes(
    [255, 15, 240, 0, 27, 222, 131, 66, 202, 192, 243, 63]
)  # of every file of Leapfrog that is known


def leapfrog(index, *arrays, end=b""):
    return b"%ARANZ-1.0\n\n[index]\n" + index + b"\n[binary]" + end + MARK + b"".join(arrays)


@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n"])
def test_msh_of_leapfrog(write, end):
    """Arrays stand in the order of the index, which may have more of them."""
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]], "<i4").tobytes()
    places, colors = VERTICES.astype("<f8").tobytes(), np.arange(5, dtype="<i4").tobytes()
    first = leapfrog(b"Tri Integer 3 3;\nLocation Double 3 5;\n", triangles, places, end=end)
    index = b"Location Double 3 5;\nColour Integer 1 5;\nTri Integer 3 3;\n"
    for content in (first, leapfrog(index, places, colors, triangles, end=end)):
        assert facets(read_mesh(write("m.msh", content))) == expected()


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (
            leapfrog(b"Tri Integer 3 1;\nLocation Double 3 3;\n", bytes(80)),
            "sizes of its arrays differ from its index",
        ),
        (leapfrog(b"Tri Integer 3 1;\n", bytes(12)), "missing: 'Location'"),
        (leapfrog(b"Tri Integer 2 1;\nLocation Double 3 3;\n", bytes(80)), "not three numbers"),
        (leapfrog(b"Tri Text 3 1;\nLocation Double 3 3;\n", bytes(84)), "unknown or missing: 'Text'"),
        (leapfrog(b"Tri Integer 3 1;\nLocation Double 3 3;\n", b"\xff" * 12, bytes(72)), "no vertex"),
    ],
)
def test_a_damaged_msh_of_leapfrog_is_refused(write, content, match):
    with pytest.raises(InputRefused, match=match):
        read_mesh(write("m.msh", content))


@pytest.mark.parametrize(
    ("name", "content", "match"),
    [
        ("m.xml", landxml().replace("<F>8 11 9</F>", "<F>8 11 99</F>"), r"surface 'Top': '8 11 99' cannot be read"),  # noqa: E501
        ("m.ply", PLY + "0 0 1\n1 0 2\n1 1 3\n3 0 1", r"m\.ply:13: .* cut off, or a count is wrong"),
        ("m.ply", PLY.replace("vertex 3", "vertex 9") + "0 0 1\n1 0 2\n1 1 3\n3 0 1 2\n", r"m\.ply:10: .* cut off"),  # noqa: E501
        ("m.ply", PLY.replace("ascii", "binary_little_endian") + "0123456789" * 4, r"cut off, .* \(byte 206\)"),  # noqa: E501
        ("m.stl", "solid a\n" + FACET + FACET.replace("vertex 0 1 0\n", "") + FACET, r"m\.stl:9: .* does not have three vertices"),  # noqa: E501
        ("m.stl", "x" * 80 + "\x03\0\0\0" + "x" * 60, r"3 triangles are announced, the file is cut off at byte 144"),  # noqa: E501
        ("m.msh", MSH.replace("1 3 1 3\n", "1 9 1 9\n").replace("2 1 0 3", "2 1 0 9"), r"m\.msh:12: .* the file is cut off"),  # noqa: E501
        ("m.msh", MSH[:-20], r"no whole section Elements \(byte \d+\); the file is cut off"),
        ("m.vtp", VTP.replace("0 1 2<", "0 1 x<"), r"array 'connectivity': invalid literal"),
        ("m.xml", landxml()[:-30], r"m\.xml:4: damaged XML"),
        ("m.xml", "<!DOCTYPE a [<!ENTITY b 'c'>]>" + landxml(), "document type"),
        ("m.dxf", "0\nSECTION\n2\nENTITIES\n0\n3DFACE\n10\nx\n0\nENDSEC\n0\nEOF\n", r"m\.dxf:6: a 3DFACE that cannot"),  # noqa: E501
        ("m.dxf", "0\nSECTION\n2\nENTITIES\n0\n3DFACE\n10\n", r"m\.dxf:8: the file has no EOF"),
        ("m.dxf", "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n", "no 3D faces, lines or points"),
        ("m.dxf", "0\nSECTION\nxx\nENTITIES\n", r"m\.dxf:3: 'xx' is no group code"),
        ("m.msh", "$MeshFormat\n3 0 8\n$EndMeshFormat\n$Nodes\n$EndNodes\n$Elements\n$EndElements\n", "MSH 3 is not read"),  # noqa: E501
        ("m.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "no whole section Nodes"),
        (
            "m.msh",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n999999999999\n1 0 0 0\n$EndNodes\n$Elements\n0\n$EndElements\n",  # noqa: E501
            "999999999999 entries are announced, the file is cut off",
        ),
    ],
)  # fmt: skip
def test_damaged_meshes_are_refused_with_the_place(write, name, content, match):
    with pytest.raises(InputRefused, match=match):
        read_mesh(write(name, content))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "$NOD\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$ENDNOD\n$ELM\n1\n1 2 1 1 3 1 2 3\n$ENDELM\n",
            "MSH 1 is not read",
        ),
        ('(0 "GAMBIT to Fluent File")\n(2 3)\n(10 (0 1 4 1 3))\n', "no mesh of Gmsh or Leapfrog"),
    ],
)
def test_other_meshes_that_end_in_msh_are_named(write, text, words):
    with pytest.raises(InputRefused, match=f"{words}; save it as"):
        read_mesh(write("a.msh", text))
