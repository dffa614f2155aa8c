# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that tiles interpolate themselves: the heights of the undivided model to the last bit."""

import numpy as np
import pytest
from realmodel.core import (
    InputRefused,
    Project,
    Rock,
    Surface,
    build,
)
from realmodel.core.base.work import native_module
from realmodel.core.surfaces.local_heights import LocalHeights, local_surfaces
from realmodel.core.surfaces.observed.surface_data import SurfaceData
from realmodel.core.surfaces.rock_input import RockInput
from realmodel.core.tiles.windows import PointWindows
from realmodel.distributed import build as build_tiles
from realmodel.distributed import tile_folder
from test_conformable import automatic
from test_series_of_sheets import rock_of
from tiled_models import OUTLINE, assert_same_blocks, assert_same_warnings

pytestmark = pytest.mark.usefixtures("tiles_in_this_process")


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
        Surface("above", points=scattered(count, 6, 12), minimum_thickness=0.5, tie=False),
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
    assert len(of_tiles) == 6 * len(tiled.tiles) + 5  # and around the points, for ties
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
        Surface("fitted", points=scattered(300, 2, -3), method="plane", minimum_thickness=0.5, tie=False),
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
    surfaces[3].minimum_thickness, surfaces[3].tie = 1.0, False
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
        Surface("cells", points=np.add(lattice, [0, 0, 3]), method="tin", minimum_thickness=0.5, tie=False),
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


def entry_of(rock):
    points = [np.empty((0, 3)) if each.points is None else each.points for each in rock.surfaces]
    return RockInput(rock, [None] * len(points), data=[SurfaceData(each, len(each)) for each in points])


def test_surfaces_that_tiles_leave_to_the_lead():
    """Those of one system, those that need one that ends, and those that such ones need."""
    points = scattered(60, 1)
    surfaces = [
        Surface("ends", points=points, options={"extrapolate": "none"}),
        Surface("on it", method="parallel", options={"to": "ends", "thickness": 1.0}),
        Surface("bound", points=points),
        Surface("smooth", points=points, method="dsi", options={"above": "bound"}),
        Surface("free", points=points, minimum_thickness=1.0, tie=False),
        Surface("under", method="parallel", options={"to": "on it", "thickness": 1.0}),
        Surface("shown", points=points, method="parallel", options={"to": "free"}),
        Surface("last", points=points, minimum_thickness=1.0, tie=False),
    ]
    rock = Rock("r", surfaces, region=OUTLINE, edge_length=4.0)
    assert local_surfaces(entry_of(rock)) == set()
    surfaces[6] = Surface("apart", points=points)
    assert local_surfaces(entry_of(rock)) == {4, 6, 7}
    surfaces[7].tie = True  # raised, it is tied again; it needs the one before
    assert local_surfaces(entry_of(rock)) == {4}


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


def test_what_auto_proposes_is_said_of_tiles_too(tmp_path):
    project = Project("p", [rock_of(automatic([15, 15, 15], 4))])
    tiled = build_tiles(project, tmp_path / "t", (600, 1100))
    assert [each.kind for each in tiled.warnings].count("series") == 1
    assert_same_warnings(tiled, build(project))


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
