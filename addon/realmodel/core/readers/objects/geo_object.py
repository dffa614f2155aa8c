# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of an object in a file of objects, whatever its format."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

POINTS, LINES, SURFACE, HOLE = "points", "lines", "surface", "borehole"


@dataclass(frozen=True)
class ObjectName:
    """An object in a file: its name and what it is: POINTS, LINES, SURFACE, HOLE. key: by which the library
    finds it."""

    name: str
    kind: str
    key: object = None


@dataclass(frozen=True, eq=False)
class Values:
    """places (N, 3): points, or the beginnings of intervals along lines, which end at `ends` (N, 3). columns:
    (N,) texts or numbers by name; what is not known is "" or NaN. depths (N, 2): of the ends of intervals;
    None: by their lengths, one after another."""

    places: np.ndarray
    columns: dict[str, np.ndarray]
    ends: np.ndarray | None = None
    depths: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class GeoObject:
    """vertices (V, 3) float64; triangles (T, 3) of a surface; values: of its points and its intervals;
    collar (3,): of a borehole that says it."""

    name: str
    kind: str
    vertices: np.ndarray
    triangles: np.ndarray | None = None
    values: list[Values] = field(default_factory=list)
    collar: np.ndarray | None = None

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """What is known of its vertices."""
        return next((values.columns for values in self.values if values.ends is None), {})


class OpenFile(Protocol):
    """A file of objects that is open. Its methods may raise anything that the library does."""

    def names(self) -> list[ObjectName]:
        """The objects that are read."""

    def read(self, wanted: ObjectName) -> GeoObject:
        """One of them, in the coordinates of the file."""


def texts(numbers: np.ndarray, names: dict[int, str]) -> np.ndarray:
    """(N,) str: the names of numbers, "" for those that have none."""
    unique, index = np.unique(np.asarray(numbers, np.int64), return_inverse=True)
    named = np.array([str(names.get(number, "")) for number in unique.tolist()] or [""], object)
    return named[index.ravel()]
