# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces one after another, as flat arrays."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.sheet import Sheet
from .rock_input import RockInput

_ARRAYS = ("vertices", "triangles", "vertex_offsets", "triangle_offsets")


@dataclass(frozen=True, eq=False)
class SurfaceArrays:
    """The arrays `surface_...` of docs/dev/geometry.md, under the same names, put together when they are
    asked for: vertices (Vs, 3) float64, triangles (Ts, 3) int32, which index within their own surface,
    vertex_offsets and triangle_offsets (S + 1,) int64. shapes: of each surface."""

    shapes: list[Sheet]

    @cached_property
    def vertices(self) -> np.ndarray:
        return np.concatenate([np.empty((0, 3)), *(vertices for vertices, _ in self.shapes)])

    @cached_property
    def triangles(self) -> np.ndarray:
        return np.concatenate([np.empty((0, 3), np.int32), *(triangles for _, triangles in self.shapes)])

    @cached_property
    def vertex_offsets(self) -> np.ndarray:
        return np.cumsum([0, *(len(vertices) for vertices, _ in self.shapes)], dtype=np.int64)

    @cached_property
    def triangle_offsets(self) -> np.ndarray:
        return np.cumsum([0, *(len(triangles) for _, triangles in self.shapes)], dtype=np.int64)

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray]) -> SurfaceArrays:
        """Of the arrays of a file, which are not put together again."""
        stored_arrays = {name: arrays[f"surface_{name}"] for name in _ARRAYS}
        vertices, triangles = (
            [
                stored_arrays[name][begin:end]
                for begin, end in itertools.pairwise(stored_arrays[f"{one}_offsets"].tolist())
            ]
            for name, one in (("vertices", "vertex"), ("triangles", "triangle"))
        )
        surface_arrays = cls([Sheet(*pair) for pair in zip(vertices, triangles, strict=True)])
        vars(surface_arrays).update(stored_arrays)
        return surface_arrays


def triangle_sheets(inputs: list[RockInput]) -> np.ndarray:
    """(Ts,) int32: of each triangle of all surfaces the sheet of its surface that it is of, from 0; a surface
    that no fault displaces has one."""
    numbers = [np.zeros(0, np.int64)]
    for entry, number in by_rock(inputs):
        sizes = _sizes(entry, number)
        numbers.append(np.repeat(np.arange(len(sizes)), sizes))
    return np.concatenate(numbers).astype(np.int32)


def sheet_sizes(inputs: list[RockInput], number: int) -> list[int]:
    """How many triangles the sheets of one surface have, by its global index: they are its own one sheet
    after another."""
    return _sizes(*by_rock(inputs)[number])


def by_rock(inputs: list[RockInput]) -> list[tuple[RockInput, int]]:
    """Of each surface, by its global index, its rock mass and its number there."""
    return [(entry, number) for entry in inputs for number in range(len(entry.surfaces))]


def _sizes(entry: RockInput, number: int) -> list[int]:
    return [len(triangles) for _, triangles in entry.divided().distinct(number)]


def vertex_attributes(inputs: list[RockInput], number: int, vertices: np.ndarray) -> dict[str, np.ndarray]:
    """The attributes (V,) of the vertices of one surface, by its global index: `height`; `variance` and
    `distance`, NaN where there are none."""
    interfaces = [entry.attributes.get(k, {}) for entry, k in by_rock(inputs)]
    attributes = interfaces[number] if number < len(interfaces) else {}  # faults and bodies have none
    unknown = np.full(len(vertices), np.nan)
    return {
        "height": vertices[:, 2].copy(),
        "variance": attributes.get("variance", unknown),
        "distance": attributes.get("distance", unknown),
    }
