# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds that contradict a point of their surface, or one another: over one position in plan, as a surface
may have any heights elsewhere. The fewest are left out (bounded.consistent), and listed with the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...heights.bounded import consistent
from ...heights.mis_ties import without_mis_ties
from ...project.project import Rock, Surface
from ...readers.tables.observations import Bounds, LeftOut, Origin
from .surface_data import SurfaceData

_LISTED = 4  # others that a text names; all are in `contradicts`


def without_contradictions(
    rock: Rock, data: Sequence[SurfaceData]
) -> tuple[list[SurfaceData], list[LeftOut]]:
    """The data of the surfaces of a rock mass without faults, without bounds that contradict; and these
    bounds. Those of a surface that goes through places on its bounds, as it has no points, stay as they
    are."""
    consistent_data, left_out = list(data), list[LeftOut]()
    for number, (surface, surface_data) in enumerate(zip(rock.surfaces, data, strict=True)):
        bounds = surface_data.bounds
        if (
            not (len(bounds) and len(surface_data.points))
            or surface_data.is_along_bounds
            or not rock.is_interpolated(surface)
        ):
            continue
        points, _ = without_mis_ties(surface_data.points)
        wrong = consistent(np.ascontiguousarray(points), bounds).left_out
        if not len(wrong):
            continue
        left_out += [_listed(surface, surface_data, bounds, wrong, row) for row in wrong.tolist()]
        is_kept = np.ones(len(bounds), bool)
        is_kept[wrong] = False
        consistent_data[number] = replace(surface_data, bounds=bounds.some(is_kept))
    return consistent_data, left_out


def _listed(surface: Surface, data: SurfaceData, bounds: Bounds, wrong: np.ndarray, row: int) -> LeftOut:
    """A bound that is left out, with the points and the bounds that are not which it contradicts."""
    place, is_lower = bounds.places[row], bool(bounds.is_lower[row])
    sign = 1.0 if is_lower else -1.0
    others = []
    for number in np.flatnonzero((data.points[:, :2] == place[:2]).all(axis=1)).tolist():
        height = float(data.points[number, 2])
        if sign * (place[2] - height) > 0:
            others.append(f"{data.source_text(number)}: '{surface.name}' lies at {height:.9g}")
    over = (bounds.places[:, :2] == place[:2]).all(axis=1) & (bounds.is_lower != is_lower)
    over &= sign * (place[2] - bounds.places[:, 2]) > 0
    over[wrong] = False
    others += [_said(surface, bounds, other) for other in np.flatnonzero(over).tolist()]
    named = "; ".join(others[:_LISTED])
    text = f"{_said(surface, bounds, row)}, which contradicts {named}"
    return LeftOut(
        "contradiction",
        text,
        "",
        *Origin.of(bounds.holes[row], bounds.depths[row])[:2],
        tuple(place.tolist()),
        tuple(others),
    )


def _said(surface: Surface, bounds: Bounds, row: int) -> str:
    side = "above" if bounds.is_lower[row] else "below"
    return f"{bounds.source(row)}: '{surface.name}' lies at or {side} {bounds.places[row, 2]:.9g}"
