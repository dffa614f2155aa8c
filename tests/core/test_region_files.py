# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions from the files that other programs write: several layers, polygons of several parts, collections;
each built as a user would."""

import json
import sqlite3
import struct
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT
from outlines import PROJECT_OF_REGION
from realmodel.core import BuildFailed, InputRefused, MapLayer, build, load_project
from realmodel.core.base.packages import vendored
from realmodel.core.readers import read_region, read_shapes
from realmodel.core.readers.map_input import map_companions

try:
    shapefile = vendored("shapefile", "pyshp", "this test")
except BuildFailed:
    shapefile = None
needs_pyshp = pytest.mark.skipif(shapefile is None, reason="addon/realmodel/vendor has no pyshp")

# An outline with a hole and an island in it, and a second outline that touches the first in a corner.
PARTS = [
    [[(0, 0), (8, 0), (8, 8), (0, 8)], [(1, 1), (1, 6), (6, 6), (6, 1)]],
    [[(2, 2), (4, 2), (4, 4), (2, 4)]],
    [[(8, 8), (11, 8), (11, 11), (8, 11)]],
]
AREA = 64 - 25 + 4 + 9


def closed(ring):
    return [*ring, ring[0]]


def wkt_body(polygon):
    rings = (", ".join(f"{x} {y}" for x, y in closed(ring)) for ring in polygon)
    return "(" + ", ".join(f"({ring})" for ring in rings) + ")"


MULTI = "MULTIPOLYGON (" + ", ".join(map(wkt_body, PARTS)) + ")"
COORDINATES = [[[list(place) for place in closed(ring)] for ring in polygon] for polygon in PARTS]


def geojson(geometry, **properties):
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    return {"type": "FeatureCollection", "features": [feature]}


MULTI_GEOJSON = {"type": "MultiPolygon", "coordinates": COORDINATES}
LINE = {"type": "LineString", "coordinates": [[0, 0], [5, 5]]}


def binary_polygon(polygon, code=3, z=()):
    """Well-known binary; code 1003: with the heights z."""
    body = struct.pack("<BII", 1, code, len(polygon))
    for ring in polygon:
        places = np.array([(*place, *z) for place in closed(ring)], "<f8")
        body += struct.pack("<I", len(places)) + places.tobytes()
    return body


def binary_several(code, members):
    return struct.pack("<BII", 1, code, len(members)) + b"".join(members)


def in_package(body):
    return b"GP" + struct.pack("<BBi", 0, 1, 28350) + body


MULTI_BINARY = binary_several(6, [binary_polygon(polygon) for polygon in PARTS])
LINE_BINARY = struct.pack("<BII4d", 1, 2, 2, 0, 0, 5, 5)


def write_geopackage(path, layers):
    """layers: {name: (geometry column, features)}, features as (well-known binary, name)."""
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE gpkg_contents (table_name TEXT, data_type TEXT)")
        base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
        for layer, (column, features) in layers.items():
            base.execute("INSERT INTO gpkg_contents VALUES (?, 'features')", (layer,))
            base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, ?)", (layer, column))
            base.execute(f'CREATE TABLE "{layer}" ("my id" INTEGER PRIMARY KEY, "{column}" BLOB, NAME TEXT)')
            rows = [(in_package(body), name) for body, name in features]
            base.executemany(f'INSERT INTO "{layer}" ("{column}", NAME) VALUES (?, ?)', rows)
    base.close()
    return path


@pytest.fixture
def package(tmp_path):
    rivers = ("SHAPE", [(LINE_BINARY, "Blackwood")])
    land = ("the geom", [(MULTI_BINARY, "Land"), (binary_polygon([[(20, 0), (21, 0), (21, 1)]]), "Rock")])
    high = [binary_polygon(polygon, 1003, (7.5,)) for polygon in PARTS]
    return write_geopackage(
        tmp_path / "maps.gpkg",
        {"rivers": rivers, "Land parts": land, "surfaces": ("geom", [(binary_several(1012, high), "")])},
    )


REGIONS = {
    "wkt": '"multi.wkt"',
    "collection of wkt": '"collection.txt"',
    "lines of wkt": '"lines.wkt"',
    "geojson": '"multi.geojson"',
    "collection of geojson": '"collection.geojson"',
    "geojson, a feature a line": '"lines.geojsonl"',
    "geojson, text sequence": '"sequence.geojsons"',
    "geopackage": '{ file = "maps.gpkg", layer = "land PARTS", where = { name = "Land" } }',
    "geopackage, surfaces with heights": '{ file = "maps.gpkg", layer = "surfaces" }',
    "shapefile": '"multi.shp"',
    "shapefile with heights": '"high.shp"',
}


@pytest.fixture
def files(write, package, tmp_path):
    polygons = [{"type": "Polygon", "coordinates": polygon} for polygon in COORDINATES]
    features = [geojson(polygon)["features"][0] for polygon in polygons]
    write("multi.wkt", f"SRID=28350;{MULTI}\n")
    write("collection.txt", f"GEOMETRYCOLLECTION (POINT (1 1), LINESTRING (0 0, 5 5), {MULTI})")
    write("lines.wkt", "\n".join("POLYGON " + wkt_body(polygon) for polygon in PARTS))
    write("multi.geojson", json.dumps(geojson(MULTI_GEOJSON, name="Land"), indent=1))
    collection = {"type": "GeometryCollection", "geometries": [LINE, MULTI_GEOJSON]}
    write("collection.geojson", json.dumps(geojson(collection)))
    write("lines.geojsonl", "\n".join(map(json.dumps, features)) + "\n")
    write("sequence.geojsons", "".join(f"\x1e{json.dumps(feature, indent=1)}\n" for feature in features))
    if shapefile is not None:
        parts = [closed(ring) for polygon in PARTS for ring in polygon]
        for name, kind in (("multi", shapefile.POLYGON), ("high", shapefile.POLYGONZ)):
            with shapefile.Writer(str(tmp_path / f"{name}.shp"), shapeType=kind) as writer:
                writer.field("NAME", "C", 10)
                if kind == shapefile.POLYGON:
                    writer.poly(parts)
                else:
                    writer.polyz([[(*place, 7.5) for place in part] for part in parts])
                writer.record("Land")
    return tmp_path


@pytest.mark.parametrize("kind", REGIONS)
def test_polygons_of_several_parts(files, write, kind):
    if shapefile is None and "shapefile" in kind:
        pytest.skip("addon/realmodel/vendor has no pyshp")
    project = load_project(write("p.toml", PROJECT_OF_REGION.format(region=REGIONS[kind])))
    assert build(project).volume == pytest.approx(AREA)


def test_by_the_batch_program(package, write, tmp_path):
    """The layer must be named, and the error lists the layers; lines beside the polygons give a warning."""

    def run(region):
        path = write("p.toml", PROJECT_OF_REGION.format(region=region))
        command = [sys.executable, ROOT / "build_model.py", path, "--quiet", "--report", tmp_path / "r.json"]
        return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)

    done = run('"maps.gpkg"')
    assert done.returncode == 1
    assert 'it has 3 layers; say which: layer = "..."; it has rivers, Land parts, surfaces' in done.stderr
    done = run('{ file = "maps.gpkg", layer = "rivers" }')
    assert done.returncode == 1
    assert "there is no polygon in it" in done.stderr
    done = run('{ file = "maps.gpkg", layer = "Land parts" }')
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "r.json").read_text())
    assert sum(block["volume"] for block in report["blocks"]) == pytest.approx(AREA + 0.5)


def test_a_part_is_named_where_it_is_wrong(write):
    """Of two parts of one feature that cross, each has its number."""
    across = {"type": "MultiPolygon", "coordinates": [COORDINATES[0], [closed([(7, 7), (9, 7), (9, 9)])]]}
    path = write("p.toml", PROJECT_OF_REGION.format(region='"a.geojson"'))
    write("a.geojson", json.dumps(geojson(across)))
    words = "feature 1, polygon 1: the outline crosses feature 1, polygon 2"
    with pytest.raises(InputRefused, match=words):
        build(load_project(path))


def test_a_damaged_line_of_a_sequence_is_named(write):
    text = json.dumps(MULTI_GEOJSON)
    for name, content in (("a.geojsonl", f"{text}\n{text[:-9]}\n"), ("a.geojsons", f"\x1e{text}\n\x1e[nan")):
        with pytest.raises(InputRefused, match="not valid JSON") as raised:
            read_region(write(name, content))
        assert raised.value.line in (2, 3)


def test_changes_that_are_not_yet_in_a_geopackage(package):
    """A program that has it open keeps them in a file beside it until it closes."""
    assert map_companions(package) == []
    base = sqlite3.connect(package)
    base.execute("PRAGMA journal_mode = WAL")
    base.execute("UPDATE \"Land parts\" SET NAME = 'Island' WHERE NAME = 'Land'")
    base.commit()
    rings, _ = read_region(MapLayer(package, "Land parts", {"NAME": "Island"}))
    assert len(rings) == 4
    assert map_companions(package) == [package.with_name("maps.gpkg-wal")]
    base.close()
    assert len(read_region(MapLayer(package, "Land parts", {"NAME": "Island"}))[0]) == 4


def test_curves_are_refused(tmp_path):
    curve = struct.pack("<BII", 1, 10, 1) + struct.pack("<BII6d", 1, 8, 3, 0, 0, 1, 1, 2, 0)
    path = write_geopackage(tmp_path / "c.gpkg", {"c": ("geom", [(curve, "")])})
    words = r"layer 'c', feature 1: .*CurvePolygon.*save it with straight lines"
    with pytest.raises(InputRefused, match=words):
        read_shapes(MapLayer(path))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.dbf", b"\x03\x7a\x01\x01" + bytes(40), r"a part of a shapefile; name the \.shp"),
        ("a.shx", b"\0\0\x27\x0a" + bytes(96), r"a part of a shapefile; name the \.shp"),
    ],
)
def test_files_of_other_kinds(write, name, content, words):
    with pytest.raises(InputRefused, match=words):
        read_region(write(name, content))
