# SPDX-License-Identifier: GPL-3.0-or-later
"""Level sets of a scalar field, with contacts on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from ..base.algebra import are_among, norm
from ..base.triangles import Sheet
from ..base.work import Work, native_module
from .lattice import ScalarField

_Field = TypeVar("_Field", bound=ScalarField)
_SHARED = 0.1  # of what contacts miss their levels by: where more is left at first they share corners
_ROUNDS = 10  # in which what is left is made less
_LEAST = 2.0**-10  # of the edges of the lattice: shorter ones are not halved
_BESIDE = 0.01  # of the range of f in its tetrahedron: what a contact may miss its level by


@dataclass(frozen=True, eq=False)
class HeldData:
    """What continues to hold: a field rises at dips (D, 3) along normals (D, 3), and at bounds (B, 3) it is,
    as signs (B,) say, at least levels (B,) or, where -1, at most."""

    dips: np.ndarray
    normals: np.ndarray
    bounds: np.ndarray
    signs: np.ndarray
    levels: np.ndarray


@dataclass(frozen=True, eq=False)
class SharedCorners:
    """What fields of one lattice have in common, each being one function on its side of faults that die out.

    same: (F, nodes) int64: field * nodes + node of the first field that has the same node. has: (F, C) bool:
    the fields of which each contact is a corner.
    """

    same: np.ndarray
    has: np.ndarray

    def have(self, corners: np.ndarray, middles: np.ndarray) -> np.ndarray:
        """(F, N) bool: the fields that have corners (N,): nodes as `same` counts them, then the middles of
        edges, which the fields (F, M) have."""
        nodes = self.same.size
        is_node = corners < nodes
        of_nodes = self.same[:, np.where(is_node, corners, 0) % self.same.shape[1]] == corners
        of_middles = np.zeros_like(of_nodes)
        of_middles[:, ~is_node] = middles[:, corners[~is_node] - nodes]
        return np.where(is_node, of_nodes, of_middles)


def fields_with_contacts(
    work: Work,
    fields: Sequence[_Field],
    contacts: np.ndarray,
    surfaces: np.ndarray,
    shared: SharedCorners,
    held: HeldData | None = None,
) -> list[_Field]:
    """Fields of one lattice with contacts (C, 3) as corners of tetrahedra, at which they have the level of
    their surfaces (C,) exactly. Before that their values are moved as little as they must be to have these
    levels there nearly: a corner alone would be a peak beside its surface where that passes another
    tetrahedron. Where contacts are denser than nodes, so that it cannot have them all, tetrahedra are halved
    along their longest edges (M. C. Rivara 1984) until it can. Nodes on a level but for next to nothing are
    moved onto it. What fields share stays the same in them. held: then fields have as few critical points as
    contacts and these allow, and those that are left."""
    levels = fields[0].levels[surfaces]
    made = _Joined(work, fields, np.ascontiguousarray(contacts, np.float64), shared)

    def through(corners: np.ndarray, weights: np.ndarray, rounds: int) -> tuple[np.ndarray, np.ndarray]:
        solve = native_module().values_through
        return work.native(solve, made.values, corners, weights, levels, rounds)

    while True:
        corners, weights = made.tetrahedra()
        missed = [np.abs(through(corners, weights, rounds)[1]) for rounds in (0, 1)]
        off = (missed[1] > _BESIDE * np.ptp(made.values[corners], axis=1)) & (missed[1] > _SHARED * missed[0])
        ends = made.halved(corners[off])
        if not len(ends):
            values, _ = through(corners, weights, _ROUNDS)
            ends = made.halved(corners[made.missed(made.fields_through(values, levels))])
        if not made.add_middles(ends):
            break
    corners, weights = made.tetrahedra()
    values, _ = through(corners, weights, _ROUNDS)
    joined = made.fields_through(values, levels)
    return joined if held is None else made.rising(joined, held)


class _Joined:
    """Fields of one lattice with the middles of halved edges, as one array of values: of all nodes, as
    `SharedCorners` counts them, then of the middles (M, 3), which are corners of the fields `of_middles` (F,
    M)."""

    def __init__(
        self, work: Work, fields: Sequence[ScalarField], contacts: np.ndarray, shared: SharedCorners
    ):
        self.work, self.fields, self.contacts, self.shared = work, fields, contacts, shared
        self.values = np.concatenate([field.values for field in fields])
        self.middles = np.empty((0, 3))
        self.of_middles = np.empty((len(fields), 0), bool)

    def _numbers(self, field: int) -> np.ndarray:
        """Where the corners of a field, nodes and then middles, are in the array of all values."""
        middles = self.shared.same.size + np.flatnonzero(self.of_middles[field])
        return np.concatenate([self.shared.same[field], middles])

    def tetrahedra(self) -> tuple[np.ndarray, np.ndarray]:
        """(C, 4) the corners of the tetrahedra of the contacts, by their places in the array, and the weights
        of these; each contact in the first field that has it."""
        corners = np.empty((len(self.contacts), 4), np.int64)
        weights = np.empty((len(self.contacts), 4))
        first = self.shared.has.argmax(axis=0)
        for number, field in enumerate(self.fields):
            numbers = self._numbers(number)
            of_middles, here = numbers[field.lattice.nodes :], np.flatnonzero(first == number)
            at = replace(
                field,
                values=self.values[numbers[: field.lattice.nodes]],
                points=self.middles[self.of_middles[number]],
                point_values=self.values[of_middles],
            )
            lattice, values, points = at.native()
            tetrahedra = self.work.native(
                native_module().tetrahedra_at, lattice, values, points, self.contacts[here]
            )
            corners[here], weights[here] = numbers[tetrahedra[0]], tetrahedra[1]
        return corners, weights

    def fields_through(self, values: np.ndarray, levels: np.ndarray) -> list:
        """The fields with these values, and contacts with levels (C,) as corners. A node that fields share is
        moved onto a level as the first of them has it."""
        nodes, moved_fields = self.fields[0].lattice.nodes, []
        moved = np.empty(self.shared.same.size)
        for number, field in enumerate(self.fields):
            numbers = self._numbers(number)
            has = self.shared.has[number]
            lattice, _, _ = field.native()
            nodal = values[numbers[:nodes]]
            moved[number * nodes :][:nodes] = native_module().moved_onto_levels(lattice, nodal, field.levels)
            moved_fields.append(
                replace(
                    field,
                    values=moved[self.shared.same[number]],
                    points=np.concatenate([self.middles[self.of_middles[number]], self.contacts[has]]),
                    point_values=np.concatenate([values[numbers[nodes:]], levels[has]]),
                )
            )
        return moved_fields

    def rising(self, fields: list, held: HeldData) -> list:
        """The fields with as few critical points as contacts, held data and nodes that they share allow."""
        rising_fields, same, middles = [], self.shared.same, self.of_middles
        is_shared = np.bincount(same.ravel(), minlength=same.size) > 1
        for number, field in enumerate(fields):
            lattice, values, points = field.native()
            fixed = np.ones(len(values) + len(field.points), np.uint8)
            fixed[: len(values)] = is_shared[same[number]]
            has_middle = middles[:, middles[number]]
            fixed[len(values) :][: has_middle.shape[1]] = has_middle.sum(axis=0) > 1
            solve = native_module().without_critical_points
            dips, bounds = (held.dips, held.normals), (held.bounds, held.signs, held.levels)
            values, of_points, left = self.work.native(solve, lattice, values, points, fixed, dips, bounds)
            values = native_module().moved_onto_levels(lattice, values, field.levels)
            rising_fields.append(replace(field, values=values, point_values=of_points, critical_points=left))
        return rising_fields

    def missed(self, fields: list) -> np.ndarray:
        """(C,) bool: the contacts that the level sets of some field do not pass through."""
        is_missed = np.zeros(len(self.contacts), bool)
        for number, field in enumerate(fields):
            lattice, values, points = field.native()
            passed = self.work.native(native_module().points_between, lattice, values, points)
            numbers = np.flatnonzero(self.shared.has[number])
            is_missed[numbers] |= passed[len(passed) - len(numbers) :] == 0
        return is_missed

    def halved(self, tetrahedra: np.ndarray) -> np.ndarray:
        """(N, 2) the ends of the longest edges of tetrahedra (T, 4), each once, but of those that are
        small."""
        edges = tetrahedra[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]]
        ends = self._positions(edges)
        length = norm(ends[:, :, 1] - ends[:, :, 0])
        longest = edges[np.arange(len(edges)), length.argmax(axis=1)]
        large = length.max(axis=1, initial=0.0) > _LEAST * max(self.fields[0].lattice.spacing)
        return np.unique(np.sort(longest[large], axis=1), axis=0)

    def add_middles(self, ends: np.ndarray) -> bool:
        """Makes the middles of edges (N, 2) corners of all fields that have both ends. False where all are
        there already."""
        have = self.shared.have(ends.ravel(), self.of_middles).reshape(len(self.fields), -1, 2).all(axis=2)
        middles = np.concatenate([self.middles, self._positions(ends).mean(axis=1)])
        of_middles = np.concatenate([self.of_middles, have], axis=1)
        for has_middle in of_middles:  # of two in one place a field has the first
            here = np.flatnonzero(has_middle)
            has_middle[here] = False
            has_middle[here[np.unique(middles[here], axis=0, return_index=True)[1]]] = True
        used = of_middles.any(axis=0)
        if used.sum() == len(self.middles):
            return False
        values = np.concatenate([self.values, self.values[ends].mean(axis=1)])
        nodes = self.shared.same.size
        self.values = np.concatenate([values[:nodes], values[nodes:][used]])
        self.middles, self.of_middles = middles[used], of_middles[:, used]
        return True

    def _positions(self, corners: np.ndarray) -> np.ndarray:
        """(..., 3) of corners: nodes and middles by their places in the array."""
        lattice = self.fields[0].lattice
        nodes = corners % lattice.nodes
        steps = np.stack(
            [nodes // stride % count for stride, count in zip(lattice.strides, lattice.counts, strict=True)],
            -1,
        )
        positions = lattice.origin + np.multiply(lattice.spacing, steps)
        is_middle = corners >= self.shared.same.size
        positions[is_middle] = self.middles[corners[is_middle] - self.shared.same.size]
        return positions


def are_on(contacts: np.ndarray, level_set: Sheet) -> np.ndarray:
    """(C,) bool: which contacts (C, 3) are vertices of a level set."""
    return are_among(contacts, level_set.vertices)


@dataclass(frozen=True, eq=False)
class LevelSolid:
    """Where a field is at most a level. boundary: closed beyond the sides of the lattice. count: of its
    triangles, the first of which are the level set."""

    boundary: Sheet
    count: int

    @property
    def level_set(self) -> Sheet:
        """Of the boundary what lies in the lattice."""
        part = self.boundary.some(np.arange(len(self.boundary.triangles)) < self.count)
        return Sheet(part.vertices, part.triangles)


def level_solids(work: Work, field: ScalarField) -> list[LevelSolid]:
    """One for each level. No two of them cross in the lattice. Triangles turn counter-clockwise seen from
    where the field is greater. Raises native InputError."""
    lattice, values, points = field.native()
    solids = work.native(native_module().level_sets, lattice, values, points, field.levels)
    return [LevelSolid(Sheet(vertices, triangles), count) for vertices, triangles, count in solids]
