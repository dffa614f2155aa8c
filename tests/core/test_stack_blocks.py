# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks built without columns against the same blocks merged from columns.

The stacks are large enough for triangles that no other surface touches: those are what the way without
columns treats differently. Both ways must bound the same parts.
"""

import numpy as np
import pytest
from realmodel import _native

KINDS = ("lattice", "waves", "level")


def triangulated(chance, size):
    """Squares of a grid, each divided along one of its diagonals."""
    triangles = []
    for i in range(size):
        for j in range(size):
            a = i * (size + 1) + j
            b, c, d = a + size + 1, a + size + 2, a + 1
            triangles += [[a, b, c], [a, c, d]] if chance.random() < 0.8 else [[a, b, d], [b, c, d]]
    return np.array(triangles, np.int32)


def heights(chance, kind, k, x, y):
    if kind == "lattice":
        return chance.integers(0, 4, x.shape) + k * chance.integers(0, 3)
    if kind == "level":
        return np.full(x.shape, float(chance.integers(0, 5)))
    a, b, c, d = chance.uniform(0, 6, 4)
    return 0.6 * k + np.sin(x * a / 6 + b) * np.cos(y * c / 6 + d) * chance.uniform(0.2, 2)


def surface(chance, size, k, kind, shared):
    ticks = np.arange(size + 1.0)
    x, y = (axis.copy() for axis in np.meshgrid(ticks, ticks, indexing="ij"))
    if not shared and chance.random() < 0.5:
        for axis in (x, y):
            axis[1:-1, 1:-1] += chance.uniform(-0.2, 0.2, (size - 1, size - 1))
    vertices = np.stack([x, y, heights(chance, kind, k, x, y)], -1).reshape(-1, 3)
    triangles = triangulated(chance, size)
    middle = vertices[triangles].mean(1)
    if chance.random() < 0.35:  # a hole, or an island
        place, reach = chance.uniform(0, size, 2), chance.uniform(0.2, 0.6) * size
        covered = np.hypot(*(middle[:, :2] - place).T) < reach
        covered = covered if chance.random() < 0.5 else ~covered
        triangles, middle = triangles[covered], middle[covered]
    if len(triangles) and chance.random() < 0.25:  # a jump
        beyond = middle[:, 0] > size * chance.uniform(0.2, 0.8)
        lifted = vertices + np.array([0.0, 0.0, chance.integers(-2, 3)])
        triangles = triangles + np.where(beyond, len(vertices), 0)[:, None].astype(np.int32)
        vertices = np.concatenate([vertices, lifted])
    return np.ascontiguousarray(vertices, float), np.ascontiguousarray(triangles, np.int32)


def stack(seed):
    chance = np.random.default_rng(seed)
    size, shared = int(chance.integers(6, 20)), chance.random() < 0.3
    kinds = KINDS if chance.random() < 0.3 else (chance.choice(KINDS),)
    surfaces = [
        surface(chance, size, k, chance.choice(kinds), shared) for k in range(int(chance.integers(2, 6)))
    ]
    region = None
    if chance.random() < 0.3:
        q = chance.uniform(0, 0.3) * size
        ring = [[q, q], [size - q, 0.5 * q], [size - q, size - q], [q, size - 1.5 * q], [size / 2, size / 2]]
        region = (np.array(ring), np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], np.int32))
    return {
        "surfaces": surfaces,
        "region": region,
        "base_elevation": -20.0 if chance.random() < 0.5 else None,
    }


def edges_of_cells(built):
    """(N, 4): cell, lower vertex, higher vertex, 1 if passed upwards and -1 if not."""
    offsets, vertices, cells = built["face_offsets"], built["face_vertices"], built["face_cells"]
    face = np.repeat(np.arange(len(cells)), np.diff(offsets))
    following = np.arange(1, len(vertices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    start, end = vertices, vertices[following]
    rows = []
    for side, sign in ((0, 1), (1, -1)):
        within = cells[face, side] >= 0
        a, b = start[within], end[within]
        way = np.where(a < b, sign, -sign)
        rows.append(np.stack([cells[face[within], side], np.minimum(a, b), np.maximum(a, b), way], 1))
    return np.concatenate(rows)


def parts_of_blocks(built, blocks):
    block = built["cell_block"]
    root = _native.cell_components(built["face_cells"], block)
    return np.bincount(block[root == np.arange(len(block))], minlength=blocks)


@pytest.mark.parametrize("seed", range(60))
def test_blocks_are_those_of_the_columns(seed):
    compare(stack(seed))


def test_middles_of_facets_on_edges_beneath_them():
    """Squares of three by three over squares of one: middles lie on vertices of the surface beneath."""

    def level(size, step, z):
        ticks = np.arange(size + 1.0) * step
        x, y = np.meshgrid(ticks, ticks, indexing="ij")
        vertices = np.stack([x, y, np.full(x.shape, z)], -1).reshape(-1, 3)
        a = (np.arange(size)[:, None] * (size + 1) + np.arange(size)).ravel()
        corners = np.stack([a, a + size + 1, a + size + 2, a, a + size + 2, a + 1], -1)
        return vertices, corners.reshape(-1, 3).astype(np.int32)

    fine, coarse = level(30, 1.0, 0.0), level(10, 3.0, 1.0)
    compare({"surfaces": [fine, coarse], "region": None, "base_elevation": -1.0})


def compare(given):
    columns = _native.build_stack(**given, cells="columns", execution=_native.Execution(1))
    blocks = _native.build_stack(**given, cells="blocks", execution=_native.Execution(2))
    count = len(given["surfaces"])
    assert blocks["volumes"] == pytest.approx(columns["volumes"], rel=1e-9, abs=1e-9)
    parts = np.bincount(blocks["cell_block"], minlength=count)
    assert parts.tolist() == parts_of_blocks(columns, count).tolist()
    edges = edges_of_cells(blocks)
    _, edge = np.unique(edges[:, :3], axis=0, return_inverse=True)
    assert not np.bincount(edge.ravel(), weights=edges[:, 3]).any()
    assert len(np.unique(blocks["vertices"], axis=0)) == len(blocks["vertices"])
    assert len(np.unique(blocks["face_vertices"])) == len(blocks["vertices"])


def test_untouched_triangles_stay_whole():
    """Two waves far apart: every face is a triangle of the input or a wall."""
    chance = np.random.default_rng(5)
    low, high = surface(chance, 30, 0, "waves", True), surface(chance, 30, 0, "waves", True)
    high[0][:, 2] += 50.0
    keep = [(v, triangulated(chance, 30)) for v, _ in (low, high)]
    built = _native.build_stack(surfaces=keep, cells="blocks", execution=_native.Execution(1))
    assert len(built["cell_block"]) == 1
    on_surface = built["face_surface"] >= 0
    sizes = np.diff(built["face_offsets"])
    inner = sum(len(t) for _, t in keep)
    assert (sizes[on_surface] == 3).sum() >= 0.8 * inner


def waves(chance, size):
    """Surfaces that cross here and there, in more triangles than a thread takes at a time."""
    ticks = np.arange(size + 1.0)
    surfaces = []
    for k in range(3):
        x, y = (axis.copy() for axis in np.meshgrid(ticks, ticks, indexing="ij"))
        for axis in (x, y):
            axis[1:-1, 1:-1] += chance.uniform(-0.2, 0.2, (size - 1, size - 1))
        vertices = np.stack([x, y, heights(chance, "waves", k, x, y)], -1).reshape(-1, 3)
        surfaces.append((vertices, triangulated(chance, size)))
    return {"surfaces": surfaces, "region": None, "base_elevation": -20.0}


@pytest.mark.parametrize("cells", ["blocks", "columns"])
@pytest.mark.parametrize("given", [3, 11, 29, "waves"])
def test_same_bytes_for_any_number_of_threads(given, cells):
    given = waves(np.random.default_rng(1), 66) if given == "waves" else stack(given)
    runs = map(_native.Execution, (1, 2, 5))
    one, two, many = (_native.build_stack(**given, cells=cells, execution=run) for run in runs)
    for name in ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block"):
        assert one[name].tobytes() == two[name].tobytes() == many[name].tobytes()
