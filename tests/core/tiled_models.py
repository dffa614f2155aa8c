# SPDX-License-Identifier: GPL-3.0-or-later
"""Models for tests of tiles, built in this process, and what they have in common with undivided ones."""

import contextlib
import pickle
import re
import unittest.mock
from concurrent.futures import Future

import numpy as np
from realmodel.core import (
    Project,
    Rock,
    Surface,
    load_project,
)
from realmodel.distributed import tile_folder
from realmodel.distributed.workers import Workers
from sample_scripts import SAMPLES


def sample(name):
    return load_project(SAMPLES / name / "project.toml")


class NoWorkers(Workers):
    """This process does all tasks, with what it would get as a worker."""

    def __init__(self):
        super().__init__(Future())

    def in_any_order(self, function, shared, tasks, cancel=None, **options):
        shared = pickle.loads(pickle.dumps(shared))
        return super().in_any_order(function, shared, tasks, cancel, **{**options, "here": True})


def in_this_process():
    """A context in which tiles are built one after another."""
    return unittest.mock.patch.object(
        tile_folder, "workers_of", lambda *_: contextlib.nullcontext(NoWorkers())
    )


def assert_same_warnings(tiled, whole):
    """But for those that only a model built in one piece has."""
    not_in_tiles = {"residual", "extrapolation", "eroded"}
    assert not not_in_tiles & {warning.kind for warning in tiled.warnings}
    wanted = [warning for warning in whole.warnings if warning.kind not in not_in_tiles]
    assert sorted(map(_as_in_tiles, tiled.warnings)) == sorted(map(_as_in_tiles, wanted))


def _as_in_tiles(warning):
    """Without the rows of points, and where surfaces are extrapolated: tiles do not know them."""
    return re.sub(r"point \d+ at", "point at", str(warning).partition("; '")[0])


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
