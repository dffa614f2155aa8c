# SPDX-License-Identifier: GPL-3.0-or-later
"""Points in tables of text: columns, rows that count, decimal commas, units, and the project file's keys."""

import random
import struct
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import InputRefused, PointFile, Project, Rock, Surface, build, load_project
from realmodel.core.project.project_checks import check_project
from realmodel.core.readers import read_point_file, read_points
from realmodel.core.readers.tables.points import read_point_rows

POINTS = [[1.5, 2.25, 3.125], [4.0, 5.0, -6.0]]


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("1,5;2,25;3,125\n4;5;-6\n", {}),
        ("1,5 2,25 3,125\n4 5 -6\n", {}),
        ("1,5\t2,25\t3,125\n4,0\t5,0\t-6,0\n", {}),
        ("1.5|2.25|3.125\n4|5|-6\n", {}),
        ("a|1,5|2,25|3,125\nb|4,0|5,0|-6,0\n", {"columns": [2, 3, 4]}),
        ("1.5:2.25:3.125\n4:5:-6\n", {"separator": ":"}),
        ("1,500;2,250;3,125\n4,000;5,000;-6,000\n", {"decimal": ","}),
        ("Hole #,X (m),Y [m],Z (m)\nW#3,1.5,2.25,3.125\nW#4,4,5,-6\n", {}),
        ("id,Easting,Northing,Elevation\n7,1.5,2.25,3.125\n8,4,5,-6\n", {}),
        ("Top of clay\nx y z\nm m m\n1.5 2.25 3.125\n4 5 -6\n", {}),
        ("a,b,c,d\n3.125,2.25,9,1.5\n-6,5,9,4\n", {"columns": ["d", "B", "a"]}),
        ("3.125,2.25,9,1.5\n-6,5,9,4\n", {"columns": [4, 2, 1]}),
        ("3.125,2.25,9,1.5\n-6,5,9,4\n", {"columns": ["4", 2, 1]}),
        ("# id X Y Z\n8 1.5 2.25 3.125\n9 4 5 -6\n", {}),
        ("x y z\n1.5 2.25 3.125\n4 5 -6\n".replace(" ", "\t").encode("utf-16"), {}),
        ('name x y z\n"Well 1" 1.5 2.25 3.125\n"A ""b""" 4 5 -6\n', {}),
        ("north,1.5,2.25,3.125\nsouth,4,5,-6\n", {"columns": [2, 3, 4]}),
        ("! Surfer\n> segment\n// one\n% two\n1.5 2.25 3.125 # here\n4 5 -6\n", {}),
        ("x,y,z,val\n1.5,2.25,3.125,60\n0,0,0,61\n4,5,-6,6e1\n,,,\n", {"where": {"val": 60}}),
        ("x,y,z,val\n1.5,2.25,3.125,60\n0,0,0,61\n4,5,-6,62\n", {"where": {"VAL": [60, 62]}}),
        ("1.5,2.25,3.125,60\n0,0,0,61\n4,5,-6,60\n", {"where": {"4": 60}}),
        ("x;y;z;bed\n1,5;2,25;3,125;7,5\n0;0;0;7\n4;5;-6;7,50\n", {"where": {"bed": 7.5}}),
        ("b,x,y,z\nGrès,1.5,2.25,3.125\nLoess,0,0,0\nGrès,4,5,-6\n", {"where": {"b": "Grès"}}),
        (
            "b,x,y,z\nGrès,1.5,2.25,3.125\nLoess,0,0,0\nGrès,4,5,-6\n".encode("latin-1"),
            {"where": {"b": "Grès"}},
        ),
        ('b,x,y,z\n"a, b",1.5,2.25,3.125\nab,0,0,0\n"a, b",4,5,-6\n', {"where": {"b": "a, b"}}),
        ("1.5,2.25,3.125\n1,2,-9999\n4,5,-6\n1,2,\n1,2,NaN\n", {"nodata": [-9999, "", float("nan")]}),
        ("1.5,2.25,3.125\n1,2,n/a\n4,5,-6\n", {"nodata": ["n/a"]}),
    ],
)
def test_tables_in_every_spelling(write, text, keys):
    assert read_point_rows(PointFile(write("p.txt", text), **keys)).points.tolist() == POINTS


@pytest.mark.parametrize(
    ("text", "keys", "line", "words"),
    [
        ("500,000;600,000;1,234\n", {}, 1, 'set decimal = ","'),
        ("1;2;3\n1,5;2.5;3\n", {}, 2, "decimals with a point"),
        ("1,5;2;3\n1;2.5;3\n", {"decimal": ","}, 2, "this file has decimal commas"),
        ("x,y,z\n1,2,3\n", {"columns": ["X", "Y", "elev"]}, 1, "no column elev; it has x, y, z"),
        ("1,2,3\n", {"columns": ["X", "Y", "Z"]}, None, "no header that names a column 'X'"),
        ("1,2,3\n1,2,3\n", {"columns": [1, 2, 5]}, 1, "5 values are needed, there are 3"),
        ("a,a,b\n1,2,3\n", {"columns": ["a", "a", "b"]}, 1, "2 columns named a"),
        ("x,y,z,val\n1,2,3,60\n1,2,3,0\n", {"where": {"val": 61}}, None, "no row has val = 61; among"),
        ("x,y,z,val\n1,2,3,60\n1,2,3,0\n", {"where": {"val": 61}}, None, "val has 60, 0"),
        ("x,y,z\n1,2,3\n", {"where": {"val": 61}}, 1, "no column val"),
        ("x,y,z\n1,2,-9999\n", {"nodata": [-9999]}, None, "none of its points has a value"),
        ("x,y,z\n1,2,nan\n", {}, 2, "nodata = nan"),
        ("1 # 2, 3\n1,2,3\n", {"separator": ","}, 1, "3 values are needed, there are 1"),
    ],
)
def test_tables_refused(write, text, keys, line, words):
    path = write("p.csv", text)
    with pytest.raises(InputRefused) as raised:
        read_point_rows(PointFile(path, **keys))
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_numbers_are_those_of_python(write):
    """Any way of writing a double gives the double that float() gives, bit for bit."""
    draw = random.Random(3)
    numbers = [struct.unpack("d", draw.randbytes(8))[0] for _ in range(3000)]
    texts = [
        form % number
        for number in numbers
        if abs(number) < 1e300
        for form in ("%r", "%.3e", "%.20g", "%.25e", "%+.6g")
    ]
    texts = texts[: len(texts) // 3 * 3]
    rows = [" ".join(texts[at : at + 3]) for at in range(0, len(texts), 3)]
    read = read_points(write("p.xyz", "\n".join(rows))).xyz
    assert read.tobytes() == np.array([float(text) for text in texts]).tobytes()


def test_lines_are_counted_over_pieces(write):
    """Errors far into a large file, behind many pieces, comments and other line ends, name their line."""
    lines = ["123456.25, 7654321.5, -98.75"] * 60_000
    lines[5] = "# comment"
    lines[59_998] = "123456.25, 7654321.5, -98,x"
    with pytest.raises(InputRefused) as raised:
        read_point_rows(PointFile(write("p.csv", "\r\n".join(lines)), columns=[1, 2, 4]))
    assert "values are needed" in str(raised.value)
    assert raised.value.line == 1
    lines[59_998] = "123456.25, 7654321.5, x"
    with pytest.raises(InputRefused, match="z is not a number: 'x'") as raised:
        read_points(write("q.csv", "\r\n".join(lines)))
    assert raised.value.line == 59_999


@pytest.mark.parametrize(
    ("units", "model", "expected"),
    [
        (None, "m", [1000, 2000, 100]),
        ("ft", "m", [304.8, 609.6, 30.48]),
        ({"z": "ft"}, "m", [1000, 2000, 30.48]),
        ({"xy": "km", "z": "m"}, "m", [1e6, 2e6, 100]),
        ("ft", "ft", [1000, 2000, 100]),
        ("m", "ft", [1000 / 0.3048, 2000 / 0.3048, 100 / 0.3048]),
        ("us-ft", "m", [1000 * 1200 / 3937, 2000 * 1200 / 3937, 100 * 1200 / 3937]),
    ],
)
def test_units(write, units, model, expected):
    given = PointFile(write("p.xyz", "1000 2000 100\n"), units=units)
    points, warnings = read_point_file(given, model)
    np.testing.assert_allclose(points[0], expected, rtol=1e-15)
    assert warnings == []


KEYS = """format = 1
name = "x"
{top}
[[rock]]
name = "r"
region = [[0, 0], [4, 0], [4, 4], [0, 4]]
edge_length = 1
base_elevation = -100
[[rock.surface]]
name = "S0"
points = "all.csv"
method = "plane"
{surface}
"""
ALL = "id;easting;northing;top;val\n" + "".join(
    f"{n};{x},0;{y},5;{val + 2 * x},25;{val}\n" for n, (x, y, val) in enumerate(np.ndindex(5, 4, 2))
)


def test_keys_of_the_project_file(write):
    write("all.csv", ALL)
    keys = 'columns = ["Easting", "Northing", "top"]\nwhere = { val = 1 }\nunits = { z = "ft" }'
    project = load_project(write("p.toml", KEYS.format(top='units = "m"', surface=keys)))
    surface = project.rocks[0].surfaces[0]
    assert surface.points.where == {"val": 1}
    assert Path(surface.points.file) in project.input_files()
    model = build(project)
    points = model.project.rocks[0].surfaces[0].points
    assert points.shape == (20, 3)
    z = model.surface_vertices
    np.testing.assert_allclose(z[:, 2], 0.3048 * (1.25 + 2 * z[:, 0]), atol=1e-9)
    again = load_project(write("p.toml", KEYS.format(top='units = "ft"', surface=keys)))
    z = build(again).surface_vertices
    np.testing.assert_allclose(z[:, 2], 1.25 + 2 * z[:, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("top", "surface", "line", "words"),
    [
        ("", "columns = 3", 13, "three columns"),
        ("", 'columns = ["a", "b"]', 13, "three columns"),
        ("", "columns = [0, 1, 2]", 13, "column numbers start at 1"),
        ("", "where = 60", 13, "where = { val = 60 }"),
        ("", "where = { val = true }", 13, "a number or text for 'val'"),
        ("", "where = { val = [] }", 13, "a number or text for 'val'"),
        ("", 'units = "feet"', 13, "unknown unit 'feet'; there are mm"),
        ("", 'units = { height = "ft" }', 13, "its parts are xy and z"),
        ("", "units = 3", 13, "unknown unit 3"),
        ("", 'separator = ", "', 13, "one character"),
        ("", 'separator = ","\ndecimal = ","', 14, "both"),
        ("", 'decimal = "\'"', 13, "'decimal' must be"),
        ("", "nodata = true", 13, "'nodata' must be"),
        ("", 'column = ["x"]', 13, "did you mean 'columns'?"),
        ('units = "feet"', "", 3, "unknown unit 'feet'"),
        ("units = 3", "", 3, "text in quotes"),
    ],
)
def test_keys_that_make_no_sense(write, top, surface, line, words):
    write("all.csv", ALL)
    path = write("p.toml", KEYS.format(top=top, surface=surface))
    with pytest.raises(InputRefused) as raised:
        load_project(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_keys_need_a_file_of_points(write):
    text = KEYS.format(top="", surface="where = { val = 1 }").replace('points = "all.csv"', "value = 3")
    path = write("p.toml", text.replace('"plane"', '"constant"'))
    with pytest.raises(InputRefused, match="needs a file of points") as raised:
        load_project(path)
    assert raised.value.line == 13


def test_point_files_from_python(write):
    path = write("all.csv", ALL)
    given = PointFile(path, columns=["easting", "northing", "top"], where={"val": 0})
    square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    surface = Surface("S0", points=given, method="plane")
    project = Project("x", [Rock("r", [surface], square, edge_length=1.0, base_elevation=-9.0)])
    assert build(project).volume == pytest.approx(16 * (4.25 + 9))
    surface.points = PointFile(path, where=[1])
    with pytest.raises(InputRefused, match="'where' must be"):
        check_project(project)


def test_points_without_a_value_are_a_warning(write):
    text = KEYS.format(top="", surface="nodata = -9999").replace("all.csv", "p.xyz")
    write("p.xyz", "0 0 1\n4 0 1\n4 4 1\n0 4 1\n2 2 -9999\n")
    warnings = build(load_project(write("p.toml", text))).warnings
    assert any("left out: 1 point without a value" in str(warning) for warning in warnings)


@pytest.mark.parametrize(
    "header",
    [
        "POINT_Y,POINT_Z,POINT_X",
        "Hochwert;Höhe (m);Rechtswert",
        "Norte;Cota;Este",
        "NORTHING;RL;EASTING",
    ],
)
def test_other_usual_names_of_columns(write, header):
    mark = ";" if ";" in header else ","
    file = write("p.csv", header + "\n" + "2.25,3.125,1.5\n5,-6,4\n".replace(",", mark))
    points, warnings = read_point_file(PointFile(file))
    assert points.tolist() == POINTS
    assert not warnings


def test_guessed_columns_are_a_warning(write):
    body = "1.5,2.25,3.125\n4,5,-6\n"
    points, warnings = read_point_file(PointFile(write("p.csv", "first,second,third\n" + body)))
    assert points.tolist() == POINTS
    assert "the first three, 'first', 'second', 'third', are used" in warnings[0]
    for text in ("My three wells\n" + body, body, "# first,second,third\n" + body, "x,y,z\n" + body):
        assert not read_point_file(PointFile(write("p.csv", text)))[1]
    file = write("p.csv", "first,second,third\n" + body)
    assert not read_point_file(PointFile(file, columns=["first", "second", "third"]))[1]


@pytest.mark.parametrize(
    ("heights", "left_out", "words"),
    [
        ((100, 120, -9999, -9999), 2, "2 points have the height -9999, far from all others"),
        ((100, 120, 1e30), 1, "1 point has the height 1e+30"),
        ((-3000, -2950, -999.25), 1, "1 point has the height -999.25"),
        ((-1400.5, -200, -999.25), 1, "1 point has the height -999.25, which often means no data, and"),
        (
            (-1400, -200, -999, -999),
            0,
            "2 points have the height -999, which often means no data: it is used",
        ),
        ((9990, 9999, 10010), 0, None),  # among the others
        ((-1400, -200, -999), 0, None),
        ((-9999, -9999), 0, "2 points have the height -9999, which often means no data: it is used"),
    ],
)
def test_heights_that_often_mean_no_data(write, heights, left_out, words):
    rows = "".join(f"{k},{2 * k},{z}\n" for k, z in enumerate(heights))
    file = write("p.csv", rows)
    points, warnings = read_point_file(PointFile(file))
    assert points[:, 2].tolist() == list(heights[: len(heights) - left_out])
    assert [words in text and "nodata" in text for text in warnings] == ([] if words is None else [True])
    points, warnings = read_point_file(PointFile(file, nodata="none"))
    assert len(points) == len(heights) and not warnings


def test_coordinates_that_mean_no_data(write):
    file = write(
        "p.csv", "x,y,z,id\n451000,5932000,-1600,a\n-999.25,-999.25,-1605,b\n451100,5932100,-1610,c\n"
    )
    read = read_points(file)
    assert read.xyz[:, 2].tolist() == [-1600, -1610]
    assert read.columns["id"].tolist() == ["a", "c"]
    assert len(read.warnings) == 2 and all("nodata" in text for text in read.warnings)
