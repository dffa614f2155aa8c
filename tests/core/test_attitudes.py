# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips as they are written in field books: bearings, points of the compass, strike and dip in one column."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import DipFile, InputRefused
from realmodel.core.readers import dip_warnings, read_dips, table_kind
from realmodel.core.readers.tables.attitudes import _COMPASS


def read(folder, text, **more):
    """(dip, direction) of each row in whole degrees, and the warnings."""
    file = folder / "dips.csv"
    file.write_text(text, encoding="utf-8")
    assert table_kind(file, more.get("columns")) == "dips"
    dips = DipFile(file, **more)
    slopes = read_dips(dips).gradients
    steep = np.degrees(np.arctan(np.hypot(*slopes.T))).round().astype(int)
    down = np.degrees(np.arctan2(-slopes[:, 0], -slopes[:, 1])).round().astype(int) % 360
    return list(zip(steep.tolist(), down.tolist(), strict=True)), dip_warnings(dips)


@pytest.mark.parametrize(
    ("header", "row", "angles"),
    [
        ("strike/dip", "N30E/45SE", (45, 120)),
        ("Strike / Dip", "030/45 SE", (45, 120)),
        ("strike_dip", "210/45 SE", (45, 120)),
        ("strike/dip", "030/45", (45, 120)),
        ("attitude", "N30°E 45°NW", (45, 300)),
        ("bedding", "S30W/45SE", (45, 120)),
        ("Clar", "120/45", (45, 120)),
        ("dip/dipdir", "45/120", (45, 120)),
        ("strike,dip", "N 30 W,45 SW", (45, 240)),
        ("strike,dip", "E-W,20 N", (20, 0)),
        ("strike,dip", "030,45", (45, 120)),
        ("dip,dip direction", "30,SE", (30, 135)),
        ("dip,dip direction", "30,S60E", (30, 120)),
        ("strike,dip,dip direction", "N30E,45,SE", (45, 120)),
    ],
)
def test_ways_to_write_a_dip(tmp_path, header, row, angles):
    rows, warnings = read(tmp_path, f"x,y,{header}\n1,2,{row}\n")
    assert rows == [angles]
    assert not warnings


def test_a_bearing_without_a_side_is_said(tmp_path):
    table = "x,y,strike,dip\n1,2,N30E,45\n2,2,N40E,30 NW\n3,2,N50E,0\n"
    rows, (text,) = read(tmp_path, table)
    assert rows[:2] == [(45, 120), (30, 310)]
    assert "line 2:" in text
    assert "right-hand rule" in text


def test_two_numbers_of_which_nothing_says_what_they_are(tmp_path):
    text = "x,y,orientation\n1,2,030/45\n"
    with pytest.raises(InputRefused, match="a dip direction and a dip") as refused:
        read(tmp_path, text)
    assert "columns = { strike = " in str(refused.value)
    assert read(tmp_path, text, columns={"strike": "orientation"})[0] == [(45, 120)]
    assert read(tmp_path, text, columns={"dip_direction": "orientation"})[0] == [(45, 30)]


@pytest.mark.parametrize(
    ("table", "lines"),
    [
        ("strike,dip,dip_direction\n1,2,0,30,90\n1,3,90,40,180\n1,4,10,20,10\n", "line 4:"),
        ("strike,dip,dip_direction\n1,2,0,30,90\n1,3,90,40,180\n1,4,90,20,0\n", "line 4:"),
        ("strike,dip,dip_direction\n1,2,0,30,90\n1,3,90,40,90\n1,4,N10E,20,200\n", "lines 3 and 4:"),
        ("strike,dip\n1,2,030,40 SW\n1,3,030,40 SE\n", "line 2:"),
        ("strike,dip,dip_direction\n1,2,N30E,45,NE\n1,3,N30E,45,SE\n", "line 2:"),
    ],
)
def test_angles_that_contradict_one_another_are_said(tmp_path, table, lines):
    _, warnings = read(tmp_path, f"x,y,{table}")
    assert [text for text in warnings if lines in text and "not at right angles" in text]


def test_strikes_by_the_left_hand_rule_contradict_nothing(tmp_path):
    table = "x,y,strike,dip,dip_direction\n1,2,180,30,90\n1,3,270,40,180\n"
    assert read(tmp_path, table) == ([(30, 90), (40, 180)], [])


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 359), st.integers(1, 89))
def test_the_same_dip_in_any_way(tmp_path_factory, direction, dip):
    """By bearing and side, by both numbers and by either order, a dip is the same."""
    strike = (direction - 90) % 360
    line = min(strike % 180, 180 - strike % 180)
    bearing = f"N{line}{'E' if strike % 180 <= 90 else 'W'}"
    quadrants = [(abs((_COMPASS[p] - direction + 180) % 360 - 180), p) for p in ("NE", "SE", "SW", "NW")]
    side = min(quadrants)[1]
    rows = [f"{bearing}/{dip}{side}", f"{strike:03d}/{dip}", f"{(strike + 180) % 360:03d}/{dip} {side}"]
    table = "x,y,strike/dip\n" + "".join(f"1,{n},{row}\n" for n, row in enumerate(rows))
    assert read(tmp_path_factory.mktemp("d"), table) == ([(dip, direction)] * 3, [])


def test_what_is_no_angle_is_refused(tmp_path):
    for row in ("N95E/30", "up/30", "N30E/steep"):
        with pytest.raises(InputRefused, match="is not a number"):
            read(tmp_path, f"x,y,strike/dip\n1,2,{row}\n")
