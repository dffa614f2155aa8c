# SPDX-License-Identifier: GPL-3.0-or-later
"""Random surfaces, blocks and planes that cut stacks: in every position that is special, and anywhere."""

import itertools

import numpy as np

from .cutting import native_arrays
from .generate import random_stack
from .model_view import built

KINDS = ("ground", "box", "boxes", "own", "face", "own block", "other block", "curtain", "ends inside")


def box(low, high):
    """The corners and triangles of an axis-parallel box, turned outward."""
    corners = np.array(list(itertools.product(*zip(low, high, strict=True))), float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)


def joined(parts):
    """Several triangulated surfaces as one."""
    first = np.cumsum([0, *(len(v) for v, _ in parts)])
    return (
        np.concatenate([v for v, _ in parts]),
        np.concatenate([t + k for (_, t), k in zip(parts, first, strict=False)]).astype(np.int32),
    )


def grid(x, y, z):
    """A grid of triangles; x (N,), y (M,), z (N, M)."""
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    number = np.arange(z.size).reshape(z.shape)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    return np.column_stack([plan.reshape(-1, 2), z.ravel()]), np.concatenate(triangles).astype(np.int32)


def _random_box(rng, vertices):
    """Between two vertices: its faces run through vertices and along faces."""
    p, q = vertices[rng.randrange(len(vertices))], vertices[rng.randrange(len(vertices))]
    p, q = np.minimum(p, q), np.maximum(p, q)
    extent = np.ptp(vertices, axis=0)
    q = np.where(q > p, q, p + 0.5 * np.maximum(extent, 1e-3))
    if rng.random() < 0.3:
        p = p - 0.1 * np.maximum(extent, 1e-3) * rng.random()
    return box(p, q)


def _ground(rng, vertices):
    """Rough or level ground through heights of vertices, beyond the model on all sides."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    low, high = low - 0.3 * (high - low) - 0.5, high + 0.3 * (high - low) + 0.5
    x, y = (np.linspace(low[k], high[k], rng.randint(1, 4) + 1) for k in (0, 1))
    if rng.random() < 0.4:  # lines of the grid through vertices
        x = np.unique([*x, vertices[rng.randrange(len(vertices)), 0]])
        y = np.unique([*y, vertices[rng.randrange(len(vertices)), 1]])
    heights = [vertices[rng.randrange(len(vertices)), 2] for _ in range(len(x) * len(y))]
    if rng.random() < 0.3:
        heights = heights[:1] * len(heights)
    return grid(x, y, np.array(heights).reshape(len(x), len(y)))


def _curtain(rng, vertices):
    """Upright along a line through vertices, folded or straight."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    reach = 2 * (high - low).max() + 1
    p, q = (vertices[rng.randrange(len(vertices)), :2] for _ in range(2))
    way = q - p if (q != p).any() else np.array([1.0, 0.0])
    way = way / np.hypot(*way)
    line = [p - reach * way, p, q if (q != p).any() else p + way, q + reach * way]
    if rng.random() < 0.5:
        line[-1] = line[-1] + np.array([-way[1], way[0]]) * reach * rng.random()
    line = np.array(line)
    below, above = low[2] - 1 - 0.1 * (high - low)[2], high[2] + 1 + 0.1 * (high - low)[2]
    vertices = np.concatenate([np.column_stack([line, np.full(len(line), z)]) for z in (below, above)])
    n = len(line)
    triangles = [t for i in range(n - 1) for t in ((i, i + 1, n + i + 1), (i, n + i + 1, n + i))]
    return vertices, np.array(triangles, np.int32)


def _along_faces(rng, model):
    """The plane of a face as a large triangle, or the boundary of a cell moved by a face's length."""
    offsets = model["face_offsets"]
    f = rng.randrange(len(offsets) - 1)
    corners = model["vertices"][model["face_vertices"][offsets[f] : offsets[f + 1]]]
    a, b, c = corners[:3]
    u, v = b - a, c - a
    reach = 4 * (np.ptp(model["vertices"], axis=0).max() + 1)
    size = max(np.abs(u).max(), np.abs(v).max())
    if not size > 0:
        return None
    k = 2.0 ** np.ceil(np.log2(reach / size))
    square = np.array([a - k * u - k * v, a + k * u - k * v, a + k * u + k * v, a - k * u + k * v])
    sides = np.linalg.norm(u), np.linalg.norm(v)
    if not np.isfinite(square).all() or min(sides) < 0.2 * max(sides):
        return None
    if np.linalg.norm(np.cross(u, v)) < 0.2 * sides[0] * sides[1]:
        return None
    return square, np.array([(0, 1, 2), (0, 2, 3)], np.int32)


def some_planes(rng, vertices):
    """Planes (point, normal) through vertices and along what is there, and one that is anywhere."""

    def vertex():
        return vertices[rng.randrange(len(vertices))]

    def plane(point, normal):
        return np.array(point, float), np.array(normal, float)

    p, q, r = vertex(), vertex(), vertex()
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    found = [
        plane(p, [(1, 0, 0), (0, 1, 0), (0, 0, 1)][rng.randrange(3)]),
        plane(p, np.cross(q - p, r - p)),  # through three vertices
        plane(p, ((q - p)[1], -(q - p)[0], 0)),  # vertical, through two
        plane(p, [rng.randint(-2, 2) for _ in range(3)]),
        plane(
            low + np.array([rng.random() for _ in range(3)]) * (high - low),
            [rng.gauss(0, 1) for _ in range(3)],
        ),
    ]
    return [(point, normal) for point, normal in found if normal.any() and np.isfinite(normal).all()]


def random_cutter(rng, stack, family, model, cells, kind=None):
    """(kind, arguments): what native.cut_by_surface takes ("vertices, triangles") or native.cut_by_block
    ("model, block") after the model; None where the kind does not apply. A "plane", which comes only where it
    is asked for, is for native.cut_by_plane ("point, normal")."""
    kind = kind or rng.choice(KINDS)
    vertices = model["vertices"]
    if kind == "plane":
        planes = some_planes(rng, vertices)
        return (kind, rng.choice(planes)) if planes else None
    if kind == "ground":
        return kind, _ground(rng, vertices)
    if kind == "box":
        return kind, _random_box(rng, vertices)
    if kind == "boxes":
        return kind, joined([_random_box(rng, vertices) for _ in range(rng.randint(2, 3))])
    if kind == "own":
        surface, triangles = rng.choice(stack.surfaces)
        return kind, (np.array(surface), np.array(triangles, np.int32))
    if kind == "face":
        found = _along_faces(rng, model)
        return None if found is None else (kind, found)
    if kind == "curtain":
        return kind, _curtain(rng, vertices)
    if kind == "ends inside":
        v, t = _ground(rng, vertices)
        keep = [k for k in range(len(t)) if rng.random() < 0.8]
        return None if not keep else (kind, (v, t[keep]))
    if kind == "own block":
        return kind, (model, int(rng.choice(list(model["cell_block"]))))
    other = random_stack(rng, family)
    others = native_arrays(other, built(other, cells=cells, threads=1), cells)
    if not len(others["cell_block"]):
        return None
    return kind, (others, int(rng.choice(list(others["cell_block"]))))
