# SPDX-License-Identifier: GPL-3.0-or-later
"""The other columns of tables of intervals, and the ends of holes."""

import numpy as np
import pytest
from realmodel.core import Boreholes, InputRefused
from realmodel.core.readers import read_picks
from realmodel.core.readers.hole_values import read_interval_values
from realmodel.core.readers.table_kind import table_kind
from realmodel.core.readers.tables.interval_values import IntervalValues

COLLARS = "BHID,Easting,Northing,RL,EOH,dip,azimuth\nA,10,20,100,30,-90,0\nB,50,20,110,20,-45,90\n"


def given(tmp_path, intervals, collars=COLLARS, **more):
    (tmp_path / "collars.csv").write_text(collars)
    (tmp_path / "intervals.csv").write_text(intervals)
    return Boreholes(collars=tmp_path / "collars.csv", intervals=tmp_path / "intervals.csv", **more)


def test_numbers_and_words_stand_along_the_holes(tmp_path):
    text = "BHID,FROM,TO,LITH,Au (ppm),Cu\nA,0,10,SST,1.5,-\nA,10,30,SHL,,2\nB,0,20,SST,0.25,3\n"
    found = read_interval_values(given(tmp_path, text))
    assert list(found.columns) == ["LITH", "Au (ppm)", "Cu"]
    assert found.columns["LITH"].tolist() == ["SST", "SHL", "SST"]
    assert np.array_equal(found.columns["Au (ppm)"], [1.5, np.nan, 0.25], equal_nan=True)
    assert np.array_equal(found.columns["Cu"], [np.nan, 2, 3], equal_nan=True)
    assert found.holes.tolist() == ["A", "A", "B"] and found.depths[1].tolist() == [10, 30]
    assert found.ends[1].tolist() == [10, 20, 70]
    assert np.allclose(found.ends[2], [50 + 20 / np.sqrt(2), 20, 110 - 20 / np.sqrt(2)])
    assert found.has("Cu").tolist() == [False, True, True]


def test_units_and_decimal_commas(tmp_path):
    text = "hole;from;to;grade\nA;0;10;1,5\nA;10;30;2,5\n"
    collars = "hole;x;y;z\nA;10;20;100\n"
    found = read_interval_values(given(tmp_path, text, collars, units={"z": "ft"}))
    assert found.columns["grade"].tolist() == [1.5, 2.5]
    assert np.allclose(found.begins[1], [10, 20, 90 * 0.3048])


def test_rows_without_depths_are_left_out_and_empty_tables_refused(tmp_path):
    found = read_interval_values(given(tmp_path, "hole,from,to,Au\nA,0,,1\nA,5,6,2\n"))
    assert found.columns["Au"].tolist() == [2.0]
    with pytest.raises(InputRefused, match="no intervals"):
        read_interval_values(given(tmp_path, "hole,from,to,Au\n"))
    found = read_interval_values(given(tmp_path, "hole,from,to,Au\nZ,0,1,1\nA,5,6,2\n"))
    assert found.columns["Au"].tolist() == [2.0], "hole Z has no collar"
    with pytest.raises(InputRefused, match="no hole of it has a collar"):
        read_interval_values(given(tmp_path, "hole,from,to,Au\nZ,0,1,1\n"))


def test_tables_with_different_columns_are_joined(tmp_path):
    one = read_interval_values(given(tmp_path, "hole,from,to,Au,note\nA,0,1,1,wet\n"))
    other = read_interval_values(given(tmp_path, "hole,from,to,note,Cu\nB,0,1,2,7\n"))
    both = IntervalValues.joined([one, other])
    assert both.columns["note"].tolist() == ["wet", "2"], "words, as some are"
    assert np.array_equal(both.columns["Au"], [1, np.nan], equal_nan=True)
    assert both.some([1]).columns["Cu"].tolist() == [7.0]


def test_assays_are_told_by_their_columns(tmp_path):
    file = tmp_path / "t.csv"
    for text, kind in (
        ("hole,from,to,Au\n", "assays"),
        ("hole,from,to,lith\n", "intervals"),
        ("hole,depth,azimuth,dip\n", "survey"),
    ):
        file.write_text(text + "A,0,1,2\n")
        assert table_kind(file) == kind


def test_the_ends_of_holes_are_kept(tmp_path):
    (tmp_path / "picks.csv").write_text("hole,surface,depth\nA,clay,5\nB,clay,4\n")
    boreholes = given(tmp_path, "hole,from,to,block\nA,0,10,clay\n")
    boreholes = Boreholes(collars=boreholes.collars, picks=tmp_path / "picks.csv")
    found = read_picks(boreholes)
    assert found.ends["A"].tolist() == [10, 20, 70]
    assert np.allclose(found.ends["B"], [50 + 20 / np.sqrt(2), 20, 110 - 20 / np.sqrt(2)])
    logged = read_picks(given(tmp_path, "hole,from,to,block\nA,0,10,clay\n"))
    assert set(logged.ends) == {"A"}, "those that have intervals"
