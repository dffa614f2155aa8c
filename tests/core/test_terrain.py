# SPDX-License-Identifier: GPL-3.0-or-later
"""The terrain of a rock mass: a boundary above all surfaces, from a raster, a mesh, points or a surface."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Body,
    Boreholes,
    Fault,
    InputRefused,
    MapFile,
    PointFile,
    Project,
    Rock,
    Surface,
    build,
    load_project,
)
from realmodel.core.ensembles import ensemble
from realmodel.core.project.project_writer import save_project

SIDE = 40.0
SQUARE = np.array([[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]])
TWO = np.array([[0, 1, 2], [0, 2, 3]])
BOX = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7]]
BOX += [[2, 7, 6], [3, 0, 4], [3, 4, 7]]


def level(name, z, **more):
    return Surface(name, method="constant", options={"value": z}, **more)


def rock_of(*surfaces, **more):
    return Rock("hill", list(surfaces), region=SQUARE, edge_length=5, base_elevation=0.0, **more)


def volumes(*surfaces, project=None, **more):
    model = build(Project("hill", [rock_of(*surfaces, **more)], **(project or {})))
    return {block.name: round(block.volume / SIDE**2, 6) for block in model.blocks}


def raster(path, heights, side=10.0, west=0.0):
    """An ESRI ASCII grid of rows from north to south."""
    rows = "\n".join(" ".join(map(str, row)) for row in heights)
    head = f"ncols {len(heights[0])}\nnrows {len(heights)}\nxllcorner {west}\nyllcorner 0\ncellsize {side}\n"
    path.write_text(f"{head}NODATA_value -9999\n{rows}\n")
    return path


def sheet(z):
    return np.column_stack([SQUARE, np.full(4, z)])


@pytest.fixture
def shapes(tmp_path):
    """The same terrain at 6 in all its forms."""
    dem = raster(tmp_path / "dem.asc", [[6] * 4] * 4)
    corners = "\n".join(f"{x} {y} 6" for x, y in SQUARE)
    (tmp_path / "top.off").write_text(f"OFF\n4 2 0\n{corners}\n3 0 1 2\n3 0 2 3\n")
    (tmp_path / "spots.csv").write_text("x,y,z\n" + corners.replace(" ", ",") + "\n")
    return {
        "raster": dem,
        "text": str(dem),
        "mesh": tmp_path / "top.off",
        "table": tmp_path / "spots.csv",
        "options": PointFile(tmp_path / "spots.csv", units={"z": "m"}),
        "array": sheet(6.0),
        "surface": Surface("today", sheet(6.0), TWO),
    }


@pytest.mark.parametrize("form", ["raster", "text", "mesh", "table", "options", "array", "surface"])
def test_what_is_above_the_terrain_is_removed_and_what_is_missing_below_it_is_filled(shapes, form):
    name = "today" if form == "surface" else "terrain"
    above = volumes(level("A", 2.0), level("B", 9.0), terrain=shapes[form])
    assert above == {"base block": 2.0, "B block": 4.0, f"{name} block": 0.0}
    below = volumes(level("A", 2.0), level("B", 5.0), terrain=shapes[form])
    assert below == {"base block": 2.0, "B block": 3.0, f"{name} block": 1.0}


def test_a_youngest_surface_without_data_is_the_terrain_and_has_its_block(shapes):
    ground = Surface("ground", block="Loam")
    for form in ("raster", "mesh", "table"):
        assert volumes(level("A", 2.0), ground, terrain=shapes[form]) == {"base block": 2.0, "Loam": 4.0}
    assert ground.points is None, "what was given stays as it is"


def test_surfaces_that_come_later_lie_below_it(tmp_path):
    raster(tmp_path / "dem.asc", [[6] * 4] * 4)
    project = tmp_path / "project.toml"
    project.write_text(
        'format = 1\nname = "p"\n[[rock]]\nname = "r"\nregion = [[0, 0], [40, 0], [40, 40], [0, 40]]\n'
        'edge_length = 5\nbase_elevation = 0\nterrain = "dem.asc"\n'
        '[[rock.surface]]\nname = "A"\nmethod = "constant"\nvalue = 2\n'
    )
    loaded = load_project(project)
    assert tmp_path / "dem.asc" in loaded.input_files()
    loaded.rocks[0].surfaces.append(level("B", 9.0))
    model = build(loaded)
    assert [block.name for block in model.blocks] == ["base block", "B block", "terrain block"]
    assert model.volume == pytest.approx(6 * SIDE**2)
    assert build(loaded, stage=1).volume == pytest.approx(9 * SIDE**2), "a stage before it has no terrain"
    save_project(model.project, tmp_path / "again.toml")
    again = load_project(tmp_path / "again.toml")
    assert again.rocks[0].terrain == "terrain"
    assert np.array_equal(build(again).vertices, model.vertices)


def test_a_surface_of_the_list_may_be_it():
    ground = Surface("ground", sheet(6.0), TWO, block="Soil")
    assert volumes(ground, level("A", 2.0), level("B", 9.0), terrain="ground")["Soil"] == 0.0


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ('"none.tif"', r"project.toml:8: .*file not found: .*none.tif"),
        ("5", "project.toml:8: .*'terrain' must be text"),
        ('{ file = "dem.asc", unit = "ft" }', "project.toml:8: rock 'r', terrain: unknown key 'unit'"),
        ('{ file = "dem.asc", units = "elle" }', "unknown unit 'elle'"),
    ],
)
def test_what_is_no_terrain_is_refused_with_its_line(tmp_path, written, said):
    raster(tmp_path / "dem.asc", [[6] * 4] * 4)
    (tmp_path / "project.toml").write_text(
        'format = 1\nname = "p"\n[[rock]]\nname = "r"\nregion = [[0, 0], [40, 0], [40, 40], [0, 40]]\n'
        f"edge_length = 5\nbase_elevation = 0\nterrain = {written}\n"
        '[[rock.surface]]\nname = "A"\nmethod = "constant"\nvalue = 2\n'
    )
    with pytest.raises(InputRefused, match=said):
        load_project(tmp_path / "project.toml")


@settings(max_examples=20, deadline=None, derandomize=True)
@given(west=st.sampled_from([0.0, 10.0, 20.0]), columns=st.integers(2, 4), hole=st.booleans())
def test_nothing_is_cut_where_the_raster_does_not_reach(tmp_path_factory, west, columns, hole):
    """A raster that covers the region to its border cuts all of it, and one that does not leaves the rest."""
    heights = [[6] * columns for _ in range(4)]
    if hole:
        heights[2][columns - 1] = -9999
    dem = raster(tmp_path_factory.mktemp("dem") / "dem.asc", heights, west=west)
    east = min(west + 10.0 * columns, SIDE)
    model = build(Project("p", [rock_of(level("A", 9.0), terrain=dem)]))
    rng = np.random.default_rng(0)
    places = rng.uniform(0.5, SIDE - 0.5, (200, 2))
    inside = (places[:, 0] > west + 5) & (places[:, 0] < east - 5)
    outside = (places[:, 0] < west - 5) | (places[:, 0] > east + 5)
    top = model.vertices[:, 2].max()
    assert (top == 9.0) == (hole or west > 0 or east < SIDE)
    if west == 0 and east == SIDE and not hole:
        assert model.volume == pytest.approx(6 * SIDE**2)
    covered = (east - west) / SIDE
    full = SIDE**2 * (9 - 3 * covered)
    assert inside.any() or outside.any()
    assert model.volume == pytest.approx(full, abs=3 * 5 * SIDE + hole * 3 * 30**2)


def test_heights_are_those_of_the_raster(tmp_path):
    """Bilinear: no smoothing by a fitted variogram; a plane is met to the last digits."""
    heights = [[3 + 0.1 * x + 0.05 * y for x in np.arange(-5, 50, 10)] for y in np.arange(45, -10, -10)]
    dem = raster(tmp_path / "dem.asc", heights, west=-10.0)
    dem.write_text(dem.read_text().replace("yllcorner 0", "yllcorner -10"))
    model = build(Project("p", [rock_of(level("A", 1.0), terrain=dem)]))
    assert model.volume == pytest.approx(SIDE**2 * (3 + 2 + 1), rel=1e-9)


def box(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    ends = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    return np.array([[*p, z] for z in (z0, z1) for p in ends], float), np.array(BOX)


def test_faults_and_bodies_end_at_it():
    """They displace, or came after, the youngest surface below it, unless they name it."""
    fault = Fault("F", np.array([[20, -5, -5], [20, 45, -5], [20, 45, 30], [20, -5, 30.0]]), TWO)
    plan = np.array([[5, 5], [15, 30], [10, 20], [25, 5], [35, 30], [30, 20.0], [8, 33], [33, 9]])
    bed = np.column_stack([plan, np.where(plan[:, 0] < 20, 3.0, 1.0)])
    surfaces = [Surface("A", points=bed, method="natural_neighbour"), level("B", 9.0)]
    ore = Body("ore", *box((2, 2, 1), (12, 12, 20)))
    model = build(Project("p", [rock_of(*surfaces, terrain=sheet(6.0))], faults=[fault], bodies=[ore]))
    assert len(model.compartment_names) == 2
    assert model.vertices[:, 2].max() == 6.0
    assert {block.name: block.volume for block in model.blocks}["ore"] == pytest.approx(500.0)
    named = Body("ore", *box((2, 2, 1), (12, 12, 20)), after="terrain")
    model = build(Project("p", [rock_of(*surfaces, terrain=sheet(6.0))], bodies=[named]))
    assert model.vertices[:, 2].max() == 20.0


def test_it_is_not_moved_to_holes_that_begin_above_it(tmp_path):
    (tmp_path / "collars.csv").write_text("hole,x,y,z\nH1,10,10,7\nH2,30,30,7\nH3,10,30,7\n")
    (tmp_path / "intervals.csv").write_text(
        "hole,from,to,block\n" + "".join(f"H{n},0,5,Sand\nH{n},5,6,Clay\n" for n in (1, 2, 3))
    )
    holes = Boreholes(collars=tmp_path / "collars.csv", intervals=tmp_path / "intervals.csv")
    surfaces = [Surface("A", block="Clay", method="plane"), Surface("B", block="Sand")]
    for terrain in (sheet(6.0), Surface("B", sheet(6.0), TWO, block="Sand")):
        own = surfaces[: 2 if isinstance(terrain, np.ndarray) else 1]
        model = build(Project("p", [rock_of(*own, boreholes=holes, terrain=terrain)]))
        assert model.vertices[:, 2].max() == pytest.approx(6.0, abs=1e-12)
        assert {b.name: b.volume for b in model.blocks}["Sand"] == pytest.approx(4 * SIDE**2)


def test_picks_of_the_surface_that_is_taken_for_it_are_named(tmp_path):
    (tmp_path / "collars.csv").write_text("hole,x,y,z\nH1,10,10,6\nH2,30,30,6\n")
    (tmp_path / "picks.csv").write_text("hole,depth,surface\nH1,1,B\nH2,1,B\n")
    holes = Boreholes(collars=tmp_path / "collars.csv", picks=tmp_path / "picks.csv")
    rock = rock_of(level("A", 2.0), Surface("B"), boreholes=holes, terrain=sheet(6.0))
    warnings = [warning.text for warning in build(Project("p", [rock])).warnings]
    assert any("picks of 'B', which is the terrain" in text for text in warnings)


def test_it_is_the_ground_of_a_map(tmp_path):
    raster(tmp_path / "dem.asc", [[2, 4, 6, 8]] * 4)
    features = []
    for unit, west, east in (("old", 0, 20), ("young", 20, 40)):
        ring = [[west, 0], [east, 0], [east, 40], [west, 40], [west, 0]]
        shape = {"type": "Polygon", "coordinates": [ring]}
        features.append({"type": "Feature", "properties": {"unit": unit}, "geometry": shape})
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    bed = Surface("bed", block="old", method="plane", options={"dip": 0.0})
    rock = rock_of(
        bed,
        Surface("top", block="young"),
        map=MapFile(tmp_path / "map.geojson", "unit"),
        terrain=tmp_path / "dem.asc",
    )
    model = build(Project("p", [rock]))
    bed_heights = model.surface("bed")[0][:, 2]
    assert np.ptp(bed_heights) < 1e-9 and bed_heights[0] == pytest.approx(5.0, abs=0.2)


def test_ensembles_do_not_move_it():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(0, SIDE, (30, 2)), rng.normal(3, 0.3, 30)])
    spots = np.column_stack([rng.uniform(0, SIDE, (60, 2)), np.full(60, 6.0)])
    spots[::2, 2] += 1.0
    rock = rock_of(Surface("A", points=points, method="kriging"), terrain=spots)
    whole = build(Project("p", [rock])).volume
    realizations = ensemble(Project("p", [rock]), 3, seed=1)
    assert realizations.volumes.sum(axis=1) == pytest.approx(np.full(3, whole), rel=1e-9)
    assert np.ptp(realizations.volumes[:, 0]) > 1
    assert not np.any(realizations.surface_deviation[1])
