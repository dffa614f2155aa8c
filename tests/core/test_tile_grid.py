# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid of tiles, and the parts of meshes that are in each."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from realmodel.core import (
    UsageError,
)
from realmodel.core.base.triangles import Sheet
from realmodel.core.tiles import grid as tile_grids
from realmodel.core.tiles.grid import checked_size, clipped_region, tile_grid, triangles_by_tile
from realmodel.distributed import build as build_tiles
from realmodel.distributed import run_folder
from tiled_models import (
    hilly,
    ready,
)


def test_tiles_compare_positions_by_their_area(tmp_path):
    grid = tile_grid([hilly(10, 0.0, 1)[0]], (25, 50))
    frame = SimpleNamespace(grid=grid)
    counts = [run_folder.places_of(frame, grid.box(*name)) for name in grid]
    assert 4000 <= sum(counts) <= 4000 + len(counts)
    assert max(counts) < 1.4 * min(counts)
    grid = tile_grid([hilly(10, 0.0, 1)[0]], (2, 2))
    assert run_folder.places_of(SimpleNamespace(grid=grid), grid.box(1, 1)) == 100  # at least


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
        away = (
            (corners[:, :, 0].max(1) < low_x)
            | (corners[:, :, 0].min(1) > high_x)
            | (corners[:, :, 1].max(1) < low_y)
            | (corners[:, :, 1].min(1) > high_y)
        )
        assert listed[column, row] == np.flatnonzero(~away).tolist()


def test_a_clipped_region_has_its_area():
    vertices, triangles = hilly(7, 0.0, 1)
    box = (11.3, -20.0, 64.9, 33.3)
    vertices, triangles = clipped_region(Sheet(vertices[:, :2], triangles), box)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (doubled > 0).all()
    assert math.isclose(doubled.sum() / 2, (64.9 - 11.3) * 33.3, rel_tol=1e-12)
