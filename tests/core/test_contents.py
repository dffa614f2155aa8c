# SPDX-License-Identifier: GPL-3.0-or-later
"""What fields of names offer: columns, values and layers of files of points."""

import json
import sqlite3

import pytest
from realmodel.core import InputRefused
from realmodel.core.readers.contents import column_names, column_values, layer_names


@pytest.fixture
def write(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def test_of_a_table(write):
    file = write("p.csv", "bed;E;N;Z\nclay;1;2;3\nsand;4;5;6\nclay;7;8,5;9\n\n")
    assert column_names(file) == ["bed", "E", "N", "Z"]
    assert column_values(file, "bed") == ["clay", "sand"]
    assert layer_names(file) == []
    with pytest.raises(InputRefused, match="no column age"):
        column_values(file, "age")


def test_of_a_table_without_header(write):
    file = write("p.xyz", "1 2 3 60\n4 5 6 61\n")
    assert column_names(file) == ["1", "2", "3", "4"]
    assert column_values(file, "4") == ["60", "61"]


def test_each_value_once_and_no_empty_one(write):
    file = write("p.csv", "x,y,z,n\n" + "".join(f"{n},0,0,{n % 80 or ''}\n" for n in range(99)))
    assert column_values(file, "n") == [str(n) for n in range(1, 80)]


def test_of_shapes(write):
    features = [
        {"type": "Feature", "properties": {"elev": z, "kind": "contour"}, "geometry": None}
        for z in (10, 20, 10)
    ]
    file = write("c.geojson", json.dumps({"type": "FeatureCollection", "features": features}))
    assert column_names(file) == ["elev", "kind"]
    assert column_values(file, "elev") == ["10", "20"]
    assert column_values(file, "none") == []


def test_of_a_geopackage(tmp_path):
    file = tmp_path / "a.gpkg"
    base = sqlite3.connect(file)
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
    for layer in ("wells", "lines"):
        base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom')", (layer,))
        base.execute(f"CREATE TABLE {layer} (geom BLOB, of_{layer} TEXT)")
        base.execute(f"INSERT INTO {layer} VALUES (NULL, 'x')")
    base.commit()
    base.close()
    assert layer_names(file) == ["wells", "lines"]
    assert column_names(file, "lines") == ["of_lines"]
    assert column_values(file, "of_wells", "wells") == ["x"]


def test_of_a_raster_there_is_nothing(write):
    file = write("g.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n")
    assert column_names(file) == []
