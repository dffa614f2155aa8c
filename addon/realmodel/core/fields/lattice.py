# SPDX-License-Identifier: GPL-3.0-or-later
"""A regular lattice in space, and scalar fields that are linear on its tetrahedra.

Each cell is divided into six tetrahedra that share its main diagonal, from its lowest corner to its highest
(H. Freudenthal 1942; H. W. Kuhn 1960). All cells are divided alike, so that neighbors agree on their faces.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..base.work import native_module

# The corners of a cell, as their steps along x, y and z, of each of its tetrahedra: those of one walk along
# the three axes from the lowest corner to the highest. Positive volumes.
TETRAHEDRA_OF_CELL = np.array(
    [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
        [[0, 0, 0], [0, 1, 0], [0, 1, 1], [1, 1, 1]],
        [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1]],
        [[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 1, 1]],
        [[0, 0, 0], [0, 1, 1], [0, 0, 1], [1, 1, 1]],
        [[0, 0, 0], [1, 0, 1], [1, 0, 0], [1, 1, 1]],
    ]
)


@dataclass(frozen=True)
class Lattice:
    """Nodes (i, j, k) at origin + spacing * (i, j, k). Node (i, j, k) has the number i + nx (j + ny k).

    origin, spacing: model units along x, y and z. counts: nodes along each, two at least.
    """

    origin: tuple[float, float, float]
    spacing: tuple[float, float, float]
    counts: tuple[int, int, int]

    @property
    def nodes(self) -> int:
        """How many nodes there are."""
        nx, ny, nz = self.counts
        return nx * ny * nz

    @property
    def strides(self) -> np.ndarray:
        """(3,) int64: how much the number of a node grows by a step along each axis."""
        nx, ny, _ = self.counts
        return np.array([1, nx, nx * ny])

    @property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and the highest corner of its box, (3,) each."""
        low = np.asarray(self.origin, float)
        return low, low + np.multiply(self.spacing, np.subtract(self.counts, 1))

    def _range_around(self, box: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The first and the last node (3,) along each axis around what of a box (2, 3) lies in the lattice,
        with a cell of margin; two apart at least."""
        steps = (np.asarray(box, float) - self.origin) / self.spacing
        last = np.subtract(self.counts, 1)
        low = np.clip(np.floor(steps[0]) - 1, 0, last - 1).astype(np.int64)
        return low, np.clip(np.ceil(steps[1]) + 1, low + 1, last).astype(np.int64)

    def positions(self) -> np.ndarray:
        """(nodes, 3) float64."""
        x, y, z = (
            start + step * np.arange(count)
            for start, step, count in zip(self.origin, self.spacing, self.counts, strict=True)
        )
        nodes = np.empty((len(z), len(y), len(x), 3))
        nodes[..., 0], nodes[..., 1], nodes[..., 2] = x, y[:, None], z[:, None, None]
        return nodes.reshape(-1, 3)

    def tetrahedra(self) -> np.ndarray:
        """(6 cells, 4) int32 nodes, of positive volume, those of one cell together, cells in the order of
        their lowest corners."""
        strides = self.strides
        i, j, k = (np.arange(count - 1) for count in self.counts)
        lowest = (i + (j * strides[1])[:, None] + (k * strides[2])[:, None, None]).reshape(-1, 1, 1)
        steps = (TETRAHEDRA_OF_CELL * strides).sum(axis=-1)
        return (lowest + steps).reshape(-1, 4).astype(np.int32)

    def located(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The tetrahedra in which points (P, 3) lie: nodes (P, 4) int64 and weights (P, 4), which are not
        negative and sum to 1. A point outside the box has weights NaN."""
        places = (np.asarray(points, float) - self.origin) / self.spacing
        last = np.subtract(self.counts, 2)
        cells = np.clip(np.floor(np.nan_to_num(places)), 0, last).astype(np.int64)
        shares = places - cells
        inside = np.all((shares >= 0) & (shares <= 1), axis=1, keepdims=True)
        walk = np.argsort(-shares, axis=1, kind="stable")
        down = np.take_along_axis(shares, walk, axis=1)
        weights = np.empty((len(places), 4))
        weights[:, 0], weights[:, 3] = 1 - down[:, 0], down[:, 2]
        weights[:, 1:3] = down[:, :2] - down[:, 1:]
        strides = self.strides
        first = (cells * strides).sum(axis=1)
        nodes = np.column_stack([first, first[:, None] + np.cumsum(strides[walk], axis=1)])
        return nodes, np.where(inside, weights, np.nan)


@dataclass(frozen=True, eq=False)
class ScalarField:
    """A function f in space, linear on each tetrahedron of a lattice. It rises from older to younger.

    values: (nodes,) float64. levels: (surfaces,) float64, rising: f on each surface, oldest first. points:
    (P, 3) float64, corners of tetrahedra beside the nodes: each divides those that it lies in. point_values:
    (P,) float64, f there. critical_points: (C, 3) the inner critical points of f, if requested.
    """

    lattice: Lattice
    values: np.ndarray
    levels: np.ndarray
    points: np.ndarray = field(default_factory=lambda: np.empty((0, 3)), kw_only=True)
    point_values: np.ndarray = field(default_factory=lambda: np.empty(0), kw_only=True)
    critical_points: np.ndarray = field(default_factory=lambda: np.empty((0, 3)), kw_only=True)

    def native(self) -> tuple:
        """The arguments of the native module: lattice, values, and the points with theirs."""
        lattice = self.lattice
        return (
            (lattice.origin, lattice.spacing, lattice.counts),
            self.values,
            (self.points, self.point_values),
        )

    def within(self, box: np.ndarray) -> ScalarField:
        """The field on the cells of its lattice around a box (2, 3): with the same tetrahedra and values."""
        lattice = self.lattice
        low, high = lattice._range_around(box)
        origin = lattice.origin + low * np.array(lattice.spacing)
        part = Lattice(tuple(origin.tolist()), lattice.spacing, tuple((high - low + 1).tolist()))
        chosen = tuple(slice(a, b + 1) for a, b in zip(low[::-1], high[::-1], strict=True))
        values = self.values.reshape(lattice.counts[::-1])[chosen]
        least, most = part.corners
        inside = ((self.points >= least) & (self.points <= most)).all(axis=1)
        return ScalarField(
            part,
            np.ascontiguousarray(values).ravel(),
            self.levels,
            points=self.points[inside],
            point_values=self.point_values[inside],
        )

    def at(self, points: np.ndarray) -> np.ndarray:
        """(P,) f at points (P, 3); NaN outside the lattice."""
        if len(self.points):
            lattice, values, field_points = self.native()
            positions = np.ascontiguousarray(points, np.float64)
            return native_module().field_at(lattice, values, field_points, positions)
        nodes, weights = self.lattice.located(points)
        return (self.values[nodes] * weights).sum(axis=1)


def rises(field: ScalarField, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(P, 3) by how much a field rises along x, y and z around points (P, 3), and over which distances
    (P, 3): an edge of the lattice, or what of it is in its box."""
    rise, far = np.empty((len(points), 3)), np.empty((len(points), 3))
    low, high = field.lattice.corners
    for axis, step in enumerate(field.lattice.spacing):
        move = 0.5 * step * np.eye(3)[axis]
        ahead, behind = (np.clip(points + way, low, high) for way in (move, -move))
        rise[:, axis] = field.at(ahead) - field.at(behind)
        far[:, axis] = ahead[:, axis] - behind[:, axis]
    return rise, far
