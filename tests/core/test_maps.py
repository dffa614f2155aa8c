# SPDX-License-Identifier: GPL-3.0-or-later
"""The geological map and contours: exact polygons, as readers that nobody here wrote read them."""

import json
import sqlite3
import struct
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from random import Random

import numpy as np
import pytest
from realmodel.core import InputRefused, Model, Project, Rock, Surface, UsageError, build
from realmodel.core.base.work import native_module
from realmodel.core.cells.cell_complex import CellComplex
from realmodel.core.readers import read_region, read_shapes
from realmodel.core.readers.maps.geojson import read_geojson
from realmodel.core.results.contours import checked_interval, contours
from realmodel.core.results.geological_map import geological_map
from realmodel.core.settings.data_files import MapLayer
from realmodel.core.surfaces.surface_input import SurfaceArrays
from sample_scripts import built_sample
from stacks.generate import random_stack
from stacks.model_view import built
from stacks.rock_masses import random_rock_masses

WHY = "not installed: scripts/test.sh installs it"
SAMPLES = {  # what crops out: how many areas, rings of all, and the plan area
    "two_layers": (2, 3, 100 * 60),
    "gravel_plain": (2, 3, 447_450),
    "tunnel": (5, 9, 640 * 320),
}


@pytest.fixture(scope="module", params=SAMPLES)
def sample(request):
    return request.param, built_sample(request.param)


@pytest.fixture(scope="module")
def two_layers():
    return built_sample("two_layers")


def shapes_of(areas):
    shapely = pytest.importorskip("shapely", reason=f"shapely is {WHY}")
    return [
        shapely.MultiPolygon([shapely.Polygon(rings[0], rings[1:]) for rings in area.polygons])
        for area in areas
    ]


def assert_a_map(model, areas):
    """Polygons are valid, share their borders edge by edge, and show the highest face everywhere."""
    shapely = pytest.importorskip("shapely", reason=f"shapely is {WHY}")
    shapes = shapes_of(areas)
    assert [shapely.is_valid_reason(shape) for shape in shapes if not shape.is_valid] == []
    whole = shapely.union_all(shapes)
    assert sum(shape.area for shape in shapes) == pytest.approx(whole.area, rel=1e-9)
    assert [area.area for area in areas] == pytest.approx([shape.area for shape in shapes], rel=1e-9)
    edges = Counter()
    for area in areas:
        for rings in area.polygons:
            for ring in rings:
                edges.update(zip(map(tuple, ring), map(tuple, np.roll(ring, -1, axis=0)), strict=True))
    assert max(edges.values(), default=1) == 1
    single = [np.subtract(a, b) for a, b in edges if (b, a) not in edges]
    assert sum(np.hypot(*edge) for edge in single) == pytest.approx(whole.length, rel=1e-6)
    assert_highest(model, areas, shapes)


def assert_highest(model, areas, shapes):
    """At random places: the block of the highest face of the model there, found one by one."""
    shapely = pytest.importorskip("shapely", reason=f"shapely is {WHY}")
    low, high = model.vertices[:, :2].min(axis=0), model.vertices[:, :2].max(axis=0)
    triangles, begins = native_module().triangulate_faces(
        model.vertices, model.face_offsets, model.face_vertices
    )
    corners = model.vertices[triangles]
    face = np.repeat(np.arange(len(model.face_cells)), np.diff(begins))
    for place in np.random.default_rng(1).uniform(low, high, (15, 2)):
        point = shapely.Point(place)
        if min(shape.boundary.distance(point) for shape in shapes) < 1e-6 * (high - low).max():
            continue
        a, b, c = (corners[:, k, :2] - place for k in range(3))
        signs = np.sign([a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]])
        third = np.sign(c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0])
        rows = np.flatnonzero((signs[0] == signs[1]) & (signs[0] == third) & (third != 0))
        found = [area.block for area, shape in zip(areas, shapes, strict=True) if shape.contains(point)]
        heights = []
        for row in rows.tolist():
            normal = np.cross(corners[row, 1] - corners[row, 0], corners[row, 2] - corners[row, 0])
            heights.append(corners[row, 0, 2] + normal[:2] @ (corners[row, 0, :2] - place) / normal[2])
        top = face[rows[int(np.argmax(heights))]] if heights else None
        expected = [] if top is None else [model.cell_block[model.face_cells[top].max()]]
        if top is not None and model.face_cells[top].min() >= 0:  # as high as the outside but for rounding
            continue
        assert found == expected


def test_maps_of_samples(sample):
    name, model = sample
    areas = geological_map(model)
    rings = sum(len(polygon) for area in areas for polygon in area.polygons)
    assert (len(areas), rings) == SAMPLES[name][:2]
    assert sum(area.area for area in areas) == pytest.approx(SAMPLES[name][2], rel=1e-9)
    assert_a_map(model, areas)


def as_model(case, cells):
    arrays = built(case, cells=cells)
    return Model(
        CellComplex.of(arrays, cells),
        [],
        SurfaceArrays([]),
        [],
        None,
    )


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize(
    "family", ["own lattices", "partial", "jumps", "regions", "rules", "T-junctions", ""]
)
def test_maps_of_random_stacks(family, cells):
    """Steps have other vertices above and below; borders are shared all the same."""
    for seed in range(8):
        rng = Random(seed)
        case = random_stack(rng, family) if family else random_rock_masses(rng)
        model = as_model(case, cells)
        if len(model.vertices):
            assert_a_map(model, geological_map(model))


def hill():
    """A pyramid of height 10 on a square of 20 x 20, around it a plain at 0 of 40 x 40."""
    corners = [[-10, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0]]
    points = np.array([*corners, *(np.multiply(corners, 2)), [0, 0, 10]], float)
    triangles = []
    for k in range(4):
        after = (k + 1) % 4
        triangles += [[k, after, 8], [4 + k, 4 + after, after], [4 + k, after, k]]
    return points, np.array(triangles, np.int32)


def test_contours_of_a_pyramid_are_squares():
    vertices, triangles = hill()
    model = build(Project("hill", [Rock("r", [Surface("ground", vertices, triangles)], base_elevation=-5.0)]))
    lines = contours(model, 2.5)
    for surface in ("", "ground"):
        own = [line for line in lines if line.surface == surface]
        assert [line.elevation for line in own if line.elevation > 0] == [2.5, 5.0, 7.5]
        for line in own:
            if line.elevation == 0:
                continue
            size = 10 - line.elevation
            assert np.array_equal(line.points[0], line.points[-1])
            assert np.abs(line.points).max(axis=1) == pytest.approx(np.full(len(line.points), size))
            x, y = line.points.T
            assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2 == pytest.approx(
                4 * size**2
            )  # higher to the left


def test_contours_lie_on_the_ground(two_layers):
    lines = contours(two_layers)
    assert {line.elevation for line in lines if not line.surface} == set(np.arange(16.0, 27.0))
    vertices, triangles = two_layers.surface(1)
    for line in lines:
        if line.surface == "ground":
            middles = (line.points[1:] + line.points[:-1]) / 2
            z = native_module().surface_heights(vertices, triangles, middles)
            assert z[np.isfinite(z)] == pytest.approx(line.elevation, abs=1e-9)
    top = [line.points.tolist() for line in lines if not line.surface]
    assert sum(map(len, top)) >= sum(len(line.points) for line in lines if line.surface == "ground")


def test_intervals():
    assert checked_interval(None, 0.0, 15.0) == 1.0
    assert checked_interval(None, 0.0, 16.0) == 2.0
    assert checked_interval(None, 100.0, 850.0) == 50.0
    assert checked_interval(None, 5.0, 5.0) > 0
    for wrong in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(UsageError, match="a contour interval is a number above 0"):
            checked_interval(wrong, 0.0, 1.0)
    with pytest.raises(UsageError, match="take a longer interval"):
        checked_interval(1e-6, 0.0, 100.0)


def read(path, layer=None):
    """Fields and shapes of a layer, by GDAL."""
    pyogrio = pytest.importorskip("pyogrio", reason=f"pyogrio is {WHY}")
    shapely = pytest.importorskip("shapely", reason=f"shapely is {WHY}")
    properties, _, shapes, fields = pyogrio.raw.read(path, layer=layer)
    return properties, dict(zip(properties["fields"], fields, strict=True)), shapely.from_wkb(shapes)


@pytest.mark.parametrize(("crs", "found"), [("EPSG:25832", "EPSG:25832"), ("ESRI:102013", None)])
def test_the_files_name_the_projects_system(two_layers, crs, found, tmp_path):
    """GDAL looks codes up: the files have no definitions."""
    model = Model.of(two_layers)
    model.project = replace(model.project, crs=crs)
    for name in ("m.gpkg", "m.geojson"):
        model.save(tmp_path / name)
        layer = "contours" if name == "m.gpkg" else None
        properties, *_ = read(tmp_path / name, layer)
        assert properties["crs"] == found or (found is None and "25832" not in str(properties["crs"]))
    head = json.loads((tmp_path / "m.geojson").read_text())["crs"]["properties"]["name"]
    assert head == "urn:ogc:def:crs:" + crs.replace(":", "::")


@pytest.mark.parametrize("ending", [".gpkg", ".geojson"])
@pytest.mark.parametrize("name", ["two_layers", "gravel_plain"])
def test_gdal_reads_the_files(name, ending, tmp_path):
    model = built_sample(name)
    model.save(tmp_path / f"m{ending}", contour_interval=2.0)
    areas = geological_map(model)
    if ending == ".gpkg":
        properties, fields, shapes = read(tmp_path / "m.gpkg", "geology")
        assert properties["crs"] is None or "ndefined" in properties["crs"]
        assert properties["geometry_type"] == "MultiPolygon"
        properties, lines, line_shapes = read(tmp_path / "m.gpkg", "contours")
        assert properties["geometry_type"] == "LineString"
    else:
        _, fields, shapes = read(tmp_path / "m.geojson")
        is_area = fields["layer"] == "geology"
        lines = {key: values[~is_area] for key, values in fields.items()}
        fields = {key: values[is_area] for key, values in fields.items()}
        shapes, line_shapes = shapes[is_area], shapes[~is_area]
    assert fields["block"].tolist() == [model.blocks[area.block].name for area in areas]
    assert fields["property"].tolist() == [model.blocks[area.block].property for area in areas]
    library = model.project.library
    assert fields["rock"].tolist() == [library.get(p).name for p in fields["property"].tolist()]
    assert all(shape.is_valid for shape in shapes)
    assert [shape.area for shape in shapes] == pytest.approx(fields["area"].tolist(), rel=1e-12)
    assert fields["area"].sum() == pytest.approx(SAMPLES[name][2], rel=1e-9)
    for shape, area in zip(shapes, areas, strict=True):
        assert shape.equals_exact(shapes_of([area])[0], 0.0)
    wanted = contours(model, 2.0)
    assert lines["elevation"].tolist() == [line.elevation for line in wanted]
    assert set(lines["surface"]) == {line.surface or "top of the model" for line in wanted}
    for shape, line in zip(line_shapes, wanted, strict=True):
        assert np.array_equal(np.array(shape.coords), line.points)


def test_the_command_line_writes_maps(two_layers, tmp_path):
    command = [sys.executable, "build_model.py", "blend_samples/two_layers/project.toml", "--quiet"]
    for name in ("m.gpkg", "m.geojson"):
        command += ["--export", str(tmp_path / name)]
    done = subprocess.run([*command, "--contour-interval", "5"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = json.loads((tmp_path / "m.geojson").read_text())["features"]
    heights = {f["properties"]["elevation"] for f in lines if f["properties"]["layer"] == "contours"}
    assert heights == {line.elevation for line in contours(two_layers, 5.0)} >= {20.0, 25.0}
    _, fields, _ = read(tmp_path / "m.gpkg", "contours")
    assert set(fields["elevation"]) == heights
    done = subprocess.run([*command, "--contour-interval", "0"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "'0' is not a length above 0" in done.stderr


def test_our_own_readers_take_them(two_layers, tmp_path):
    for ending in (".gpkg", ".geojson"):
        two_layers.save(tmp_path / f"m{ending}")
    areas = geological_map(two_layers)
    first = read_shapes(MapLayer(tmp_path / "m.gpkg", "geology", {"block": "Sand"})).polygons
    second = read_geojson(MapLayer(tmp_path / "m.geojson", where={"block": "Sand"})).polygons
    assert len(first) == len(second) == len(areas[1].polygons)
    for one, two, rings in zip(first, second, areas[1].polygons, strict=True):
        assert np.array_equal(one.rings[0], two.rings[0])
        assert {*map(tuple, one.rings[0])} == {*map(tuple, rings[0])}


def test_the_same_model_gives_the_same_bytes(two_layers, tmp_path):
    for name in ("a.gpkg", "b.gpkg", "a.geojson", "b.geojson"):
        two_layers.save(tmp_path / name)
    assert (tmp_path / "a.gpkg").read_bytes() == (tmp_path / "b.gpkg").read_bytes()
    assert (tmp_path / "a.geojson").read_bytes() == (tmp_path / "b.geojson").read_bytes()


def test_a_wrong_interval_writes_nothing(two_layers, tmp_path):
    for name in ("m.gpkg", "m.geojson"):
        with pytest.raises(UsageError, match="take a longer interval"):
            two_layers.save(tmp_path / name, contour_interval=1e-9)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "system", ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::4326", "EPSG:4258"]
)
def test_degrees_are_no_lengths(tmp_path, system):
    """A file that says that it is in degrees is refused, unless its numbers cannot be degrees."""
    file = tmp_path / "a.geojson"
    for ring, is_refused in (
        ([[7.1, 48.1], [7.2, 48.1], [7.2, 48.2], [7.1, 48.1]], True),
        ([[0, 0], [3100, 0], [3100, 2000], [0, 0]], False),
    ):
        content = {"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": system}}}
        shape = {"type": "Polygon", "coordinates": [ring]}
        content["features"] = [{"type": "Feature", "properties": {}, "geometry": shape}]
        file.write_text(json.dumps(content))
        if is_refused:
            with pytest.raises(InputRefused, match="degrees of longitude and latitude"):
                read_region(file)
        else:
            assert len(read_region(file)[0]) == 1
    file.write_text(json.dumps(content).replace(system, "EPSG:25832").replace("3100", "31"))
    assert len(read_region(file)[0]) == 1
    base = sqlite3.connect(tmp_path / "a.gpkg")
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, srs_id INT)")
    columns = "srs_id INT, organization TEXT, organization_coordsys_id INT, definition TEXT"
    base.execute(f"CREATE TABLE gpkg_spatial_ref_sys ({columns})")
    base.execute("INSERT INTO gpkg_geometry_columns VALUES ('a', 'geom', 7)")
    base.execute("INSERT INTO gpkg_spatial_ref_sys VALUES (7, 'EPSG', 4326, 'GEOGCS[]')")
    base.execute("CREATE TABLE a (fid INTEGER PRIMARY KEY, geom BLOB)")
    line = struct.pack("<BII4d", 1, 2, 2, 7.0, 48.0, 7.1, 48.1)
    base.execute("INSERT INTO a VALUES (NULL, ?)", (b"GP" + struct.pack("<BBi", 0, 1, 7) + line,))
    base.commit()
    base.close()
    with pytest.raises(InputRefused, match="degrees of longitude and latitude"):
        read_shapes(MapLayer(tmp_path / "a.gpkg"))
