# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells of a model around points, and places beside its faces."""

import numpy as np

from . import signs


class Faces:
    """The faces of a model as triangles from their first corners."""

    def __init__(self, model):
        self.model = model
        size = np.diff(model.face_offsets)
        first = np.repeat(model.face_offsets[:-1], size - 2)
        self.face = np.repeat(np.arange(len(size)), size - 2)
        step = np.arange(len(self.face)) - np.repeat(np.cumsum(size - 2) - (size - 2), size - 2)
        fans = np.stack([first, first + step + 1, first + step + 2], axis=1)
        self.corners = model.vertices[model.face_vertices[fans]]
        normal = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.normal = np.zeros((len(size), 3))
        np.add.at(self.normal, self.face, normal / 2)

    def cells(self, points):
        """Of each point the cells whose boundary goes round it: a list of {cell: times}; None where that is
        not decided."""
        found = [{} for _ in points]
        rows, numbers, on_edge = signs.triangles_over(points[:, :2], self.corners)
        a, b, c = self.corners[numbers].transpose(1, 0, 2)
        facing = signs.turn(a[:, :2], b[:, :2], c[:, :2])
        under = signs.over(a, b, c, points[rows]) * facing
        cells = self.model.face_cells[self.face[numbers]]
        for row, edge, level, up, (own, other) in zip(rows, on_edge, under, facing, cells, strict=True):
            if found[row] is None or level > 0:
                continue
            if edge or level == 0:
                found[row] = None
                continue
            found[row][own] = found[row].get(own, 0) + int(up)
            if other >= 0:
                found[row][other] = found[row].get(other, 0) - int(up)
        return [None if f is None else {cell: n for cell, n in f.items() if n} for f in found]

    def beside(self, random, count, away):
        """Places on some faces, faces (K,), places (K, 3), steps (K, 3) across each, at least `away` long."""
        convex = self._widest(away)
        some = random.permutation(convex)[:count]
        corners = self.corners[some]
        weights = random.dirichlet((3, 3, 3), len(some))
        places = np.einsum("ni,nik->nk", weights, corners)
        normal = self.normal[self.face[some]]
        unit = normal / np.linalg.norm(normal, axis=1)[:, None]
        steps = np.maximum(2 * away, 1e-4 * self.widths[some])[:, None] * unit
        return self.face[some], places, steps

    def _widest(self, away):
        """Triangles that are wide enough and face as their faces do: they lie within these."""
        a, b, c = self.corners.transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        area = np.linalg.norm(normal, axis=1)
        longest = np.max([np.linalg.norm(x, axis=1) for x in (b - a, c - b, a - c)], axis=0)
        self.widths = area / np.maximum(longest, 1e-300)
        sizes = np.diff(self.model.face_offsets)[self.face]
        whole = self.normal[self.face]
        aligned = (normal * whole).sum(axis=1) > 0.99 * area * np.linalg.norm(whole, axis=1)
        # of a face that is not convex only if it is one triangle
        is_wall = self.model.face_surface[self.face] == -1
        blocks = self.model.cell_kind == "blocks"
        fine = aligned & ((sizes == 3) | ~(is_wall | blocks))
        return np.flatnonzero(fine & (self.widths > 64 * away))


def distances(points, corners):
    """(N,) of points to the nearest of triangles (M, 3, 3); inf without any."""
    nearest = np.full(len(points), np.inf)
    if not len(corners):
        return nearest
    a, b, c = (x[None] for x in corners.transpose(1, 0, 2))
    p = points[:, None]
    normal = np.cross(b - a, c - a)
    size = (normal**2).sum(axis=2)
    off = ((p - a) * normal).sum(axis=2)
    inside = np.broadcast_to(size > 0, off.shape).copy()  # one without an area is its edges
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(v - u, p - u) * normal).sum(axis=2) >= 0
        way = v - u
        t = np.clip(((p - u) * way).sum(axis=2) / np.maximum((way**2).sum(axis=2), 1e-300), 0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(p - u - t[..., None] * way, axis=2).min(axis=1))
    plane = np.where(inside, np.abs(off) / np.sqrt(np.where(size > 0, size, 1.0)), np.inf)
    return np.minimum(nearest, plane.min(axis=1))
