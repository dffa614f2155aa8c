# SPDX-License-Identifier: GPL-3.0-or-later
"""Square pegs that hold the beds of a print together: where there is room for them.

A peg stands on a bed and reaches into the one above it. Its sides are vertical, as faults are: beds are put
together by lowering one onto the other. Whether there is room is looked up on a lattice of vertical lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.algebra import dot, norm, ranks_in_runs
from .beds import Beds
from .strata import Strata

_PER_PEG = 3  # lines of the lattice along the side of a peg
_MOST_LINES = 160  # along a side of the box
_OFF = np.array([0.317, 0.441])  # of a step: lattices through the corners of a mesh would meet it in edges


@dataclass(frozen=True, eq=False)
class Pegs:
    """The pegs on the boundaries between beds. side: of all. places: of each boundary, from below, their
    centers (P, 2) along and across the direction `Beds.across`, from the middle of the box. heights: (N,) of
    those of each boundary."""

    side: float
    places: list[np.ndarray]
    heights: np.ndarray

    @property
    def count(self) -> int:
        """How many there are."""
        return sum(map(len, self.places))


def place_pegs(beds: Beds, strata: Strata, vertices: np.ndarray, triangles: np.ndarray) -> Pegs:
    """Places up to strata.pegs on the boundary above each bed but the last, far from each other, where the
    mesh has rock around them. None is on an unconformity or on a fault."""
    side, tilted, slant = strata.peg_size, len(beds.levels), beds.slant
    plan, z = vertices[:, :2], np.minimum(vertices[:, 2], beds.floor)
    top = float((z - beds.datum(plan, beds.strips(plan))).max())
    upper = np.append(beds.covers, beds.high[2]) if math.isfinite(beds.floor) else beds.covers
    heights = np.minimum(side, 0.5 * np.append(np.diff(beds.levels, append=top), np.diff(upper)))
    places = [np.empty((0, 2)) for _ in heights]
    if not strata.pegs:
        return Pegs(side, places, heights)
    lines = _Lines(beds, side, vertices, triangles)
    for boundary, height in enumerate(heights.tolist()):
        level = lines.datum + beds.levels[boundary] if boundary < tilted else beds.covers[boundary - tilted]
        gap = strata.gap * (slant if boundary < tilted else 1.0)
        low, high = level - 0.5 * height - gap, level + 1.5 * height + gap
        inside = lines.are_inside(low, high)
        if math.isfinite(beds.floor):
            inside &= high < beds.floor if boundary < tilted else low > beds.floor
        places[boundary] = lines.spread(inside, side + strata.gap, strata.pegs)
    return Pegs(side, places, heights)


class _Lines:
    """Vertical lines on a lattice, and where they cross a closed mesh."""

    def __init__(self, beds: Beds, side: float, vertices: np.ndarray, triangles: np.ndarray):
        axes = beds.axes
        plan = dot((vertices[:, :2] - beds.middle)[:, None], axes)
        low, high = plan.min(axis=0), plan.max(axis=0)
        self._step = max(side / _PER_PEG, float((high - low).max()) / _MOST_LINES)
        self._counts = np.maximum(((high - low) / self._step).astype(int) + 1, 1)
        begin = low + _OFF * self._step
        row, column = np.divmod(np.arange(self._counts.prod()), self._counts[1])
        self._places = begin + self._step * np.column_stack([row, column])
        points = dot(self._places[:, None], axes.T) + beds.middle
        strips = beds.strips(points)
        self.datum = beds.datum(points, strips)
        along, positions, _ = beds.fault
        across = dot(points - beds.middle, along)
        self._from_faults = np.abs(across[:, None] - positions).min(axis=1, initial=np.inf)
        self._line, self._z = self._crossings((plan - begin) / self._step, vertices[:, 2], triangles)

    def _crossings(
        self, plan: np.ndarray, z: np.ndarray, triangles: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The line and the elevation of each crossing with a triangle. plan: (V, 2) in steps."""
        corners = plan[triangles]
        first = np.maximum(np.ceil(corners.min(axis=1)).astype(int), 0)
        last = np.minimum(np.floor(corners.max(axis=1)).astype(int), self._counts - 1)
        sizes = np.maximum(last - first + 1, 0)
        numbers = sizes.prod(axis=1)
        of = np.repeat(np.arange(len(triangles)), numbers)
        nodes = first[of] + np.column_stack(np.divmod(ranks_in_runs(numbers), np.maximum(sizes[of, 1], 1)))
        a, b, c = (corners[of, k] - nodes for k in range(3))
        shares = np.column_stack([_cross(b, c), _cross(c, a), _cross(a, b)])
        area = shares.sum(axis=1)
        met = ((shares >= 0).all(axis=1) | (shares <= 0).all(axis=1)) & (area != 0)
        heights = (shares * z[triangles][of]).sum(axis=1)[met] / area[met]
        return nodes[met, 0] * self._counts[1] + nodes[met, 1], heights

    def are_inside(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """(N,) whether each line is inside the mesh from one elevation to another."""
        low, high = (np.broadcast_to(level, len(self._places)) for level in (low, high))
        below, upto = (
            np.bincount(self._line[self._z < level[self._line]], minlength=len(self._places))
            for level in (low, high)
        )
        return (below % 2 == 1) & (below == upto)

    def spread(self, inside: np.ndarray, reach: float, most: int) -> np.ndarray:
        """(P, 2) places far from each other around which all lines within a reach are inside, and no fault
        is."""
        far = math.ceil(reach / self._step)
        padded = np.pad(inside.reshape(self._counts), far)
        rooms = np.lib.stride_tricks.sliding_window_view(padded, (2 * far + 1, 2 * far + 1))
        free = rooms.all(axis=(2, 3)).ravel() & (self._from_faults > 1.5 * reach)
        places = self._places[free]
        if not len(places):
            return places
        apart = norm(places - places.mean(axis=0))
        chosen = [int(apart.argmin() if most == 1 else apart.argmax())]
        apart = np.full(len(places), np.inf)
        while len(chosen) < most:
            apart = np.minimum(apart, norm(places - places[chosen[-1]]))
            if apart.max() < 3.0 * reach:
                break
            chosen.append(int(apart.argmax()))
        return places[chosen]


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
