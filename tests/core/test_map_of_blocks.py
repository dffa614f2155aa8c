# SPDX-License-Identifier: GPL-3.0-or-later
"""Geological maps as input: contacts where the ground cuts them, blocks on the ground, maps as they come."""

import json
import sqlite3

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, MapFile, Project, Rock, Surface, build, load_project
from realmodel.core.base.work import Work
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers.unit_polygons import UnitPolygon
from realmodel.core.surfaces.field_data import read_field_data
from realmodel.core.surfaces.observed.polygon_borders import border_lines
from realmodel.core.surfaces.prepare import read_rocks
from structure_cases import heights_at, plane_fault
from test_map_points import needs_pyshp, shapefile

PROJECT = """format = 1
name = "map"

[[rock]]
name = "r"
region = [[0, 0], [100, 0], [100, 60], [0, 60]]
edge_length = 5
base_elevation = 0
map = {{ file = "{file}", block = "FORMATION", ground = "ground.asc"{more} }}
names = {{ Yng = "sand", water = "" }}

[[rock.surface]]
name = "top of clay"
block = "clay"
method = "universal_kriging"
dips = "dips.csv"

[[rock.surface]]
name = "ground"
block = "sand"
method = "grid"
"""
BORDER = [[50, 0], [50, 13], [50, 37.5], [50, 60]]
WEST = [[0, 0], *BORDER, [0, 60]]
EAST = [[100, 0], [100, 60], *BORDER[::-1]]


def ground(x, y):
    return 20 + 0.1 * x + 0.05 * y


def contact(x, y):
    """A plane that dips east; the ground cuts it at x = 50."""
    return 25 - 0.2 * (x - 50) + 0.05 * y


def features(*areas):
    """GeoJSON of (unit, ring, holes...)."""
    return json.dumps(
        {
            "type": "FeatureCollection",
            "features": [
                {
                    "type": "Feature",
                    "properties": {"Formation": unit},
                    "geometry": {"type": "Polygon", "coordinates": [[*ring, ring[0]] for ring in rings]},
                }
                for unit, *rings in areas
            ],
        }
    )


def write_ground(folder, height=ground):
    """A raster whose outermost cells have their middles on the outline of the region."""
    rows = [" ".join(repr(float(height(5.0 * c, 60 - 5.0 * r))) for c in range(21)) for r in range(13)]
    head = "ncols 21\nnrows 13\nxllcenter 0\nyllcenter 0\ncellsize 5\nnodata_value -9999\n"
    (folder / "ground.asc").write_text(head + "\n".join(rows) + "\n")


@pytest.fixture
def project_of(tmp_path):
    """project_of(areas): the project with a map of them."""
    write_ground(tmp_path)
    dips = "".join(f"{x},{y},-0.2,0.05\n" for x, y in ((20, 10), (50, 30), (90, 50)))
    (tmp_path / "dips.csv").write_text("x,y,slope_x,slope_y\n" + dips)

    def made(*areas, more=""):
        (tmp_path / "map.geojson").write_text(features(*areas))
        (tmp_path / "project.toml").write_text(PROJECT.format(file="map.geojson", more=more))
        return load_project(tmp_path / "project.toml")

    return made


def field_of(project):
    return read_field_data(project, project.rocks[0])


def contacts_of(project):
    """The places where two blocks meet."""
    places, times = np.unique(field_of(project).rock.observations.places, axis=0, return_counts=True)
    return places[times == 2]


def test_contacts_lie_on_the_plane_that_the_ground_cuts_and_with_dips_make_it(project_of):
    project = project_of(("clay", WEST), ("Yng", EAST))
    found = contacts_of(project)
    assert len(found) == 12  # 60 long, 5 apart
    assert (found[:, 0] == 50).all()
    assert {13.0, 37.5} <= set(found[:, 1])  # corners of the line
    assert np.array_equal(read_rocks(Work(), project)[0].data[0].contacts, found)
    assert np.abs(found[:, 2] - contact(*found[:, :2].T)).max() < 1e-9
    assert np.diff(np.sort(found[:, 1])).max() < 7.6
    model = build(project)
    seen = model.observed()
    assert max(abs(each.residual) for each in seen.contacts) < 1e-6
    assert seen.share == 1.0
    assert not seen.left_out
    assert {each.block: each.observations for each in seen.blocks}.keys() == {"clay", "sand"}
    assert model.project.rocks[0].map is None
    volumes = [block.volume for block in model.blocks]
    # sand: from x = 50, its thickness grows by 0.3 with x
    assert volumes[1] == pytest.approx(60 * 0.3 * 50**2 / 2, rel=0.02)


def test_places_within_polygons_are_apart_from_borders_and_each_polygon_has_one(project_of):
    island = [[20.1, 20.1], [20.3, 20.1], [20.2, 20.4]]
    project = project_of(("clay", WEST, island), ("Yng", EAST), ("sand", island))
    observed = field_of(project).rock.observations
    _, first, times = np.unique(observed.places, axis=0, return_index=True, return_counts=True)
    within = first[times == 1]
    places, blocks = observed.places[within], observed.blocks[within]
    assert np.abs(places[:, 2] - ground(*places[:, :2].T)).max() < 1e-9
    # a place for each square of the edge length, but beside the line
    assert 220 < len(within) <= 241
    assert (np.abs(places[:, 0] - 50) > 1.25).all()
    on_island = (places[:, :2] > 20.1).all(axis=1) & (places[:, :2] < 20.4).all(axis=1)
    assert blocks[on_island].tolist() == ["ground"]
    west = places[:, 0] < 50
    assert set(blocks[west & ~on_island]) == {"top of clay"}
    assert set(blocks[~west]) == {"ground"}


@pytest.mark.parametrize(
    ("west", "east"),
    [
        (WEST, [[50, 0], [100, 0], [100, 60], [50, 60]]),  # T-junctions: one side has no corners
        (WEST, [[50, 0], [100, 0], [100, 60], [50, 60], [50, 50], [50, 21]]),  # others
        (WEST, [*EAST[:3], [50.01, 37.5], [49.99, 20], [50, 0]]),  # shared corners differ a little
    ],
)
def test_borders_that_were_digitized_twice(project_of, west, east):
    found = contacts_of(project_of(("clay", west), ("Yng", east)))
    assert len(found) >= 11
    assert np.abs(found[:, 0] - 50).max() < 0.02
    assert np.diff(np.sort(found[:, 1])).max() < 8


@pytest.mark.parametrize("step", [0.0, 0.3])
def test_lines_are_as_long_as_shapely_finds_borders(step):
    """Cells of a Voronoi diagram; with a step each has corners of its own along its border."""
    shapely = pytest.importorskip("shapely")
    draw = np.random.default_rng(3)
    seeds = shapely.MultiPoint(draw.uniform(0, 100, (80, 2)))
    frame = shapely.box(0, 0, 100, 100)
    cells = [cell.intersection(frame) for cell in shapely.voronoi_polygons(seeds, extend_to=frame).geoms]
    cells = [shapely.segmentize(cell, step) if step else cell for cell in cells]
    classes = draw.integers(0, 4, len(cells))
    polygons = [
        UnitPolygon(f"feature {n}", "", [np.array(cell.exterior.coords)[:-1]], True)
        for n, cell in enumerate(cells)
    ]
    lines, apart = border_lines(polygons, classes, 2.0)
    assert not apart
    found, true = np.zeros((4, 4)), np.zeros((4, 4))
    for line in lines:
        corners = np.concatenate([line.corners, line.corners[:1]]) if line.closed else line.corners
        found[line.classes] += np.hypot(*np.diff(corners, axis=0).T).sum()
        assert len(line.polygons) == len(corners) - 1
    for n, cell in enumerate(cells):
        for m in range(n):
            if classes[n] != classes[m]:
                shared = cell.boundary.buffer(1e-9).intersection(cells[m].boundary).length
                true[tuple(sorted((classes[n], classes[m])))] += shared
    assert np.abs(found - true).max() < 1e-4
    assert true.sum() > 500


@pytest.mark.parametrize(
    ("shift", "is_one"), [(0.3, True), (-0.3, True), (2, False), (-2, False), (9, False), (-9, False)]
)
def test_gaps_and_overlaps_between_borders(project_of, shift, is_one):
    """Narrow ones are one line, others are none; both are listed. Wider ones are no gaps."""
    east = [[x + shift if x == 50 else x, y] for x, y in EAST]
    field = field_of(project_of(("clay", WEST), ("Yng", east)))
    found = contacts_of(project_of(("clay", WEST), ("Yng", east)))
    assert len(found) == (12 if is_one else 0)
    assert len(field.map_warnings) == (abs(shift) < 5)
    if field.map_warnings:
        assert f"feature 1 and feature 2 (up to {abs(shift)} along 60)" in field.map_warnings[0]
        assert ("count as one line" in field.map_warnings[0]) == is_one
    assert not is_one or np.abs(found[:, 0] - 50).max() <= 0.3
    overlaps = [each for each in field.left_out if each.kind == "overlap"]
    assert len(overlaps) == (shift == -9)
    assert not overlaps or "feature 1 and feature 2 overlap, as at (42.5, 2.5)" in overlaps[0].text


def test_what_a_later_polygon_covers_is_no_contact(project_of):
    cover = [[40, 20], [60, 20], [60, 40], [40, 40]]
    found = contacts_of(project_of(("clay", WEST), ("Yng", EAST), ("clay", cover)))
    assert not ((found[:, 1] > 20) & (found[:, 1] < 40) & (found[:, 0] == 50)).all()
    hidden = contacts_of(project_of(("clay", WEST), ("Yng", EAST), ("water", cover)))
    assert not ((hidden[:, 1] > 20) & (hidden[:, 1] < 40)).any()
    assert len(hidden) == 8


def test_units_that_say_nothing_and_unknown_ones(project_of):
    middle = [[50, 0], [60, 0], [60, 60], *BORDER[:0:-1]]
    east = [[60, 0], [100, 0], [100, 60], [60, 60]]
    for unit, kinds in (("water", []), ("", []), ("Xyz", ["unknown_block"])):
        field = field_of(project_of(("clay", WEST), (unit, middle), ("Yng", east)))
        assert field.surfaces[0][1] is None or not len(field.surfaces[0][1][field.surfaces[0][1][:, 0] == 50])
        assert [each.kind for each in field.left_out] == kinds
        assert not kinds or field.left_out[0].text.startswith("feature 2, 'Xyz': this is no block")


def test_lines_of_faults_are_no_contacts(project_of, tmp_path):
    areas = ("clay", WEST), ("Yng", EAST)
    assert len(contacts_of(project_of(*areas))) == 12
    (tmp_path / "faults.wkt").write_text("LINESTRING(50.5 -3, 50.5 30.2)")
    found = contacts_of(project_of(*areas, more=', faults = "faults.wkt"'))
    assert found[:, 1].min() > 30.2
    assert len(found) == 6
    project = project_of(*areas)
    project.faults.append(Fault("F", trace=[[50.0, 20], [50, 70]], dip=90))
    assert contacts_of(project)[:, 1].max() < 20
    (tmp_path / "faults.wkt").write_text("POINT(1 1)")
    with pytest.raises(InputRefused, match="no lines of faults"):
        field_of(project_of(*areas, more=', faults = "faults.wkt"'))


def test_lines_beside_the_polygons_are_faults(project_of, tmp_path):
    """As GIS programs keep them in one file."""
    project = project_of(("clay", WEST), ("Yng", EAST))
    file = tmp_path / "map.geojson"
    found = json.loads(file.read_text())
    line = {"type": "LineString", "coordinates": [[50.5, -3], [50.5, 30.2]]}
    found["features"].append({"type": "Feature", "properties": {"kind": "fault"}, "geometry": line})
    file.write_text(json.dumps(found))
    assert contacts_of(project)[:, 1].min() > 30.2
    assert any(
        "1 line beside its polygons: treated as faults" in text for text in field_of(project).map_warnings
    )


def test_a_fault_of_any_kind_takes_contacts_near_it(project_of):
    project = project_of(("clay", WEST), ("Yng", EAST))
    vertices, triangles = plane_fault(x=50.4, y=(-50.0, 150.0), z=(-90.0, 90.0))
    project.rocks[0].surfaces[0].points = np.array(
        [[x, y, contact(x, y) - 10 * (x > 50)] for x in (5.0, 45, 60, 95) for y in (2.0, 33, 58)]
    )
    project.faults.append(Fault("F", vertices, triangles))
    model = build(project)
    assert len(model.compartment_names) == 2
    data = model.rock_inputs[0].data[0]
    assert not len(data.contacts)
    assert len(data.points) == 12
    project.faults.clear()
    assert len(build(project).rock_inputs[0].data[0].contacts) == 12


@needs_pyshp
def test_formats_of_maps(project_of, tmp_path):
    expected = contacts_of(project_of(("clay", WEST), ("Yng", EAST)))
    with shapefile.Writer(str(tmp_path / "map.shp"), shapeType=shapefile.POLYGON) as writer:
        writer.field("FORMATION", "C")
        for unit, ring in (("clay", WEST), ("Yng", EAST)):
            writer.poly([[*ring, ring[0]]])
            writer.record(unit)
    (tmp_path / "project.toml").write_text(PROJECT.format(file="map.shp", more=""))
    assert np.array_equal(contacts_of(load_project(tmp_path / "project.toml")), expected)
    feet = [[[x / 0.3048, y / 0.3048] for x, y in ring] for ring in (WEST, EAST)]
    found = contacts_of(project_of(("clay", feet[0]), ("Yng", feet[1]), more=', units = "ft"'))
    assert np.abs(found - expected).max() < 1e-9


def test_the_ground_is_a_surface_or_is_made_from_its_file(project_of, tmp_path):
    areas = ("clay", WEST), ("Yng", EAST)
    given = project_of(*areas)
    expected = contacts_of(given)
    x, y = (each.ravel() for each in np.meshgrid(np.arange(0, 101, 5.0), np.arange(0, 61, 5.0)))
    points = np.column_stack([x, y, ground(x, y)])
    corners = np.array([[-1, -1], [101, -1], [101, 61], [-1, 61.0]])
    mesh = {"vertices": np.column_stack([corners, ground(*corners.T)]), "triangles": [[0, 1, 2], [0, 2, 3]]}
    rock = given.rocks[0]
    for shape in ({"points": points}, mesh):
        for name in (None, "ground"):
            surfaces = [rock.surfaces[0], Surface("ground", block="sand", **shape)]
            own = Rock("r", surfaces, rock.region, edge_length=5, base_elevation=0.0, names=rock.names)
            own.map = MapFile(rock.map.file, "FORMATION", ground=name)
            assert np.abs(contacts_of(Project("p", [own])) - expected).max() < 1e-9
    assert field_of(given).surfaces[1][0].point_file.file == tmp_path / "ground.asc"
    own.map = MapFile(rock.map.file, "FORMATION")
    own.surfaces = [rock.surfaces[0], Surface("ground", block="sand", method="natural_neighbour")]
    with pytest.raises(InputRefused, match=r"ground of the map is not known.*ground = "):
        contacts_of(Project("p", [own]))


@pytest.mark.parametrize("method", ["natural_neighbour", "kriging"])
def test_the_ground_passes_through_the_places_of_its_map_between_cells(project_of, tmp_path, method):
    """Its cells, 5 apart, are vertices; bilinear heights between them are on no triangle of these."""
    write_ground(tmp_path, lambda x, y: ground(x, y) + 3 * np.sin(x / 9) * np.cos(y / 11))
    project = project_of(("clay", WEST), ("Yng", EAST))
    project.rocks[0].surfaces[1].method = method
    model = build(project)
    assert not model.observed().violated
    places = model.project.rocks[0].observed.places
    assert len(places) > 240
    z = heights_at(places[:, :2], *model.surface(1))
    assert np.abs(z - places[:, 2]).max() < 1e-9 * np.ptp(places[:, 2])


def test_a_small_polygon_that_reaches_beyond_the_region_has_a_place(project_of):
    strip = [[90, 20.2], [300, 20.2], [300, 20.4], [90, 20.4]]
    observed = field_of(project_of(("clay", WEST), ("Yng", EAST, strip), ("clay", strip))).rock.observations
    _, first, times = np.unique(observed.places, axis=0, return_index=True, return_counts=True)
    within = first[times == 1]
    (place,) = observed.places[within][observed.blocks[within] == "top of clay"][-1:]
    assert np.allclose(place[:2], [95, 20.3])


def test_places_without_ground_are_listed(project_of, tmp_path):
    write_ground(tmp_path, lambda x, y: -9999 if y > 30 else ground(x, y))
    project = project_of(("clay", WEST), ("Yng", EAST))
    field = field_of(project)
    assert contacts_of(project)[:, 1].max() <= 30
    (warning,) = field.map_warnings
    assert "places of the map are where the ground is not known" in warning
    assert float(warning.rpartition(", ")[2].rstrip(")")) > 30


def test_a_feature_of_several_parts_that_is_not_known_is_listed_once(project_of, tmp_path):
    project = project_of(("clay", WEST), ("Yng", EAST))
    known = json.loads((tmp_path / "map.geojson").read_text())
    parts = [[[*ring, ring[0]]] for ring in (WEST, EAST)]
    known["features"] += json.loads(features(("Xyz", WEST)))["features"]
    known["features"][2]["geometry"] = {"type": "MultiPolygon", "coordinates": parts}
    (tmp_path / "map.geojson").write_text(json.dumps(known))
    kinds = [each.kind for each in field_of(project).left_out]
    assert kinds.count("unknown_block") == 1


def test_maps_that_are_refused(project_of, tmp_path):
    line = [[0, 0], [50, 0], [50, 0]]
    field = field_of(project_of(("clay", WEST), ("Yng", EAST), ("Yng", line)))
    assert any("feature 3: a ring with fewer than three corners" in text for text in field.map_warnings)
    for areas, more, what in (
        ((("clay", line),), "", "no polygon in it has an area"),
        ((("clay", [[900, 0], [950, 0], [950, 50]]),), "", "map: no polygon of it lies in the region"),
    ):
        with pytest.raises(InputRefused, match=what):
            field_of(project_of(*areas, more=more))
    for old, new, what in (
        ('"FORMATION"', '"AGE"', "no attribute 'AGE'.*they have Formation"),
        ("map.geojson", "none.geojson", "file not found: .*none.geojson"),
        ("ground.asc", "none.asc", "file not found: .*none.asc"),
        ('block = "FORMATION"', 'blocks = "F"', "blocks"),
        (', block = "FORMATION"', "", "block"),
        (', block = "FORMATION"', ', block = "F", faults = "f.wkt"', "file not found: .*f.wkt"),
    ):
        project_of(("clay", WEST))
        text = (tmp_path / "project.toml").read_text().replace(old, new)
        (tmp_path / "project.toml").write_text(text)
        with pytest.raises(InputRefused, match=what):
            field_of(load_project(tmp_path / "project.toml"))


def test_a_project_is_written_back_with_what_its_map_says(project_of, tmp_path):
    model = build(project_of(("clay", WEST), ("Yng", EAST)))
    (tmp_path / "again").mkdir()
    written = save_project(model.project, tmp_path / "again" / "project.toml")
    assert "project_r_observations.csv" in {path.name for path in written}
    again = build(load_project(written[0]))
    assert [block.volume for block in again.blocks] == [block.volume for block in model.blocks]
    assert np.array_equal(again.rock_inputs[0].data[0].contacts, model.rock_inputs[0].data[0].contacts)


def valley():
    """Three folded beds below a valley, all surfaces ready meshes of one grid."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 100, 41), np.linspace(0, 60, 25)))
    corner = np.arange(41 * 25).reshape(25, 41)
    a, b, c, d = (
        each.ravel() for each in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    )
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    bed = 30 - 0.2 * (x - 50) + 3 * np.sin(y / 15)
    heights = {"A": bed - 4, "B": bed + 2, "ground": 28 + 6 * ((y - 30) / 30) ** 2 + np.sin(x / 20)}
    surfaces = [Surface(name, np.column_stack([x, y, z]), triangles) for name, z in heights.items()]
    return Project("valley", [Rock("r", surfaces, base_elevation=0.0)]), surfaces[-1]


def test_the_map_of_a_model_makes_a_model_that_honors_it(tmp_path):
    """The map that a model writes, read again: contacts on it lie on the surfaces of the model, and the model
    that they make has the same map."""
    first = build(valley()[0])
    first.save(tmp_path / "map.gpkg")
    with sqlite3.connect(tmp_path / "map.gpkg") as base:
        assert base.execute("SELECT count(*) FROM geology").fetchone()[0] >= 3
    surfaces = [
        Surface("A", block="base block", method="spline"),
        Surface("B", method="spline"),
        valley()[1],
    ]
    rock = Rock("r", surfaces, [[0, 0], [100, 0], [100, 60], [0, 60]], edge_length=4, base_elevation=0.0)
    rock.map = MapFile(tmp_path / "map.gpkg", "block", "geology")
    second = build(Project("again", [rock]))
    seen = second.observed()
    for name, number in (("A", 0), ("B", 1)):
        contacts = second.rock_inputs[0].data[number].contacts
        assert len(contacts) > 20, name
        on = first.surface(number)
        heights = np.array([_height(on, *place[:2]) for place in contacts])
        assert np.abs(heights - contacts[:, 2]).max() < 1e-6, name
    assert max(abs(each.residual) for each in seen.contacts) < 0.2
    assert seen.share > 0.98
    areas = {first.blocks[each.block].name: 0.0 for each in first.geological_map()}
    for model, sign in ((first, 1), (second, -1)):
        for each in model.geological_map():
            areas[model.blocks[each.block].name] += sign * each.area
    assert max(map(abs, areas.values())) < 0.02 * 6000


def _height(surface, x, y):
    vertices, triangles = surface
    corners = vertices[triangles]
    u, v = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    w = np.array([x, y]) - corners[:, 0, :2]
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / area
    t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / area
    row = int(np.minimum(np.minimum(s, t), 1 - s - t).argmax())
    z = corners[row, :, 2]
    return z[0] + s[row] * (z[1] - z[0]) + t[row] * (z[2] - z[0])
