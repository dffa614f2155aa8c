# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about points that cannot be meant for a region, and about surfaces that miss a point by much or
cut older layers beyond their points."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..base.algebra import dot
from ..base.errors import BuildWarning, InputRefused, number_list, place_text
from ..base.triangles import Sheet
from ..base.units import length_text, number_text
from ..base.work import Work, native_module
from ..heights.interpolation import Interpolation
from ..heights.mis_ties import mean_heights
from ..project.project import Rock, surface_item
from ..readers.tables.observations import Origin
from ..settings.methods import METHODS, SURFACE_OPTIONS
from ..settings.rules import RULES, Rule
from .likely_unit import surface_unit, unit_advice
from .rock_input import RockInput
from .wrong_sides import heights_at

_MOST = 20_000  # points or nodes at most at which other surfaces are examined
_NOTABLE = 0.25  # of the distance to the neighbors: an outlier below it is not reported
_BEYOND_NORMAL = 1.5  # times the largest of so many normally distributed residuals, and more, is an outlier
_DEVIATIONS = 3.0  # of the error of the heights of points, which predict a residual
_LEAST_SHARE = 0.01  # of the area: less is neither reported, nor taken as known from the points


@dataclass(frozen=True)
class Compartment:
    """Of a rock mass with faults. points: (P, 3) those that a surface was interpolated from here, in this
    compartment and in others. holds(places (N, 3)): (N,) bool, which of them lie in it."""

    points: np.ndarray
    holds: Callable[[np.ndarray], np.ndarray]


def doubtful_heights(
    work: Work, entry: RockInput, numbers: Iterable[int], compartment: Compartment | None = None
) -> list[BuildWarning]:
    """Warnings about surfaces of a RockInput, by their numbers in ascending order, once all that are built
    have heights. compartment: that the heights are of, with one surface asked for, whose points are those in
    it. None of a realization: what it draws is no estimate."""
    if entry.draws is not None:
        return []
    reach, warnings = _Reach(work, entry), []
    for number in numbers:
        points = np.ascontiguousarray(entry.data[number].points, np.float64)
        if len(points) and not entry.data[number].has_only_bound_points:
            warnings.append(_missed(work, entry, number, points, compartment is None))
        if len(points := points if compartment is None else compartment.points):
            warnings.append(reach.beyond(number, points, compartment))
    return [warning for warning in warnings if warning is not None]


def _missed(
    work: Work, entry: RockInput, number: int, points: np.ndarray, are_all: bool
) -> BuildWarning | None:
    """The warning about the point that a surface misses by most, a tied one before it was. are_all: the
    points are all that it has, and have the numbers that users know.

    It is given where the residual, less what the mesh does not show and what errors of heights predict, is
    larger than the median distance to the surfaces before and after it; or larger than a quarter of this, if
    it is an outlier: larger than any that as many normally distributed residuals with the deviation of the
    other ones would have.
    """
    rock, data, shape = entry.rock, entry.data[number], entry.surface(number)
    if not rock.surfaces[number].tie and _goes_through_points(entry, number):
        return None  # what its nodes do not resolve says nothing of the points, and is left so on purpose
    is_tied = shape in entry.untied and len(data.tied_points(rock.surfaces[number])) > 0
    if is_tied:
        shape = entry.untied[shape]
    z = heights_at(work, shape, points[:, :2])
    is_known = np.isfinite(z)
    sizes = np.where(is_known, np.abs(points[:, 2] - z), 0.0)
    apart = _distance_to_neighbors(work, entry, number, points, z)
    if apart is None:
        return None
    candidates = np.flatnonzero(sizes > _NOTABLE * apart)
    if not len(candidates):
        return None
    expected = _DEVIATIONS * np.sqrt(data.error)
    beyond_mesh = sizes[candidates] - _unresolved(work, entry, shape, points[candidates]) - expected
    worst = int(candidates[beyond_mesh.argmax()])
    largest = float(beyond_mesh.max())
    if largest <= _NOTABLE * apart or (largest <= apart and not _is_outlier(sizes[is_known], sizes[worst])):
        return None
    place, hole = place_text(points[worst].tolist()), _hole(data.source(worst))
    row = data.row(worst)
    named = f"point {row}" if are_all else "the point"
    side = "above" if points[worst, 2] > z[worst] else "below"
    before = "before it is tied " if is_tied else ""
    text = (
        f"{before}it misses {named} at {place}{hole}, which lies {number_text(sizes[worst])} {side} it; the "
        f"neighboring surfaces are {number_text(apart)} away: "
        f"{_remedy(entry.interpolations[number], is_tied)}"
    )
    return BuildWarning(text, "residual", rock.name, rock.surfaces[number].name, (row,) * are_all)


def _goes_through_points(entry: RockInput, number: int) -> bool:
    """Whether the method of a surface gives the heights of points where nodes are at them."""
    result = entry.interpolations[number]
    if result is None:
        return False
    variogram = result.variogram
    return METHODS[result.method].is_triangulated or (variogram is not None and variogram.nugget == 0)


def _unresolved(work: Work, entry: RockInput, shape: Sheet, points: np.ndarray) -> np.ndarray:
    """(N,) what the mesh may not show of a surface at points: half of its second difference over an edge,
    about twice the error of linear interpolation at a peak between nodes."""
    nodes, triangles = entry.planar_mesh()
    plan = np.ascontiguousarray(points[:, :2])
    # edges of equilateral triangles as large as the mean one
    edge = np.sqrt(float(np.prod(np.ptp(nodes, axis=0))) / len(triangles) * 4.0 / np.sqrt(3.0))
    middle, bend = heights_at(work, shape, plan), np.zeros(len(plan))
    for offset in ((edge, 0.0), (0.0, edge)):
        before, after = (heights_at(work, shape, plan + np.array(offset) * sign) for sign in (-1, 1))
        bend = np.fmax(bend, 0.5 * np.abs(before + after - 2.0 * middle))  # without those at the border
    return bend


def _is_outlier(sizes: np.ndarray, largest: float) -> bool:
    others = len(sizes) - 1
    if others < 2:
        return False
    deviation = np.sqrt(max(float((sizes**2).sum()) - largest**2, 0.0) / others)
    return largest > _BEYOND_NORMAL * np.sqrt(2.0 * np.log(others + 1)) * deviation


def _distance_to_neighbors(
    work: Work, entry: RockInput, number: int, points: np.ndarray, z: np.ndarray
) -> float | None:
    """The median of the vertical distances, at its points, to the surfaces before and after one, and to the
    base; None where there is none."""
    step = -(-len(points) // _MOST)
    plan, z = np.ascontiguousarray(points[::step, :2]), z[::step]
    neighbors = [
        heights_at(work, shape, plan)
        for other in (number - 1, number + 1)
        for shape in entry.surfaces[max(0, other) : other + 1]
        if shape is not None
    ]
    if number == 0 and entry.rock.base_elevation is not None:
        neighbors.append(np.full(len(plan), entry.rock.base_elevation))
    apart = np.abs(np.concatenate(neighbors) - np.tile(z, len(neighbors))) if neighbors else np.empty(0)
    apart = apart[apart > 0]  # not where one of them ends, or they are one
    return float(np.median(apart)) if len(apart) else None


def _hole(source: Origin) -> str:
    """The borehole that a point comes from, the depth and the row, as a part of a sentence."""
    at = "" if source.depth is None else f" at a depth of {source.depth:.6g}"
    row = "" if source.file is None else f" ({source.file.name}, line {source.line})"
    return f" of borehole '{source.hole}'{at}{row}" if source.hole else ""


def _remedy(result: Interpolation | None, is_tied: bool) -> str:
    if is_tied:
        return "check the point, through which the surface makes a bump"
    nugget = 0.0 if result is None or result.variogram is None else result.variogram.nugget
    cause = f"nugget ({number_text(nugget)}; 0 honors every point)" if nugget else "method"
    return f"check the point, the {cause}, and the edge length"


class _Reach:
    """What the surfaces of a rock mass cut, one after another, at nodes of its region, _MOST at most."""

    def __init__(self, work: Work, entry: RockInput):
        self.work, self.entry = work, entry
        if entry.region is None:
            return
        nodes, triangles = entry.region
        self.step = -(-len(nodes) // _MOST)
        self.plan = np.ascontiguousarray(nodes[:: self.step])
        (ux, uy), (vx, vy) = ((nodes[triangles[:, n]] - nodes[triangles[:, 0]]).T for n in (1, 2))
        doubled = np.repeat(np.abs(ux * vy - uy * vx), 3)
        self.area = np.bincount(triangles.ravel(), doubled, len(nodes))[:: self.step]
        self.blocks = _Blocks(len(self.plan), entry.rock.base_elevation)

    def beyond(self, number: int, points: np.ndarray, compartment: Compartment | None) -> BuildWarning | None:
        """The warning about older blocks that a surface cuts beyond its points (outside their convex hull,
        and farther from them than they are from one another), and not where they are. Surfaces are asked
        about in their order."""
        rock = self.entry.rock
        surface = rock.surfaces[number]
        follows = any(surface.options.get(option) is not None for option in SURFACE_OPTIONS)
        if self.entry.region is None or number == 0 or not RULES[surface.rule].cuts or follows:
            return None
        while len(self.blocks) < number:
            at = len(self.blocks)
            self.blocks.add(self._heights(at), RULES[rock.surfaces[at].rule])
        z = self._heights(number)
        cut = self.blocks.cut_by(z)
        if not cut.any():
            return None
        outside = self._outside(points)
        counts = np.isfinite(z)
        if not (cut & outside).any():
            return None
        if compartment is not None:
            counts[counts] = compartment.holds(np.column_stack([self.plan, z])[counts])
        beyond, beside = (np.where(counts & where, self.area, 0.0) for where in (outside, ~outside))
        whole = beyond.sum() + beside.sum()
        is_new = (dot(cut, beyond) > _LEAST_SHARE * whole) & (dot(cut, beside) <= _LEAST_SHARE * beside.sum())
        if not is_new.any():
            return None
        newly_cut = cut[is_new].any(axis=0) & (beyond > 0)
        depth = np.where(newly_cut, self.blocks.top - z, -np.inf)
        place = place_text(self.plan[depth.argmax()].tolist())
        names = [self._name(block) for block in np.flatnonzero(is_new).tolist()]
        text = (
            f"beyond its points, on {100 * beyond[newly_cut].sum() / whole:.2g} % of its area, it cuts "
            f"{number_list(names)}, which it does not cut near them; deepest by "
            f"{number_text(float(depth.max()))} at {place}: "
            'add a point there, or set extrapolate = "nearest"'
        )
        return BuildWarning(text, "extrapolation", rock.name, surface.name)

    def _heights(self, number: int) -> np.ndarray:
        vertices, _ = shape = self.entry.surface(number)
        xyz = vertices[:: self.step]
        if len(vertices) == len(self.entry.planar_mesh().vertices) and np.array_equal(xyz[:, :2], self.plan):
            return np.array(xyz[:, 2])
        return heights_at(self.work, shape, self.plan)

    def _outside(self, points: np.ndarray) -> np.ndarray:
        native = native_module()
        outside = self.work.native(native.outside_hull, points, self.plan)
        if outside.any():
            away = self.work.native(native.nearest_distance, points, self.plan)
            along = float(np.ptp(points[:, :2], axis=0).max()) / len(points)  # of points on a line
            spacing = float(native.mean_spacing(mean_heights(points), are_apart=True))
            outside &= away > max(spacing, along)
        return outside

    def _name(self, number: int) -> str:
        return f"'{self.entry.rock.block_names()[number]}'"


class _Blocks:
    """The blocks that surfaces leave at (N,) places; `top`: of what is there, NaN where nothing is."""

    def __init__(self, count: int, base: float | None):
        self.top = np.full(count, np.nan if base is None else base)
        self.firm = np.full(count, -np.inf)
        self.bottoms: list[np.ndarray] = []
        self.tops: list[np.ndarray] = []

    def __len__(self) -> int:
        return len(self.tops)

    def add(self, z: np.ndarray, rule: Rule) -> None:
        """The next surface, with heights z (N,), NaN where it has none."""
        covered = np.isfinite(z)
        z = np.maximum(z if rule.cuts else np.fmax(z, np.where(covered, self.top, np.nan)), self.firm)
        if rule.cuts:
            self.tops = [np.where(covered, np.minimum(top, z), top) for top in self.tops]
        self.bottoms.append(self.top)
        self.tops.append(z)
        self.top = np.where(covered, z, self.top)
        if rule.protects:
            self.firm = np.where(covered, z, self.firm)

    def cut_by(self, z: np.ndarray) -> np.ndarray:
        """(B, N) bool: where a surface that cuts takes more of a block than a tenth of its mean thickness."""
        z = np.maximum(z, self.firm)
        is_cut = []
        for bottom, top in zip(self.bottoms, self.tops, strict=True):
            thickness = top - bottom
            is_there = thickness > 0  # never where NaN
            least = 0.1 * thickness[is_there].mean() if is_there.any() else np.inf
            is_cut.append(is_there & (top - np.maximum(z, bottom) > least))
        return np.array(is_cut)


_FARTHEST = 3.0  # times the extent of points and region
_TOWARDS = ("east", "northeast", "north", "northwest", "west", "southwest", "south", "southeast")


def require_points_near(entry: RockInput, given: Rock, unit: str) -> None:
    """Refuses a surface whose points are all far away from the region of its rock mass, or whose mesh lies
    beside it.

    Points do if the gap between their bounding box and that of the region, in plan, is more than three times
    the diagonals of both; meshes, which say nothing beyond their borders, where there is any. given: as of
    surface_unit. Raises InputRefused with the distance.
    """
    rock = entry.rock
    if rock.region is None:
        return
    low, high = _box(np.concatenate(rock.rings()))
    for number, (surface, data) in enumerate(zip(rock.surfaces, entry.data, strict=True)):
        is_interpolated = rock.is_interpolated(surface)
        points = data.points if is_interpolated else surface.vertices
        if points is None or not len(points):
            continue
        first, last = _box(points[:, :2])
        gap = np.where(first > high, first - high, np.where(last < low, last - low, 0.0))
        away = float(np.hypot(*gap))
        most = _FARTHEST if is_interpolated else 0.0
        if away > most * max(np.hypot(*(high - low)), np.hypot(*(last - first))):
            towards = _TOWARDS[round(float(np.degrees(np.arctan2(gap[1], gap[0]))) / 45.0) % 8]
            what = "its points lie" if is_interpolated else "its mesh lies"
            advice = "check the coordinates and units of both; the region must lie where the surface is"
            if (other := surface_unit(entry, given, number, unit)) is not None:
                advice = unit_advice(other)
            raise InputRefused(
                f"{what} {length_text(away, unit)} {towards} of the region",
                item=surface_item(rock, surface),
                file=surface.shape_file,
                advice=advice,
            )


def farthest(region: np.ndarray, places: np.ndarray) -> tuple[int, float] | None:
    """The place of some (P, 2 or 3) that lies farthest from the bounding box of a region (N, 2) in plan, and
    how far, if that is more than three times the diagonal of the box."""
    low, high = _box(region)
    beyond = np.maximum(np.maximum(low - places[:, :2], places[:, :2] - high), 0.0)
    away = np.hypot(*beyond.T)
    if not (away > _FARTHEST * np.hypot(*(high - low))).any():
        return None
    worst = int(away.argmax())
    return worst, float(away[worst])


def _box(plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return plan.min(axis=0), plan.max(axis=0)
