# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as people have them, looked at before they are read."""

import numpy as np
import pytest
from realmodel.core import InputRefused, PointFile
from realmodel.core.readers import preview_table, read_point_file
from realmodel.core.readers.contents import column_values
from realmodel.core.readers.tables import table_preview

SEMICOLONS = (
    "Survey of 2019, zone 3\n"
    "Horizon;Easting [m];Northing [m];Elevation [m]\n"
    "top clay;3430000,5;5390000,25;201,5\n"
    "top clay;3430010,5;5390010,25;202,5\n"
    "base gravel;3430000,5;5390000,25;181,5\n"
)


@pytest.fixture
def table(tmp_path):
    def write(text, name="t.csv"):
        path = tmp_path / name
        path.write_bytes(text.encode())
        return path

    return write


def test_semicolons_and_decimal_commas(table):
    path = table(SEMICOLONS)
    found = preview_table(path)
    assert found.names == ["Horizon", "Easting [m]", "Northing [m]", "Elevation [m]"]
    assert tuple(found.axes.values()) == ("Easting [m]", "Northing [m]", "Elevation [m]")
    assert found.rows[0] == ["top clay", "3430000,5", "5390000,25", "201,5"]
    assert found.splits == {"Horizon": ["top clay", "base gravel"]}
    assert found.is_plain
    assert column_values(path, "Horizon") == ["top clay", "base gravel"]
    points, _ = read_point_file(PointFile(path, where={"Horizon": "base gravel"}))
    assert points.tolist() == [[3430000.5, 5390000.25, 181.5]]


def test_units_of_measure_name_no_surfaces(table):
    path = table("x,y,z,unit\n" + "".join(f"{n},{2 * n},{3.5 * n},{('m', 'ft')[n % 2]}\n" for n in range(9)))
    assert not preview_table(path).is_plain
    assert preview_table(table(path.read_text().replace("ft", "clay"))).is_plain


@pytest.mark.parametrize("separator", ["\t", ",", " "])
def test_a_number_that_names_surfaces(table, separator):
    rows = [("x", "y", "z", "val")] + [(n, 2 * n, 3.5 * n, 60 * (n % 3)) for n in range(60)]
    path = table("\n".join(separator.join(map(str, row)) for row in rows) + "\n")
    found = preview_table(path)
    assert found.splits == {"val": ["0", "60", "120"]}
    assert not found.is_plain, "it may be a quality as well"


def test_without_a_header(table):
    found = preview_table(table("1 2 3\n4 5 6\n7 8 9\n", "t.xyz"))
    assert (found.names, list(found.axes.values()), found.splits) == (["1", "2", "3"], ["1", "2", "3"], {})
    assert not found.has_header


def test_too_many_values_name_no_surfaces(table):
    rows = "".join(f"{n},{n},{n},P{n}\n" for n in range(60))
    assert preview_table(table("x,y,z,point\n" + rows)).splits == {}


def test_a_missing_column_is_said_and_can_be_chosen(table):
    path = table("x,thickness,north\n1,2,3\n4,5,6\n")
    found = preview_table(path)
    assert found.problem == "the header has no column z; it has x, thickness, north"
    assert found.axes == {"x": "x", "y": "north"}
    assert list(preview_table(path, ["x", "north", "thickness"]).axes.values()) == ["x", "north", "thickness"]


def test_what_is_no_table(table):
    with pytest.raises(InputRefused):
        preview_table(table("\0\1\2"))


def test_a_long_table_sorted_by_horizon_is_sampled(table, monkeypatch):
    rng = np.random.default_rng(3)
    lines = [f"{x:.3f},{y:.3f},{z:.3f},H{h}\n" for h in range(8) for x, y, z in rng.random((500, 3))]
    path = table("x,y,z,horizon\n" + "".join(lines))
    monkeypatch.setattr(table_preview, "_PIECES", 16)
    monkeypatch.setattr(table_preview, "_PIECE", 256)
    looked_at = []
    sampled = table_preview._sampled_rows
    monkeypatch.setattr(
        table_preview, "_sampled_rows", lambda file: looked_at.extend(sampled(file)) or looked_at
    )
    assert preview_table(path).splits["horizon"] == [f"H{h}" for h in range(8)]
    assert len(looked_at) < len(lines) / 10
