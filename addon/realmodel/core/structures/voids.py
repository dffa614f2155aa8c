# SPDX-License-Identifier: GPL-3.0-or-later
"""What younger surfaces make of the inside of a void.

What was there is gone, but it is remembered where nothing ever was: younger surfaces fill the void from the
top of that. It is found by building the older surfaces alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..work import native_module
from .exact import orient2d
from .located import fanned
from .rock_structure import Triangulation

_DEPOSITS = "conformable"
_FAR = 1.0  # ranges of heights below everything: where there is rock for sure

# (sheets, region, rules, surfaces before which all becomes air) to the arrays of a model of columns
Build = Callable[[list[Triangulation], Triangulation | None, list[str], Sequence[int]], dict]


class Piece(NamedTuple):
    """A part of a top, and the number of the sheet that it is of."""

    sheet: Triangulation
    of: int


class Older(NamedTuple):
    """sheets, rules: of the surfaces before a void or body. region: that of the rock mass, or None. emptied:
    the surfaces before which all that was there became air."""

    build: Build
    sheets: Sequence[Triangulation]
    rules: Sequence[str]
    region: Triangulation | None
    emptied: Sequence[int] = ()

    @property
    def plans(self) -> list[Triangulation]:
        """Triangulations that cover what the sheets cover."""
        return distinct_plans(self.sheets)

    def _built(self) -> dict:
        """The model of the sheets upon one more for each plan, far below all; these count first. Raises the
        builder's InputError for a sheet that it refuses, with the sheet's number."""
        heights = [vertices[:, 2] for vertices, _ in self.sheets if len(vertices)]
        low, high = min(each.min() for each in heights), max(each.max() for each in heights)
        far = float(low - _FAR * (high - low) - 1.0)
        floors = [level(plan, far) for plan in self.plans]
        first = self.emptied[-1] if self.emptied else 0
        sheets = [*self.sheets[:first], *floors, *self.sheets[first:]]
        rules = [*self.rules[:first], *[_DEPOSITS] * len(floors), *self.rules[first:]]
        try:
            model = self.build(sheets, self.region, rules, self.emptied)
        except native_module().InputError:  # of a floor: the sheet is refused in its own place
            self.build(list(self.sheets), self.region, list(self.rules), self.emptied)
            raise
        count = len(floors)
        order = [*range(count, count + first), *range(count), *range(count + first, len(sheets))]
        number = np.array([*order, -2, -1], np.int32)  # bases and walls stay
        return {
            **model,
            "face_surface": number[model["face_surface"]],
            "cell_block": number[model["cell_block"]],
        }

    def never(self, fills: Sequence[bool]) -> list[Piece]:
        """The top of what is below the oldest surface, where there is one. fills: sheets that fill bodies:
        nothing is below these."""
        model = self._built()
        count = len(self.plans)
        chosen = np.zeros(len(model["cell_block"]), bool)
        chosen[model["face_cells"][model["face_surface"] >= 0][_are_floors(model, count)].max(axis=1)] = True
        chosen &= ~np.array([*[False] * count, *fills], bool)[model["cell_block"]]
        return _tops(self.build, model, chosen, count)


def _are_floors(model: dict, count: int) -> np.ndarray:
    """(K,) bool: of the faces on sheets those that are on the first ones."""
    named = model["face_surface"]
    return named[named >= 0] < count


def _tops(build: Build, model: dict, chosen: np.ndarray, floors: int) -> list[Piece]:
    """What lies over some cells and under none of them; numbers of sheets are counted after the floors."""
    plan = model["vertices"][:, :2]
    triangles, face = fanned(model["face_offsets"], model["face_vertices"])
    a, b, c = model["vertices"][triangles].transpose(1, 0, 2)
    area = np.bincount(face, np.cross(b - a, c - a)[:, 2], len(model["face_surface"]))[face]
    number = model["face_surface"][face]
    # a face is seen counter-clockwise from outside of its first cell
    is_in = np.append(chosen, False)[model["face_cells"]][face]
    is_top = np.where(area > 0, is_in[:, 0] & ~is_in[:, 1], is_in[:, 1] & ~is_in[:, 0])
    is_top &= (number >= floors) & (orient2d(*plan[triangles].transpose(1, 0, 2)) * area > 0)
    found = []
    for of in np.unique(number[is_top]):
        used, corners = np.unique(triangles[is_top & (number == of)], return_inverse=True)
        sheet = np.ascontiguousarray(model["vertices"][used]), corners.reshape(-1, 3).astype(np.int32)
        found += [Piece(each, int(of) - floors) for each in _single_valued(build, sheet)]
    return found


def _single_valued(build: Build, sheet: Triangulation) -> list[Triangulation]:
    """A sheet as several ones: rounding may have put some of its triangles over others by a unit in the last
    place."""
    vertices, triangles = sheet
    aside: list[int] = []
    while True:
        kept = np.setdiff1d(np.arange(len(triangles)), aside)
        part = vertices, np.ascontiguousarray(triangles[kept])
        try:
            build([part], None, [_DEPOSITS], ())
        except native_module().InputError as error:
            if error.kind != "double_valued":
                raise
            aside.append(int(kept[error.items[1]]))
            continue
        if not aside:
            return [part]
        return [part, *_single_valued(build, (vertices, triangles[aside]))]


def distinct_plans(sheets: Sequence[Triangulation]) -> list[Triangulation]:
    """Of sheets, one of each that cover the same triangles in plan."""
    found: list[Triangulation] = []
    for sheet in sheets:
        if not any(_same_plan(sheet, other) for other in found):
            found.append(sheet)
    return found


def _same_plan(one: Triangulation, other: Triangulation) -> bool:
    return one is other or (
        np.array_equal(one[1], other[1]) and np.array_equal(one[0][:, :2], other[0][:, :2])
    )


def level(plan: Triangulation, height: float) -> Triangulation:
    """A level surface over what a sheet or a region covers."""
    vertices, triangles = plan
    return np.column_stack([vertices[:, :2], np.full(len(vertices), height)]), triangles
