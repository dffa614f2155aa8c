# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet: triangles that share vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .packages import extra

if TYPE_CHECKING:
    import pyvista


class Triangulation(NamedTuple):
    """vertices: (V, 3) float64, or (V, 2) in plan, model units. triangles: (T, 3) int32, numbers of vertices.

    It is a tuple: `vertices, triangles = model.surfaces["top"]`.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    def to_pyvista(self) -> pyvista.PolyData:
        """The triangles as a mesh of PyVista; in plan all heights are 0. Raises UsageError where PyVista is
        missing."""
        places = np.pad(self.vertices, ((0, 0), (0, 3 - self.vertices.shape[1])))
        return extra("pyvista", "to_pyvista()").PolyData.from_regular_faces(places, self.triangles)


@dataclass(frozen=True, eq=False)
class Sheet:
    """vertices: (V, 3) float64, or (V, 2) in plan. triangles: (T, 3) int32. numbers: (T,) of its triangles in
    the surface that it is a part of; None: 0, 1, ... Sheets are equal where they are one object, which
    compartments share."""

    vertices: np.ndarray
    triangles: np.ndarray
    numbers: np.ndarray | None = None

    def __iter__(self) -> Iterator[np.ndarray]:
        """`vertices, triangles = sheet`."""
        return iter(self.arrays)

    @property
    def arrays(self) -> Triangulation:
        """Vertices and triangles, as the native module takes them."""
        return Triangulation(self.vertices, self.triangles)

    @property
    def corners(self) -> np.ndarray:
        """(T, 3, 2) or (T, 3, 3): of its triangles."""
        return self.vertices[self.triangles]

    @property
    def of_surface(self) -> np.ndarray:
        """(T,) the numbers of its triangles, also where it is whole."""
        return np.arange(len(self.triangles)) if self.numbers is None else self.numbers

    def has_plan_of(self, other: Sheet) -> bool:
        """Whether it covers the same triangles in plan."""
        has_triangles = self.triangles is other.triangles or np.array_equal(self.triangles, other.triangles)
        return self is other or (
            has_triangles and np.array_equal(self.vertices[:, :2], other.vertices[:, :2])
        )

    def some(self, kept: np.ndarray) -> Sheet:
        """Some of its triangles (T,) bool, with only their own vertices."""
        if kept.all():
            return self
        used = np.zeros(len(self.vertices), bool)
        used[self.triangles[kept]] = True
        number = np.cumsum(used, dtype=np.int64) - 1
        triangles = number[self.triangles[kept]].astype(np.int32)
        return Sheet(np.ascontiguousarray(self.vertices[used]), triangles, self.of_surface[kept])
