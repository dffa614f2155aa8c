# SPDX-License-Identifier: GPL-3.0-or-later
"""The compartments of a family of a surface, and what of lines lies in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.algebra import norm
from ...base.triangles import extents, segments_hit, shares_hit
from ...base.work import Work, native_module
from ...surfaces.rock_structure import RockStructure
from ...surfaces.sides import FaultShape, fault_sides
from .families import DIES_OUT, Family, keys_of, parting

_ON = 1e-9  # of the extent of a line: nearer points are in a plane
_LEAST = 1e-12  # of a line: shorter parts are rounding


@dataclass
class Within:
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
