# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of other programs: OBJ, STL, PLY, GOCAD TSurf."""

import struct

import numpy as np
import pytest
from realmodel.core import InputRefused, Project, Rock, Surface, build
from realmodel.core.readers import read_mesh
from realmodel.core.readers.formats import MESH, OBJECTS, endings

SQUARE = np.array([[0.5, 0, 1], [1.5, 0, 2], [1.5, 1, 3], [0.5, 1, 4]])


def facets(mesh):
    """The corners of each triangle, (T, 3, 3)."""
    return mesh.vertices[mesh.triangles]


OBJ = "v 0.5 0 1\nv 1.5 0 2 0.1 0.2 0.3\nv 1.5 1 3\nv 0.5 1 4\nvt 0 0\n"
PLY = """ply
format ascii 1.0
comment made by hand
element vertex 4
property double x
property double y
property double z
property uchar red
element face 1
property uchar flag
property list uchar int vertex_index
element edge 1
property int vertex1
end_header
0.5 0 1 9
1.5 0 2 9
1.5 1 3 9
0.5 1 4 9
7 4 0 1 2 3
0
"""
TSURF = """GOCAD TSurf 1
HEADER {
name: top
}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
ZPOSITIVE Depth
END_ORIGINAL_COORDINATE_SYSTEM
TFACE
VRTX 1 0.5 0 -1
PVRTX 2 1.5 0 -2 0.7
VRTX 7 1.5 1 -3
ATOM 8 7
VRTX 9 0.5 1 -4
TRGL 1 2 8
TRGL 1 7 9
END
"""


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("square.obj", OBJ + "f 1/1 2/1 3/1 4/1\n"),
        ("relative.obj", OBJ + "f -4 -3 -2 -1\n"),
        ("two.obj", OBJ + "o a\nf 1 2 3\ng b\nf 1//5 3//5 4//5\n"),
        ("square.ply", PLY),
        ("square.ts", TSURF),
    ],
)
def test_a_square_is_read(write, name, text):
    mesh = read_mesh(write(name, text))
    assert facets(mesh).tolist() == SQUARE[[[0, 1, 2], [0, 2, 3]]].tolist()
    assert mesh.triangles.dtype == np.int32
    assert (mesh.face_of_triangle is None) == (name in ("two.obj", "square.ts"))


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("sizes", [(3, 3), (3, 4), (4, 4)])
def test_binary_ply_of_triangles_and_squares(write, order, sizes):
    mark = "<" if order == "little" else ">"
    head = (
        f"ply\nformat binary_{order}_endian 1.0\nelement material 1\nproperty short id\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty double z\nelement face 2\n"
        "property list uchar ushort vertex_indices\nproperty short group\nend_header\n"
    )
    body = struct.pack(f"{mark}h", 5)
    body += b"".join(struct.pack(f"{mark}ffd", *vertex) for vertex in SQUARE)
    body += b"".join(struct.pack(f"{mark}B{n}Hh", n, *range(n), 1) for n in sizes)
    mesh = read_mesh(write("m.ply", head.encode() + body))
    assert mesh.vertices.tolist() == SQUARE.tolist()
    expected = [triangle for n in sizes for triangle in [[0, 1, 2], [0, 2, 3]][: n - 2]]
    assert mesh.triangles.tolist() == expected


def stl_text():
    lines = ["solid a"]
    for a, b, c in SQUARE[[[0, 1, 2], [0, 2, 3]]].tolist():
        corners = [f"vertex {x} {y} {z}" for x, y, z in (a, b, c)]
        lines += ["facet normal 0 0 1", "outer loop", *corners, "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid a", ""])


def stl_binary(head):
    facet = [struct.pack("<12fH", 0, 0, 1, *corners.ravel(), 0) for corners in SQUARE[[[0, 1, 2], [0, 2, 3]]]]
    return head.ljust(80, b"\0") + struct.pack("<I", 2) + b"".join(facet)


@pytest.mark.parametrize("content", [stl_text(), stl_binary(b"made"), stl_binary(b"solid, but binary")])
def test_stl_shares_vertices(write, content):
    mesh = read_mesh(write("m.stl", content))
    assert len(mesh.vertices) == 4
    assert facets(mesh).tolist() == SQUARE[[[0, 1, 2], [0, 2, 3]]].tolist()


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("m.obj", OBJ + "f 1 2 5\n", r"m\.obj:6: face 1 has a corner that is no vertex"),
        ("m.obj", OBJ + "f 1 2 0\n", r"m\.obj:6: face 1 has a corner that is no vertex"),
        ("m.obj", OBJ + "f 1 2\n", r"m\.obj:6: a face of 2 corners"),
        ("m.obj", "v 1 2\n", r"m\.obj:1: 'v 1 2' cannot be read"),
        ("m.obj", "v 1 nan 2\nf 1 1 1\n", "vertex 1 is not finite"),
        ("m.obj", OBJ, "has no faces; if it holds points"),
        ("m.ts", TSURF.replace("TRGL 1 2 8", "TRGL 1 2 6"), r"m\.ts:14: 'TRGL 1 2 6' cannot be read"),
        ("m.ts", "GOCAD Voxet 1\nHEADER {\nname: a\n}\nEND\n", "a GOCAD Voxet, which is not read"),
        (
            "m.ts",
            "GOCAD PLine 1\nVRTX 1 0 0 0\nVRTX 2 1 0 0\nSEG 1 2\nEND\n",
            "has no faces; if it holds points",
        ),
        ("m.ply", PLY.replace("4 0 1 2 3", "4 0 1 2 9"), "face 1 has a corner"),
        ("m.ply", PLY.replace("4 0 1 2 3", "4 0 1 2 0.5"), "face 1 has a corner"),
        ("m.ply", PLY.replace("vertex 4", "vertex 400000000000"), "not a PLY file"),
        ("m.ply", PLY.replace("4 0 1 2 3", "-1 0 1 2 3"), "it is cut off, or a count is wrong"),
        ("m.stl", stl_binary(b"")[:-1], "2 triangles are announced, the file is cut off"),
        ("m.stl", stl_text().replace("vertex 1.5 1.0 3.0", "", 1), "does not have three vertices"),
        ("m.stl", b"", "cut off"),
    ],
)
def test_damaged_meshes_are_refused_by_name(write, name, text, said):
    with pytest.raises(InputRefused, match=said):
        read_mesh(write(name, text))


def test_a_project_takes_such_meshes(write):
    floor = write("floor.obj", OBJ.replace(" 2 0.1", " 0 0.1").replace("1 3", "1 0") + "f 1 2 3 4\n")
    surfaces = [Surface("floor", mesh=floor), Surface("top", mesh=write("top.ts", TSURF))]
    model = build(Project("p", [Rock("r", surfaces)]))
    assert model.volume > 0
    assert {".obj", ".stl", ".ply", ".ts"} <= set(endings(MESH, OBJECTS))
