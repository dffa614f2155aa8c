# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of neighbors in a compartment without enough data: continued beyond their fault, and several as
one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...base.algebra import dot, principal_axes
from ...base.work import Work, native_module
from ...surfaces.rock_structure import FaultShape, fault_sides
from ...surfaces.wrong_sides import Sheet
from .tips import trace_of

_FAR = 2.0  # ranges of its heights: a sheet that goes so far beyond them in another compartment is no guide
_ROUNDING = 1e-9  # of heights: level sheets differ by so much
_AT_ONCE = 1 << 20  # pairs of a place and a part of a line


def as_at_fault(work: Work, sheet: Sheet, fault: FaultShape, side: int) -> Sheet | None:
    """A sheet that has the height of the nearest place of its cutoff line everywhere beyond a fault. side: of
    the fault, on which the sheet is known. None where it does not meet the fault."""
    vertices, triangles = sheet
    line = _cutoff(work, sheet, fault)
    if len(line) < 2:
        return None
    z, beyond = vertices[:, 2].copy(), fault_sides(work, vertices, fault) != side
    z[beyond] = _nearest_heights(line, vertices[beyond, :2])
    return Sheet(np.column_stack([vertices[:, :2], z]), triangles)


def _cutoff(work: Work, sheet: Sheet, fault: FaultShape) -> np.ndarray:
    """(M, 3) places at which a sheet meets a fault, in the order of its strike."""
    trace = trace_of(work, sheet, fault, lambda points: np.ones(len(points), bool))
    places = np.unique(np.column_stack([trace.points, trace.heights]), axis=0)
    if len(places) < 2:
        return places
    along = dot(places[:, :2], principal_axes(places[:, :2])[1][0])
    return places[np.argsort(along, kind="stable")]


def _nearest_heights(line: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """(N,) the heights of a line (M, 3) at its places nearest to others (N, 2) in plan."""
    begin, step = line[:-1], np.diff(line, axis=0)
    size = dot(step[:, :2], step[:, :2])
    z = np.empty(len(plan))
    some = max(1, _AT_ONCE // len(begin))
    for start in range(0, len(plan), some):
        part = slice(start, start + some)
        away = plan[part, None] - begin[:, :2]
        share = np.clip(dot(away, step[:, :2]) / np.where(size > 0, size, 1.0), 0.0, 1.0)
        off = away - share[..., None] * step[:, :2]
        number = dot(off, off).argmin(axis=1)
        z[part] = begin[number, 2] + share[np.arange(len(number)), number] * step[number, 2]
    return z


def sheet_runs_away(sheet: Sheet, known: np.ndarray, within: Callable[[np.ndarray], np.ndarray]) -> bool:
    """Whether a sheet goes far beyond the heights that it has where it is known, (V,) bool, in the
    compartment in which points `within` lie."""
    vertices = sheet.vertices
    inside = within(vertices) & ~known
    if not inside.any() or not known.any():
        return False
    low, high = vertices[known, 2].min(), vertices[known, 2].max()
    lowest, highest = vertices[inside, 2].min(), vertices[inside, 2].max()
    rounding = _ROUNDING * max(abs(low), abs(high))
    return bool(max(low - lowest, highest - high) > _FAR * (high - low) + rounding)


def between_faults(
    work: Work,
    first: Sheet,
    heights: list[np.ndarray],
    faults: list[tuple[np.ndarray, FaultShape, int]],
) -> Sheet:
    """Several sheets as one, each with a weight of one over its distance from the fault across which it
    comes: so the throw of each fault is that of its own sheet. heights: (V,) of each sheet, at the vertices
    of the first. faults: of each sheet, places (M, 2) along its fault in plan, the fault, and on which side
    of it the sheet comes from. There no sheet counts from elsewhere."""
    plan, is_known = np.ascontiguousarray(first.vertices[:, :2]), np.isfinite(heights)
    nearest = native_module().nearest_points
    away = np.array([work.native(nearest, places, plan)[1][:, 0] for places, _, _ in faults])
    from_there = np.array(
        [
            fault_sides(work, np.column_stack([plan, np.nan_to_num(z)]), fault) == side
            for z, (_, fault, side) in zip(heights, faults, strict=True)
        ]
    )
    counts = is_known & (from_there | ~from_there.any(axis=0))
    counts[0] |= ~counts.any(axis=0)
    away = np.where(counts, away, np.inf)
    least = away.min(axis=0)
    share = np.where(away == least, 1.0, least / np.where(away > 0, away, 1.0))
    total = np.where(counts, share * heights, 0.0).sum(axis=0)
    z = total / np.where(counts, share, 0.0).sum(axis=0)
    return Sheet(np.column_stack([plan, z]), first.triangles)
