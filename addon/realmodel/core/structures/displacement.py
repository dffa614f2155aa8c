# SPDX-License-Identifier: GPL-3.0-or-later
"""Throw and heave: the displacement of surfaces along each fault."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..algebra import dot, norm, principal_axes
from ..work import Work, run
from .rock_structure import RockStructure, Triangulation
from .sides import fault_sides
from .tips import trace_of

_ALONG = 2.0  # distances between places on a trace: the other side is looked for so far along the fault


@dataclass(frozen=True)
class Displacement:
    """Of one surface along one fault, at places (N, 3) where its sheet below the fault meets it: throw and
    heave (N,), model units. Throw is how much lower the upper side lies: positive at a normal fault, negative
    at a reverse one. Heave is how far its edge is from that of the lower side in plan, across the fault."""

    fault: str
    rock: str
    surface: str
    places: np.ndarray
    throw: np.ndarray
    heave: np.ndarray


def displacements(model) -> list[Displacement]:
    """The displacements of each fault of a model, for each surface that it displaces where it meets it."""
    if model.structures is None:
        return []
    return run(lambda work: _displacements(work, model))


def _displacements(work: Work, model) -> list[Displacement]:
    found = []
    for number, fault in enumerate(model.structures.faults):
        for entry in model.rock_inputs:
            structure = entry.structure
            if number not in structure.faults.numbers:
                continue
            at = structure.faults.numbers.index(number)
            for k in range(min(structure.faults.youngest[at], len(entry.surfaces) - 1) + 1):
                parts = [
                    _along(work, structure, at, k, below, above, model.threads)
                    for below, above in _sheet_pairs(structure, at, k)
                ]
                joined = [np.concatenate(each) for each in zip(*parts, strict=True)]
                if joined and len(joined[0]):
                    name = entry.rock.surfaces[k].name
                    found.append(Displacement(fault.name, entry.rock.name, name, *joined))
    return found


def _sheet_pairs(structure, fault: int, surface: int) -> list[tuple[int, int]]:
    """Compartments on the two sides of a fault, and on one side of each other that is on both sides of it;
    once for each two sheets of a surface."""
    rows = np.where(structure.faults.active(surface), structure.compartments, 0)
    pairs = {}
    for below in np.flatnonzero(rows[:, fault] < 0):
        for above in np.flatnonzero(rows[:, fault] > 0):
            same = (rows[below] == rows[above]) | (rows[below] == 0) | (rows[above] == 0)
            same[fault] = True
            if same.all():
                sheets = tuple(id(structure.sheets[each][surface]) for each in (below, above))
                pairs.setdefault(sheets, (int(below), int(above)))
    return list(pairs.values())


def throws_between(
    work: Work, structure: RockStructure, fault: int, surface: int, below: int, above: int, threads: int
) -> tuple[np.ndarray, np.ndarray]:
    """places (N, 3) and throw (N,) of a surface along a fault, between two compartments."""
    return _along(work, structure, fault, surface, below, above, threads)[:2]


def _along(work: Work, structure, fault: int, surface: int, below: int, above: int, threads: int):
    """places (N, 3), throw and heave (N,) of two sheets along a fault."""
    shape = structure.faults.shapes[fault]
    rows = np.where(structure.faults.active(surface), structure.compartments[[below, above]], 0)
    wanted = np.where(rows[0] != 0, rows[0], rows[1])
    wanted[fault] = 0

    def within(points: np.ndarray) -> np.ndarray:
        found = np.ones(len(points), bool)
        for other in np.flatnonzero(wanted):
            found &= fault_sides(work, points, structure.faults.shapes[other], threads) == wanted[other]
        return found

    low, high = (
        _trace(work, structure.sheets[each][surface], shape, within, threads) for each in (below, above)
    )
    nothing = np.empty((0, 3)), np.empty(0), np.empty(0)
    if len(low) < 2 or len(high) < 2:
        return nothing
    normal = _normals(low, shape)
    level = norm(normal[:, :2])
    steep = level > 1e-9
    low, normal = low[steep], normal[steep]
    across = normal[:, :2] / level[steep, None]
    along = np.column_stack([-across[:, 1], across[:, 0]])
    places, throw, heave = [], [], []
    apart = np.diff(high[np.argsort(dot(high, principal_axes(high)[1][0]))], axis=0)
    step = _ALONG * float(np.median(norm(apart)))
    for place, direction, sideways in zip(low, along, across, strict=True):
        away = high - place
        shift = dot(away[:, :2], direction)
        before, after = np.where(shift <= 0, shift, -np.inf), np.where(shift >= 0, shift, np.inf)
        one, other = int(before.argmax()), int(after.argmin())
        if before[one] < -step or after[other] > step:
            continue
        share = 0.0 if after[other] == before[one] else -before[one] / (after[other] - before[one])
        there = away[one] + share * (away[other] - away[one])
        places.append(place)
        throw.append(-there[2])
        heave.append(abs(dot(there[:2], sideways)))
    return (np.array(places).reshape(-1, 3), np.array(throw), np.array(heave)) if places else nothing


def _trace(work: Work, sheet: Triangulation, shape, within, threads: int) -> np.ndarray:
    """(M, 3) places at which a sheet meets a fault, in the compartment."""
    trace = trace_of(work, sheet, shape, within, threads)
    places = np.column_stack([trace.points, trace.heights])
    return places[within(places)] if len(places) else places


def _normals(places: np.ndarray, shape: Triangulation) -> np.ndarray:
    """(N, 3) of length 1: those of the fault's triangles whose middles are nearest."""
    corners = shape[0][shape[1]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= norm(normals)[:, None]
    middles = corners.mean(axis=1)
    return normals[[int(((middles - place) ** 2).sum(axis=1).argmin()) for place in places]]
