# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds that contradict a point of their surface, or one another: over one position in plan, as a surface
may have any heights elsewhere. The fewest are left out (bounded.consistent), and listed with the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...heights.bounded import consistent
from ...heights.mis_ties import without_mis_ties
from ...project.project import Rock, Surface
from ...readers.tables.observations import Bounds, LeftOut, Observations, source_text

_LISTED = 4  # others that a text names; all are in `contradicts`


def without_contradictions(rock: Rock, observations: Observations) -> tuple[Rock, list[LeftOut]]:
    """A rock mass without faults, without bounds that contradict; and these bounds. Those of a surface that
    goes through places on its bounds, as it has no points, stay as they are."""
    surfaces, left_out = list(rock.surfaces), []
    for number, surface in enumerate(surfaces):
        bounds = surface.bounds
        if not surface.interpolated or bounds is None or not len(bounds) or not len(surface.point_array()):
            continue
        if surface.is_along_bounds:
            continue
        points, _ = without_mis_ties(surface.point_array())
        wrong = consistent(np.ascontiguousarray(points), bounds).left_out
        if not len(wrong):
            continue
        left_out += [_listed(surface, points, bounds, wrong, row, observations) for row in wrong.tolist()]
        kept = np.ones(len(bounds), bool)
        kept[wrong] = False
        surfaces[number] = replace(surface, bounds=bounds.some(kept))
    return replace(rock, surfaces=surfaces), left_out


def _listed(
    surface: Surface, points: np.ndarray, bounds: Bounds, wrong: np.ndarray, row: int, given: Observations
) -> LeftOut:
    """A bound that is left out, with the points and the bounds that are not which it contradicts."""
    place, is_lower = bounds.places[row], bool(bounds.is_lower[row])
    sign = 1.0 if is_lower else -1.0
    others = []
    for point in points[(points[:, :2] == place[:2]).all(axis=1)]:
        if sign * (place[2] - point[2]) > 0:
            same = np.flatnonzero((given.places == point).all(axis=1))
            at = given.source(int(same[0])) if len(same) else source_text("", np.nan, point)
            others.append(f"{at}: '{surface.name}' lies at {point[2]:.9g}")
    over = (bounds.places[:, :2] == place[:2]).all(axis=1) & (bounds.is_lower != is_lower)
    over &= sign * (place[2] - bounds.places[:, 2]) > 0
    over[wrong] = False
    others += [_said(surface, bounds, other) for other in np.flatnonzero(over).tolist()]
    named = "; ".join(others[:_LISTED])
    text = f"{_said(surface, bounds, row)}, which contradicts {named}"
    depth = float(bounds.depths[row])
    return LeftOut(
        "contradiction",
        text,
        "",
        str(bounds.holes[row]),
        None if np.isnan(depth) else depth,
        tuple(place.tolist()),
        tuple(others),
    )


def _said(surface: Surface, bounds: Bounds, row: int) -> str:
    side = "above" if bounds.is_lower[row] else "below"
    return f"{bounds.source(row)}: '{surface.name}' lies at or {side} {bounds.places[row, 2]:.9g}"
