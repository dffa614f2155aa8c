# SPDX-License-Identifier: GPL-3.0-or-later
"""Models in tiles, built one tile after another in this process: the same as undivided ones."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from realmodel.core import (
    InputRefused,
    build,
    load_project,
    open_tiles,
)
from realmodel.distributed import build as build_tiles
from stacks.generate import random_stack
from stacks.judge import volume_allowance
from stacks.model_view import rocks_of
from stacks.project_files import stack_project
from stacks.rock_masses import random_rock_masses
from tiled_models import HOLE, OUTLINE, assert_same_blocks, assert_same_warnings, ready, sample

pytestmark = pytest.mark.usefixtures("tiles_in_this_process")


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
    return model.block_at(places).tolist()


def test_blocks_at_points_and_on_a_grid_are_those_of_the_whole(tmp_path):
    project = sample("two_layers")
    whole, tiled = build(project), build_tiles(project, tmp_path / "t", (30, 25))
    assert len(tiled.tiles) > 3
    np.testing.assert_array_equal(tiled.grid((13, 11, 7)), whole.grid((13, 11, 7)))
    points = np.random.default_rng(3).uniform((-5, -5, -1), (90, 60, 40), (500, 3))
    assert tiled.block_at(points).tolist() == whole_blocks(whole, points)


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


def test_a_base_that_cuts_surfaces_off(tmp_path):
    project = ready()
    project.rocks[0].base_elevation = 5.0
    tiled, whole = build_tiles(project, tmp_path / "t", (30, 30)), build(project)
    assert len(tiled.tiles) == 16
    assert_same_blocks(tiled, whole)
    assert_same_warnings(tiled, whole)
    project.rocks[0].base_elevation = 500.0
    with pytest.raises(InputRefused) as expected:
        build(project)
    with pytest.raises(InputRefused) as found:
        build_tiles(project, tmp_path / "u", (30, 30))
    assert str(found.value) == str(expected.value)


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
