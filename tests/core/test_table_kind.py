# SPDX-License-Identifier: GPL-3.0-or-later
"""What tables of field data are, by their columns."""

import pytest
from realmodel.core import InputRefused
from realmodel.core.readers import table_contents, table_kind

HEADERS = {
    "hole,x,y,z": "collars",
    "BHID;EAST;NORTH;RL;DEPTH": "collars",
    "hole_id,x,y,z,azimuth,dip": "collars",
    "name,x,y,z,azimuth,dip": "collars",
    "hole,depth,azimuth,dip": "survey",
    "HOLEID\tAT\tBRG\tINCL": "survey",
    "hole,surface,depth": "picks",
    "hole,x,y,surface,elevation": "picks",
    "well,x,y,z,formation": "picks",
    "name,x,y,z,unit,md": "picks",
    "hole,x,y,z,formation,depth,azimuth,dip": "picks",
    "hole,formation,from": "picks",
    "hole,from,to,formation": "intervals",
    "BHID,FROM (m),TO (m),LITH": "intervals",
    "hole,x,y,z,from,to,code,azimuth,dip": "intervals",
    "x,y,z,block": "observations",
    "id,easting,northing,elevation,unit": "observations",
    "hole,x,y,z,depth,lithology": "observations",
    "x,y,z,dip,dip_direction": "dips",
    "id,x,y,z,dip,strike,unit": "dips",
    "X,Y,Z,azimuth,dip,polarity,formation": "dips",
    "x,y,slope_x,slope_y": "dips",
}


def written(folder, header, row=None):
    separator = next(sign for sign in ";\t," if sign in header)
    entries = ["1"] * len(header.split(separator))
    path = folder / "table.csv"
    path.write_text(f"{header}\n{row or separator.join(entries)}\n")
    return path


def test_what_is_read_of_a_table(tmp_path):
    table = tmp_path / "logs.csv"
    table.write_text("BHID;From;To;Lith\nB1;0;2;CLY\nB1;2;3;LC\nB2;0;2;CLY\nB2;2;4;\n")
    columns = {"hole": "bhid", "from": "from", "to": "to", "block": "lith"}
    assert table_contents(table) == (columns, ["CLY", "LC"])
    assert table_contents(written(tmp_path, "hole,x,y,z"))[1] == []
    with pytest.raises(InputRefused, match="do not say"):
        table_contents(written(tmp_path, "a,b"))


@pytest.mark.parametrize("header", HEADERS)
def test_a_table_is_told_by_its_columns(tmp_path, header):
    assert table_kind(written(tmp_path, header)) == HEADERS[header]


@pytest.mark.parametrize(
    ("header", "columns", "kind"),
    [
        ("id,x,y,z,unit", {"surface": "unit"}, "picks"),
        ("hole,from,to,unit", {"surface": "unit", "depth": "from"}, "picks"),
        ("hole,x,y,z,unit", {"block": "unit"}, "observations"),
        ("x,y,z,dip,strike,unit", {"block": "unit"}, "observations"),
        ("name,x,y,z,azimuth,dip", {"dip_direction": "azimuth"}, "dips"),
        ("a,b,c,d", {"hole": "a", "from": "b", "to": "c", "block": "d"}, "intervals"),
        ("a,b,c,d", {"hole": 1, "x": 2, "y": 3, "z": 4}, "collars"),
        ("hole,x,y,z", {"depth": "MD", "block": "LITH"}, "collars"),
    ],
)
def test_named_columns_decide(tmp_path, header, columns, kind):
    assert table_kind(written(tmp_path, header), columns) == kind


def test_a_table_that_is_none_of_them_is_refused(tmp_path):
    with pytest.raises(InputRefused, match="do not say whether it has collars, survey, picks"):
        table_kind(written(tmp_path, "sample,gold"))
