# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations of blocks on a geological map: two at each place on the line between two of them, which make a
contact, and places within polygons."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.algebra import norm, ranks_in_runs
from ...base.errors import number_list, place_text
from ...base.work import native_module, on_threads
from ...readers.tables.observations import LeftOut, Observations, unknown_block
from ...readers.tables.unit_names import UnitNames
from ...readers.unit_polygons import UnitPolygon
from .polygon_borders import Apart, BorderLine, border_lines, inside, places_along

_NEAR_BORDER = 0.25  # of the spacing: places within polygons are farther from their borders
_NEAR_FAULT = 0.25  # of the spacing: nearer to a fault, it may be this that divides two blocks
# Of the diagonal of the box: how far lines are taken to be off. A map half a meter wide, drawn to a
# millimeter, is off by less than half of it, but along a line by as much for a good way.
_ACCURACY = 1 / 200
_OF_RELIEF = 0.1**2  # of the variance of the ground's heights: contacts that are off by more say little
_LISTED = 6
_LINES = 3  # across a small polygon, the farthest from its corners first

Heights = Callable[[np.ndarray], np.ndarray]  # of places (N, 2), (N,), NaN where the ground is not known


@dataclass(frozen=True)
class MapFrame:
    """Where and how densely a map is read. box: (2, 2) low and high corners in plan; spacing: of places;
    faults: (N, 2) lines that no contact lies on; heights: of the ground; accuracy: how far other lines may be
    off, None where it is not said."""

    box: np.ndarray
    spacing: float
    faults: Sequence[np.ndarray]
    heights: Heights
    accuracy: float | None

    def height_errors(self, plan: np.ndarray, relief: np.ndarray) -> np.ndarray:
        """(N,) by how much contacts at places (N, 2) on lines are off where these are as far off as they may
        be, across the contours; 0 where the ground is not known. relief: (P,) heights of the ground."""
        accuracy, squares = self.accuracy, np.zeros(len(plan))
        if accuracy is None:
            accuracy = _ACCURACY * float(norm(self.box[1] - self.box[0]))
        if not accuracy or not len(plan):
            return squares
        for axis in np.eye(2) * accuracy:
            rise = 0.5 * (self.heights(plan + axis) - self.heights(plan - axis))
            squares += np.where(np.isfinite(rise), rise, 0.0) ** 2
        most = squares.mean()
        if self.accuracy is None:
            most = min(most, _OF_RELIEF * float(np.nanvar(relief)))
        return np.sqrt(squares * (most / squares.mean())) if most > 0 else np.zeros(len(plan))

    def covers(self, plan: np.ndarray) -> np.ndarray:
        """(N,) bool: which places (N, 2) lie in the box."""
        return ((plan >= self.box[0]) & (plan <= self.box[1])).all(axis=1)


def observed_on_map(
    polygons: list[UnitPolygon], units: UnitNames, frame: MapFrame
) -> tuple[Observations, list[LeftOut], list[str]]:
    """The observations of a map, what of it is not used, and warnings, sentences. Places on a line between
    two blocks are about a spacing apart, at its corners where there are some; so are those within polygons,
    each of which has at least one."""
    blocks, left_out = _blocks(polygons, units)
    names = sorted(set(blocks) - {""})
    classes = np.array([names.index(block) if block else -1 for block in blocks])
    lines, apart = border_lines(polygons, classes, frame.spacing)
    warnings = _gaps(polygons, classes, apart)
    borders = _Near([_closed(ring) for polygon in polygons for ring in polygon.rings], frame.spacing / 8)
    on_lines = _contacts(polygons, classes, lines, frame)
    within, overlaps = _within(polygons, classes, borders, frame)
    left_out += overlaps
    plan = np.concatenate([np.repeat(on_lines[0], 2, axis=0), within[0]])
    of_class = np.concatenate([on_lines[1].ravel(), within[1]])
    z = frame.heights(plan) if len(plan) else np.empty(0)
    of_lines = frame.height_errors(on_lines[0], z)
    errors = np.concatenate([np.repeat(of_lines, 2), np.zeros(len(within[0]))])
    is_known = np.isfinite(z)
    if not is_known.all():
        missing = np.unique(plan[~is_known], axis=0)
        text = f"{len(missing)} places of the map are where the ground is not known, and are left out"
        warnings.append(f"{text}: one is at {place_text(missing[0].tolist())}")
    places = np.column_stack([plan, z])[is_known]
    blocks_there = np.array([*names, ""])[of_class[is_known]]
    return Observations(places, blocks_there, height_errors=errors[is_known]), left_out, warnings


def _blocks(polygons: list[UnitPolygon], units: UnitNames) -> tuple[list[str], list[LeftOut]]:
    """The block of each polygon, by the name that UnitNames gives it; "" for none. A feature of several
    polygons is left out once."""
    blocks, left_out = [], dict[str, LeftOut]()
    for polygon in polygons:
        block = "" if units.says_nothing(polygon.unit) else units.block(polygon.unit)
        if block is None:
            left_out[polygon.item] = unknown_block(f"{polygon.item}, '{polygon.unit}'", polygon.unit)
        blocks.append(block or "")
    return blocks, list(left_out.values())


def _gaps(polygons: list[UnitPolygon], classes: np.ndarray, apart: list[Apart]) -> list[str]:
    said = []
    for joined, what in ((True, "which count as one line"), (False, "where no contact is seen")):
        listed = [
            f"{polygons[a].item} and {polygons[b].item} (up to {gap.width:.3g} along {gap.length:.3g})"
            for gap in apart
            for a, b in [gap.polygons]
            if gap.joined == joined and classes[a] >= 0 and classes[b] >= 0
        ]
        if listed:
            text = f"{len(listed)} pairs of polygons have gaps or overlaps between their borders, {what}"
            said.append(f"{text}: {number_list(listed, _LISTED)}")
    return said


class _Near:
    """Lines (N, 2), and how far places are from them, to a part of a step."""

    def __init__(self, lines: Sequence[np.ndarray], step: float):
        parts = [np.empty((0, 2))]
        for line in lines:
            way = np.diff(line, axis=0)
            count = np.maximum(np.ceil(norm(way) / step), 1).astype(np.int64)
            edge = np.repeat(np.arange(len(way)), count)
            share = ranks_in_runs(count) / count[edge]
            parts += [line[edge] + share[:, None] * way[edge], line[-1:]]
        self._points = np.concatenate(parts)

    def distance(self, plan: np.ndarray) -> np.ndarray:
        """(N,) of places (N, 2)."""
        if not (len(self._points) and len(plan)):
            return np.full(len(plan), np.inf)
        return native_module().nearest_points(self._points, plan, execution=on_threads(0))[1][:, 0]


def _closed(ring: np.ndarray) -> np.ndarray:
    return np.concatenate([ring, ring[:1]])


def _contacts(
    polygons: list[UnitPolygon], classes: np.ndarray, lines: list[BorderLine], frame: MapFrame
) -> tuple[np.ndarray, np.ndarray]:
    """Places (C, 2) on lines between blocks, and the two classes (C, 2) there."""
    plan, beside = [np.empty((0, 2))], [np.empty((0, 2), np.int64)]
    for line in lines:
        if min(line.classes) >= 0:
            places, edge = places_along(line, frame.spacing)
            plan.append(places)
            beside.append(line.polygons[edge])
    contacts, sides = np.concatenate(plan), np.concatenate(beside)
    is_kept = frame.covers(contacts)
    is_kept[is_kept] = (
        _Near(frame.faults, frame.spacing / 16).distance(contacts[is_kept]) > _NEAR_FAULT * frame.spacing
    )
    contacts, sides = contacts[is_kept], sides[is_kept]
    # another polygon lies over both, as of a unit that was drawn later
    hidden = np.zeros(len(contacts), bool)
    for number, rows in _in_boxes(polygons, contacts):
        rows_below = rows[(classes[sides[rows]] != classes[number]).all(axis=1)]
        hidden[rows_below] |= inside(polygons[number].rings, contacts[rows_below])
    return contacts[~hidden], classes[sides[~hidden]]


def _within(
    polygons: list[UnitPolygon], classes: np.ndarray, borders: _Near, frame: MapFrame
) -> tuple[tuple[np.ndarray, np.ndarray], list[LeftOut]]:
    """Places (N, 2) within polygons and the class of each (N,); and the polygons that overlap."""
    low, high = frame.box
    axes = [np.arange(low[k] + 0.5 * frame.spacing, high[k], frame.spacing) for k in (0, 1)]
    plan = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    plan = plan[borders.distance(plan) > _NEAR_BORDER * frame.spacing]
    owner = np.full(len(plan), -1)
    seen = np.zeros(len(polygons), bool)
    for number, rows in _in_boxes(polygons, plan):
        rows_within = rows[inside(polygons[number].rings, plan[rows])]
        seen[number] = len(rows_within) > 0
        owner[rows_within] = np.where(owner[rows_within] < 0, number, owner[rows_within])
    more = [_middle(polygon, frame.box) for number, polygon in enumerate(polygons) if not seen[number]]
    alone = np.flatnonzero(~seen)
    at = np.array(more).reshape(-1, 2)
    is_here = np.isfinite(at).all(axis=1)
    is_here[is_here] = frame.covers(at[is_here])
    plan, owner = np.concatenate([plan, at[is_here]]), np.concatenate([owner, alone[is_here]])
    claimed: dict[tuple[int, int], list[int]] = {}
    for number, rows in _in_boxes(polygons, plan):
        others = rows[(owner[rows] >= 0) & (classes[owner[rows]] != classes[number])]
        for row in others[inside(polygons[number].rings, plan[others])].tolist():
            claimed.setdefault((int(min(owner[row], number)), int(max(owner[row], number))), []).append(row)
    left_out = []
    for (a, b), those in claimed.items():
        text = (
            f"{polygons[a].item} and {polygons[b].item} overlap, as at {place_text(plan[those[0]].tolist())}"
        )
        left_out.append(LeftOut("overlap", text, polygons[a].unit))
    twice = np.unique([row for rows in claimed.values() for row in rows]).astype(np.int64)
    is_kept = owner >= 0
    is_kept[twice] = False
    is_kept &= classes[owner] >= 0
    return (plan[is_kept], classes[owner[is_kept]]), left_out


def _in_boxes(polygons: list[UnitPolygon], plan: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """The number of each polygon whose box has places (N, 2), and their rows."""
    order = np.argsort(plan[:, 0], kind="stable")
    x = plan[order, 0]
    for number, polygon in enumerate(polygons):
        corners = np.concatenate(polygon.rings)
        low, high = corners.min(axis=0), corners.max(axis=0)
        rows = order[np.searchsorted(x, low[0]) : np.searchsorted(x, high[0], "right")]
        rows = rows[(plan[rows, 1] >= low[1]) & (plan[rows, 1] <= high[1])]
        if len(rows):
            yield number, np.sort(rows)


def _middle(polygon: UnitPolygon, box: np.ndarray) -> np.ndarray:
    """A place (2,) within a polygon and a box (2, 2): the middle of the longest part of a line across it; NaN
    where they have no area in common."""
    begin = np.concatenate(polygon.rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in polygon.rings])
    (left, bottom), (right, top) = box.tolist()
    heights = np.unique(np.clip(begin[:, 1], bottom, top))
    best, middle = 0.0, np.full(2, np.nan)
    steps = np.diff(heights)
    for tried, at in enumerate(np.argsort(-steps, kind="stable")):
        if tried >= _LINES and best > 0:
            break
        y = heights[at] + 0.5 * steps[at]
        crosses = (begin[:, 1] < y) != (end[:, 1] < y)
        share = (y - begin[crosses, 1]) / (end[crosses, 1] - begin[crosses, 1])
        x = np.sort(begin[crosses, 0] + share * (end[crosses, 0] - begin[crosses, 0]))
        for low, high in np.clip(x, left, right).reshape(-1, 2).tolist():
            if high - low > best:
                best, middle = high - low, np.array([0.5 * (low + high), y])
    return middle
