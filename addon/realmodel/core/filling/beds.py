# SPDX-License-Identifier: GPL-3.0-or-later
"""Beds laid through a box: the bed of any point, in closed form.

All tilted beds have the shape of one datum: a plane, with folds along straight axes, broken by vertical
faults. So the bed of a point follows from its height above the datum alone. Folds are polylines across their
axis, of _NODES to a wavelength: the datum has no curves, and the sheets of `sheets.py` are exactly what the
formulas here say.

Folds whose axial planes are not vertical are laid upright: in a space that is sheared along level planes, so
that these planes, volumes and heights stay as they are. `Beds.upright` leads there, `Beds.leaned` back.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..base.algebra import cos, dot, exp, sin
from ..base.errors import InputRefused
from .strata import Strata

_NODES = 32  # of a fold's polyline to a wavelength
_MOST_NODES = 2048
_PARALLEL = 0.05  # below it, beds are too nearly parallel to axial planes; 0: they are, and have no datum
_ARRAYS = ("lean", "low", "high", "slope", "across", "wave", "levels", "covers")  # of Beds
_UNEVEN = 1.2  # beds are at most exp(1.2) times as thick as the mean before that is made even


@dataclass(frozen=True, eq=False)
class Beds:
    """Beds through a box, the oldest number 0.

    lean: (2,) how far axial planes move in plan from one height to the next. All that follows is in the
    upright space. low, high: (3,) corners of the box. slope: (2,) of the datum's plane, which is at 0 in the
    middle of the box. across: (2,) the direction in plan across folds; wave: (3,) of their polyline the
    distance of its nodes along it, how many of these node 0 is from the middle, and the height of crests, 0
    without folds. fault: a direction in plan (2,), the distances of the faults along it (F,) and the shifts
    of the strips between them (F + 1,). levels: (L,) heights above the datum between the tilted beds. floor:
    the elevation of the unconformity, infinite where there is none. covers: (U,) elevations between the beds
    above it.
    """

    lean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    slope: np.ndarray
    across: np.ndarray
    wave: np.ndarray
    fault: tuple[np.ndarray, np.ndarray, np.ndarray]
    levels: np.ndarray
    floor: float
    covers: np.ndarray

    @property
    def count(self) -> int:
        """How many beds there are."""
        return len(self.levels) + 1 + (len(self.covers) + 1 if math.isfinite(self.floor) else 0)

    @property
    def middle(self) -> np.ndarray:
        """(2,) the middle of the box in plan; distances are from there."""
        return 0.5 * (self.low + self.high)[:2]

    @property
    def axes(self) -> np.ndarray:
        """(2, 2) the direction across the fold axes, and the one along them."""
        return np.array([self.across, [-self.across[1], self.across[0]]])

    @cached_property
    def fold(self) -> tuple[np.ndarray, np.ndarray]:
        """(N,) the distances of the fold's nodes across it and (N,) their heights, all through the box."""
        step, offset, amplitude = self.wave
        if not amplitude:
            return np.zeros(1), np.zeros(1)
        first, last = _node_range(_corners(self.low, self.high), self.across, step, offset)
        nodes = np.arange(first, last + 1)
        return (nodes + offset) * step, amplitude * sin((nodes % _NODES) * (2.0 * math.pi / _NODES))

    def reaching(self, vertices: np.ndarray) -> Beds:
        """These beds with a box around vertices (V, 3) as well. No bed moves."""
        places, middle = self.upright(vertices), self.middle
        half = np.maximum(np.abs(places[:, :2] - middle).max(axis=0), 0.5 * (self.high - self.low)[:2])
        low, high = np.minimum(self.low, places.min(axis=0)), np.maximum(self.high, places.max(axis=0))
        if (half <= 0.5 * (self.high - self.low)[:2]).all():
            return replace(self, low=np.append(self.low[:2], low[2]), high=np.append(self.high[:2], high[2]))
        return replace(self, low=np.append(middle - half, low[2]), high=np.append(middle + half, high[2]))

    def to_json(self) -> str:
        """The beds as text, from which `from_json` makes the same ones."""
        numbers = {name: np.asarray(value).tolist() for name, value in vars(self).items() if name in _ARRAYS}
        return json.dumps({**numbers, "fault": [part.tolist() for part in self.fault], "floor": self.floor})

    @staticmethod
    def from_json(text: str) -> Beds:
        """The beds of a text that `to_json` wrote."""
        record = json.loads(text)
        arrays = {name: np.array(record[name], float) for name in _ARRAYS}
        along, distances, shifts = (np.array(part, float) for part in record["fault"])
        return Beds(**arrays, fault=(along, distances, shifts), floor=float(record["floor"]))

    @property
    def slant(self) -> float:
        """How much longer than at right angles to the datum's plane a line through a bed is that is vertical
        in the upright space."""
        return _slant(self.slope, self.lean)

    def upright(self, points: np.ndarray) -> np.ndarray:
        """(N, 3) the points (N, 3) in the space in which folds stand upright."""
        return _sheared(points, -self.lean)

    def leaned(self, points: np.ndarray) -> np.ndarray:
        """(N, 3) points (N, 3) of the upright space where they belong."""
        return _sheared(points, self.lean)

    def strips(self, plan: np.ndarray) -> np.ndarray:
        """(N,) the strip between faults in which each place in plan (N, 2) lies."""
        along, positions, _ = self.fault
        return np.searchsorted(positions, dot(plan - self.middle, along))

    def datum(self, plan: np.ndarray, strips: np.ndarray) -> np.ndarray:
        """(N,) the elevation of the datum at places in plan (N, 2), in strips between faults (N,)."""
        away = plan - self.middle
        distances, heights = self.fold
        fold = np.interp(dot(away, self.across), distances, heights)
        return dot(away, self.slope) + fold + self.fault[2][strips]

    def numbers(self, points: np.ndarray) -> np.ndarray:
        """(N,) int32: the bed that each of the points (N, 3) lies in."""
        return self.found(points)[0]

    def places(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(N,) int32 the bed that each of the points (N, 3) lies in, (N,) its share of the thickness of the
        bed, from 0 at its base to 1 at its top, and (N,) that thickness. The lowest and the highest bed are
        as thick as the mean of the others, or reach to the end of the box."""
        bed, height = self.found(points)
        base, top = self.bounds()
        thickness = (top - base)[bed]
        return bed, np.clip((height - base[bed]) / thickness, 0.0, 1.0), thickness

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """(B,) the bases and the tops of beds: above the datum, those above the unconformity elevations."""
        mean = (
            float(np.diff(self.levels).mean()) if len(self.levels) > 1 else float(self.high[2] - self.low[2])
        )
        levels = self.levels if len(self.levels) else np.zeros(1)
        ends = np.array([levels[0] - mean, *self.levels, levels[-1] + mean])
        if not math.isfinite(self.floor):
            return ends[:-1], ends[1:]
        covers = np.array([self.floor, *self.covers, max(self.high[2], self.floor + mean)])
        return np.concatenate([ends[:-1], covers[:-1]]), np.concatenate([ends[1:], covers[1:]])

    def found(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(N,) int32 beds of points, and heights: above the datum, or elevations above the unconformity."""
        plan, z = self.upright(points)[:, :2], points[:, 2]
        height = z - self.datum(plan, self.strips(plan))
        beds = np.searchsorted(self.levels, height)
        if math.isfinite(self.floor):
            is_above = z > self.floor
            beds = np.where(is_above, len(self.levels) + 1 + np.searchsorted(self.covers, z), beds)
            height = np.where(is_above, z, height)
        return beds.astype(np.int32), height


def lay_beds(strata: Strata, vertices: np.ndarray) -> Beds:
    """Lays beds through the box of vertices (V, 3). Raises InputRefused where folds are too narrow for it, or
    lean as the beds dip."""
    random = np.random.default_rng(strata.seed)
    lean = _lean(strata)
    vertices = _sheared(vertices, -lean)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    corners = _corners(low, high)
    thicknesses = exp(strata.variation * _UNEVEN * (2.0 * random.random(strata.beds) - 1.0))
    phase, fault_random = random.random(), random.random((2, strata.faults))
    slope = _upright_slope(strata, lean)
    empty = np.empty(0)
    has_cover = strata.unconformity > 0
    laid = Beds(
        lean,
        low,
        high,
        slope,
        _towards(strata.fold_axis + 90.0),
        _wave(strata, corners, phase, _slant(slope, lean)),
        _faults(strata, corners, fault_random),
        empty,
        float(low[2] + strata.unconformity * (high[2] - low[2])) if has_cover else math.inf,
        empty,
    )
    return _divided(strata, laid, vertices, thicknesses)


def check_gap(beds: Beds, gap: float) -> None:
    """Raises InputRefused for a gap that leaves nothing of a bed, or of a strip between faults."""
    slant = beds.slant
    between = (
        ("bed", "fewer beds or less variation", np.diff(beds.levels) / slant),
        ("bed above the unconformity", "fewer beds or less variation", np.diff(beds.covers)),
        ("strip between faults", "fewer faults", np.diff(beds.fault[1])),
    )
    for what, remedy, sizes in between:
        if gap and gap >= sizes.min(initial=math.inf):
            raise InputRefused(
                f"gaps of {gap:g} leave nothing of a {what} of {sizes.min():.3g}",
                advice=f"choose smaller gaps, {remedy}",
            )


def _divided(strata: Strata, laid: Beds, vertices: np.ndarray, thicknesses: np.ndarray) -> Beds:
    """The beds with the boundaries between them. thicknesses: (N,) in any unit."""
    plan, z = vertices[:, :2], vertices[:, 2]
    above = np.minimum(z, laid.floor) - laid.datum(plan, laid.strips(plan))
    upper = 0
    if math.isfinite(laid.floor):
        upper = min(max(round(strata.beds * (1.0 - strata.unconformity)), 1), strata.beds - 1)
    tilted, level = thicknesses[: strata.beds - upper], thicknesses[strata.beds - upper :]
    begin, extent = float(above.min()), float(np.ptp(above))
    if strata.thickness:
        total = strata.thickness * len(tilted) * laid.slant
        begin, extent = begin + 0.5 * (extent - total), total
    levels = begin + extent * _shares(tilted)
    covers = np.empty(0)
    if upper:
        extent = strata.thickness * upper if strata.thickness else float(laid.high[2]) - laid.floor
        covers = laid.floor + extent * _shares(level)
    return replace(laid, levels=levels, covers=covers)


def _shares(thicknesses: np.ndarray) -> np.ndarray:
    """(N - 1,) where the boundaries between beds are, from 0 to 1."""
    ends = np.cumsum(thicknesses)
    return ends[:-1] / ends[-1]


def _towards(azimuth: float) -> np.ndarray:
    """(2,) the direction of an azimuth; exact where it is one of the four of the compass."""
    quarters, rest = divmod(azimuth, 90.0)
    east, north = (0.0, 1.0) if not rest else (sin(math.radians(rest)), cos(math.radians(rest)))
    for _ in range(int(quarters) % 4):
        east, north = north, -east
    return np.array([east, north])


def _lean(strata: Strata) -> np.ndarray:
    if not strata.has_leaning_folds:
        return np.zeros(2)
    dip = math.radians(strata.axial_dip)
    return cos(dip) / sin(dip) * _towards(strata.fold_axis + 90.0)


def _sheared(points: np.ndarray, by: np.ndarray) -> np.ndarray:
    """(N, 3) points (N, 3) moved in plan by a vector (2,) times their height: the same ones where it is 0."""
    if not by.any():
        return points
    return np.column_stack([points[:, :2] + points[:, 2:] * by, points[:, 2]])


def _upright_slope(strata: Strata, lean: np.ndarray) -> np.ndarray:
    """(2,) the slope of the datum's plane in the upright space."""
    dip = math.radians(strata.dip)
    slope = -sin(dip) / cos(dip) * _towards(strata.dip_direction)
    left = 1.0 - float(dot(slope, lean))
    if left < _PARALLEL:
        raise InputRefused(
            f"beds that dip {strata.dip:g} degrees towards {strata.dip_direction:g} are as steep as the "
            f"axial planes of their folds, which dip {strata.axial_dip:g}",
            advice="choose a smaller dip, a greater axial dip, or another direction",
        )
    return slope / left


def _slant(slope: np.ndarray, lean: np.ndarray) -> float:
    return math.sqrt((1.0 + float(dot(slope, lean))) ** 2 + float(dot(slope, slope)))


def _wave(strata: Strata, corners: np.ndarray, phase: float, slant: float) -> np.ndarray:
    if not strata.is_folded:
        return np.array([1.0, 0.0, 0.0])
    step, offset, across = strata.fold_wavelength / _NODES, phase * _NODES, _towards(strata.fold_axis + 90.0)
    first, last = _node_range(corners, across, step, offset)
    if last - first > _MOST_NODES:
        wide = float(np.ptp(dot(corners, across)))
        raise InputRefused(
            f"folds {strata.fold_wavelength:g} long are too narrow for a solid {wide:g} wide",
            advice=f"choose a wavelength of {wide * _NODES / (_MOST_NODES - 4):.3g} or more",
        )
    return np.array([step, offset, strata.fold_amplitude * slant])


def _corners(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(4, 2) the corners of a box in plan, from its middle."""
    corners = np.array([(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])])
    return corners - 0.5 * (low + high)[:2]


def _node_range(corners: np.ndarray, across: np.ndarray, step: float, offset: float) -> tuple[int, int]:
    """The first and the last node of a fold through the corners of a box."""
    reach = dot(corners, across)
    return math.floor(reach.min() / step - offset) - 1, math.ceil(reach.max() / step - offset) + 1


def _faults(
    strata: Strata, corners: np.ndarray, random: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faults at about equal distances, each down to one side or the other."""
    # exactly along the axes of folds that lean, so that walls stay vertical
    across = _towards(strata.fold_axis if strata.has_leaning_folds else strata.fault_strike + 90.0)
    reach = dot(corners, across)
    share = (np.arange(strata.faults) + 0.5 + 0.6 * (random[0] - 0.5)) / max(strata.faults, 1)
    steps = np.where(random[1] < 0.5, -strata.throw, strata.throw)
    return across, reach.min() + np.ptp(reach) * share, np.append(0.0, np.cumsum(steps))
