# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface that lie where the rules do not let the surface be: usually errors in the data."""

from __future__ import annotations

import numpy as np

from .build_warning import BuildWarning
from .errors import place_text
from .project import Rock
from .rules import RULES
from .work import Work, native_module

Triangulation = tuple[np.ndarray, np.ndarray]


def heights_at(work: Work, shape: Triangulation, plan: np.ndarray, threads: int) -> np.ndarray:
    """(N,) heights of a surface at places (N, 2), NaN where it has none."""
    surface_heights = native_module().surface_heights
    return work.native(surface_heights, *shape, np.ascontiguousarray(plan), threads=threads)


def points_too_low(work: Work, entry, number: int, threads: int) -> list[BuildWarning]:
    """The points of a surface of a RockInput below what its rule keeps it above, where heights of all older
    ones are known.

    A surface that does not cut ends on the top that is there, and any surface on one that protects itself; a
    minimum thickness keeps it above the one before it. What an older surface's points do above a younger
    one is no contradiction: there the younger one ends, or has cut.
    """
    rock = entry.rock
    surface = rock.surfaces[number]
    points = surface.points
    if number == 0 or points is None or not len(points):
        return []
    top, firm = _Floor(len(points)), _Floor(len(points))
    before = None
    for older in range(number):
        if entry.surfaces[older] is None:
            continue
        before = heights_at(work, entry.surfaces[older], points[:, :2], threads)
        own = _Floor(len(points))
        own.raise_to(before, older)
        covered = np.isfinite(before)
        if not RULES[rock.surfaces[older].rule].cuts:
            own.raise_to(np.where(covered, top.z, np.nan), top.surface)
        own.raise_to(np.where(covered, firm.z, np.nan), firm.surface)
        top.take(own, covered)
        if RULES[rock.surfaces[older].rule].protects:
            firm.take(own, covered)
    floor = firm if RULES[surface.rule].cuts else top
    if surface.minimum_thickness is not None and entry.surfaces[number - 1] is not None:
        floor.raise_to(before, number - 1)
    return listed(rock, number, floor.z - points[:, 2], "below", floor.surface)


class _Floor:
    """(N,) heights, and the surface that each is of."""

    def __init__(self, count: int):
        self.z = np.full(count, -np.inf)
        self.surface = np.full(count, -1)

    def raise_to(self, z: np.ndarray, surface) -> None:
        higher = z > self.z  # never where NaN
        self.z = np.where(higher, z, self.z)
        self.surface = np.where(higher, surface, self.surface)

    def take(self, other: _Floor, where: np.ndarray) -> None:
        self.z = np.where(where, other.z, self.z)
        self.surface = np.where(where, other.surface, self.surface)


def listed(rock: Rock, number: int, beyond: np.ndarray, side: str, others) -> list[BuildWarning]:
    """What to tell of points (N,) so far beyond other surfaces; others: their numbers, one or (N,)."""
    surface = rock.surfaces[number]
    wrong = np.flatnonzero(beyond > 0)
    if not len(wrong):
        return []
    numbers = np.unique(np.broadcast_to(others, beyond.shape)[wrong])
    names = " and ".join(f"'{rock.surfaces[n].name}'" for n in numbers)
    worst = wrong[int(beyond[wrong].argmax())]
    text = (
        f"{len(wrong)} of its {len(beyond)} points lie {side} {names}, the farthest by "
        f"{beyond[worst]:.4g}: point {worst} at {place_text(surface.points[worst])}"
    )
    return [BuildWarning(text, "wrong_side", rock.name, surface.name, tuple(int(i) for i in wrong))]
