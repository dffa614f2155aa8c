# SPDX-License-Identifier: GPL-3.0-or-later
"""Families, compartments that share the data of a surface, and what of lines lies in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.algebra import norm
from ...base.triangles import extents, segments_hit, shares_hit
from ...base.work import Work, native_module
from ...surfaces.rock_structure import FaultShape, RockFaults, RockStructure, fault_sides

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


_ON = 1e-9  # of the extent of a line: nearer points are in a plane
_LEAST = 1e-12  # of a line: shorter parts are rounding


@dataclass
class CompartmentTest:
    """Whether points lie in the compartments of a family of surface `number` of a rock mass."""

    work: Work
    structure: RockStructure
    number: int
    family: Family
    known: tuple[np.ndarray, np.ndarray] | None = None  # a box and its walls

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """(N,) bool of points (N, 3). A fault that neither ends at another one nor dies out is only asked for
        what those before it have left."""
        faults, key = self.structure.faults, self.family.key
        active, asked = faults.active(self.number), parting(faults, self.number)
        plain = [
            n for n in asked if active[n] and key[n] in (-1, 1) and not (faults.ends[n] or faults.dies_out[n])
        ]
        left = np.arange(len(points))
        for fault in plain:
            left = left[fault_sides(self.work, points[left], faults.shapes[fault]) == key[fault]]
        sides = np.ones((len(left), len(faults)), np.int8)
        sides[:, plain] = np.array(key, np.int8)[plain]
        for fault in [n for n in asked if n not in plain]:
            sides[:, fault] = fault_sides(self.work, points[left], faults.shapes[fault])
        is_inside = np.zeros(len(points), bool)
        is_inside[left] = self.has(faults.without_dropped(sides))
        return is_inside

    def has(self, sides: np.ndarray) -> np.ndarray:
        """(N,) bool of points with these sides (N, F) of the faults."""
        keys = keys_of(self.structure, self.number, sides)
        keys[:, list(self.family.branches)] = DIES_OUT
        return (keys == self.family.key).all(axis=1)

    def walls(self, box: np.ndarray) -> np.ndarray:
        """(M, 3, 3) triangles of all faults and of what continues them in a box (2, 3): between them nothing
        changes."""
        faults = self.structure.faults
        if not parting(faults, self.number):
            return np.empty((0, 3, 3))
        if self.known is None or (box[0] < self.known[0][0]).any() or (box[1] > self.known[0][1]).any():
            wider = box if self.known is None else box_of(box, self.known[0])
            self.known = wider, walls_of(faults.shapes, wider)
        return self.known[1]


def walls_of(shapes: list[FaultShape], box: np.ndarray) -> np.ndarray:
    """(M, 3, 3) triangles of faults and of what continues them in a box (2, 3)."""
    walls = [np.empty((0, 3, 3))]
    for shape in shapes:
        beyond = native_module().structure_continuation(shape.native(), np.ascontiguousarray(box))
        corners = np.concatenate([shape.vertices[shape.triangles], beyond.reshape(-1, 3, 3)])
        low, high = extents(corners)
        walls.append(corners[((low <= box[1]) & (high >= box[0])).all(axis=1)])
    return np.concatenate(walls)


def parts_of_lines(
    begin: np.ndarray, end: np.ndarray, walls: np.ndarray, number: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Of lines from begin to end (K, 3) the parts between two places where they meet triangles (M, 3, 3): the
    number (N,) of the line of each part, and the shares (N, 2) of the line at which it begins and ends.

    A line in the plane of a triangle is divided where it passes the planes through its edges. number: (K,) of
    lines; those with one number are divided alike.
    """
    number = np.arange(len(begin)) if number is None else number
    pairs = native_module().meeting_boxes(np.stack([begin, end, end], axis=1), walls)
    line = pairs[:, 0]
    corners = walls[pairs[:, 1]]
    first, last = begin[line], end[line]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    near = _ON * norm(np.ptp(box_of(begin, end, walls), axis=0)) * size
    off = [np.abs(((at - corners[:, 0]) * normal).sum(axis=1)) for at in (first, last)]
    flat = (off[0] <= near) & (off[1] <= near)
    hit = ~flat & segments_hit(first, last, corners)
    owners = [np.repeat(np.arange(len(begin)), 2), line[hit]]
    shares = [np.tile([0.0, 1.0], len(begin)), shares_hit(first[hit], last[hit], corners[hit])]
    for corner in range(3):
        a, b = corners[flat, corner], corners[flat, (corner + 1) % 3]
        outward = np.cross(b - a, normal[flat])
        low, high = (((at[flat] - a) * outward).sum(axis=1) for at in (first, last))
        crosses = low * high < 0
        owners.append(line[flat][crosses])
        shares.append((low / np.where(crosses, low - high, 1.0))[crosses])
    owner, share = number[np.concatenate(owners)], np.concatenate(shares)
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    is_part = (owner[1:] == owner[:-1]) & (share[1:] - share[:-1] > _LEAST)
    return owner[1:][is_part], np.stack([share[:-1], share[1:]], axis=1)[is_part]


def middles_of_parts(begin: np.ndarray, end: np.ndarray, walls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As parts_of_lines, with the midpoints (N, 3) of the parts."""
    line, shares = parts_of_lines(begin, end, walls)
    return line, begin[line] + shares.mean(axis=1)[:, None] * (end - begin)[line]


def box_of(*places: np.ndarray) -> np.ndarray:
    """(2, 3) corners around points (..., 3)."""
    every = np.concatenate([points.reshape(-1, 3) for points in places])
    return np.array([every.min(axis=0), every.max(axis=0)])
