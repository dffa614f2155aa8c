# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults in a series: the coordinates by which its field differs on their two sides.

Each is half of a fault's `mouth`, with the sign of the side. The mouth of one that divides all rock is
1. That of one that dies out is 0 on what continues it beyond its tips, and grows along it from there. On each
combination of sides of the faults the field is made at all nodes as if they were not there, but around such
a continuation, where it is one function: these nodes are the same for both sides, to the bit, and so are the
level sets between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.algebra import norm
from ..base.errors import InputRefused
from ..base.triangles import extents
from ..base.work import Work, native_module
from ..fields import Lattice, SharedCorners, SlitData
from ..settings.rules import RULES
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import FaultShape, fault_sides
from ..surfaces.wrong_sides import heights_at
from .field_warnings import within_rock
from .sheets.families import CompartmentTest, Family

_PIECE = 0.5  # of an edge of the lattice: what a continuation is divided into
_BESIDE = 1e-6  # of an edge of the lattice: what touches a cell is in it
_STEP = 0.5  # of an edge of the lattice: over which slopes at dips are measured


@dataclass(frozen=True, eq=False)
class Slit:
    """shape: of a fault. number: of the fault in the rock mass. pieces: (T, 3, 3) triangles of what continues
    it in the rock that it displaces, where it dies out. cells: (x, y, z) bool, those of the lattice that they
    meet. reach: how far the fault goes from its tips. ends: the slits, by their places among all, at which it
    ends, and the side of each that it is on; beyond their tips it has no mouth either, as the way round these
    leads to where it is not: pieces and cells are those of these slits, too."""

    shape: FaultShape
    number: int
    pieces: np.ndarray
    cells: np.ndarray
    reach: float
    ends: tuple[tuple[int, int], ...] = ()

    def opening(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) from 0 beyond its tips to at most 1."""
        if not len(self.pieces):  # it divides all rock
            return np.ones(len(points))
        nearest = native_module().nearest_triangles
        points = np.ascontiguousarray(points, np.float64)
        _, beyond = work.native(nearest, self.pieces, points)
        _, off = work.native(nearest, self.shape.vertices[self.shape.triangles], points)
        return beyond / (beyond + off + self.reach)


@dataclass(frozen=True, eq=False)
class Slits:
    """The faults that part a family of compartments, each after those at which it ends. combinations:
    (S, F) int8 of their sides that there are, 0 beyond a fault at which it ends; members: of each the
    compartments. of_nodes: (S, nodes, F) int8: of each the sides of nodes: beyond tips their own ones."""

    lattice: Lattice
    slits: list[Slit]
    combinations: np.ndarray
    members: list[list[int]]
    of_nodes: np.ndarray

    @classmethod
    def of(cls, entry: RockInput, family: Family, within: CompartmentTest, lattice: Lattice) -> Slits:
        """Those of a family, whose places `within` tells. Raises InputRefused."""
        faults = entry.divided().faults
        order = [number for number in faults.order() if number in family.dying]
        columns = [family.dying.index(number) for number in order]
        sides = sorted({tuple(row[at] for at in columns) for row in family.members.values()})
        members = [
            [n for n, row in family.members.items() if tuple(row[at] for at in columns) == combination]
            for combination in sides
        ]
        slits: list[Slit] = []
        for number in order:
            branches = [n for n, pairs in enumerate(faults.ends) if number in [other for other, _ in pairs]]
            dividing = [n for n in branches if not faults.dies_out[n]]
            if dividing and faults.dies_out[number]:
                raise InputRefused(
                    f"it dies out in a series with a field, and fault '{faults.names[dividing[0]]}', which "
                    "does not, ends at it",
                    item=f"fault '{faults.names[number]}'",
                    advice="let them cross, or make the other one die out, too",
                )
            ends = tuple((order.index(at), side) for at, side in faults.ends[number] if at in family.dying)
            slits.append(_slit(entry, number, within, lattice, [(at, side, slits[at]) for at, side in ends]))
        combinations = np.array(sides, np.int8).reshape(len(sides), -1)
        positions = lattice.positions()
        of_nodes = np.repeat(combinations[:, None], len(positions), axis=1)
        for n, slit in enumerate(slits):
            beyond = np.flatnonzero(_corners(slit.cells).ravel(order="F"))
            of_nodes[:, beyond, n] = fault_sides(within.work, positions[beyond], slit.shape)
            for at, side in slit.ends:
                of_nodes[of_nodes[:, :, at] == -side, n] = 0
        return cls(lattice, slits, combinations, members, of_nodes)

    def numbers(self, sides: np.ndarray) -> np.ndarray:
        """(N,) the combination that places are on, by their sides (N, faults) of all faults; 0 where there is
        none such."""
        slit_sides = sides[:, [slit.number for slit in self.slits]]
        return (slit_sides[None] == self.combinations[:, None]).all(axis=2).argmax(axis=0)

    def shared(self, points: np.ndarray, numbers: np.ndarray) -> SharedCorners:
        """What the fields have in common, with points (C, 3) on combinations (C,): one beyond tips is a
        corner of the fields on both sides."""
        beyond = self._columns([self._meets(slit, points) for slit in self.slits], len(points))
        alike = self.combinations[:, None] == self.combinations[numbers]
        return SharedCorners(self._same, (alike | (beyond > 0)).all(axis=2))

    def data(self, work: Work, parts: list[np.ndarray], numbers: np.ndarray) -> SlitData | None:
        """For the solver. parts: positions of contacts, dips and bounds, of all these the combinations
        (N,)."""
        if not self.slits:
            return None
        every = np.concatenate(parts)
        combinations = self.combinations[numbers]
        openings = self._columns([slit.opening(work, every) for slit in self.slits], len(every))
        ends = np.cumsum([len(part) for part in parts])[:2]
        contacts, dips, bounds = np.split(0.5 * combinations * openings, ends)
        _, of_dips, of_bounds = np.split(numbers, ends)
        slopes = np.empty((len(dips), len(self.slits), 3))
        step = _STEP * self.lattice.spacing[0]
        for axis in range(3):
            move = step * np.eye(3)[axis]
            ahead, behind = (self._beside(work, parts[1] + way, of_dips) for way in (move, -move))
            slopes[:, :, axis] = (ahead - behind) / (2 * step)
        positions = self.lattice.positions()
        openings = self._columns([slit.opening(work, positions) for slit in self.slits], len(positions))
        nodes = 0.5 * self.of_nodes * openings
        of_bounds = of_bounds.astype(np.int32)
        return SlitData(contacts, dips, bounds, slopes, self._normals(), nodes, self._same, of_bounds)

    def _normals(self) -> np.ndarray:
        """(F, 3) the normals of the faults, in the mean over their areas."""
        normals = np.empty((len(self.slits), 3))
        for n, slit in enumerate(self.slits):
            a, b, c = slit.shape.vertices[slit.shape.triangles].transpose(1, 0, 2)
            normals[n] = np.cross(b - a, c - a).sum(axis=0)
        size = norm(normals)[:, None]
        return np.where(size > 0, normals / np.where(size > 0, size, 1.0), [0.0, 0.0, 1.0])

    def _beside(self, work: Work, points: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """(N, F) the coordinates at points beside places on combinations (N,): beyond tips by their own
        sides, else as if no fault were between."""
        coordinates = self.combinations[numbers].astype(float)
        for n, slit in enumerate(self.slits):
            here = np.flatnonzero(self._meets(slit, points))
            coordinates[here, n] = fault_sides(work, points[here], slit.shape)
            for at, side in slit.ends:
                coordinates[coordinates[:, at] == -side, n] = 0.0
        openings = self._columns([slit.opening(work, points) for slit in self.slits], len(points))
        return 0.5 * coordinates * openings

    @cached_property
    def _same(self) -> np.ndarray:
        """(S, nodes) int64, as SlitData has it."""
        sides, nodes, _ = self.of_nodes.shape
        numbers = np.arange(sides * nodes).reshape(sides, nodes)
        for number in range(sides):
            for earlier in reversed(range(number)):
                alike = (self.of_nodes[number] == self.of_nodes[earlier]).all(axis=1)
                numbers[number, alike] = numbers[earlier, alike]
        return numbers

    def _meets(self, slit: Slit, points: np.ndarray) -> np.ndarray:
        """(N,) bool: which points lie in the cells of a slit, or touch them."""
        meets = np.zeros(len(points), bool)
        for way in np.stack(np.meshgrid(*[(-_BESIDE, _BESIDE)] * 3), -1).reshape(-1, 3):
            meets |= slit.cells[tuple(_cell_of(self.lattice, points, way).T)]
        return meets

    @staticmethod
    def _columns(columns: list[np.ndarray], count: int) -> np.ndarray:
        return np.column_stack([np.empty((count, 0)), *columns])


def _slit(
    entry: RockInput,
    number: int,
    within: CompartmentTest,
    lattice: Lattice,
    ends: list[tuple[int, int, Slit]],
) -> Slit:
    """The slit of a fault. ends: those at which it ends, with their places and the side that it is on."""
    structure = entry.divided()
    shape = structure.faults.shapes[number]
    box = np.ascontiguousarray(np.stack(lattice.corners))
    beyond = native_module().structure_continuation(shape.native(), box).reshape(-1, 3, 3)
    size = _PIECE * lattice.spacing[0]
    pieces = _divided(beyond if structure.faults.dies_out[number] else beyond[:0], size, box)
    pieces = pieces[_in_rock(entry, number, within, pieces, size)]
    for _, side, other in ends:
        pieces = pieces[fault_sides(within.work, pieces.mean(axis=1), other.shape) != -side]
    cells = np.zeros(np.subtract(lattice.counts, 1), bool)
    for corner in np.stack(np.meshgrid(*[(0, 1)] * 3), -1).reshape(-1, 3):
        at = np.where(corner, pieces.max(axis=1), pieces.min(axis=1)) if len(pieces) else np.empty((0, 3))
        cells[tuple(_cell_of(lattice, at, np.where(corner, _BESIDE, -_BESIDE)).T)] = True
    for _, _, other in ends:
        cells |= other.cells
        pieces = np.concatenate([pieces, other.pieces])
    reach = 0.0
    if len(pieces):
        vertices = shape.vertices[np.unique(shape.triangles)]
        near = vertices[((vertices >= box[0]) & (vertices <= box[1])).all(axis=1)]
        nearest = within.work.native(native_module().nearest_triangles, pieces, np.ascontiguousarray(near))
        reach = float(nearest[1].max(initial=lattice.spacing[0]))
    return Slit(shape, number, pieces, cells, reach, tuple((at, side) for at, side, _ in ends))


def _in_rock(
    entry: RockInput, number: int, within: CompartmentTest, pieces: np.ndarray, size: float
) -> np.ndarray:
    """(T,) bool: the pieces (T, 3, 3) of what continues a fault that lie in a family, or nearly so, where
    rock is that the fault displaces: not above a younger surface that cuts."""
    work, structure = within.work, entry.divided()
    low, high = extents(pieces)
    box = [np.where(corner, high, low) for corner in ([0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0])]
    raised = np.array([0.0, 0.0, size])
    is_in_rock = np.zeros(len(pieces), bool)
    for at in (*pieces.transpose(1, 0, 2), pieces.mean(axis=1), *box):
        rows = np.flatnonzero(within_rock(work, entry, at + raised) & within(at))
        for younger in range(structure.faults.youngest[number] + 1, len(entry.rock.surfaces)):
            surface = entry.rock.surfaces[younger]
            if (
                entry.rock.is_level_set(surface)
                or not RULES[surface.rule].cuts
                or not structure.is_made(younger)
            ):
                continue
            heights = np.full(len(rows), -np.inf)
            for compartment in within.family.members:
                z = heights_at(work, structure.sheet(compartment, younger), at[rows, :2])
                heights = np.fmax(heights, z)
            rows = rows[(at[rows, 2] - size <= heights) | np.isinf(heights)]
        is_in_rock[rows] = True
    return is_in_rock


def _divided(triangles: np.ndarray, size: float, box: np.ndarray) -> np.ndarray:
    """Triangles (T, 3, 3) in a box, halved along their longest edges until these are at most of a size."""
    pieces = [np.empty((0, 3, 3))]
    while len(triangles):
        low, high = extents(triangles)
        triangles = triangles[((low <= box[1]) & (high >= box[0])).all(axis=1)]
        lengths = norm(np.roll(triangles, -1, axis=1) - triangles)
        longest = lengths.argmax(axis=1)
        is_small = lengths.max(axis=1, initial=0.0) <= size
        pieces.append(triangles[is_small])
        corner, rows = longest[~is_small], triangles[~is_small]
        a, b, c = (rows[np.arange(len(rows)), (corner + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(pieces)


def _cell_of(lattice: Lattice, points: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """(N, 3) the cells of a lattice that points lie in, moved by a share of a cell."""
    places = np.floor((points - lattice.origin) / lattice.spacing + moved).astype(np.int64)
    return np.clip(places, 0, np.subtract(lattice.counts, 2))


def _corners(cells: np.ndarray) -> np.ndarray:
    """(x + 1, y + 1, z + 1) bool: the nodes of cells (x, y, z) bool."""
    nodes = np.zeros(np.add(cells.shape, 1), bool)
    nx, ny, nz = cells.shape
    for i, j, k in np.ndindex(2, 2, 2):
        nodes[i : i + nx, j : j + ny, k : k + nz] |= cells
    return nodes
