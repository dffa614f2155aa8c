# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes that are not vertical: their way by minimum curvature, and the tables it comes from."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Boreholes, InputRefused, build, load_project
from realmodel.core.readers import read_picks
from realmodel.core.readers.tables.holes import WellTrajectory, direction, dogleg_angles

NEAR = {"rtol": 0, "atol": 1e-9}


def path(*stations):
    """(depth, inclination, azimuth) each."""
    return WellTrajectory([s[0] for s in stations], [direction(*s[1:]) for s in stations])


def test_a_quarter_of_a_circle_to_the_north():
    radius = 100.0
    end = radius * math.pi / 2
    hole = path((0, 0, 0), (end, 90, 0))
    for share in np.linspace(0, 1, 9):
        turned = share * math.pi / 2
        there = [0, radius * (1 - math.cos(turned)), radius * math.sin(turned)]
        np.testing.assert_allclose(hole.offset(share * end), there, **NEAR)
    np.testing.assert_allclose(hole.offset(end + 7), [0, radius + 7, radius], **NEAR)  # straight on


def test_a_level_turn_from_north_to_east():
    radius = 40.0
    end = radius * math.pi / 2
    hole = path((0, 90, 0), (end, 90, 90))
    np.testing.assert_allclose(hole.offset(end), [radius, radius, 0], **NEAR)
    middle = [radius * (1 - math.sqrt(0.5)), radius * math.sqrt(0.5), 0]
    np.testing.assert_allclose(hole.offset(end / 2), middle, **NEAR)


def test_the_textbook_example():
    """Stations at 3500 ft (15, 20) and 3600 ft (25, 45): north 27.22, east 19.45, down 94.01."""
    hole = path((3500, 15, 20), (3600, 25, 45))
    np.testing.assert_allclose(hole.offset(3600) - hole.offset(3500), [19.45, 27.22, 94.01], atol=0.005)


@pytest.mark.parametrize("inclination", [0, 30, 90, 135])
@pytest.mark.parametrize("azimuth", [0, 57, 250])
def test_straight_holes(inclination, azimuth):
    towards = np.array(direction(inclination, azimuth))
    for hole in (path((0, inclination, azimuth)), path((5, inclination, azimuth), (9, inclination, azimuth))):
        for depth in (0, 2, 5, 7, 9, 30):
            np.testing.assert_allclose(hole.offset(depth), depth * towards, **NEAR)
    assert path((0, inclination, azimuth)).is_vertical == (inclination == 0)


ANGLES = st.tuples(st.floats(0, 180), st.floats(0, 360))


@settings(max_examples=60, deadline=None)
@given(ANGLES, ANGLES, st.floats(0.1, 1000), st.floats(0.01, 0.99))
def test_arcs(first, second, length, share):
    """The way is as long as the depths say, has their directions at its ends, and stays the same where a
    station is put on it; backwards it is the same way."""
    begin, end = np.array(direction(*first)), np.array(direction(*second))
    bend = dogleg_angles(begin, end)
    if bend > 3.1:
        return
    hole = WellTrajectory([0, length], [begin, end])
    steps = np.array([hole.offset(depth) for depth in np.linspace(0, length, 65)])
    chords = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    half = bend / 64 / 2
    assert chords == pytest.approx(length / 64 * (math.sin(half) / half if half else 1), rel=1e-6)
    np.testing.assert_allclose(steps[1] - steps[0], length / 64 * begin, atol=length / 64 * (half + 1e-9))
    np.testing.assert_allclose(steps[-1] - steps[-2], length / 64 * end, atol=length / 64 * (half + 1e-9))
    away = 1e-5 * length
    towards = hole.offset(share * length + away) - hole.offset(share * length - away)
    towards /= np.linalg.norm(towards)
    split = WellTrajectory([0, share * length, length], [begin, towards, end])
    np.testing.assert_allclose(split.offset(length), hole.offset(length), atol=1e-6 * length)
    back = WellTrajectory([0, length], [-end, -begin])
    np.testing.assert_allclose(back.offset(length), -hole.offset(length), atol=1e-9 * length)


def test_a_bend_of_nothing_is_as_exact_as_a_straight_hole():
    hole = path((0, 30, 10), (1000, 30 + 1e-7, 10))
    np.testing.assert_allclose(hole.offset(1000), 1000 * np.array(direction(30, 10)), atol=1e-5)
    assert dogleg_angles(direction(30, 10), direction(30 + 1e-7, 10)) == pytest.approx(np.radians(1e-7), 1e-6)


COLLARS = "hole,x,y,z\nB1,500,700,50\nB2,100,200,60\n"
PICKS = f"hole,surface,depth\nB1,clay,{100 + 50 * math.pi}\nB1,sand,100\nB2,clay,30\n"
# 100 down, then a quarter of a circle of 100 to the east; B2 straight down
SURVEY = f"hole,depth,azimuth,dip\nB1,{100 + 50 * math.pi},90,0\nB1,0,90,-90\nB1,100,,-90\nB2,0,,-90\n"


def read(write, survey=SURVEY, collars=COLLARS, picks=PICKS, **keys):
    return read_picks(
        Boreholes(
            picks=write("p.csv", picks),
            collars=collars and write("c.csv", collars),
            survey=survey and write("s.csv", survey),
            **keys,
        )
    )


TURNED = str.maketrans("", "", "-")


@pytest.mark.parametrize(
    ("survey", "keys"),
    [
        (SURVEY, {}),
        (SURVEY.translate(TURNED), {}),
        (SURVEY.translate(TURNED), {"downward_dip": "positive"}),
        (SURVEY, {"downward_dip": "negative"}),
        (
            SURVEY.replace("dip", "inclination").replace("-90\n", "0\n").replace("90,0\nB1,0", "90,90\nB1,0"),
            {},
        ),
        (SURVEY.replace("hole,depth,azimuth,dip", "BHID,AT,BRG,DIP (deg)").replace(",", ";"), {}),
        (
            SURVEY.replace("hole,depth,azimuth,dip", "HOLE;BIS;RICHTUNG;FALLEN").replace(",", ";"),
            {"columns": {"azimuth": "RICHTUNG", "dip": "FALLEN", "depth": "BIS"}},
        ),
    ],
)
def test_tables(write, survey, keys):
    picks = PICKS.replace("depth", "BIS") if "columns" in keys else PICKS
    met = read(write, survey, picks=picks, **keys)
    np.testing.assert_allclose(met.points["clay"], [[600, 700, -150], [100, 200, 30]], **NEAR)
    np.testing.assert_allclose(met.points["sand"], [[500, 700, -50]], **NEAR)
    # A quarter of a circle between two stations is more than a hole can bend: a warning, with its line.
    assert [text for text in met.warnings if "line 2: hole 'B1' turns by 90 degrees" in text]


def test_without_a_table_of_collars(write):
    picks = "hole,x,y,z,surface,depth\nB1,500,700,50,sand,100\nB1,500,700,50,clay,120\n"
    met = read(write, "hole,depth,azimuth,inclination\nB1,0,180,60\n", None, picks)
    np.testing.assert_allclose(met.points["sand"], [[500, 700 - 100 * math.sin(math.pi / 3), 0]], **NEAR)
    assert met.warnings == []


def test_collars_with_directions(write):
    """Straight holes; a survey of a hole says more than its collar."""
    collars = "hole,x,y,z,azimuth,dip\nB1,0,0,0,270,-30\nB2,0,0,0,,-90\nB3,0,0,0,0,-60\n"
    picks = "hole,surface,depth\nB1,clay,10\nB2,clay,10\nB3,clay,10\n"
    met = read(write, "hole,depth,azimuth,dip\nB3,0,90,-30\n", collars, picks)
    across, down = 10 * math.cos(math.pi / 6), 5
    np.testing.assert_allclose(
        met.points["clay"], [[-across, 0, -down], [0, 0, -10], [across, 0, -down]], **NEAR
    )
    alone = read(write, None, collars, picks)
    np.testing.assert_allclose(
        alone.points["clay"], [[-across, 0, -down], [0, 0, -10], [0, down, -across]], **NEAR
    )
    assert alone.warnings == []


def test_a_column_that_is_called_inclination_holds_dips(write):
    """As the refusal of its angles advises."""
    collars = "hole,x,y,z,azimuth,Incl (from horizontal)\nB1,0,0,0,270,-30\n"
    picks = "hole,surface,depth\nB1,clay,10\n"
    with pytest.raises(InputRefused, match='dip = "incl"'):
        read(write, None, collars, picks)
    met = read(write, None, collars, picks, columns={"dip": "incl"})
    np.testing.assert_allclose(met.points["clay"], [[-10 * math.cos(math.pi / 6), 0, -5]], **NEAR)


def test_depths_in_feet(write):
    met = read(
        write,
        "hole,depth,azimuth,inclination\nB1,0,90,45\nB2,0,0,0\n",
        picks=PICKS.replace("100", "1000"),
        units={"z": "ft"},
    )
    side = 1000 * math.sqrt(0.5) * 0.3048
    np.testing.assert_allclose(met.points["sand"], [[500 + side, 700, 50 * 0.3048 - side]], **NEAR)


def test_surveys_without_a_match_are_a_warning(write):
    met = read(write, "hole,depth,azimuth,dip\nB1,0,90,-60\nB7,0,90,-60\n")
    assert any("no direction for B2: taken as vertical" in text for text in met.warnings)
    assert any("B7 have no collar" in text for text in met.warnings)
    np.testing.assert_allclose(met.points["clay"][1], [100, 200, 30], **NEAR)


@pytest.mark.parametrize(
    ("survey", "line", "words"),
    [
        ("hole,depth,azimuth,dip\nB1,0,90,-60\nB1,30,90,60\n", 3, "dip is 60, and -60 in line 2; say which"),
        ("hole,depth,azimuth,dip\nB1,0,90,-95\n", 2, "dip is -95; dip is measured from the horizontal"),
        (
            "hole,depth,azimuth,inclination\nB1,0,90,-60\n",
            2,
            'is a dip: columns = { dip = "incl',
        ),
        ("hole,depth,azimuth,dip\nB1,0,999,-60\n", 2, "azimuth is 999"),
        ("hole,depth,azimuth,dip\nB1,0,,-60\n", 2, "the azimuth is missing where dip is -60"),
        ("hole,depth,azimuth,dip\nB1,-3,9,-60\n", 2, "depth is -3"),
        ("hole,depth,azimuth,dip\nB1,x,9,-60\n", 2, "depth is not a number: 'x'"),
        ("hole,depth,azimuth,dip\nB1,0,9\n", 2, "4 values are needed, there are 3"),
        ("hole,depth,dip\nB1,9,9\n", 1, 'no column azimuth; name it: columns = { azimuth = "..." }'),
        ("hole,depth,azimuth\nB1,9,9\n", 2, "no column for dip (from the horizontal)"),
        ("hole,depth,azimuth,dip\n", None, "no directions"),
    ],
)
def test_surveys_refused(write, survey, line, words):
    with pytest.raises(InputRefused) as raised:
        read(write, survey)
    assert words in str(raised.value)
    assert (raised.value.file.name, raised.value.line) == ("s.csv", line)


@pytest.mark.parametrize(
    ("picks", "words"),
    [
        (
            "hole,surface,elevation\nB1,clay,6\n",
            "hole 'B1' is not vertical: an elevation does not say",
        ),
        ("hole,surface,TVD\nB1,clay,6\n", "hole 'B1' is not vertical, and TVD is a vertical depth"),
    ],
)
def test_picks_that_do_not_say_where_in_a_deviated_hole(write, picks, words):
    with pytest.raises(InputRefused) as raised:
        read(write, picks=picks)
    assert words in str(raised.value)
    assert (raised.value.file.name, raised.value.line) == ("p.csv", 2)
    # of a vertical one both say it
    met = read(write, picks=picks.replace("B1", "B2"))
    assert met.points["clay"].tolist() == [[100, 200, 6 if "elevation" in picks else 54]]


PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [700, 0], [700, 900], [0, 900]]
edge_length = 100
base_elevation = -300
boreholes = {boreholes}
[[rock.surface]]
name = "clay"
method = "plane"
[[rock.surface]]
name = "sand"
method = "constant"
"""


def test_a_project(write, tmp_path):
    for name, text in (("c.csv", COLLARS), ("p.csv", PICKS), ("s.csv", SURVEY)):
        write(name, text)
    given = '{ collars = "c.csv", survey = "s.csv", picks = "p.csv", downward_dip = "negative" }'
    project = load_project(write("p.toml", PROJECT.format(boreholes=given)))
    assert tmp_path / "s.csv" in project.input_files()
    model = build(project)
    clay = model.project.rocks[0].surfaces[0].points
    np.testing.assert_allclose(clay, [[100, 200, 30], [600, 700, -150]], **NEAR)
    for wrong, words in (
        (given.replace("s.csv", "no.csv"), "file not found"),
        (given.replace("negative", "down"), "'downward_dip' must be"),
        (given.replace('"s.csv"', "3"), "survey"),
    ):
        path = write("q.toml", PROJECT.format(boreholes=wrong))
        with pytest.raises(InputRefused) as raised:
            load_project(path)
        assert words in str(raised.value)
        assert (raised.value.file, raised.value.line) == (path, 8)


def test_angles_in_other_units_are_degrees(write):
    """Angles in any unit that the header names, beside others in degrees."""
    expected = read(write).points["clay"]
    for unit, factor in (("gon", 1 / 0.9), ("rad", math.pi / 180), ("Radians", math.pi / 180)):
        head, *lines = SURVEY.splitlines()
        rows = [line.split(",") for line in lines]
        rows = [[*row[:3], repr(float(row[3]) * factor)] for row in rows]
        text = "\n".join([head.replace("dip", f"dip ({unit})"), *map(",".join, rows)]) + "\n"
        met = read(write, text)
        np.testing.assert_allclose(met.points["clay"], expected)
        assert any("converted to degrees" in text for text in met.warnings)
