# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions: nasty outlines with the right verdict, files of every format, and the keys of the project file."""

import sqlite3
import struct

import numpy as np
import pytest
from outlines import ACCEPTED, PROJECT_OF_REGION, REFUSED, SQUARE, area, squares_in_squares, star
from realmodel.core import (
    BuildFailed,
    InputRefused,
    MapLayer,
    Project,
    Rock,
    Surface,
    build,
    load_project,
    mesh_region,
)
from realmodel.core.base.packages import vendored
from realmodel.core.project.plan_input import read_rings, region_rings
from realmodel.core.readers import read_region, read_shapes
from realmodel.core.readers.maps.wkt import parse_wkt
from realmodel.core.surfaces.planar_mesh import triangulate_rings
from stacks import places

try:
    shapefile = vendored("shapefile", "pyshp", "this test")
except BuildFailed:
    shapefile = None
needs_pyshp = pytest.mark.skipif(shapefile is None, reason="addon/realmodel/vendor has no pyshp")
needs_data = pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)


def region_area(rings):
    """The area of a region by its triangles, all of which must be the right way round."""
    vertices, triangles = triangulate_rings(rings)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (areas > 0).all()
    return float(areas.sum())


@pytest.mark.parametrize("name", ACCEPTED)
def test_nasty_outlines_are_accepted(name):
    outline, holes, expected = ACCEPTED[name]
    rings = region_rings(outline, holes)
    assert len(rings) == 1 + len(holes)
    if expected is None:
        expected = abs(area(np.asarray(outline)))
    assert region_area(rings) == pytest.approx(expected, rel=1e-9)
    turned = region_rings(np.asarray(outline)[::-1], [np.asarray(hole)[::-1] for hole in holes])
    assert region_area(turned) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", REFUSED)
def test_nasty_outlines_are_refused(name):
    outline, holes, words, place = REFUSED[name]
    for turn in (1, -1):
        with pytest.raises(InputRefused) as raised:
            mesh_region(np.array(outline, float)[::turn], holes=holes, edge_length=1.0)
        assert words in str(raised.value) or (turn < 0 and name == "NaN")
        assert "\n" not in str(raised.value)
        if place is not None and turn > 0:
            assert raised.value.place == pytest.approx(place)


def test_random_stars():
    for seed in range(20):
        outline = star(300, seed)
        assert region_area(region_rings(outline)) == pytest.approx(abs(area(outline)), rel=1e-9)
        swapped = outline.copy()
        swapped[[50, 200]] = swapped[[200, 50]]
        with pytest.raises(InputRefused, match="crosses itself"):
            region_rings(swapped)


def test_several_outlines():
    """A list of outlines counts even-odd, in any order; holes must lie in one of them."""
    rings = squares_in_squares(6)
    expected = region_area(region_rings(rings))
    assert expected == pytest.approx(4 * (36 - 25 + 16 - 9 + 4 - 1))
    assert region_area(region_rings(rings[::-1])) == pytest.approx(expected)
    assert region_area(region_rings([SQUARE, SQUARE + 10], [SQUARE / 4 + 11])) == pytest.approx(31)
    vertices, _ = mesh_region([SQUARE, SQUARE + 10], edge_length=1.0)
    assert vertices.max() == 14
    with pytest.raises(InputRefused, match="hole 1: this hole does not lie inside its outline"):
        region_rings([SQUARE, SQUARE + 10], [SQUARE / 4 + 6])
    with pytest.raises(InputRefused, match="outline 1: the outline crosses outline 2"):
        region_rings([SQUARE, SQUARE + 2])


WKT = [
    "POLYGON ((0 0, 4 0, 4 4, 0 0), (1 0.5, 2 0.5, 2 1, 1 0.5))",
    "  polygon((0 0,4 0,4 4,0 0),(1 .5,2 .5,2 1,1 .5))  ",
    "SRID=28350;POLYGON Z ((0 0 7, 4 0 7, 4 4 7, 0 0 7), (1 0.5 7, 2 0.5 7, 2 1 7, 1 0.5 7))",
    "MULTIPOLYGON (((0 0, 4e0 0, 4 4, 0 0), (1 0.5, 2 0.5, 2 1, 1 0.5)))",
    "GEOMETRYCOLLECTION (POINT EMPTY, POLYGON M ((0 0 1, 4 0 1, 4 4 1, 0 0 1),\n(1 0.5 1, 2 0.5 1, 2 1 1)))",
    "POLYGONZM ((0 0 1 2, 4 0 1 2, 4 4 1 2), (1 0.5 0 0, 2 0.5 0 0, 2 1 0 0))",
]
RINGS = [[[0, 0], [4, 0], [4, 4]], [[1, 0.5], [2, 0.5], [2, 1]]]


@pytest.mark.parametrize("text", WKT)
def test_well_known_text(write, text):
    rings, left_out = read_region(write("r.wkt", text))
    assert [ring.tolist() for ring in rings] == RINGS
    assert left_out == []
    assert [ring.tolist() for ring in read_rings(text)[1]] == RINGS[1:]


def test_lines_and_points_of_well_known_text():
    shapes = parse_wkt(
        "LINESTRING (0 0, 1 2)\nMULTILINESTRING ((0 0, 1 1), (2 2, 3 3));POINT (5 6)\nMULTIPOINT (1 2, 3 4)"
    )
    assert [line.tolist() for _, line in shapes.lines] == [
        [[0, 0], [1, 2]],
        [[0, 0], [1, 1]],
        [[2, 2], [3, 3]],
    ]
    assert [point.tolist() for _, point in shapes.points] == [[5, 6], [1, 2], [3, 4]]
    assert shapes.lines[1][0] == "geometry 2"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("POLYGON ((0 0, 4 0, 4 4", 1, "a bracket is not closed"),
        ("POLYGON ((0 0, 4 0,\n4, 0 0))", 1, "'4' is no position"),
        ("POLYGON\n((0 0, 4 x, 4 4, 0 0))", 2, "'4 x' is no position"),
        ("POLYGON ((0 0, 4 nan, 4 4, 0 0))", 1, "not finite"),
        ("POLYGON ((0 0, 1 0, 1 1)", 1, "too early"),
        ("POLYGON 3", 1, "'(' is expected, there is '3'"),
        ("POLYGON ((0 0, 1 0, 1 1)) CURVEPOLYGON ((0 0))", 1, "'CURVEPOLYGON' is no geometry"),
        ("LINESTRING (0 0, 1 1)", None, "no polygon"),
        ("GEOMETRYCOLLECTION (" * 60 + "POINT (0 0)" + ")" * 60, 1, "nested too deep"),
        ("hello (world)", None, "neither GeoJSON"),
    ],
)
def test_well_known_text_refused(write, text, line, words):
    path = write("r.wkt", text)
    with pytest.raises(InputRefused) as raised:
        read_region(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def write_shapefile(path, rings_of_features, names, kind=5):
    with shapefile.Writer(str(path), shapeType=kind) as writer:
        writer.field("NAME", "C", 40)
        writer.field("AREA", "N", 12, 3)
        for number, (rings, name) in enumerate(zip(rings_of_features, names, strict=True)):
            closed = [
                [*map(list, ring), list(ring[0])] if kind == 5 else list(map(list, ring)) for ring in rings
            ]
            (writer.poly if kind == 5 else writer.line)(closed)
            writer.record(name, number * 1.5)
    return path


@needs_pyshp
def test_shapefiles(tmp_path):
    """Rings of either direction; features by their attributes; lines; a missing table."""
    path = write_shapefile(tmp_path / "a.shp", [RINGS, [SQUARE + 10]], ["Hill", "Dale"])
    assert len(read_region(path)[0]) == 3
    rings, _ = read_region(MapLayer(path, where={"name": "Hill"}))
    assert region_area(rings) == pytest.approx(8 - 0.25)
    rings, _ = read_region(MapLayer(path, where={"AREA": [1.5, 7]}))
    assert [ring.tolist() for ring in rings] == [(SQUARE + 10).tolist()] or len(rings[0]) == 4
    for where, words in (
        ({"NAME": "Hull"}, "NAME is Hill, Dale"),
        ({"KIND": 1}, "no attribute 'KIND'; they have NAME"),
    ):
        with pytest.raises(InputRefused, match=words):
            read_region(MapLayer(path, where=where))
    (tmp_path / "a.dbf").unlink()
    assert len(read_region(path)[0]) == 3
    with pytest.raises(InputRefused, match=r"its \.dbf file, .* is missing"):
        read_region(MapLayer(path, where={"NAME": "Hill"}))
    lines = write_shapefile(
        tmp_path / "l.shp", [[[(0, 0), (1, 1)], [(2, 2), (3, 3), (4, 4)]]], ["river"], kind=3
    )
    assert [len(line) for _, line in read_shapes(MapLayer(lines)).lines] == [2, 3]
    with pytest.raises(InputRefused, match="no polygon"):
        read_region(lines)


@needs_pyshp
def test_damaged_shapefiles(tmp_path):
    path = write_shapefile(tmp_path / "a.shp", [RINGS, [SQUARE + 10]], ["Hill", "Dale"])
    whole, draw = path.read_bytes(), np.random.default_rng(1)
    for _ in range(150):
        raw = bytearray(whole[: draw.integers(4, len(whole))] if draw.random() < 0.3 else whole)
        for at in draw.integers(4, len(raw), 2) if len(raw) > 4 else []:
            raw[at] = draw.integers(0, 256)
        path.write_bytes(raw)
        try:
            read_region(path)
        except InputRefused as error:
            assert "\n" not in str(error)


def packaged(rings, order="<", envelope=0, code=3):
    """A polygon as a GeoPackage has it."""
    body = struct.pack(f"{order}BII", order == "<", code, len(rings))
    for ring in rings:
        positions = [*ring, ring[0]]
        size = {3: 2, 1003: 3, 0x80000003: 3}[code]
        body += struct.pack(f"{order}I", len(positions))
        body += b"".join(
            struct.pack(f"{order}{size}d", *position, *[9.0] * (size - 2)) for position in positions
        )
    return b"GP" + struct.pack("<BBi", 0, 1 | envelope << 1, 28350) + bytes((0, 32)[envelope]) + body


def write_geopackage(path, layers):
    path.unlink(missing_ok=True)
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
    for layer, features in layers.items():
        base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom')", (layer,))
        quoted = layer.replace('"', '""')
        base.execute(f'CREATE TABLE "{quoted}" (fid INTEGER PRIMARY KEY, geom BLOB, name TEXT, depth REAL)')
        base.executemany(f'INSERT INTO "{quoted}" (geom, name, depth) VALUES (?, ?, ?)', features)
    base.commit()
    base.close()
    return path


@pytest.mark.parametrize(
    ("order", "envelope", "code"), [("<", 0, 3), (">", 1, 3), ("<", 1, 1003), (">", 0, 0x80000003)]
)
def test_geopackages(tmp_path, order, envelope, code):
    path = tmp_path / "a.gpkg"
    lake = packaged(RINGS, order, envelope, code)
    write_geopackage(
        path, {"lakes": [(lake, "Hill", 2.5), (None, "none", 0), (packaged([SQUARE + 9]), "Dale", 3)]}
    )
    assert len(read_region(path)[0]) == 3
    for where in ({"name": "Hill"}, {"depth": 2.5}, {"name": "Hill", "depth": [2.5, 4]}):
        rings, _ = read_region(MapLayer(path, where=where))
        assert [ring.tolist() for ring in rings] == RINGS
    with pytest.raises(InputRefused, match="no feature has name = 'Hull'; name is Hill, none, Dale"):
        read_region(MapLayer(path, where={"name": "Hull"}))


def test_layers_of_geopackages(tmp_path, write):
    path = tmp_path / "a.gpkg"
    write_geopackage(path, {"lakes": [(packaged(RINGS), "", 0)], 'odd "name"': [(packaged([SQUARE]), "", 0)]})
    rings, _ = read_region(MapLayer(path, 'odd "name"'))
    assert rings[0].tolist() == SQUARE.tolist()
    for layer, words in ((None, "it has 2 layers; say which"), ("lake", "no layer 'lake'; it has lakes")):
        with pytest.raises(InputRefused, match=words):
            read_region(MapLayer(path, layer))
    with pytest.raises(InputRefused, match="it is not a GeoPackage"):
        read_region(MapLayer(write("r.wkt", WKT[0]), "lakes"))
    write_geopackage(path, {"lakes": [(packaged(RINGS)[:-9], "", 0)]})
    with pytest.raises(InputRefused, match="layer 'lakes', feature 1: its geometry cannot be read"):
        read_region(path)
    path.write_bytes(path.read_bytes()[:600])
    with pytest.raises(InputRefused, match="GeoPackage"):
        read_region(path)


def test_polygons_that_share_borders_are_one_region(write):
    """Neighbours dissolve, with corners on each other's edges and a hole between the three."""
    text = (
        "MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4)), ((4 1, 8 1, 8 8, 3 8, 3 5, 4 4, 4 3)),"
        "((0 4, 4 4, 3 5, 3 8, 0 8), (1 5, 2 5, 2 6)))"
    )
    region, holes, _ = read_rings(write("r.wkt", text))
    assert holes == []
    total = sum(abs(area(ring)) for ring in (
        [(0, 0), (4, 0), (4, 4), (0, 4)], [(4, 1), (8, 1), (8, 8), (3, 8), (3, 5), (4, 4), (4, 3)],
        [(0, 4), (4, 4), (3, 5), (3, 8), (0, 8)])) - 0.5  # fmt: skip
    assert region_area(region) == pytest.approx(total)
    assert len(region) == 2
    with pytest.raises(InputRefused, match="cover each other"):
        read_rings("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4)), ((0 0, 4 0, 4 4, 0 4)))")
    with pytest.raises(InputRefused, match="polygon 2, hole 1: this hole does not lie inside its outline"):
        read_rings("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4)), ((9 9, 8 9, 8 8), (1 1, 2 1, 2 2)))")


@needs_data
def test_hamersley():
    """Units of a geological map, by attribute: each is a region, with its holes; neighbours are one."""
    path = places.REAL_DATA / "hamersley" / "geology.geojson"
    shapes = read_shapes(MapLayer(path))
    assert len(shapes.polygons) >= 61
    units = {}
    for polygon in shapes.polygons:
        units.setdefault(polygon.item, 0)
        units[polygon.item] += region_area(region_rings(polygon.rings[0], polygon.rings[1:]))
    region, holes, warnings = read_rings(MapLayer(path, where={"unitname": "Marra Mamba Iron Formation"}))
    assert warnings == []
    rings = [region, *holes] if isinstance(region, np.ndarray) else region
    assert region_area(rings) > 0
    _, triangles = mesh_region(rings, edge_length=3000.0)
    assert len(triangles) > 100


@needs_data
@needs_pyshp
def test_pleasant_lakes_are_holes(tmp_path):
    """The lakes with their islands as holes of a region around them."""
    lakes = read_shapes(MapLayer(places.REAL_DATA / "pleasant" / "all_lakes.shp"))
    rings = [ring for polygon in lakes.polygons for ring in polygon.rings]
    assert (len(lakes.polygons), len(rings)) == (9, 33)
    low, high = (f(np.concatenate(rings), axis=0) for f in (np.min, np.max))
    low, high = low - 500, high + 500
    outline = [low, (high[0], low[1]), high, (low[0], high[1])]
    water = region_area(region_rings(rings))
    around = region_rings(outline, rings)
    assert region_area(around) == pytest.approx(np.prod(high - low) - water, rel=1e-9)
    vertices, triangles = mesh_region(outline, holes=rings, edge_length=400.0)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(np.prod(high - low) - water, rel=1e-9)


def test_regions_of_the_project_file(write, tmp_path):
    write("r.wkt", WKT[0])
    write_geopackage(
        tmp_path / "a.gpkg", {"a": [(packaged(RINGS), "Hill", 0), (packaged([SQUARE]), "Dale", 0)], "b": []}
    )
    for region in (
        '"r.wkt"',
        f'"{WKT[0]}"',
        '{ file = "a.gpkg", layer = "a", where = { name = "Hill" } }',
        "[[0, 0], [4, 0], [4, 4]]\nholes = [[[1, 0.5], [2, 0.5], [2, 1]]]",
        "[[[0, 0], [4, 0], [4, 4]], [[1, 0.5], [2, 0.5], [2, 1]]]",
        '{ file = "r.wkt", units = "m" }',
    ):
        project = load_project(write("p.toml", PROJECT_OF_REGION.format(region=region)))
        model = build(project)
        assert model.volume == pytest.approx(7.75)
        assert build(model.project).volume == pytest.approx(7.75)  # from the arrays that were read
        if "gpkg" in region:
            assert tmp_path / "a.gpkg" in project.input_files()
    feet = load_project(write("p.toml", PROJECT_OF_REGION.format(region='{ file = "r.wkt", units = "ft" }')))
    assert build(feet).volume == pytest.approx(7.75 * 0.3048**2)


@pytest.mark.parametrize(
    ("region", "line", "words"),
    [
        ('{ file = "no.shp" }', 5, "file not found"),
        ('{ layer = "a" }', 5, "key 'file' is missing"),
        ('{ file = "r.wkt", layers = "a" }', 5, "did you mean 'layer'?"),
        ('{ file = "r.wkt", where = 3 }', 5, "'where' must be"),
        ('{ file = "r.wkt", where = { a = 3 } }', None, "no attributes"),
        ('{ file = "r.wkt", units = "feet" }', 5, "unknown unit"),
        ('"POLYGON ((0 0, 4 4, 4 0, 0 4))"', 5, "region, outline: the outline crosses itself at (2, 2)"),
        ("[[0, 0],\n[9, 9],\n[9, 0],\n[0, 9]]", 5, "crosses itself at (4.5, 4.5)"),
        ("[[0, 0],\n[9, 0],\n[9, 9],\n[-1, 1],\n[0, 9]]", 7, "crosses itself"),
        (
            "[[0, 0], [9, 0], [9, 9]]\nholes = [\n[[20, 1], [21, 1], [21, 2]]]",
            7,
            "hole 1: this hole does not",
        ),
        ("[[0, 0], [9, 0], [9]]", 5, "two finite numbers"),
        ('"r.wkt"\nholes = [[[1, 1], [2, 2], [2, 1]]]', 6, "put the holes into"),
    ],
)
def test_regions_of_the_project_file_refused(write, region, line, words):
    write("r.wkt", WKT[0])
    path = write("p.toml", PROJECT_OF_REGION.format(region=region))
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert words.split(": ")[-1] in str(raised.value)
    assert raised.value.line == line


def test_regions_from_python():
    surface = Surface("S0", method="constant", options={"value": 0.0})
    for region in (WKT[0], [np.array(ring, float) for ring in RINGS]):
        rock = Rock("r", [surface], region, edge_length=1.0, base_elevation=-2.0)
        assert build(Project("x", [rock])).volume == pytest.approx(15.5)
