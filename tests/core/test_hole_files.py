# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold all tables of boreholes: AGS and others, by small reconstructions."""

import numpy as np
import pytest
from realmodel.core import InputRefused, build, load_project, read_boreholes
from test_reported_boreholes import LOG, PLACES, assert_layers

PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [100, 0], [100, 100], [0, 100]]
edge_length = 10
base_elevation = -60
boreholes = {boreholes}
"""
for _name in "CBA":
    PROJECT += f'[[rock.surface]]\nname = "{_name}"\nblock = "{_name}"\nmethod = "tin"\n'


def quoted(*rows):
    return "".join(",".join(f'"{entry}"' for entry in row) + "\r\n" for row in rows)


def ags4(unit="m", by=1.0):
    locations = [("DATA", hole, x * by, y * by, 0, 40 * by) for hole, (x, y) in PLACES.items()]
    layers = [
        ("DATA", hole, begin * by, end * by, 'Soft ""organic"" CLAY, sandy', code)
        for hole in PLACES
        for begin, end, code in LOG
    ]
    return quoted(
        ("GROUP", "PROJ"),
        ("HEADING", "PROJ_ID"),
        ("UNIT", ""),
        ("TYPE", "ID"),
        ("DATA", "Löß"),
        ("GROUP", "LOCA"),
        ("HEADING", "LOCA_ID", "LOCA_NATE", "LOCA_NATN", "LOCA_GL", "LOCA_FDEP"),
        ("UNIT", "", unit, unit, unit, unit),
        ("TYPE", "ID", "2DP", "2DP", "2DP", "2DP"),
        *locations,
        ("GROUP", "GEOL"),
        ("HEADING", "LOCA_ID", "GEOL_TOP", "GEOL_BASE", "GEOL_DESC", "GEOL_LEG"),
        ("UNIT", "", unit, unit, "", ""),
        ("TYPE", "ID", "2DP", "2DP", "X", "PA"),
        *layers,
    )


def ags3():
    locations = [(hole, x, y, 0, 40) for hole, (x, y) in PLACES.items()]
    layers = [(hole, begin, end, "Soft CL", code) for hole in PLACES for begin, end, code in LOG]
    with_more = [row for layer in layers for row in (layer, ("<CONT>", "", "", "AY", ""))]
    return quoted(
        ("**PROJ",),
        ("*PROJ_ID", "*?PROJ_NAME"),
        ("<UNITS>", ""),
        ("1", "x"),
        ("**HOLE",),
        ("*HOLE_ID", "*HOLE_NATE", "*HOLE_NATN"),
        ("*HOLE_GL", "*HOLE_FDEP"),
        ("<UNITS>", "m", "m", "m", "m"),
        *locations,
        ("**GEOL",),
        ("*HOLE_ID", "*GEOL_TOP", "*GEOL_BASE", "*?GEOL_DESC", "*GEOL_GEOL"),
        ("<UNITS>", "m", "m", "", ""),
        *with_more,
    )


@pytest.mark.parametrize(
    "content", [b"\xef\xbb\xbf" + ags4().encode(), ags4().encode("cp1252"), ags3().encode()]
)
def test_ags(write, content):
    """A20."""
    path = write("site.ags", content)
    for boreholes in ('"site.ags"', '{ file = "site.ags" }', '{ intervals = "site.ags" }'):
        assert_layers(build(load_project(write("p.toml", PROJECT.format(boreholes=boreholes)))))
    found = read_boreholes(path)
    assert list(found.collars) == ["hole", "x", "y", "z", "end"] and len(found.collars) == 5
    assert list(found.intervals) == ["hole", "from", "to", "block"] and len(found.intervals) == 15
    assert len(found.picks) == len(found.survey) == len(found.problems) == len(found.warnings) == 0


def test_units_of_ags_are_obeyed(write):
    found = read_boreholes(write("site.ags", ags4("ft", 1 / 0.3048)))
    np.testing.assert_allclose(found.collars["end"], 40)
    np.testing.assert_allclose(found.intervals["to"], [10, 25, 40] * 5)
    assert "the header says ft for 'LOCA_NATE', 'LOCA_NATN', 'LOCA_GL' and 'LOCA_FDEP'" in found.warnings[0]


def test_inclined_holes_of_ags(write):
    survey = quoted(
        ("GROUP", "HORN"),
        ("HEADING", "LOCA_ID", "HORN_TOP", "HORN_BASE", "HORN_ORNT", "HORN_INCL"),
        ("UNIT", "", "m", "m", "deg", "deg"),
        ("TYPE", "ID", "2DP", "2DP", "0DP", "0DP"),
        ("DATA", "H0", "0", "40", "90", "60"),
    )
    found = read_boreholes(write("site.ags", ags4() + survey))
    assert found.survey["dip"].tolist() == [60.0]
    write("p.toml", PROJECT.format(boreholes='"site.ags"'))
    model = build(load_project(write("p.toml", PROJECT.format(boreholes='"site.ags"'))))
    places = model.rock_inputs[0].rock.observations
    low = places.places[places.holes == "H0"][-1]
    np.testing.assert_allclose(low, [10 + 20, 10, -40 * 3**0.5 / 2], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (quoted(("GROUP", "PROJ"), ("HEADING", "PROJ_ID"), ("DATA", "1")), "it has no rows of LOCA or HOLE"),
        (ags4().split('"GROUP","GEOL"')[0], "it has no rows of GEOL"),
        (ags4().replace("GEOL_TOP", "GEOL_TOPP"), "the header has no column from"),
        (ags3().replace('"H0","10","10"', '"<CONT>","10","10"'), "<CONT> continues no row"),
    ],
)
def test_damaged_ags(write, text, words):
    with pytest.raises(InputRefused, match=words):
        read_boreholes(write("site.ags", text))


def test_a_file_that_holds_no_boreholes(write):
    with pytest.raises(InputRefused, match="it does not hold all tables of boreholes"):
        read_boreholes(write("a.csv", "hole,from,to,block\nA,0,1,x\n"))
