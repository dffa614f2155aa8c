# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes in a finished model: the blocks along a vertical one, and what a planned one will meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import cos, dot, norm, sin
from ..base.errors import UsageError
from ..cells.model_data import ModelData
from ..notebook import data_frame
from .sections.section_data import SectionData
from .volumes import missing_deviations

if TYPE_CHECKING:
    import pandas
from ..base.algebra import ranks_in_runs

_SAME = 1e-9  # of the size of a hole and its model: depths that are nearer are one
_SAME_WEIGHT = 1e-6  # of a corner of a triangle: a place so far outside lies on its edge
COLUMNS = (
    *("block", "name", "property", "from", "to", "length", "vertical_from", "vertical_to"),
    *("probability", "from_deviation", "to_deviation"),
)


@dataclass(frozen=True)
class HoleAxis:
    """A planned hole. collar: (x, y, z). azimuth: degrees clockwise from north (+y). dip: degrees below the
    horizontal, 90 straight down. length: from the collar, model units. Raises UsageError."""

    collar: tuple[float, float, float]
    azimuth: float = 0.0
    dip: float = 90.0
    length: float = 100.0

    def __post_init__(self) -> None:
        collar = np.asarray(self.collar, np.float64)
        if collar.shape != (3,) or not np.isfinite(collar).all():
            raise UsageError(f"the collar must be three finite numbers, not {self.collar!r}")
        if not np.isfinite(self.azimuth):
            raise UsageError(f"the azimuth must be a finite number, not {self.azimuth!r}")
        if not -90.0 <= self.dip <= 90.0:
            raise UsageError(f"the dip must lie between -90 and 90 degrees, not {self.dip!r}")
        if not (np.isfinite(self.length) and self.length > 0):
            raise UsageError(f"the length must be above 0, not {self.length!r}")
        object.__setattr__(self, "collar", tuple(collar.tolist()))

    @property
    def heading(self) -> np.ndarray:
        """(2,) of length 1: its direction in plan."""
        turn = np.radians(self.azimuth % 360.0)
        return np.array([float(sin(turn)), float(cos(turn))])

    @property
    def direction(self) -> np.ndarray:
        """(3,) of length 1: its direction."""
        if abs(self.dip) == 90.0:
            return np.array([0.0, 0.0, -np.sign(self.dip)])
        tilt = np.radians(self.dip)
        return np.array([*(float(cos(tilt)) * self.heading), -float(sin(tilt))])

    def places(self, depths: ArrayLike) -> np.ndarray:
        """(N, 3) where depths (N,) along it are."""
        return np.array(self.collar) + np.asarray(depths, np.float64)[:, None] * self.direction

    def vertical(self, depth: float) -> float:
        """How far below the collar a depth along it is."""
        return float(-depth * self.direction[2])


@dataclass(frozen=True)
class HoleInterval:
    """An interval of a planned hole in one `block` (its number), from the depth `begin` along the hole to
    `end`. probability: of this block, on average along it; None without an ensemble."""

    block: int
    begin: float
    end: float
    probability: float | None = None

    @property
    def length(self) -> float:
        """Along the hole, model units."""
        return self.end - self.begin


@dataclass(frozen=True)
class HoleContact:
    """The contact of two blocks in a planned hole: from the block `above` into the block `below`, -1 outside
    the model. surface: the surface, fault or body that the contact lies on, "" for the base and walls.
    deviation: the standard deviation of its depth along the hole: of the realizations that have this contact,
    and `share` is how many of them do, from 0 to 1; without an ensemble (share None) as the variance of the
    interpolated height gives it, None where that is not known."""

    depth: float
    above: int
    below: int
    surface: str = ""
    deviation: float | None = None
    share: float | None = None


@dataclass(frozen=True, eq=False)
class PlannedHoleData:
    """What a planned hole meets.

    axis: where it goes. intervals, contacts: along it, from the collar. block_names, properties: (B,) of the
    model's blocks. depths (N,), probability (N, B) float64: of each block at depths along the hole, from an
    ensemble; None without one. unit: of lengths. remarks: sentences that say why contacts with a surface have
    no standard deviation.
    """

    axis: HoleAxis
    intervals: list[HoleInterval]
    contacts: list[HoleContact]
    block_names: list[str]
    properties: list[int]
    unit: str = ""
    remarks: tuple[str, ...] = ()
    depths: np.ndarray | None = field(default=None, repr=False)
    probability: np.ndarray | None = field(default=None, repr=False)

    def rows(self) -> list[dict]:
        """A row for each interval, from the collar: `block` (its number), `name`, `property`, the depths
        `from` and `to` along the hole and `length`, the depths `vertical_from` and `vertical_to` below the
        collar; `probability` and the standard deviations of both ends, `from_deviation` and `to_deviation`,
        None where they are not known."""
        deviations = {contact.depth: contact.deviation for contact in self.contacts}
        return [
            {
                "block": interval.block,
                "name": self.block_names[interval.block],
                "property": self.properties[interval.block],
                "from": interval.begin,
                "to": interval.end,
                "length": interval.length,
                "vertical_from": self.axis.vertical(interval.begin),
                "vertical_to": self.axis.vertical(interval.end),
                "probability": interval.probability,
                "from_deviation": deviations.get(interval.begin),
                "to_deviation": deviations.get(interval.end),
            }
            for interval in self.intervals
        ]

    def table(self) -> pandas.DataFrame:
        """The `rows` as a DataFrame. Raises UsageError where pandas is missing."""
        return data_frame(self.rows(), COLUMNS)


def mean_share(share: np.ndarray, depths: np.ndarray, begin: float, end: float) -> float:
    """The mean of a share (N,) at depths (N,) between two depths; where none of these is between them, the
    share in their middle."""
    inside = (depths >= begin) & (depths <= end)
    if inside.any():
        return float(share[inside].mean())
    return float(np.interp(0.5 * (begin + end), depths, share))


def intervals_on(section: SectionData, axis: HoleAxis) -> list[HoleInterval]:
    """The blocks along a hole, by the section of the model by the upright plane through it."""
    away = section.vertices - np.array(axis.collar)
    direction = axis.direction
    ahead = np.array([*axis.heading, 0.0])
    aside = (
        np.array([0.0, 0.0, 1.0]) * dot(ahead, direction) - ahead * direction[2]
    )  # across it, on the plane
    u, v = dot(away, direction), dot(away, aside)
    corners, offsets = section.polygon_vertices, section.offsets
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    first, second = corners, corners[following]
    crossed = np.flatnonzero((v[first] <= 0) != (v[second] <= 0))
    low, high = first[crossed], second[crossed]
    at = u[low] + (u[high] - u[low]) * v[low] / (v[low] - v[high])
    polygon = np.searchsorted(offsets, crossed, "right") - 1
    order = np.lexsort((at, polygon))  # each has an even number, of which two follow one another
    ends = np.clip(at[order].reshape(-1, 2), 0.0, axis.length)
    blocks = section.block[polygon[order][::2]]
    size = float(np.ptp(section.vertices, axis=0).max()) if len(section.vertices) else 0.0
    return _joined(ends, blocks, _SAME * max(axis.length, size))


def _joined(ends: np.ndarray, blocks: np.ndarray, near: float) -> list[HoleInterval]:
    """Stretches (K, 2) in order, those of one block that meet as one."""
    intervals: list[HoleInterval] = []
    for row in np.lexsort((ends[:, 1], ends[:, 0])).tolist():
        (begin, end), block = ends[row].tolist(), int(blocks[row])
        if end - begin <= near:
            continue
        if intervals and begin - intervals[-1].end <= near:
            begin = intervals[-1].end
            if intervals[-1].block == block:
                intervals[-1] = HoleInterval(block, intervals[-1].begin, max(end, begin))
                continue
        if end > begin:
            intervals.append(HoleInterval(block, begin, end))
    return intervals


def contacts_between(intervals: Sequence[HoleInterval], axis: HoleAxis) -> list[HoleContact]:
    """Where blocks begin and end; not where the hole itself does."""
    contacts = []
    stops = [None, *intervals, None]
    for above, below in pairwise(stops):
        if above is not None and below is not None and above.end == below.begin:
            contacts.append(HoleContact(above.end, above.block, below.block))
            continue
        if above is not None and above.end < axis.length:
            contacts.append(HoleContact(above.end, above.block, -1))
        if below is not None and below.begin > 0:
            contacts.append(HoleContact(below.begin, -1, below.block))
    return contacts


def on_surfaces(model: ModelData, contacts: Sequence[HoleContact], axis: HoleAxis) -> list[HoleContact]:
    """Contacts with the surfaces that they lie on, and the standard deviations of their depths that follow
    from the variances of interpolated heights: a surface that is raised meets the hole farther along it by
    the slope of its triangle there."""
    places = axis.places([contact.depth for contact in contacts])
    near = 1e-7 * float(np.ptp(model.vertices, axis=0).max(initial=0.0) + axis.length)
    result = list(contacts)
    for number, kind in enumerate(model.surface_kind.tolist() if contacts else []):
        vertices, triangles = model.surface(number)
        corners = vertices[triangles]
        low, high = corners.min(axis=1) - near, corners.max(axis=1) + near
        variance = None
        for row, place in enumerate(places):
            if kind != 0 and result[row].surface:
                continue
            some = np.flatnonzero(((low <= place) & (place <= high)).all(axis=1))
            chosen = _containing(corners[some], place, near)
            if chosen is None:
                continue
            at, weights, normal = some[chosen[0]], *chosen[1:]
            if variance is None and kind == 0 and model.lacks_project is None:
                variance = model.surface_attributes(number)["variance"]
            deviation = None
            nearing = abs(float(dot(normal, axis.direction)))
            if variance is not None and nearing > 0:
                corner_variances = np.maximum(variance[triangles[at]], 0.0)
                height = float(dot(weights, np.sqrt(corner_variances)))
                deviation = None if np.isnan(height) else height * abs(float(normal[2])) / nearing
            result[row] = replace(contacts[row], surface=model.surface_names[number], deviation=deviation)
    return result


def remarks_on(model: ModelData, contacts: Sequence[HoleContact]) -> tuple[str, ...]:
    """Why contacts have no standard deviation where the data of their surfaces show no variogram."""
    met = {contact.surface for contact in contacts if contact.deviation is None}
    return tuple(f"{name}: {text}" for name, text in missing_deviations(model).items() if name in met)


def _containing(
    corners: np.ndarray, place: np.ndarray, near: float
) -> tuple[int, np.ndarray, np.ndarray] | None:
    """The number of the triangle (T, 3, 3) that a place lies in, up to a distance, how much each of its
    corners counts there, and its normal; None where it lies in none."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    doubled = norm(normal)
    with_area = np.flatnonzero(doubled > 0)
    if not len(with_area):
        return None
    a, b, c, normal, doubled = (array[with_area] for array in (a, b, c, normal, doubled))
    unit = normal / doubled[:, None]
    weights = np.column_stack(
        [dot(unit, np.cross(q - place, r - place)) for q, r in ((b, c), (c, a), (a, b))]
    )
    weights = weights / doubled[:, None]
    is_off = np.abs(dot(unit, place - a)) > near
    least = np.where(is_off, -np.inf, weights.min(axis=1))
    best = int(least.argmax())
    return None if least[best] < -_SAME_WEIGHT else (int(with_area[best]), weights[best], unit[best])


_WALL = -1  # face_surface


@dataclass(frozen=True)
class Interval:
    """A stretch of a borehole in one block (its number), from the height `top` down to `bottom`, model
    units."""

    block: int
    top: float
    bottom: float

    @property
    def length(self) -> float:
        """Between top and bottom, model units."""
        return self.top - self.bottom


def borehole(model: ModelData, x: float, y: float) -> list[Interval]:
    """The blocks along the vertical line at the position (x, y) in plan, from above downward; nothing where
    there is no rock. On the border of two faces one of them counts.

    >>> for interval in model.borehole(3.5, 1.0):
    ...     print(model.blocks[interval.block].name, interval.top, interval.bottom)
    soil 4.5 3.0
    sand 3.0 2.0
    clay 2.0 0.0
    """
    faces = _faces_at(model, x, y)
    height, is_up = _heights(model, faces, x, y)
    cells = model.face_cells[faces]
    cells[~is_up] = cells[~is_up, ::-1]
    below, above = np.append(model.cell_block, np.int32(-1))[cells].T  # the first cell is below
    intervals: list[Interval] = []
    for k in np.lexsort((above, -height)).tolist():
        z = float(height[k])
        if intervals and intervals[-1].bottom == -np.inf:
            intervals[-1] = Interval(intervals[-1].block, intervals[-1].top, z)
        if below[k] >= 0:
            intervals.append(Interval(int(below[k]), z, -np.inf))
    return _merged(intervals)


def _merged(intervals: list[Interval]) -> list[Interval]:
    """Without stretches of no length, and with those of one block that follow one another as one."""
    merged: list[Interval] = []
    for interval in intervals:
        if not interval.top > interval.bottom:
            continue
        if merged and merged[-1].block == interval.block and merged[-1].bottom == interval.top:
            merged[-1] = Interval(interval.block, merged[-1].top, interval.bottom)
        else:
            merged.append(interval)
    return merged


def _faces_at(model: ModelData, x: float, y: float) -> np.ndarray:
    """The faces over and under a position that are no walls: a ray to the right leaves them."""
    west, south, east, north = model.plan_boxes
    near = np.flatnonzero((west <= x) & (x <= east) & (south <= y) & (y <= north))
    near = near[model.face_surface[near] != _WALL]
    corners, following, size = _outlines(model, near)
    at_edge = np.flatnonzero((corners[:, 1] <= y) != (corners[following, 1] <= y))
    low, high = corners[at_edge, :2], corners[following[at_edge], :2]
    turned = low[:, 1] > high[:, 1]  # both faces at an edge see it the same way
    low[turned], high[turned] = high[turned], low[turned].copy()
    share = (y - low[:, 1]) / (high[:, 1] - low[:, 1])
    right = at_edge[low[:, 0] + share * (high[:, 0] - low[:, 0]) > x]
    times = np.bincount(np.repeat(np.arange(len(near)), size)[right], minlength=len(near))
    return near[times % 2 == 1]


def _outlines(model: ModelData, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corners of faces (K, 3), one face after another, which of them follows each, and how many each face
    has."""
    begin, size = model.face_offsets[faces], np.diff(model.face_offsets)[faces]
    step, here = ranks_in_runs(size), np.arange(size.sum())
    following = np.where(step + 1 == np.repeat(size, size), here - step, here + 1)
    return model.vertices[model.face_vertices[np.repeat(begin, size) + step]], following, size


def _heights(model: ModelData, faces: np.ndarray, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
    """The heights of faces at a position, and whether each faces up out of its first cell."""
    here, following, size = _outlines(model, faces)
    origin = here[np.cumsum(size) - size]
    here = here - np.repeat(origin, size, axis=0)
    doubled = np.cross(here, here[following]) if len(here) else np.empty((0, 3))
    normal = np.add.reduceat(doubled, np.cumsum(size) - size, axis=0) if len(faces) else np.empty((0, 3))
    slope = normal[:, 0] * (x - origin[:, 0]) + normal[:, 1] * (y - origin[:, 1])
    return origin[:, 2] - slope / normal[:, 2], normal[:, 2] > 0
