# SPDX-License-Identifier: GPL-3.0-or-later
"""Points with heights from GeoJSON, well-known text, shapefiles and GeoPackages; meshes in another unit."""

import json
import sqlite3
import struct

import numpy as np
import pytest
from realmodel.core import (
    BuildFailed,
    InputRefused,
    MeshFile,
    PointFile,
    Project,
    Rock,
    Surface,
    build,
    load_project,
)
from realmodel.core.base.packages import vendored
from realmodel.core.readers import read_point_file

try:
    shapefile = vendored("shapefile", "pyshp", "this test")
except BuildFailed:
    shapefile = None
needs_pyshp = pytest.mark.skipif(shapefile is None, reason="addon/realmodel/vendor has no pyshp")

SPOTS = [(1.0, 2.0, 10.0), (3.0, 4.0, 12.5), (5.0, 1.0, 11.0)]
CONTOUR = [(0.0, 0.0), (2.0, 0.5), (4.0, 0.0)]


def features(*parts):
    return json.dumps(
        {
            "type": "FeatureCollection",
            "features": [
                {"type": "Feature", "properties": properties, "geometry": geometry}
                for properties, geometry in parts
            ],
        }
    )


def point(place):
    return {"type": "Point", "coordinates": place}


@needs_pyshp
def test_heights_of_positions(write, tmp_path):
    """Each format, its z; a plain position beside them has none, with a warning."""
    geojson = write("a.geojson", features(*[({}, point(spot)) for spot in SPOTS], ({}, point([9, 9]))))
    wkt = write("a.wkt", "MULTIPOINT Z ((1 2 10), (3 4 12.5))\nLINESTRING(5 1 11, 9 9 nan)\n")
    with shapefile.Writer(str(tmp_path / "a.shp"), shapeType=shapefile.POINTZ) as writer:
        writer.field("N", "N")
        for spot in SPOTS:
            writer.pointz(*spot)
            writer.record(1)
    package = write_geopackage(tmp_path / "a.gpkg", {"spots": [(packed(1001, spot), None) for spot in SPOTS]})
    for file, count in ((geojson, 1), (wkt, 1), (tmp_path / "a.shp", 0), (package, 0)):
        points, warnings = read_point_file(PointFile(file))
        assert points.tolist() == [list(spot) for spot in SPOTS], file
        assert len(warnings) == count
        assert not count or "left out: 1 point without a value" in warnings[0]
    measures = write("m.wkt", "LINESTRING M (1 2 7, 3 4 8)")
    with pytest.raises(InputRefused, match=r"no elevation.*height = "):
        read_point_file(PointFile(measures))


@needs_pyshp
def test_heights_by_an_attribute(write, tmp_path):
    """Contour lines with their elevation; a corner of a ring counts once; features are chosen."""
    line = {"type": "LineString", "coordinates": CONTOUR}
    ring = {"type": "Polygon", "coordinates": [[[0, 5], [1, 5], [1, 6], [0, 5]]]}
    text = features(
        ({"ELEV": 20, "kind": "contour"}, line),
        ({"ELEV": "25.5", "kind": "lake"}, ring),
        ({"ELEV": None, "kind": "contour"}, line),
        ({"ELEV": 99, "kind": "contour"}, point([7, 7, 1])),
    )
    path = write("c.geojson", text)
    points, warnings = read_point_file(PointFile(path, height="elev", nodata=99))
    expected = [[*place, 20.0] for place in CONTOUR] + [[0, 5, 25.5], [1, 5, 25.5], [1, 6, 25.5]]
    assert points.tolist() == expected
    assert "left out: 4 points without a value" in warnings[0]
    points, _ = read_point_file(PointFile(path, height="ELEV", where={"kind": "lake"}))
    assert len(points) == 3

    with shapefile.Writer(str(tmp_path / "c.shp"), shapeType=shapefile.POLYLINE) as writer:
        writer.field("ELEV", "N", 10, 2)
        writer.line([CONTOUR])
        writer.record(20)
    points, _ = read_point_file(PointFile(tmp_path / "c.shp", height="ELEV", units={"z": "ft"}))
    assert points.tolist() == [[*place, 20.0 * 0.3048] for place in CONTOUR]
    blob = packed(2, *CONTOUR)
    package = write_geopackage(tmp_path / "c.gpkg", {"contours": [(blob, 20.0)], "other": [(blob, 1.0)]})
    points, _ = read_point_file(PointFile(package, layer="contours", height="elev"))
    assert points.tolist() == expected[:3]


@pytest.mark.parametrize(
    ("name", "text", "keys", "words"),
    [
        ("a.geojson", features(({"a": 1}, point([1, 2]))), {"height": "b"}, "no attribute 'b'; it has a"),
        ("a.geojson", features(({"a": "high"}, point([1, 2]))), {"height": "a"}, "not a number: 'high'"),
        ("a.geojson", features(({"a": True}, point([1, 2]))), {"height": "a"}, "not a number"),
        ("a.geojson", features(({"a": None}, point([1, 2]))), {"height": "a"}, "'a' has no elevations"),
        ("a.geojson", features(({"ELEV": 7, "b": 1}, point([1, 2]))), {}, "no elevation; .*it has ELEV, b$"),
        ("a.geojson", features(), {}, "no points in it"),
        ("a.geojson", features(({}, point([1, 2, 3]))), {"columns": ["x", "y", "z"]}, "'columns' has no"),
        ("a.geojson", features(({}, point([1, 2, 3]))), {"layer": "a"}, "not a GeoPackage"),
        ("a.wkt", "POINT (1 2 3)", {"height": "z"}, "no attributes"),
        ("a.csv", "1,2,3\n", {"height": "z"}, "it is a table, so 'height' has no effect"),
        ("a.csv", 'WKT,elev\n"POINT (1 2)",3\n', {}, "well-known text in a column; .*AS_XYZ"),
        ("a.asc", "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n", {"layer": "a"}, "a raster"),
    ],
)
def test_refused(write, name, text, keys, words):
    with pytest.raises(InputRefused, match=words):
        read_point_file(PointFile(write(name, text), **keys))


def packed(code, *places):
    """A point, or a line, as a GeoPackage has it."""
    body = struct.pack("<BI", 1, code) + (b"" if code % 1000 == 1 else struct.pack("<I", len(places)))
    body += b"".join(struct.pack(f"<{len(place)}d", *place) for place in places)
    return b"GP" + struct.pack("<BBi", 0, 1, 28350) + body


def write_geopackage(path, layers):
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
    for layer, rows in layers.items():
        base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom')", (layer,))
        base.execute(f"CREATE TABLE {layer} (fid INTEGER PRIMARY KEY, geom BLOB, elev REAL)")
        base.executemany(f"INSERT INTO {layer} (geom, elev) VALUES (?, ?)", rows)
    base.commit()
    base.close()
    return path


OFF = "OFF\n4 2 0\n0 0 {z}\n10 0 {z}\n10 10 {z}\n0 10 {z}\n3 0 1 2\n3 0 2 3\n"


@pytest.mark.parametrize(
    ("units", "scale"), [('"ft"', (0.3048, 0.3048)), ('{ z = "ft" }', (1.0, 0.3048)), ('"m"', (1.0, 1.0))]
)
def test_meshes_in_another_unit(write, units, scale):
    write("top.off", OFF.format(z=5))
    path = write(
        "p.toml",
        'format = 1\nname = "x"\n[[rock]]\nname = "r"\nbase_elevation = 0\n[[rock.surface]]\n'
        f'name = "top"\nmesh = "top.off"\nunits = {units}\n',
    )
    plan, height = scale
    assert build(load_project(path)).volume == pytest.approx((10 * plan) ** 2 * 5 * height)


def test_units_of_meshes_that_make_no_sense(write):
    file = write("top.off", OFF.format(z=5))
    project = Project("x", [Rock("r", [Surface("top", mesh=MeshFile(file, "feet"))], base_elevation=0.0)])
    with pytest.raises(InputRefused, match="unknown unit 'feet'"):
        build(project)
    project.rocks[0].surfaces[0].mesh = MeshFile(file, {"z": "ft"})
    assert build(project).volume == pytest.approx(100 * 5 * 0.3048)


def test_a_project_with_contours(write):
    """The keys of a project file."""
    plan = np.array([(x, y) for x in (0.0, 2.0, 4.0) for y in (0.0, 2.0, 4.0)])
    contours = [
        ({"ELEV": float(x), "bed": "top"}, {"type": "LineString", "coordinates": [[x, 0], [x, 2], [x, 4]]})
        for x in np.unique(plan[:, 0])
    ]
    write("c.geojson", features(*contours, ({"ELEV": 99, "bed": "other"}, point([1, 1]))))
    path = write(
        "p.toml",
        'format = 1\nname = "x"\n[[rock]]\nname = "r"\nregion = [[0, 0], [4, 0], [4, 4], [0, 4]]\n'
        'edge_length = 1\nbase_elevation = -1\n[[rock.surface]]\nname = "top"\npoints = "c.geojson"\n'
        'height = "ELEV"\nwhere = { bed = "top" }\nmethod = "plane"\n',
    )
    assert build(load_project(path)).volume == pytest.approx(16 * 3)
    write("p.toml", path.read_text().replace('height = "ELEV"', "height = 3"))
    with pytest.raises(InputRefused, match="'height' must be a name"):
        load_project(path)
