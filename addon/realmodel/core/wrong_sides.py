# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface that lie where the rules do not let the surface be: usually errors in the data."""

from __future__ import annotations

from collections.abc import Iterable

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


def points_too_low(work: Work, entry, numbers: Iterable[int], threads: int) -> list[BuildWarning]:
    """The points of surfaces of a RockInput, by their numbers, below what the rule of each keeps it above,
    where heights of all older ones are known. Each older surface is asked once for the points of all.

    A surface that does not cut ends on the top that is there, and any surface on one that protects itself; a
    minimum thickness keeps it above the one before it. What an older surface's points do above a younger
    one is no contradiction: there the younger one ends, or has cut.
    """
    surfaces = entry.rock.surfaces
    beneath = {
        number: _Beneath(len(surfaces[number].points))
        for number in numbers
        if number > 0 and surfaces[number].points is not None and len(surfaces[number].points)
    }
    for older in range(max(beneath, default=0)):
        younger = [number for number in beneath if number > older]
        if entry.surfaces[older] is None:
            continue
        plan = np.concatenate([surfaces[number].points[:, :2] for number in younger])
        z = heights_at(work, entry.surfaces[older], plan, threads)
        ends = np.cumsum([len(surfaces[number].points) for number in younger])
        for number, own in zip(younger, np.split(z, ends[:-1]), strict=True):
            beneath[number].add(own, older, RULES[surfaces[older].rule])
    warnings = []
    for number, found in beneath.items():
        surface = surfaces[number]
        floor = found.firm if RULES[surface.rule].cuts else found.top
        if surface.minimum_thickness is not None and entry.surfaces[number - 1] is not None:
            floor.raise_to(found.last, number - 1)
        warnings += listed(entry.rock, number, floor.z - surface.points[:, 2], "below", floor.surface)
    return warnings


class _Beneath:
    """What there is beneath (N,) points: the top, and what may not be cut; last: the heights of the youngest
    surface of those that were added, oldest first."""

    def __init__(self, count: int):
        self.top, self.firm = _Floor(count), _Floor(count)
        self.last: np.ndarray | None = None

    def add(self, z: np.ndarray, number: int, rule) -> None:
        own = _Floor(len(z))
        own.raise_to(z, number)
        covered = np.isfinite(z)
        if not rule.cuts:
            own.raise_to(np.where(covered, self.top.z, np.nan), self.top.surface)
        own.raise_to(np.where(covered, self.firm.z, np.nan), self.firm.surface)
        self.top.take(own, covered)
        if rule.protects:
            self.firm.take(own, covered)
        self.last = z


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
