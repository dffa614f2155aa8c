# SPDX-License-Identifier: GPL-3.0-or-later
"""What younger surfaces make of the inside of a void.

What was there is gone, but it is remembered where nothing ever was, and what was protected: younger surfaces
fill the void from the top of the former, and below the top of the latter they cut nothing, though it is air
now. Both tops are found by building the older surfaces alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..rules import RULES
from ..work import native_module
from .exact import orient2d
from .located import fanned
from .rock_structure import Triangulation

_DEPOSITS, _CUTS = "conformable", "erosional"
_FAR = 1.0  # ranges of heights below everything: where there is rock for sure

# (sheets, region, rules) to the arrays of a model of columns
Build = Callable[[list[Triangulation], Triangulation | None, list[str]], dict]


class Piece(NamedTuple):
    """A part of a top, and the number of the sheet that it is of."""

    sheet: Triangulation
    of: int


class Older(NamedTuple):
    """sheets, rules: of the surfaces before a void or body. region: that of the rock mass, or None."""

    build: Build
    sheets: Sequence[Triangulation]
    rules: Sequence[str]
    region: Triangulation | None

    @property
    def plans(self) -> list[Triangulation]:
        """Triangulations that cover what the sheets cover."""
        return distinct_plans(self.sheets)

    def _built(self, sheets, rules, region) -> dict:
        """The model of sheets upon one more for each plan, far below all."""
        heights = [vertices[:, 2] for vertices, _ in (*self.sheets, *sheets) if len(vertices)]
        low, high = min(each.min() for each in heights), max(each.max() for each in heights)
        far = float(low - _FAR * (high - low) - 1.0)
        floors = [level(plan, far) for plan in self.plans]
        return self.build([*floors, *sheets], region, [*[_DEPOSITS] * len(floors), *rules])

    def never(self, fills: Sequence[bool]) -> list[Piece]:
        """The top of what is below the oldest surface, where there is one. fills: sheets that fill bodies:
        nothing is below these."""
        model = self._built(self.sheets, self.rules, self.region)
        count = len(self.plans)
        chosen = np.zeros(len(model["cell_block"]), bool)
        chosen[model["face_cells"][model["face_surface"] >= 0][_are_floors(model, count)].max(axis=1)] = True
        chosen &= ~np.array([*[False] * count, *fills], bool)[model["cell_block"]]
        return _tops(self.build, model, chosen, count)

    def protected(self) -> list[Piece]:
        """The top of what is protected: of the rock when each surface that protects came, where that is."""
        found = []
        for k, rule in enumerate(self.rules):
            if not RULES[rule].protects:
                continue
            model = self._built(self.sheets[: k + 1], self.rules[: k + 1], _plan(self.sheets[k]))
            found += _tops(self.build, model, np.ones(len(model["cell_block"]), bool), len(self.plans))
        return found

    def lower(self, tops: list[Piece], sheet: Triangulation, number: int) -> list[Piece]:
        """The lower one of tops, the highest of them, and of a sheet, where there are both."""
        rules = [*[_DEPOSITS] * len(tops), _CUTS]
        model = self._built([*(piece.sheet for piece in tops), sheet], rules, _plan(sheet))
        last = len(self.plans) + len(tops)
        found = _tops(self.build, model, model["cell_block"] < last, len(self.plans))
        of = [*(piece.of for piece in tops), number]
        return [Piece(piece.sheet, of[piece.of]) for piece in found]

    def above(self, tops: list[Piece], sheet: Triangulation) -> list[Piece]:
        """What of tops, the highest of them, lies above a sheet, or where that is not."""
        model = self._built([sheet, *(piece.sheet for piece in tops)], [_DEPOSITS] * (1 + len(tops)), None)
        first = len(self.plans) + 1
        found = _tops(self.build, model, model["cell_block"] >= first, first)
        return [Piece(piece.sheet, tops[piece.of].of) for piece in found]


def _plan(sheet: Triangulation) -> Triangulation:
    """What a sheet covers, as a region."""
    return np.ascontiguousarray(sheet[0][:, :2]), sheet[1]


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
            build([part], None, [_DEPOSITS])
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
