# SPDX-License-Identifier: GPL-3.0-or-later
"""Models in tiles, built one tile after another in this process: the same as undivided ones."""

import contextlib
import gc
import itertools
import math
import shutil
import weakref
from concurrent.futures import Future
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from realmodel.core import (
    InputRefused,
    OutputFailed,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
    open_tiles,
)
from realmodel.core.base.sheet import Sheet
from realmodel.core.base.work import native_module
from realmodel.core.surfaces.local_heights import LocalHeights, local_surfaces
from realmodel.core.tiles import grid as tile_grids
from realmodel.core.tiles.grid import checked_size, clipped_region, part_of, tile_grid, triangles_by_tile
from realmodel.core.tiles.windows import PointWindows
from realmodel.distributed import build as build_tiles
from realmodel.distributed import run_folder, tile_folder
from realmodel.distributed.workers import Workers
from sample_scripts import SAMPLES
from stacks.generate import random_stack
from stacks.judge import volume_allowance
from stacks.model_view import rocks_of
from stacks.project_files import stack_project
from stacks.rock_masses import random_rock_masses


def sample(name):
    return load_project(SAMPLES / name / "project.toml")


@pytest.fixture(autouse=True)
def one_after_another(monkeypatch):
    """Tasks in this process; test_distributed_tiles has them on workers."""
    _in_this_process(monkeypatch)


class NoWorkers(Workers):
    """This process does all tasks."""

    def __init__(self):
        super().__init__(Future())

    def in_any_order(self, *arguments, **options):
        return super().in_any_order(*arguments, **{**options, "here": True})


def _in_this_process(patch):
    patch.setattr(tile_folder, "workers_of", lambda *_: contextlib.nullcontext(NoWorkers()))


def assert_same_warnings(tiled, whole):
    """But for those that only a model built in one piece has."""
    not_in_tiles = {"residual", "extrapolation"}
    assert not not_in_tiles & {warning.kind for warning in tiled.warnings}
    wanted = [str(warning) for warning in whole.warnings if warning.kind not in not_in_tiles]
    assert sorted(map(str, tiled.warnings)) == sorted(wanted)


def assert_same_blocks(tiled, whole, allowed=None):
    assert [block.name for block in tiled.blocks] == [block.name for block in whole.blocks]
    for number, (one, other) in enumerate(zip(tiled.blocks, whole.blocks, strict=True)):
        assert (one.surface, one.rock, one.property) == (other.surface, other.rock, other.property)
        assert one.components == other.components, one
        limit = 1e-12 * other.volume if allowed is None else allowed[number]
        assert abs(one.volume - other.volume) <= limit, (one, other)
        if tiled.cell_kind == "blocks":
            assert one.cells == other.cells
    assert tiled.unequal == 0


def hilly(n, shift, seed, size=100.0):
    """A surface on a lattice of its own."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, size, n + 1), np.linspace(0, size, n + 1))
    z = shift + 4 * np.sin(x / 17 + seed) + 3 * np.cos(y / 11) + rng.normal(0, 0.5, x.shape)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), triangles.astype(np.int32)


def ready(region=None, holes=()):
    """Five ready surfaces with triangulations of their own, some eroded."""
    surfaces = [
        Surface(f"S{k}", *hilly(n, shift, k), rule=rule)
        for k, (n, shift, rule) in enumerate(
            [
                (9, 0, "erosional"),
                (14, 6, "base"),
                (11, 12, "erosional"),
                (17, 11, "conformable"),
                (8, 14, "erosional"),
            ]
        )
    ]
    return Project("ready", [Rock("rock", surfaces, region=region, holes=holes, base_elevation=-20.0)])


OUTLINE = [[7.5, -3.0], [97.0, 11.0], [88.0, 60.0], [104.0, 103.0], [31.0, 90.0], [-4.0, 40.0]]
HOLE = [[40.0, 35.0], [63.0, 41.0], [52.0, 58.0]]


@pytest.mark.parametrize(
    ("name", "size", "cells"),
    [
        ("two_layers", (37, 23), "columns"),
        ("two_layers", (37, 23), "blocks"),
        ("two_layers", (1000, 1000), "columns"),
        ("gravel_plain", (600, 350), "columns"),
        ("gravel_plain", (600, 350), "blocks"),
        ("haut_barr", (50, 40), "blocks"),
    ],
)
def test_samples(name, size, cells, tmp_path):
    project = sample(name)
    tiled = build_tiles(project, tmp_path / "t", size, cells=cells)
    whole = build(project, cells=cells)
    assert_same_blocks(tiled, whole)
    if size[0] == 1000:
        assert len(tiled.tiles) == 1
        assert tiled.blocks == whole.blocks


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize(("region", "holes"), [(None, ()), (OUTLINE, ()), (OUTLINE, [HOLE])])
def test_ready_surfaces(region, holes, cells, tmp_path):
    """Surfaces that the region and the borders of tiles both clip."""
    project = ready(region, holes)
    tiled = build_tiles(project, tmp_path / "t", (29, 41), cells=cells)
    assert len(tiled.tiles) == 12
    assert_same_blocks(tiled, build(project, cells=cells))


def test_a_model_opened_again(tmp_path):
    project = ready(OUTLINE, [HOLE])
    whole = build(project)
    build_tiles(project, tmp_path / "t", (40, 40))
    tiled = open_tiles(tmp_path / "t")
    assert_same_blocks(tiled, whole)
    assert tiled.name == "ready"
    assert tiled.surface_names == whole.surface_names
    assert math.isclose(tiled.volume, whole.volume, rel_tol=1e-12)
    assert sum(tile.cells for tile in tiled.tiles) == sum(block.cells for block in tiled.blocks)
    assert np.allclose(sum(tile.volumes for tile in tiled.tiles), [block.volume for block in whole.blocks])
    tile = tiled.tiles[4]
    model = tile.model()
    assert model.validate(500).passed
    low_x, low_y, high_x, high_y = tile.box
    assert (model.vertices[:, :2] >= [low_x, low_y]).all() and (
        model.vertices[:, :2] <= [high_x, high_y]
    ).all()
    for point, normal in [
        ((50, 50, 5), (1, 0.3, 0.1)),
        ((50, 50, 5), (0, 0, 1)),
        ((tiled.x[1], 0, 0), (1, 0, 0)),
    ]:
        one, other = tiled.section(point, normal), whole.section(point, normal)
        assert np.allclose(one.area_by_block(), other.area_by_block(), rtol=1e-11, atol=1e-9)
        assert one.block_names == other.block_names and one.unit == other.unit
        assert one.cells.max() < sum(tile.cells for tile in tiled.tiles)
    line = [(2, 5), (95, 44), (60, 98)]
    one, other = tiled.fence(line), whole.fence(line)
    assert np.allclose(one.area_by_block(), other.area_by_block(), rtol=1e-11)
    assert set(one.panel) == {0, 1}
    assert len(tiled.section((500, 0, 0), (1, 0, 0))) == 0


def test_boreholes(tmp_path):
    project = ready(OUTLINE, [HOLE])
    whole = build(project)
    tiled = build_tiles(project, tmp_path / "t", (40, 40))
    in_rock = 0
    for x, y in np.random.default_rng(5).uniform(-5, 105, (60, 2)):
        one, other = tiled.borehole(x, y), whole.borehole(x, y)
        assert [each.block for each in one] == [each.block for each in other]
        for a, b in zip(one, other, strict=True):
            assert math.isclose(a.top, b.top, abs_tol=1e-9) and math.isclose(a.bottom, b.bottom, abs_tol=1e-9)
        if one:
            in_rock += 1
            assert one[-1].bottom == -20.0
            assert all(a.bottom == b.top for a, b in itertools.pairwise(one))
            at = np.array([[x, y, (each.top + each.bottom) / 2] for each in one])
            assert whole_blocks(whole, at) == [each.block for each in one]
    assert in_rock > 20
    assert whole.borehole(51, 45) == []  # in the hole


def whole_blocks(model, places):
    from realmodel.core.ensembles import blocks_at

    return blocks_at(model, places).tolist()


usual = settings(
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=12,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
FAMILIES = ("own lattices", "partial", "jumps", "regions", "rules", "general", "T-junctions", "rock masses")


@usual
@given(
    st.sampled_from(FAMILIES),
    st.sampled_from(["columns", "blocks"]),
    st.floats(0.3, 1.2),
    st.randoms(use_true_random=True),
)
def test_random_stacks(tmp_path_factory, family, cells, share, rng):
    """Holes, islands, steps, borders of any shape, protected surfaces."""
    case = random_rock_masses(rng) if family == "rock masses" else random_stack(rng, family)
    path = stack_project(tmp_path_factory.mktemp("stack"), rocks_of(case))
    assume(path is not None)
    project = load_project(path)
    whole = build(project, cells=cells)
    extent = np.ptp(whole.surface_vertices[:, :2], axis=0)
    with pytest.MonkeyPatch.context() as patch:
        _in_this_process(patch)
        tiled = build_tiles(project, tmp_path_factory.mktemp("tiles"), extent * share, cells=cells)
    surfaces = [block.surface for block in whole.blocks]
    volumes = np.zeros(len(whole.surface_names))
    volumes[surfaces] = [block.volume for block in whole.blocks]
    assert_same_blocks(tiled, whole, np.asarray(volume_allowance(case, volumes))[surfaces])


def test_warnings_about_triangles_have_their_numbers(tmp_path):
    project = ready()
    surface = project.rocks[0].surfaces[2]
    flat = np.vstack([surface.triangles[-1], surface.triangles[-1]])
    flat[:, 1] = flat[:, 0]
    surface.triangles = np.vstack([surface.triangles, flat])
    tiled = build_tiles(project, tmp_path / "t", (30, 30))
    whole = build(project)
    assert [str(w) for w in tiled.warnings] == [str(w) for w in whole.warnings]
    assert tiled.warnings[0].items == whole.warnings[0].items
    assert open_tiles(tmp_path / "t").warnings == tiled.warnings


def test_a_surface_with_two_heights_is_refused(tmp_path):
    project = ready()
    surface = project.rocks[0].surfaces[3]
    surface.triangles = np.vstack([surface.triangles, surface.triangles[77]])
    with pytest.raises(InputRefused, match=r"S3.*triangles 77 and 578 overlap"):
        build_tiles(project, tmp_path / "t", (30, 30))
    assert not (tmp_path / "t" / "tiles.toml").exists()


def test_the_base_must_be_below(tmp_path):
    project = ready()
    project.rocks[0].base_elevation = 5.0
    with pytest.raises(InputRefused, match="base_elevation 5 is not below"):
        build_tiles(project, tmp_path / "t", (30, 30))


def scattered(count, seed, shift=0.0):
    """Points in clusters, with a large void, and beyond the region."""
    rng = np.random.default_rng(seed)
    plan = np.concatenate([rng.normal(c, s, (count // 3, 2)) for c, s in ((20, 6), (75, 18), (60, 45))])
    z = shift + 3 * np.sin(plan[:, 0] / 15) + 0.03 * plan[:, 1] + rng.normal(0, 0.3, len(plan))
    return np.column_stack([plan, z])


GIVEN = {"model": "spherical", "range": 30.0, "sill": 4.0, "nugget": 0.1}


def from_points(count=900):
    """Surfaces of which tiles interpolate those that they can."""
    surfaces = [
        Surface("kriged", points=scattered(count, 1), options={"neighbours": 12}),
        Surface("drift", points=scattered(count, 2, 4), method="universal_kriging", rule="base"),
        Surface("weighted", points=scattered(count, 3, 7), method="idw", rule="conformable"),
        Surface("lattice", points=np.round(scattered(count, 4, 9)), options={"variogram": GIVEN}),
        Surface(
            "splines",
            points=scattered(count, 7, 10.5),
            method="spline",
            options={"neighbours": 10, "smoothing": 0.1},
        ),
        Surface("triangles", points=scattered(count, 5, 12), method="tin"),
        Surface("above", points=scattered(count, 6, 12), minimum_thickness=0.5),
    ]
    lattice = surfaces[3]  # many points at one distance from a node, each place once
    lattice.points = lattice.points[np.unique(lattice.points[:, :2], axis=0, return_index=True)[1]]
    tied = surfaces[0].points[:5].copy()  # mis-ties, of which the mean counts
    tied[:, 2] += 0.05
    surfaces[0].points = np.concatenate([surfaces[0].points, tied])
    return Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=3.0, base_elevation=-30.0)])


@pytest.mark.parametrize("count", [9, 900])
def test_tiles_interpolate_from_the_points_around(monkeypatch, count, tmp_path):
    """The heights of the undivided model to the last bit, from a part of the points."""
    project, seen, real = from_points(count), [], LocalHeights.heights

    def heights(self, work, points, nodes, *others):
        seen.append((len(nodes), len(points)))
        return real(self, work, points, nodes, *others)

    monkeypatch.setattr(LocalHeights, "heights", heights)
    tiled = build_tiles(project, tmp_path / "t", (20, 25))
    whole = build(project)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    assert count == 9 or any(warning.kind == "wrong_side" for warning in tiled.warnings)
    of_tiles = [points for nodes, points in seen if nodes]
    assert len(of_tiles) == 6 * (len(tiled.tiles) + 1)  # and around the points, for ties
    assert count == 9 or np.mean(of_tiles) < 0.7 * count
    assert_same_heights(tiled, whole)


def assert_same_heights(tiled, whole):
    """To the last bit."""
    surfaces = (whole.surface(k)[0].tolist() for k in range(len(whole.surface_names)))
    known = [{(x, y): z for x, y, z in vertices} for vertices in surfaces]
    for tile in tiled.tiles:
        model = tile.model()
        for k, heights in enumerate(known):
            assert all(heights[x, y] == z for x, y, z in model.surface(k)[0].tolist())


def of_all_kinds():
    """Surfaces whose heights follow from all points, from a few numbers, or from other surfaces."""
    far = scattered(60, 20, 30)
    patch = on_a_grid((12, 9), (4, 5), (15, 12), 0.3, 60, 2, left_out=0.05)
    far[:, :2] = 30 + 0.4 * far[:, :2]  # there are nodes outside their hull, and far from them
    surfaces = [
        Surface("deep", method="constant", options={"value": -8.0}),
        Surface(
            "mean", points=np.concatenate([scattered(60, 1, -6), scattered(6, 1, -6)]), method="constant"
        ),
        Surface("fitted", points=scattered(300, 2, -3), method="plane", minimum_thickness=0.5),
        Surface(
            "dipping", points=scattered(9, 3, 0), method="plane", options={"dip": 2.0, "dip_direction": 70.0}
        ),
        Surface("on top", method="parallel", options={"to": "smooth", "thickness": 0.25}),
        Surface("smooth", points=scattered(60, 4, 3), method="dsi"),
        Surface("given", method="parallel", options={"to": 9.5, "thickness": -1.0}, minimum_thickness=2.0),
        Surface("all", points=scattered(90, 5, 8), method="kriging", options={"neighbours": 0}),
        Surface("drift", points=scattered(60, 6, 11), method="universal_kriging", options={"neighbours": 0}),
        Surface("bent", points=scattered(60, 7, 14), method="spline", options={"neighbours": 0}),
        Surface("weighted", points=scattered(60, 8, 17), method="idw", options={"neighbours": 0}),
        Surface(
            "near", points=np.add(far, [0, 0, -9]), method="idw", options={"neighbours": 0, "radius": 12.5}
        ),
        Surface("nearer", points=np.add(far, [0, 0, -6]), options={"neighbours": 9, "radius": 9.0}),
        Surface("eighths", points=scattered(2400, 9, 26), options={"octants": 1, "neighbours": 5}),
        Surface("sectors", points=scattered(900, 10, 29), method="idw", options={"octants": 2}),
        Surface(
            "ends", points=np.add(far, [0, 0, 2]), options={"extrapolate": "nearest", "variogram": GIVEN}
        ),
        Surface("stops", points=np.add(far, [0, 0, 4]), method="spline", options={"extrapolate": "nearest"}),
        Surface(
            "raster",
            points=on_a_grid((12, 9), (4, 5), (15, 12), 0.3, 36, 2, left_out=0.2),
            method="grid",
            options={"extrapolate": "nearest"},
        ),
        Surface(
            "again", method="parallel", options={"to": "raster", "thickness": 2.0}, minimum_thickness=1.0
        ),
        Surface("short", points=np.add(far, [0, 0, 14]), options={"extrapolate": "none", "variogram": GIVEN}),
        Surface("cut", points=scattered(60, 4, 45), method="tin", options={"extrapolate": "none"}),
        Surface("flat", points=np.add(far, [0, 0, 22]), method="plane", options={"extrapolate": "none"}),
        Surface("patch", points=patch, method="grid", options={"extrapolate": "none"}),
    ]
    surfaces[3].minimum_thickness = 1.0
    return Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=4.0, base_elevation=-30.0)])


def test_heights_that_take_more_than_the_points_around(monkeypatch, tmp_path):
    """By the tiles, with the heights of the undivided model to the last bit."""
    project, made, real = of_all_kinds(), set(), LocalHeights.heights

    def heights(self, work, points, nodes, *others):
        made.add((self.method, len(points)) if len(nodes) else None)
        return real(self, work, points, nodes, *others)

    monkeypatch.setattr(LocalHeights, "heights", heights)
    tiled, whole = build_tiles(project, tmp_path / "t", (40, 25)), build(project)
    assert_same_heights(tiled, whole)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    kinds = {warning.kind for warning in tiled.warnings}
    assert {"minimum_thickness", "wrong_side", "points"} <= kinds
    assert any("within the radius" in str(warning) for warning in tiled.warnings)
    assert {method for method, _ in made - {None}} == {
        *("constant", "plane", "parallel", "kriging", "universal_kriging", "spline", "idw", "grid")
    }
    assert {count for method, count in made - {None} if method in ("constant", "plane")} == {0}


def test_a_surface_that_ends_before_the_region_begins(tmp_path):
    """Is refused as in the undivided model, once no tile has any of it."""
    points = scattered(60, 1) * [0.01, 0.01, 1] - [40, 40, 0]
    surfaces = [Surface("away", points=points, options={"extrapolate": "none", "variogram": GIVEN})]
    project = Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=9.0, base_elevation=-30.0)])
    with pytest.raises(InputRefused) as expected:
        build(project)
    assert "no triangle of the region's mesh" in str(expected.value)
    with pytest.raises(InputRefused) as found:
        build_tiles(project, tmp_path / "t", (40, 25))
    assert str(found.value) == str(expected.value)


def test_triangles_of_points_by_windows(monkeypatch, tmp_path):
    """Those that are certain: of scattered points, on a lattice, where all circles are through four points,
    with few points and far apart, in one line, and where there are nodes outside the hull."""
    lattice = on_a_grid((34, 30), (4, 4), (-15, -12), 0, 8, 2)
    aside = on_a_grid((40, 30), (1.5, 1.5), (25, 20), 0.3, 14, 3)
    line = np.column_stack([np.linspace(0, 100, 30), np.linspace(10, 70, 30), np.linspace(30, 33, 30)])
    nearest = {"extrapolate": "nearest"}
    surfaces = [
        Surface("natural", points=scattered(3000, 1), method="natural_neighbour"),
        Surface("linear", points=scattered(3000, 2, 4), method="tin"),
        Surface("lattice", points=lattice, method="natural_neighbour"),
        Surface("cells", points=np.add(lattice, [0, 0, 3]), method="tin", minimum_thickness=0.5),
        Surface("aside", points=aside, method="natural_neighbour"),
        Surface("near", points=np.add(aside, [0, 0, 4]), method="natural_neighbour", options=nearest),
        Surface("nearer", points=np.add(aside, [0, 0, 7]), method="tin", options=nearest),
        Surface("few", points=scattered(12, 3, 25), method="natural_neighbour"),
        Surface("in line", points=line, method="natural_neighbour"),
    ]
    project = Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=3.0, base_elevation=-30.0)])
    seen, real = [], LocalHeights.certain_heights

    def certain_heights(self, work, points, nodes, window):
        if window is not self.border[1]:  # of all points, for ties
            seen.append((len(nodes), len(points)))
        return real(self, work, points, nodes, window)

    monkeypatch.setattr(LocalHeights, "certain_heights", certain_heights)
    tiled, whole = build_tiles(project, tmp_path / "t", (20, 25)), build(project)
    assert_same_heights(tiled, whole)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    nodes, points = np.array(seen).T
    assert nodes @ points / nodes.sum() < 900  # of 3000, 1020 and 1200


def test_surfaces_that_tiles_leave_to_the_lead():
    """Those of one system, those that need one that ends, and those that such ones need."""
    points = scattered(60, 1)
    surfaces = [
        Surface("ends", points=points, options={"extrapolate": "none"}),
        Surface("on it", method="parallel", options={"to": "ends", "thickness": 1.0}),
        Surface("bound", points=points),
        Surface("smooth", points=points, method="dsi", options={"above": "bound"}),
        Surface("free", points=points, minimum_thickness=1.0),
        Surface("under", method="parallel", options={"to": "on it", "thickness": 1.0}),
        Surface("shown", points=points, method="parallel", options={"to": "free"}),
        Surface("last", points=points, minimum_thickness=1.0),
    ]
    rock = Rock("r", surfaces, region=OUTLINE, edge_length=4.0)
    assert local_surfaces(rock) == set()
    surfaces[6] = Surface("apart", points=points)
    assert local_surfaces(rock) == {4, 6, 7}


def on_a_grid(shape, steps, corner, turn, shift, seed, left_out=0.0):
    """Points on a grid, turned by an angle, in any order."""
    rng = np.random.default_rng(seed)
    across, up = np.mgrid[0 : shape[0], 0 : shape[1]].reshape(2, -1) * np.array(steps)[:, None]
    x, y = across * np.cos(turn) - up * np.sin(turn), across * np.sin(turn) + up * np.cos(turn)
    z = shift + 2 * np.sin(x / 15) + rng.normal(0, 0.2, len(x))
    points = np.column_stack([corner[0] + x, corner[1] + y, z])
    return points[rng.permutation(len(x))[: int(len(x) * (1 - left_out))]]


def test_grids_are_interpolated_by_windows(monkeypatch, tmp_path):
    """With nodes missing, nodes beside the grid, and points given twice."""
    holes = on_a_grid((45, 60), (2.3, 1.7), (20, -10), 0.4, 0, 1, left_out=0.3)
    holes = holes[(np.abs(holes[:, :2] - [60, 50]) > 12).any(axis=1)]
    tied = on_a_grid((30, 30), (4, 4), (-10, -10), 0, 12, 3)
    tied = np.concatenate([tied, np.add(tied[:7], [0, 0, 0.05]), tied[9:11]])
    surfaces = [
        Surface("holes", points=holes, method="grid"),
        Surface("coarse", points=on_a_grid((6, 5), (23, 29), (-5, -5), 0, 6, 2), method="grid"),
        Surface("tied", points=tied, method="grid"),
        Surface("aside", points=on_a_grid((20, 90), (1.1, 0.3), (60, 20), -0.2, 18, 4), method="grid"),
    ]
    project = Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=3.0, base_elevation=-30.0)])
    seen, real = [], LocalHeights.heights

    def heights(self, work, points, nodes, *others):
        seen.append((len(nodes), len(points)))
        return real(self, work, points, nodes, *others)

    monkeypatch.setattr(LocalHeights, "heights", heights)
    tiled, whole = build_tiles(project, tmp_path / "t", (20, 25)), build(project)
    assert_same_blocks(tiled, whole)
    assert_same_heights(tiled, whole)
    assert_same_warnings(tiled, whole)
    of_tiles = [points for nodes, points in seen if nodes]
    assert len(of_tiles) == 4 * len(tiled.tiles)
    for number in (0, 2):  # those that cover most of the region
        assert np.mean(of_tiles[number::4]) < 0.4 * len(surfaces[number].points)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda points: points + np.eye(len(points), 3) * 0.5, "not a regular grid"),
        (
            lambda points: np.concatenate([points, np.add(points[3:4], [0, 0, 9])]),
            "two points with different",
        ),
        (lambda points: points[:3], "at least four points"),
        (lambda points: points[points[:, 0] == 0], "in one row"),
    ],
)
def test_points_that_are_no_grid_are_refused_the_same(change, said, tmp_path):
    points = change(on_a_grid((20, 20), (5, 5), (0, 0), 0, 0, 1))
    surface = Surface("S", points=points, method="grid")
    project = Project("p", [Rock("r", [surface], region=OUTLINE, edge_length=9.0, base_elevation=-30.0)])
    with pytest.raises(InputRefused, match=said) as refused:
        build_tiles(project, tmp_path / "t", (40, 40))
    with pytest.raises(InputRefused) as here:
        build(project)
    assert str(refused.value) == str(here.value)


def test_the_automatic_method_is_chosen_once(monkeypatch, tmp_path):
    """By all points; tiles interpolate by what was chosen, where they can."""
    smooth = scattered(300, 1, 5)
    smooth[:, 2] = 5 + 2 * np.sin(smooth[:, 0] / 30) * np.cos(smooth[:, 1] / 40)
    flat = np.array([[10.0, 10.0, 30.0], [80.0, 70.0, 31.0]])
    surfaces = [
        Surface("rough", points=scattered(300, 2), method="auto"),
        Surface("smooth", points=smooth, method="auto"),
        Surface("ends", points=scattered(300, 3, 14), method="auto", options={"extrapolate": "nearest"}),
        Surface("two", points=flat, method="auto"),
    ]
    project = Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=4.0, base_elevation=-30.0)])
    whole = build(project)
    chosen = [each.method for each in whole.interpolations]
    assert {"kriging", "universal_kriging"}.intersection(chosen[:1]) and chosen[3] == "plane"
    assert chosen[1] in ("spline", "kriging", "universal_kriging")
    found = []
    real = tile_folder.prepared

    def prepared(*arguments):
        made = real(*arguments)
        found.extend((k, local.method) for (_, k), local in made.frame.local.items())
        return made

    monkeypatch.setattr(tile_folder, "prepared", prepared)
    tiled = build_tiles(project, tmp_path / "t", (30, 25))
    assert found == list(enumerate(chosen))
    assert_same_blocks(tiled, whole)
    assert_same_heights(tiled, whole)
    assert_same_warnings(tiled, whole)
    assert [surface.method for surface in project.rocks[0].surfaces] == ["auto"] * 4


def test_tiles_do_not_interpolate_where_borders_are_joined(tmp_path):
    """Then the mesh changes, and heights are made for the whole."""
    project = from_points()
    edge = np.array([[np.nextafter(100.0, 200.0), 40.0], [140.0, 50.0], [100.0, 60.0]])
    other = Surface("other", np.column_stack([edge, [1, 2, 3.0]]), np.array([[0, 1, 2]]))
    square = [[60.0, 40.0], [100.0, 40.0], [100.0, 60.0], [60.0, 60.0]]
    project.rocks[0].region = square
    project.rocks.append(Rock("beside", [other], base_elevation=-30.0))
    tiled = build_tiles(project, tmp_path / "t", (20, 25))
    whole = build(project)
    assert any(warning.kind == "joined" for warning in whole.warnings)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)


def test_borders_of_one_mesh_are_not_compared(monkeypatch, tmp_path):
    """Nodes of a region's mesh may lie as near each other as they do: nothing is joined in the undivided
    model, either."""
    monkeypatch.setattr(native_module(), "find_joins", None)
    project = from_points()
    near = np.nextafter(40.0, 50.0)
    project.rocks[0].constraints = [
        np.array([[20.0, 40.0], [50.0, near]]),
        np.array([[60.0, 40.0], [80.0, 40.0]]),
    ]
    tiled, whole = build_tiles(project, tmp_path / "t", (40, 45)), build(project)
    assert_same_blocks(tiled, whole)
    assert_same_heights(tiled, whole)


def test_windows_hold_the_nearest_points():
    rng = np.random.default_rng(7)
    for points in (
        scattered(600, 1)[:, :2],
        rng.uniform(0, 1, (500, 2)) * [300, 0],
        np.mgrid[0:20, 0:30].T.reshape(-1, 2) * 4.0,
    ):
        boxes = [(0.0, 0.0, 30.0, 20.0), (60.0, 10.0, 61.0, 90.0), (-300.0, 500.0, -280.0, 510.0)]
        found = PointWindows(points, boxes, 16)
        windows = {box: [] for box in range(3)}
        for begin in range(0, len(points), 100):
            for box, which in found.of(points[begin : begin + 100], begin == 0):
                windows[box].append(which + begin)
        for box, window in zip(boxes, map(np.concatenate, windows.values()), strict=True):
            assert window[0] == 0 and (np.diff(window) > 0).all()
            for place in rng.uniform(box[:2], box[2:], (50, 2)):
                squared = np.square(points - place).sum(axis=1)
                near = squared <= np.sort(squared)[16]
                assert np.isin(np.flatnonzero(near), window).all()


def test_a_stopped_run_goes_on(monkeypatch, tmp_path):
    project, calls, built = ready(OUTLINE), [], []
    real, build_one = tile_folder._join, tile_folder._build

    def stops(shared, name):
        calls.append(name)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(shared, name)

    monkeypatch.setattr(tile_folder, "_join", stops)
    with pytest.raises(KeyboardInterrupt):
        build_tiles(project, tmp_path / "t", (40, 40))
    with pytest.raises(InputRefused, match="not finished"):
        open_tiles(tmp_path / "t")
    assert {path.name for path in (tmp_path / "t" / "run").glob("joined-*")} == {
        f"joined-{tile}.json" for tile in ("0000-0000", "0001-0000")
    }
    run = tmp_path / "t" / "run"
    left = {path.stem for path in run.glob("built-*.arrays")}
    assert left == {"built-0002-0000", "built-0000-0001", "built-0001-0001", "built-0002-0001"}
    assert len(list(run.glob("built-*.json"))) == 6  # a tile is joined as soon as those around it are built
    monkeypatch.setattr(
        tile_folder, "_build", lambda shared, name: built.append(name) or build_one(shared, name)
    )
    tiled = build_tiles(project, tmp_path / "t", (40, 40))
    assert len(calls) == 3 + len(tiled.tiles) - 2
    assert built == [(0, 2), (1, 2), (2, 2)]
    assert_same_blocks(tiled, build(project))
    assert not (tmp_path / "t" / "run").exists()
    monkeypatch.setattr(tile_folder, "_join", None)
    again = build_tiles(project, tmp_path / "t", (40, 40))
    assert again.blocks == tiled.blocks


def test_tasks_are_done_twice(monkeypatch, tmp_path):
    """As Dask does those of a worker that is lost before their results are fetched."""
    real = tile_folder._step

    def twice(shared, task):
        real(shared, task)
        real(shared, task)

    monkeypatch.setattr(tile_folder, "_step", twice)
    project = sample("two_layers")
    assert_same_blocks(build_tiles(project, tmp_path / "t", (40, 40)), build(project))


def test_surfaces_are_let_go_of_once_they_are_divided(monkeypatch, tmp_path):
    """The lead has none of them while workers are at work."""
    real, arrays, left = tile_folder.prepared, [], []

    def prepared(*arguments):
        made = real(*arguments)
        arrays.extend(weakref.ref(each) for shapes, *_ in made.rocks for shape in shapes for each in shape)
        return made

    def build_one(shared, name):
        gc.collect()
        left.append(sum(each() is not None for each in arrays))
        return real_build(shared, name)

    real_build = tile_folder._build
    monkeypatch.setattr(tile_folder, "prepared", prepared)
    monkeypatch.setattr(tile_folder, "_build", build_one)
    build_tiles(sample("two_layers"), tmp_path / "t", (37, 23))
    assert arrays and left and not any(left)


def test_surfaces_are_kept_in_files(monkeypatch, tmp_path):
    """Read, interpolated or given: one is in memory at a time, and the files are gone at the end."""
    ready_one = sample("two_layers")
    vertices, triangles = build(ready_one).surface(0)
    ready_one.rocks[0].surfaces[0] = Surface("given", vertices, triangles)
    found = []

    def look(prepared, *rest):
        meshes = [mesh for shapes, region, *_ in prepared.rocks for mesh in (*shapes, region) if mesh]
        found.extend(isinstance(each, np.memmap) for mesh in meshes for each in mesh)
        assert len(list((tmp_path / "t" / "run").glob("inputs-*"))) == 1
        return real(prepared, *rest)

    real = tile_folder.divided
    monkeypatch.setattr(tile_folder, "divided", look)
    for project in (sample("haut_barr"), ready_one):
        build_tiles(project, tmp_path / "t", (1e6, 1e6))
        assert found and all(found)
        assert not list((tmp_path / "t").rglob("inputs-*"))
        shutil.rmtree(tmp_path / "t")


def test_nothing_is_left_of_a_model_that_is_refused(tmp_path):
    project = sample("two_layers")
    project.rocks[0].surfaces[1].points = tmp_path / "missing.csv"
    for folder in (tmp_path / "new", tmp_path / "there"):
        (tmp_path / "there").mkdir(exist_ok=True)
        with pytest.raises(InputRefused, match=r"missing\.csv"):
            build_tiles(project, folder, (37, 23))
    assert not (tmp_path / "new").exists()
    assert not list((tmp_path / "there").iterdir())


def test_tiles_compare_positions_by_their_area(tmp_path):
    grid = tile_grid([hilly(10, 0.0, 1)[0]], (25, 50))
    frame = SimpleNamespace(grid=grid)
    counts = [run_folder.places_of(frame, grid.box(*name)) for name in grid]
    assert 4000 <= sum(counts) <= 4000 + len(counts)
    assert max(counts) < 1.4 * min(counts)
    grid = tile_grid([hilly(10, 0.0, 1)[0]], (2, 2))
    assert run_folder.places_of(SimpleNamespace(grid=grid), grid.box(1, 1)) == 100  # at least


def test_the_same_bytes_again(tmp_path):
    project = ready(OUTLINE)
    for folder in ("a", "b"):
        build_tiles(project, tmp_path / folder, (60, 60))
    names = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert len(names) == 2 * 4 + 2
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_the_folder_of_another_model_is_refused(monkeypatch, tmp_path):
    build_tiles(ready(), tmp_path / "t", (60, 60))
    with pytest.raises(UsageError, match="another project, tile size or kind of cells"):
        build_tiles(ready(), tmp_path / "t", (60, 60), cells="blocks")

    def full(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(tile_folder, "_build", full)
    with pytest.raises(KeyboardInterrupt):
        build_tiles(ready(), tmp_path / "u", (60, 60))
    with pytest.raises(UsageError, match="another project"):
        build_tiles(ready(), tmp_path / "u", (50, 60))
    (tmp_path / "v").mkdir()
    (tmp_path / "v" / "notes.txt").write_text("mine")
    with pytest.raises(UsageError, match="other content"):
        build_tiles(ready(), tmp_path / "v", (50, 60))


def test_a_full_disk_stops_it_in_one_line(monkeypatch, tmp_path):
    project = ready()
    real = run_folder.write_vtu

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(run_folder, "write_vtu", full)
    with pytest.raises(OutputFailed, match="No space left on device; make room") as failed:
        build_tiles(project, tmp_path / "t", (60, 60))
    assert "\n" not in str(failed.value)
    assert not list((tmp_path / "t" / "tiles").iterdir())[1:]  # one .npz, its .vtu is missing
    monkeypatch.setattr(run_folder, "write_vtu", real)
    assert_same_blocks(build_tiles(project, tmp_path / "t", (60, 60)), build(project))


def test_a_tile_that_was_changed_is_refused(tmp_path):
    tiled = build_tiles(ready(), tmp_path / "t", (60, 60))
    file = tiled.tiles[1].file
    file.write_bytes(file.read_bytes()[:-7] + b"changed")
    with pytest.raises(InputRefused, match="has changed"):
        tiled.tiles[1].model()
    file.unlink()
    with pytest.raises(InputRefused, match="cannot be read"):
        tiled.tiles[1].model()
    catalog = tmp_path / "t" / "tiles.toml"
    catalog.write_text(catalog.read_text().replace("digest", "digits"))
    with pytest.raises(InputRefused, match="damaged"):
        open_tiles(tmp_path / "t")


def test_the_index_opens_in_vtk(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    project = ready(OUTLINE, [HOLE])
    tiled = build_tiles(project, tmp_path / "t", (40, 40))
    grid = pyvista.read(tmp_path / "t" / "model.pvtu")
    assert grid.n_cells == sum(tile.cells for tile in tiled.tiles)
    cells = np.bincount(grid["block"], minlength=len(tiled.blocks))
    assert cells.tolist() == [block.cells for block in tiled.blocks]
    vertices = build(project).vertices
    low, high = np.array(grid.bounds).reshape(3, 2).T
    assert np.array_equal(low, vertices.min(axis=0)) and np.array_equal(high, vertices.max(axis=0))


@pytest.mark.parametrize("size", [(0, 5), (5,), (5, -1), (math.inf, 5), "wide", (1e-9, 5)])
def test_sizes_that_are_none(size, tmp_path):
    with pytest.raises(UsageError):
        build_tiles(ready(), tmp_path / "t", size)


def test_lines_keep_off_vertices():
    mesh = np.stack(np.meshgrid(np.arange(0.0, 101), np.arange(0.0, 51)), axis=-1).reshape(-1, 2)
    grid = tile_grid([mesh], checked_size((10, 25)))
    assert grid.columns == 10 and grid.rows == 2
    assert np.abs(grid.x[1:-1] - np.arange(10, 100, 10)).max() <= 10 / 16
    for axis, lines in enumerate((grid.x, grid.y)):
        assert np.abs(mesh[:, axis][:, None] - lines).min() > 0.1


@pytest.mark.parametrize("at_once", [7, 1000])
def test_each_triangle_is_in_the_tiles_that_it_meets(monkeypatch, at_once):
    monkeypatch.setattr(tile_grids, "_TRIANGLES_AT_ONCE", at_once)
    mesh = Sheet(*hilly(10, 0.0, 1))
    grid = tile_grid([mesh.vertices], (35, 30))
    listed = {}
    for name, numbers in triangles_by_tile(mesh, grid):
        listed.setdefault(name, []).extend(numbers.tolist())
    corners = mesh.corners[:, :, :2]
    for column, row in grid:
        low_x, low_y, high_x, high_y = grid.box(column, row)
        part = part_of(mesh, np.array(listed[column, row]))
        away = (
            (corners[:, :, 0].max(1) < low_x)
            | (corners[:, :, 0].min(1) > high_x)
            | (corners[:, :, 1].max(1) < low_y)
            | (corners[:, :, 1].min(1) > high_y)
        )
        assert np.array_equal(part.numbers, np.flatnonzero(~away))
        assert np.array_equal(part.vertices[part.triangles], mesh.corners[part.numbers])


def test_a_clipped_region_has_its_area():
    vertices, triangles = hilly(7, 0.0, 1)
    box = (11.3, -20.0, 64.9, 33.3)
    vertices, triangles = clipped_region(Sheet(vertices[:, :2], triangles), box)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (doubled > 0).all()
    assert math.isclose(doubled.sum() / 2, (64.9 - 11.3) * 33.3, rel_tol=1e-12)
