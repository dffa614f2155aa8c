# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of sides of faults that die out, each with the heights that count near its compartment alone.

Twelve faults that overlap in plan leave some hundred rows, but at one node few of them are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...base.triangles import Sheet
from ...base.work import Work, native_module
from ...surfaces.rock_structure import FaultShape, fault_sides

_RINGS = 2  # of triangles around those in which a compartment is


SideRow = tuple[int, ...]  # the side of each of some faults: -1, 1, or 0 where it is not


def with_neighbors(triangles: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """(N,) bool: some nodes, and those that share a triangle with one of them."""
    near = nodes.copy()
    near[triangles[nodes[triangles].any(axis=1)]] = True
    return near


def triangles_met(
    work: Work, fault: FaultShape, low: np.ndarray, high: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """(T,) uint8: the triangles that a fault touches, 1, or passes, 2, beyond its ends, between two
    heights."""
    triangles = np.ascontiguousarray(triangles)
    return work.native(native_module().structure_beyond, fault.native(), low, high, triangles)


def near_rows(
    work: Work,
    mesh: Sheet,
    common: np.ndarray,
    faults: Sequence[FaultShape],
    rows: Sequence[SideRow],
    values_of: Callable[[SideRow, np.ndarray], np.ndarray],
) -> dict[SideRow, np.ndarray]:
    """Values (N, C) at the nodes of a planar mesh, first of all heights, of each row of sides.

    They are the row's own where its compartment may be at some height that the row has there, and those in
    `common` elsewhere.

    common: (N, C), what is seen without regard to the faults; NaN where it has no height. rows: the sides of
    each fault, 0 where it is not. values_of: (K, C) of one row at some nodes, (N,) bool, K of them; it is
    asked for no node twice.
    """
    plan, triangles = mesh
    values = {sides: common.copy() for sides in rows}
    asked = {sides: np.zeros(len(plan), bool) for sides in rows}
    on = {(number, side): np.zeros(len(plan), bool) for number in range(len(faults)) for side in (-1, 1)}
    low, high = common[:, 0].copy(), common[:, 0].copy()
    wider = np.isfinite(low)
    while wider.any():
        _add_sides(work, mesh, wider, (low, high), faults, on)
        corner_on = {key: mask[triangles].any(axis=1) for key, mask in on.items()}
        wider = np.zeros(len(plan), bool)
        for sides in rows:
            is_there = np.ones(len(triangles), bool)
            for number, side in enumerate(sides):
                if side:
                    is_there &= corner_on[number, side]
            near = np.zeros(len(plan), bool)
            near[triangles[is_there]] = True
            for _ in range(_RINGS):
                near = with_neighbors(triangles, near)
            some = near & ~asked[sides]
            if some.any():
                asked[sides] |= some
                values[sides][some] = values_of(sides, some)
                z = values[sides][:, 0]
                wider |= some & ((z < low) | (z > high))
                low, high = np.fmin(low, z), np.fmax(high, z)
    return values


def _add_sides(
    work: Work,
    mesh: Sheet,
    some: np.ndarray,
    heights: Sequence[np.ndarray],
    faults: Sequence[FaultShape],
    on: dict,
) -> None:
    """Adds to `on`, by fault and side, those of some nodes at which a height is on that side, and those of
    triangles that the fault passes between the heights, beyond its ends."""
    plan, triangles = mesh
    places = np.unique(
        np.concatenate([np.column_stack([np.flatnonzero(some), z[some]]) for z in heights]), axis=0
    )
    node = places[:, 0].astype(np.int64)
    places = np.column_stack([plan[node], places[:, 1]])
    low, high = (np.column_stack([plan, np.nan_to_num(z)]) for z in heights)
    changed = triangles[some[triangles].any(axis=1)]
    for number, fault in enumerate(faults):
        side = fault_sides(work, places, fault)
        is_passed = triangles_met(work, fault, low, high, changed) > 0
        for its in (-1, 1):
            on[number, its][node[side == its]] = True
            on[number, its][changed[is_passed]] = True
