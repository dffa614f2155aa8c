# SPDX-License-Identifier: GPL-3.0-or-later
"""The trajectory of a deviated borehole between the stations where its direction was surveyed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ...base.elementary import atan2, cos, sin

Direction = tuple[float, float, float]  # of length 1: to the east, to the north, down
_STRAIGHT = 1e-12  # radians


def direction(inclination: float, azimuth: float) -> Direction:
    """inclination: degrees from the vertical, 0 straight down, 90 level, 180 straight up. azimuth: degrees
    clockwise from north (+y)."""
    tilt, turn = np.radians(inclination), np.radians(azimuth % 360.0)
    return sin(tilt) * sin(turn), sin(tilt) * cos(turn), cos(tilt)


class WellTrajectory:
    """A borehole by minimum curvature: between two stations, where its direction is known, it is the arc of a
    circle that has these directions at its ends; above the first and below the last it is straight.

    Taylor and Mason 1972, *A systematic approach to well surveying calculations*, SPE Journal 12; Sawaryn
    and Thorogood 2005, *A compendium of directional calculations based on the minimum curvature method*,
    SPE Drilling & Completion 20, section "Interpolation".
    """

    def __init__(self, depths: Sequence[float], directions: Sequence[Direction]):
        """depths (N,), N > 0: along the hole from its collar, each greater than the one before it.
        directions (N, 3): of length 1, no two neighbours opposite to each other."""
        self._depths = np.array(depths, float)
        self._directions = np.array(directions, float).reshape(-1, 3)
        begin, end = self._directions[:-1], self._directions[1:]
        self._doglegs = dogleg_angles(begin, end)
        self._doglegs[self._doglegs < _STRAIGHT] = 0.0
        across = end - (begin * end).sum(axis=1, keepdims=True) * begin
        length = np.linalg.norm(across, axis=1, keepdims=True)
        self._across = np.divide(across, length, out=np.zeros_like(across), where=length > _STRAIGHT)
        self._starts = np.empty_like(self._directions)  # from the collar to each station
        self._starts[0] = self._depths[0] * self._directions[0]
        for n, length in enumerate(np.diff(self._depths)):
            self._starts[n + 1] = self._starts[n] + self._along(n, length)

    @property
    def is_vertical(self) -> bool:
        """Whether the hole is vertical, up to the precision of survey tables."""
        return bool((np.abs(self._directions - (0.0, 0.0, 1.0)) < 1e-9).all())

    def offset(self, depth: float) -> np.ndarray:
        """(3,) how far to the east, to the north and down from the collar a depth along the hole is."""
        n = max(int(np.searchsorted(self._depths, depth, side="right")) - 1, 0)
        if n == len(self._depths) - 1 or depth <= self._depths[0]:
            return self._starts[n] + (depth - self._depths[n]) * self._directions[n]
        return self._starts[n] + self._along(n, depth - self._depths[n])

    def _along(self, n: int, length: float) -> np.ndarray:
        """The way of this length from station n towards the next one."""
        turned = self._doglegs[n] * length / (self._depths[n + 1] - self._depths[n])
        # (1 - cos t) / t = t / 2 (sin(t / 2) / (t / 2))^2
        sideways = turned / 2 * _sin_by(turned / 2) ** 2 * self._across[n]
        return length * (_sin_by(turned) * self._directions[n] + sideways)


def _sin_by(x: float) -> float:
    """sin(x) / x."""
    return sin(x) / x if x else 1.0


def dogleg_angles(begin: ArrayLike, end: ArrayLike) -> np.ndarray:
    """(...) the angles in radians between directions (..., 3) of length 1; as exact for small ones as for
    large."""
    begin, end = np.asarray(begin, float), np.asarray(end, float)
    return 2 * atan2(np.linalg.norm(begin - end, axis=-1), np.linalg.norm(begin + end, axis=-1))
