# SPDX-License-Identifier: GPL-3.0-or-later
"""Points, meshes and regions from files: every way of writing them, every way of getting it wrong."""

import numpy as np
import pytest
from realmodel.core import Cancelled, InputRefused, PointFile
from realmodel.core.readers import read_off, read_points, read_region
from realmodel.core.readers.tables.points import read_point_rows

POINTS = [[1.0, 2.0, 3.0], [-4.5, 5e3, 0.25]]


@pytest.mark.parametrize(
    "text",
    [
        "1,2,3\n-4.5,5e3,.25\n",
        "1;2;3\n-4.5;5000;0.25",
        "1\t2\t3\r\n-4.5\t5E+3\t0.25\r\n",
        "1 2 3\n  -4.5   5000 0.25 \n",
        "1 2 3\t\n-4.5 5000 0.25\n",
        "x,y,z\n1,2,3\n-4.5,5e3,0.25\n",
        "Z;Y;X\n3;2;1\n0.25;5000;-4.5\n",
        ",X,Y,Z,val,name\n0,1,2,3,9,a\n1,-4.5,5000,.25,,\n",
        "east,north,height\n1,2,3\n-4.5,5000,.25\n",
        '"X","Y","Z"\n"1","2","3"\n"-4.5","5000","0.25"\n',
        'x,y,z,name\n1,2,3,"a, b"\n-4.5,5000,0.25,\n',
        "# comment\n\n1, 2, 3, # last\n#\n-4.5, 5000, 0.25, 7\n\n",
        "\ufeffx y z\n1 2 3\n+1 2 3 # again\n".replace("+1 2 3 # again", "-4.5 5000 .25"),
        "x,y,z,note\n1,2,3,é\n-4.5,5000,.25,ü\n".encode("latin-1"),
        "1 2 3\r-4.5 5000 0.25\r",
    ],
)
def test_points_in_every_spelling(write, text):
    assert read_points(write("p.csv", text)).xyz.tolist() == POINTS


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", None, "no rows"),
        ("\n# only\n", None, "no rows"),
        ("x,y,z\n", None, "no points"),
        ("1,2,3\n1,2\n", 2, "3 values are needed, there are 2"),
        ("1,2,3\n\n1,,3\n", 3, "y is not a number: ''"),
        ("1,2,3\n# c\n1,abc,3\n", 3, "y is not a number: 'abc'"),
        ("1,2,nan\n", 1, "z is nan"),
        ("x,y,z\n1,2,3\n1,-INF,3\n", 3, "y is -INF"),
        ("1 2 3\n1 2 1e999\n", 2, "too large"),
        ("1,2,3\n1,2,0x10\n", 2, "not a number"),
        ("1,2,3\n1,2,1_0\n", 2, "not a number"),
        ("x,y,thickness\n1,2,3\n", 1, "no column z"),
        ("x,y,z,x\n1,2,3,4\n", 1, "2 columns named x"),
        ("id,1,z\n1,2,3\n", 1, "no column x"),
        ("name,1,2\n1,2,3\n", 1, "not a number"),
        (b"\x00\x01\x02", None, "binary"),
    ],
)
def test_points_refused_with_the_line(write, text, line, words):
    path = write("p.csv", text)
    with pytest.raises(InputRefused) as raised:
        read_points(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_a_bad_line_among_many_is_named(write):
    lines = ["0 0 0"] * 100_000
    lines[77_776] = "0 0 x"
    with pytest.raises(InputRefused) as raised:
        read_points(write("p.xyz", "\n".join(lines)))
    assert raised.value.line == 77_777


def test_a_million_points(tmp_path):
    """Exact, with progress in small steps, and it can be stopped."""
    points = np.random.default_rng(1).random((1_000_000, 3)).round(9)
    text = "\n".join(map("{0[0]!r},{0[1]!r},{0[2]!r}".format, points.tolist()))
    path = tmp_path / "p.csv"
    path.write_text(text)
    steps = []
    read = read_point_rows(PointFile(path), steps.append).points
    assert np.array_equal(read, points)
    assert len(steps) >= 50
    assert steps == sorted(steps)

    def stop(_share):
        raise Cancelled("stop")

    with pytest.raises(Cancelled):
        read_point_rows(PointFile(path), stop)


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]]
CORNERS = "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n"


@pytest.mark.parametrize(
    "text",
    [
        "OFF\n4 2 0\n" + CORNERS + "3 0 1 2\n3 0 2 3\n",
        "OFF 4 2 5\n" + CORNERS + "3 0 1 2\n3 0 2 3\n",
        "# made by hand\nOFF # so\n\n4 2 0 # counts\n" + CORNERS + "# faces\n3 0 1 2 # first\n\n3 0 2 3",
        "OFF\r\n4 2 0\r\n" + CORNERS.replace("\n", "\r\n") + "3 0 1 2\r\n3 0 2 3\r\n",
        "COFF\n4 2 0\n" + CORNERS.replace("\n", " 255 0 0 255\n") + "3 0 1 2\n3 0 2 3\n",
        "OFF\n4 2 0\n" + CORNERS + "3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 0.5\n",
        "OFF\n4 2\n" + CORNERS + "3 0 1 2\n3 0 2 3\n",
    ],
)
def test_off_in_every_spelling(write, text):
    mesh = read_off(write("m.off", text))
    assert mesh.vertices.tolist() == SQUARE
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert (mesh.vertices.dtype, mesh.triangles.dtype) == (np.float64, np.int32)


def test_off_polygons_are_fanned(write):
    text = "OFF\n5 2 0\n0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n3 4 3 2\n"
    mesh = read_off(write("m.off", text))
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 3, 2]]
    assert mesh.face_of_triangle.tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", None, "empty"),
        ("PLY\n", 1, "does not begin with OFF"),
        ("OFF BINARY\n", 1, "binary"),
        ("OFF\n", 1, "missing"),
        ("OFF\n4 x 0\n", 2, "numbers of vertices and faces"),
        ("OFF\n4\n", 2, "numbers of vertices and faces"),
        ("OFF\n0 0 0\n", 2, "no vertices or no faces"),
        ("OFF\n4 2 0\n0 0 0\n1 0 0\n", 4, "4 vertices are announced, there are 2"),
        ("OFF\n4 2 0\n" + CORNERS + "3 0 1 2\n", 7, "2 faces are announced, there are 1"),
        ("OFF\n4 1 0\n" + CORNERS + "3 0 1 2\n3 0 2 3\n", 8, "more than the 4 vertices and 1 faces"),
        ("OFF\n3 1 0\n0 0 0\n\n1 0\n0 1 0\n3 0 1 2\n", 5, "needs 3 finite coordinates, there is '1 0'"),
        ("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 4, "finite coordinates, there is '1 0 nan'"),
        ("OFF\n3 1 0\n0 0 0\n1 0 z\n0 1 0\n3 0 1 2\n", 4, "there is '1 0 z'"),
        ("OFF\n3 1 0\n0 0 0\n1 0 1e999\n0 1 0\n3 0 1 2\n", 4, "finite coordinates"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6, "face 1 has a corner that is no vertex"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6, "face 1 has a corner that is no vertex"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", 6, "at least 3"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 6, "a face is its number of corners"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 x\n", 6, "vertex numbers"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", 6, "vertex numbers"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\nx 0 1 2\n", 6, "number of corners"),
        ("OFF\n4 1 0\n" + CORNERS + "4 0 1 2 9\n", 7, "no vertex"),
    ],
)
def test_off_refused_with_the_line(write, text, line, words):
    path = write("m.off", text)
    with pytest.raises(InputRefused) as raised:
        read_off(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_absent_files_are_named(tmp_path):
    for read in (read_off, read_points, read_region):
        with pytest.raises(InputRefused, match=r"none\.x: cannot be read: No such file"):
            read(tmp_path / "none.x")


RING = "[[0,0],[4,0],[4,4],[0,0]]"
HOLE = "[[1,0.5],[2,0.5],[2,1],[1,0.5]]"
POLYGON = f'{{"type":"Polygon","coordinates":[{RING},{HOLE}]}}'


@pytest.mark.parametrize(
    "text",
    [
        POLYGON,
        f'{{"type":"MultiPolygon","coordinates":[[{RING}],[{HOLE}]]}}',
        f'{{"type":"Feature","properties":{{}},"geometry":{POLYGON}}}',
        f'{{"type":"FeatureCollection","features":[{{"type":"Feature","geometry":{POLYGON}}},'
        '{"type":"Feature","geometry":null}]}',
        f'{{"type":"GeometryCollection","geometries":[{POLYGON}]}}',
        POLYGON.replace("[4,4]", "[4,4,99]"),
        POLYGON.replace("[4,4],[0,0]]", "[4,4]]"),
        "\ufeff" + POLYGON,
    ],
)
def test_regions_in_every_wrapping(write, text):
    rings, left_out = read_region(write("r.geojson", text))
    assert [ring.tolist() for ring in rings] == [[[0, 0], [4, 0], [4, 4]], [[1, 0.5], [2, 0.5], [2, 1]]]
    assert left_out == []


def test_region_says_what_it_leaves_out(write):
    text = f'{{"type":"GeometryCollection","geometries":[{{"type":"Point","coordinates":[0,0]}},{POLYGON}]}}'
    rings, left_out = read_region(write("r.geojson", text))
    assert len(rings) == 2
    assert "geometry 1 is a Point" in left_out[0]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ('{"type":\n "Polygon",\n "coordinates": [}', 3, "not valid JSON"),
        ("", 1, "not valid JSON"),
        ('{"type":"Polygon",\n"coordinates":[[[0,0],[1,0],\n[0,NaN]]]}', 3, "NaN is not a finite"),
        ("[1, 2]", None, "not GeoJSON"),
        ('{"type":"Polygn"}', None, "'Polygn'"),
        ('{"type":"Polygon"}', None, "without a list 'coordinates'"),
        ('{"type":"FeatureCollection"}', None, "without a list 'features'"),
        ('{"type":"FeatureCollection","features":[]}', None, "no polygon"),
        ('{"type":"Point","coordinates":[0,0]}', None, "no polygon"),
        (
            '{"type":"FeatureCollection","features":[{"type":"Feature"}]}',
            None,
            "feature 1: a Feature has no geom",
        ),
        ('{"type":"Polygon","coordinates":[[[0,0],[1,0]]]}', None, "ring 1: a ring needs at least 3"),
        ('{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,"a"]]]}', None, "position 3 is not [x, y]"),
        ('{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1e999]]]}', None, "3 is not [x, y], finite"),
        ('{"type":"Polygon","coordinates":[3]}', None, "ring 1"),
        (b'{"type":"\xff"}', None, "UTF-8"),
    ],
)
def test_regions_refused(write, text, line, words):
    path = write("r.geojson", text)
    with pytest.raises(InputRefused) as raised:
        read_region(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)
