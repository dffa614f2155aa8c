# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces from points in tiles: the heights of the undivided model to the last bit."""

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
from realmodel.distributed import build as build_tiles
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
def test_surfaces_from_points(count, tmp_path):
    project = from_points(count)
    tiled = build_tiles(project, tmp_path / "t", (20, 25))
    whole = build(project)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    assert count == 9 or any(warning.kind == "wrong_side" for warning in tiled.warnings)
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


def test_heights_of_all_methods(tmp_path):
    project = of_all_kinds()
    tiled, whole = build_tiles(project, tmp_path / "t", (40, 25)), build(project)
    assert_same_heights(tiled, whole)
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    kinds = {warning.kind for warning in tiled.warnings}
    assert {"minimum_thickness", "wrong_side", "points"} <= kinds
    assert any("within the radius" in str(warning) for warning in tiled.warnings)


def test_a_surface_that_ends_before_the_region_begins(tmp_path):
    """Is refused as in the undivided model."""
    points = scattered(60, 1) * [0.01, 0.01, 1] - [40, 40, 0]
    surfaces = [Surface("away", points=points, options={"extrapolate": "none", "variogram": GIVEN})]
    project = Project("p", [Rock("r", surfaces, region=OUTLINE, edge_length=9.0, base_elevation=-30.0)])
    with pytest.raises(InputRefused) as expected:
        build(project)
    assert "no triangle of the region's mesh" in str(expected.value)
    with pytest.raises(InputRefused) as found:
        build_tiles(project, tmp_path / "t", (40, 25))
    assert str(found.value) == str(expected.value)


def on_a_grid(shape, steps, corner, turn, shift, seed, left_out=0.0):
    """Points on a grid, turned by an angle, in any order."""
    rng = np.random.default_rng(seed)
    across, up = np.mgrid[0 : shape[0], 0 : shape[1]].reshape(2, -1) * np.array(steps)[:, None]
    x, y = across * np.cos(turn) - up * np.sin(turn), across * np.sin(turn) + up * np.cos(turn)
    z = shift + 2 * np.sin(x / 15) + rng.normal(0, 0.2, len(x))
    points = np.column_stack([corner[0] + x, corner[1] + y, z])
    return points[rng.permutation(len(x))[: int(len(x) * (1 - left_out))]]


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


def test_what_auto_proposes_is_said_of_tiles_too(tmp_path):
    project = Project("p", [rock_of(automatic([15, 15, 15], 4))])
    tiled = build_tiles(project, tmp_path / "t", (600, 1100))
    assert [each.kind for each in tiled.warnings].count("series") == 1
    assert_same_warnings(tiled, build(project))


def test_borders_are_joined(tmp_path):
    """Of the mesh of a region and of a ready mesh beside it."""
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
