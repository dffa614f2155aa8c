# SPDX-License-Identifier: GPL-3.0-or-later
"""What tables of field data are, by their columns."""

import random

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
    "X,Y,Z,G_x,G_y,G_z,id,formation": "dips",
    "x,y,z,normal_x,normal_y,normal_z": "dips",
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


NAMES = [
    ("BHID", "FROM", "TO"),
    ("hole_id", "depth_from", "depth_to"),
    ("Foro", "Da", "A"),
    ("Sondaggio", "Da", "A"),
    ("Bohrung", "Von", "Bis"),
    ("HoleId", "FromDepth", "ToDepth"),
]
# Columns of assays that may be taken for names of units, with values.
DOUBTFUL = {
    "unit": ("ppm", "%", "g/t"),
    "Material": ("RC chips", "Half core", "pulp"),
    "material": ("core",),
    "soil": ("5.5", "6.25", "7.1"),
    "code": ("standard", "blank", "original"),
    "Domain": ("0.75", "1.5"),
    "graphic": ("", ""),
}
ELEMENTS = ("Au_ppm", "Cu", "As_ppm", "Fe2O3", "S_pct", "A", "RQD", "SampleID", "Lab_Batch", "Ag")
LITHOLOGIES = {
    "lithology": ("CLY", "SND"),
    "soil": ("clay", "sand"),
    "Domain": ("1", "2"),
    "unit": ("Jo", "Tr"),
}


@pytest.mark.parametrize("seed", range(60))
def test_assays_are_no_intervals_of_units(tmp_path, seed):
    """In any order of columns, with columns whose names may mean units; the same with a log are intervals."""
    chance = random.Random(seed)
    hole, begin, end = chance.choice(NAMES[:2] + NAMES[3:])
    elements = [name for name in chance.sample(ELEMENTS, chance.randint(1, 5)) if name != end]
    doubtful = chance.sample(sorted(DOUBTFUL), chance.randint(0, 2))
    log = chance.choice(sorted(LITHOLOGIES))
    values = {name: lambda n: f"{n % 7 + 0.25 * (n % 3):g}" for name in elements}
    values |= {name: lambda n, name=name: DOUBTFUL[name][n % len(DOUBTFUL[name])] for name in doubtful}
    values |= {hole: lambda n: f"B{n // 4}", begin: lambda n: f"{n % 4}", end: lambda n: f"{n % 4 + 1}"}

    def kind(columns):
        order = chance.sample(list(columns), len(columns))
        rows = [",".join(columns[name](n) for name in order) for n in range(12)]
        path = tmp_path / "t.csv"
        path.write_text("\n".join([",".join(order), *rows]) + "\n")
        return table_kind(path), table_contents(path)

    found, (columns, codes) = kind(values)
    assert found == "assays"
    assert columns["to"] == end.lower()
    found, (columns, codes) = kind(values | {log: lambda n: LITHOLOGIES[log][n % 2]})
    assert found == "intervals"
    assert codes == sorted(LITHOLOGIES[log])


def test_a_column_a_is_no_end_of_intervals(tmp_path):
    with pytest.raises(InputRefused, match="do not say"):
        table_kind(written(tmp_path, "hole,B,A,Au"))
    assert table_kind(written(tmp_path, "hole,from,A,lithology")) == "intervals"
    assert "to" not in table_contents(written(tmp_path, "hole,from,A,lithology"))[0]
    assert table_contents(written(tmp_path, "Foro;Da;A;Litologia"), {"hole": "foro"})[0]["to"] == "a"
