# SPDX-License-Identifier: GPL-3.0-or-later
"""What editors and old systems put around text, in every format of text: the mark of UTF-8, UTF-16, the sign
with which files of DOS end, lines that end in \\r\\n or \\r. The content is the same."""

import numpy as np
import pytest
from realmodel.core import read_mesh, read_points

GRID = "ncols 2\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\n1 2\n3 4\n"
FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
FILES = {
    "a.csv": "x,y,z,note\n1,2,3,a\n4,5,6,b\n",
    "a.asc": GRID,
    "a.grd": "DSAA\n2 2\n0 10\n0 20\n1 4\n1 2\n3 4\n",
    "a.zmap": "! c\n@GRID FILE, GRID, 2\n15, 1e30, , 7, 1\n2, 2, 0, 10, 0, 20\n0.0, 0.0, 0.0\n@\n1 2\n3 4\n",
    "a.cps": "FSASCI 0 1 COMPUTED 0 1.0E+30\nFSATTR 0 0\nFSLIMI 0 10 0 20 1 4\nFSNROW 2 2\nFSXINC 10 20\n"
    "1 2\n3 4\n",
    "a.irap": "-996 2 10 20\n0 10 0 20\n2 0 0 0\n0 0 0 0 0 0 0\n1 2 3 4\n",
    "a.pol": "1 2 3\n2 2 3\n999 999 999\n",
    "a.wkt": "POINT Z (1 2 3)\n",
    "a.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "a.off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    "a.stl": f"solid a\n{FACET}endsolid a\n",
    "a.ts": "GOCAD TSurf 1\nHEADER {\nname:A\n}\nTFACE\nVRTX 1 0 0 -5\nVRTX 2 1 0 -5\nVRTX 3 0 1 -5\n"
    "TRGL 1 2 3\nEND\n",
    "a.vtk": "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n"
    "POLYGONS 1 4\n3 0 1 2\n",
    "a.dxf": "0\nSECTION\n2\nENTITIES\n0\n3DFACE\n8\nTOP\n10\n0\n20\n0\n30\n5\n11\n1\n21\n0\n31\n5\n"
    "12\n0\n22\n1\n32\n5\n13\n0\n23\n1\n33\n5\n0\nENDSEC\n0\nEOF\n",
}
MESHES = (".obj", ".off", ".stl", ".ts", ".vtk", ".dxf")


def content(file):
    if file.suffix in MESHES:
        mesh = read_mesh(file)
        return mesh.vertices[mesh.triangles]
    return read_points(file).xyz


@pytest.mark.parametrize("name", FILES)
def test_marks_around_text_change_nothing(tmp_path, name):
    text = FILES[name]
    written = {
        "BOM": b"\xef\xbb\xbf" + text.encode(),
        "UTF-16": text.encode("utf-16"),
        "DOS": text.replace("\n", "\r\n").encode() + b"\x1a",
        "lines": text.encode() + b"\n\n",
    }
    if name != "a.vtk":
        written["old Mac"] = text.replace("\n", "\r").encode()
    (file := tmp_path / name).write_text(text)
    expected = content(file)
    assert len(expected)
    for what, data in written.items():
        file.write_bytes(data)
        np.testing.assert_array_equal(content(file), expected, err_msg=what)


def test_rows_that_excel_leaves_empty(tmp_path):
    (file := tmp_path / "a.csv").write_text("x,y,z,note\n1,2,3,\n4,5,6,\n,,,\r\n,,,\n")
    assert read_points(file).xyz.tolist() == [[1, 2, 3], [4, 5, 6]]
    file.write_text("x,y,z\n1,2,3\n4,5,\n,,\n")  # an empty entry of the last row stays one
    assert read_points(file, nodata="").xyz.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize(
    ("text", "z"),
    [
        ('x,y,z,note\n1,2,3,"wet\nand, soft"\n4,5,6,b\n', [3, 6]),
        ('"x\n(m)","y\n(m)","z\n(m)"\n1,2,3\n4,5,6\n', [3, 6]),
        ('x,y,z,pipe\n1,2,3,5" steel\n4,5,6,6" steel\n7,8,9,\n', [3, 6, 9]),  # no quotes but inches
        ('x,y,z,note\n1,2,3,"never closed\n4,5,6,b\n', [3, 6]),
    ],
)
def test_texts_in_quotes_go_on_in_further_lines(tmp_path, text, z):
    (file := tmp_path / "a.csv").write_bytes(text.encode())
    assert read_points(file).xyz[:, 2].tolist() == z
    file.write_bytes(text.replace("\n", "\r\n").encode())
    assert read_points(file).xyz[:, 2].tolist() == z
