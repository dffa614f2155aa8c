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
_HALVINGS = 3  # they make a tetrahedron half as large
_NEAR = 3  # tetrahedra from one contact to another, over corners that they share
_EDGES = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]  # of a tetrahedron
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
    made = _Joined(work, fields, np.ascontiguousarray(contacts, np.float64), levels, shared)
    everything = np.arange(len(contacts))
    while True:
        made.find_tetrahedra(everything)
        if made.refine(made.crowded(everything)):
            continue
        joined = made.fields_through()
        if not made.refine(made.missed(joined), _HALVINGS):
            return joined if held is None else made.rising(joined, held)


class _Joined:
    """Fields of one lattice with the middles of halved edges, as one array of values: of all nodes, as
    `SharedCorners` counts them, then of the middles (M, 3), which are corners of the fields `of_middles` (F,
    M)."""

    def __init__(
        self,
        work: Work,
        fields: Sequence[ScalarField],
        contacts: np.ndarray,
        levels: np.ndarray,
        shared: SharedCorners,
    ):
        self.work, self.fields, self.shared = work, fields, shared
        self.contacts, self.levels = contacts, levels
        self.values = np.concatenate([field.values for field in fields])
        self.middles = np.empty((0, 3))
        self.of_middles = np.empty((len(fields), 0), bool)
        # of each contact the corners of its tetrahedron, by their places in the array, and their weights
        self.corners = np.empty((len(contacts), 4), np.int64)
        self.weights = np.empty((len(contacts), 4))

    def _numbers(self, field: int) -> np.ndarray:
        """Where the corners of a field, nodes and then middles, are in the array of all values."""
        middles = self.shared.same.size + np.flatnonzero(self.of_middles[field])
        return np.concatenate([self.shared.same[field], middles])

    def find_tetrahedra(self, contacts: np.ndarray) -> None:
        """Finds the tetrahedra of contacts, given by their numbers (N,), each in the first field that has
        it."""
        first = self.shared.has[:, contacts].argmax(axis=0)
        for number, field in enumerate(self.fields):
            numbers = self._numbers(number)
            of_middles, here = numbers[field.lattice.nodes :], contacts[first == number]
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
            self.corners[here], self.weights[here] = numbers[tetrahedra[0]], tetrahedra[1]

    def _through(self, contacts: np.ndarray, rounds: int) -> tuple[np.ndarray, np.ndarray]:
        """The values with which contacts (N,) have their levels nearly, and what each misses its level by."""
        at = (self.corners[contacts], self.weights[contacts], self.levels[contacts])
        return self.work.native(native_module().values_through, self.values, *at, rounds)

    def crowded(self, contacts: np.ndarray) -> np.ndarray:
        """Those of some contacts (N,) that share corners with others, so that the field cannot have their
        levels."""
        values = self.values[self.corners[contacts]]
        at_first = self.levels[contacts] - (self.weights[contacts] * values).sum(axis=1)
        missed = np.abs(self._through(contacts, 1)[1])
        return contacts[(missed > _BESIDE * np.ptp(values, axis=1)) & (missed > _SHARED * np.abs(at_first))]

    def refine(self, contacts: np.ndarray, halvings: int = 1) -> bool:
        """Halves the tetrahedra of contacts (N,) so many times, and then those of contacts near them that are
        crowded, until none is, as far as is seen from near them. False where nothing could be halved."""
        is_refined = False
        while len(contacts) and self._halve(contacts):
            is_refined = True
            if halvings > 1:
                halvings -= 1
                continue
            near = np.zeros(len(self.values), bool)
            for _ in range(_NEAR):
                near[self.corners[contacts]] = True
                contacts = np.flatnonzero(near[self.corners].any(axis=1))
            contacts = self.crowded(contacts)
        return is_refined

    def _halve(self, contacts: np.ndarray) -> bool:
        """Halves the tetrahedra of contacts (N,); False where none of them could be."""
        ends = self.halved(self.corners[contacts])
        if not self.add_middles(ends):
            return False
        has_halved = np.isin(self._edge_numbers(self.corners[:, _EDGES]), self._edge_numbers(ends))
        self.find_tetrahedra(np.flatnonzero(has_halved.any(axis=1)))
        return True

    def fields_through(self) -> list:
        """The fields with contacts as corners, and as little moved as they must be to have their levels
        there. A node that fields share is moved onto a level as the first of them has it."""
        values, _ = self._through(np.arange(len(self.contacts)), _ROUNDS)
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
                    point_values=np.concatenate([values[numbers[nodes:]], self.levels[has]]),
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
        """(N,) the contacts that the level sets of some field do not pass through."""
        is_missed = np.zeros(len(self.contacts), bool)
        for number, field in enumerate(fields):
            lattice, values, points = field.native()
            passed = self.work.native(native_module().points_between, lattice, values, points)
            numbers = np.flatnonzero(self.shared.has[number])
            is_missed[numbers] |= passed[len(passed) - len(numbers) :] == 0
        return np.flatnonzero(is_missed)

    def halved(self, tetrahedra: np.ndarray) -> np.ndarray:
        """(N, 2) the ends of the longest edges of tetrahedra (T, 4), each once, but of those that are
        small."""
        edges = tetrahedra[:, _EDGES]
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

    def _edge_numbers(self, ends: np.ndarray) -> np.ndarray:
        """(...) a number for each edge (..., 2)."""
        return ends.min(axis=-1) * len(self.values) + ends.max(axis=-1)

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
