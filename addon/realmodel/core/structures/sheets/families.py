# SPDX-License-Identifier: GPL-3.0-or-later
"""Families: compartments that share the data of a surface, separated only by faults that die out or do not
displace it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...surfaces.rock_structure import RockStructure
from ...surfaces.sides import RockFaults

DIES_OUT = 2  # in a key: a fault that dies out is there, on either side


@dataclass(frozen=True)
class Family:
    """key: of each fault -1 or +1, the side; 0, it is not there or does not displace the surface; 2, it dies
    out here. members: the sides of the latter, -1 or +1 each, by compartment. branches: of several families
    together the faults that end at one that dies out: 2 in the key, 0 in members where they are not. settled:
    of these families the faults beyond whose tips the sheets are equal already."""

    key: tuple[int, ...]
    members: dict[int, tuple[int, ...]]
    branches: tuple[int, ...] = ()
    settled: tuple[int, ...] = ()

    @property
    def dying(self) -> list[int]:
        """The faults that die out here."""
        return [fault for fault, side in enumerate(self.key) if side == DIES_OUT]

    def with_ends(self, some: list[int], faults: RockFaults) -> list[int]:
        """Some of the faults that die out here, as numbers among these, and those at which they end: where
        these are not themselves, sheets beside the others may still differ on their two sides."""
        dying, numbers = self.dying, set(some)
        waiting = list(some)
        while waiting:
            for other, _ in faults.ends[dying[waiting.pop()]]:
                if other in dying and (number := dying.index(other)) not in numbers:
                    numbers.add(number)
                    waiting.append(number)
        return sorted(numbers)


def keys_of(structure: RockStructure, number: int, sides: np.ndarray) -> np.ndarray:
    """(N, F) of rows of sides: the key of the family that each belongs to, for surface `number`. A fault of
    which no throw is found parts nothing.

    Where a fault that dies out ends at another one that does, it is there beyond that, too: the way round its
    tips leads there, so data are not parted.
    """
    faults = structure.faults
    active, dies_out = faults.active(number), np.array(faults.dies_out, bool)
    steps = (structure.steps or {}).get(number)
    if steps is not None:
        active &= steps.heights != 0.0
    rows = np.where(active, sides, 0)
    keys = np.where(dies_out & (rows != 0), DIES_OUT, rows)
    for branch in np.flatnonzero(active & dies_out):
        ends = faults.ends[branch]
        if any(dies_out[other] for other, _ in ends):
            masks = [rows[:, other] != -side for other, side in ends if not dies_out[other]]
            keys[np.all(masks, axis=0) if masks else slice(None), branch] = DIES_OUT
    return keys


def parting(faults: RockFaults, number: int) -> list[int]:
    """The faults whose sides decide in which family of surface `number` a place is. One that dies out and
    neither ends at another nor has one end at it parts nothing."""
    active = np.flatnonzero(faults.active(number)).tolist()
    waiting = [n for n in active if faults.ends[n] or not faults.dies_out[n]]
    numbers = set(waiting)
    while waiting:
        others = {other for other, _ in faults.ends[waiting.pop()]} - numbers
        numbers |= others
        waiting += others
    return sorted(numbers)


def families(structure: RockStructure, number: int) -> list[Family]:
    """The families of all compartments of a rock mass, for surface `number`."""
    by_key: dict[tuple[int, ...], Family] = {}
    rows = structure.compartments
    for compartment, key in enumerate(map(tuple, keys_of(structure, number, rows).tolist())):
        family = by_key.setdefault(key, Family(key, {}))
        family.members[compartment] = tuple(rows[compartment, family.dying].tolist())
    return list(by_key.values())


def around_tips(structure: RockStructure, number: int, every: list[Family]) -> list[Family]:
    """Families together that only branches of a fault that dies out part, which do not die out themselves:
    past its tips, where these branches are not, their sheets are one."""
    faults = structure.faults
    active = faults.active(number)
    branches = tuple(
        branch
        for branch, ends in enumerate(faults.ends)
        if active[branch] and not faults.dies_out[branch] and any(faults.dies_out[other] for other, _ in ends)
    )
    if not branches:
        return []
    ended_at = {other for branch in branches for other, _ in faults.ends[branch]}
    settled = tuple(
        fault for fault, dies_out in enumerate(faults.dies_out) if dies_out and fault not in ended_at
    )
    by_key: dict[tuple[int, ...], Family] = {}
    for family in every:
        key = tuple(DIES_OUT if fault in branches else side for fault, side in enumerate(family.key))
        together = by_key.setdefault(key, Family(key, {}, branches, settled))
        for compartment in family.members:
            together.members[compartment] = tuple(
                structure.compartments[compartment, together.dying].tolist()
            )
    return list(by_key.values())
