# SPDX-License-Identifier: GPL-3.0-or-later
"""The data that a built model does not honor."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..base.algebra import atan2, norm
from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..fields.series_field import SeriesField
from ..project.project import Rock
from ..readers.tables.observations import SWITCHED_OFF, Origin
from ..results.surface_quality import heights_of_points
from ..settings.dips import Dips
from ..surfaces.rock_input import RockInput
from .closed_form import AIR, ClosedForm, closed_forms
from .observed import NEAR, look, violated_bounds

MISFIT_KINDS = ("point", "bound", "block", "dip", "left_out")
DIP_TOLERANCE = 5.0  # degrees
_NO_ROCK = "no rock"


@dataclass(frozen=True)
class Misfit:
    """A datum that a built model does not honor. kind: "point" (of a surface, contacts too),
    "bound", "block" (a place or an interval), "dip", or "left_out". rock: its rock mass. name: its surface or
    block. hole, depth: where it comes from; "" and None where it has none. row: of a point, a dip and an
    observation its row in the data of the surface or the rock mass, from 0; None where there is none. place:
    (x, y, z), model units, None where it is not known; end: of an interval its lower end. says: what the
    datum says; has: what the model has there, or why it is not used. by: how much is between them, model
    units, of dips degrees; None of what is left out."""

    kind: str
    rock: str
    name: str
    hole: str
    depth: float | None
    row: int | None
    place: tuple[float, ...] | None
    says: str
    has: str
    by: float | None
    end: tuple[float, ...] | None = None


def misfits(
    model: ModelData, tolerance: float | None = None, dip_tolerance: float = DIP_TOLERANCE
) -> list[Misfit]:
    """The data that a built model does not honor: points and contacts off their surfaces, bounds
    that are not kept, intervals and places in another block, dips, and observations that are left out, but
    not those that are switched off. In this order, the largest of each kind first. Distances from surfaces
    that are level sets of a field are approximate; the dips of a field are those of its series.

    tolerance: model units, from which on something counts; None: a billionth of the range of heights of the
    data. dip_tolerance: degrees between a dip and its surface. Raises InputRefused for a model of a file
    without its project.
    """
    model.require_project("what does not fit")
    return run(lambda work: _misfits(work, model, tolerance, dip_tolerance), threads=model.threads)


def _misfits(work: Work, model: ModelData, tolerance: float | None, dip_tolerance: float) -> list[Misfit]:
    misfits: list[Misfit] = []
    forms, first = closed_forms(model), 0
    for number, (entry, form) in enumerate(zip(model.rock_inputs, forms, strict=True)):
        near = tolerance if tolerance is not None else NEAR * _range_of_heights(entry)
        for at, surface in enumerate(entry.rock.surfaces):
            which = first + at, at, number
            misfits += _points(model, which, near)
            misfits += _bounds(model, which, near)
            if entry.data[at].dips is not None and not entry.rock.is_level_set(surface):
                misfits += _dips(model, which, dip_tolerance)
        for field in entry.fields:
            misfits += _dips_of_field(work, entry.rock, field, form, dip_tolerance)
        observed = entry.rock.observed
        if observed is not None and len(observed):
            misfits += _blocks(work, model, number, form, near)
        misfits += [
            Misfit(
                "left_out", entry.rock.name, e.block, e.hole, e.depth, None, e.place, e.block, e.text, None
            )
            for e in entry.left_out
            if e.kind != SWITCHED_OFF
        ]
        first += len(entry.rock.surfaces)
    order = {kind: number for number, kind in enumerate(MISFIT_KINDS)}
    return sorted(misfits, key=lambda misfit: (order[misfit.kind], -(misfit.by or 0.0)))


def _range_of_heights(entry: RockInput) -> float:
    observed, parts = entry.rock.observed, [data.points[:, 2] for data in entry.data]
    parts += [] if observed is None else [observed.places[:, 2]]
    heights = np.concatenate(parts) if parts else np.empty(0)
    return float(np.ptp(heights)) if len(heights) else 0.0


def _points(model: ModelData, which: tuple[int, int, int], near: float) -> Iterator[Misfit]:
    """which: the number of a surface in the model, in its rock mass, and that of the rock mass."""
    entry = model.rock_inputs[which[2]]
    rock, surface, data = entry.rock, entry.rock.surfaces[which[1]], entry.data[which[1]]
    points = data.measured_points
    heights = heights_of_points(model, *which, points) if len(points) else np.empty(0)
    for row in np.flatnonzero(np.abs(points[:, 2] - heights) > near).tolist():
        place, z = tuple(points[row].tolist()), float(heights[row])
        by = abs(place[2] - z)
        says, has = f"{place[2]:,.6g}", f"{z:,.6g}, {by:.4g} {'below' if z < place[2] else 'above'}"
        if rock.is_level_set(surface):
            says, has = "on it", f"{by:.4g} on its {'younger' if z < place[2] else 'older'} side"
        source = *data.source(row)[:2], data.row(row)
        yield Misfit("point", rock.name, surface.name, *source, place, says, has, by)


def _bounds(model: ModelData, which: tuple[int, int, int], near: float) -> Iterator[Misfit]:
    for bound in violated_bounds(model, which, near):
        side, other = ("at or above", "below") if bound.is_lower else ("at or below", "above")
        says = f"{bound.surface} {side} {bound.place[2]:,.6g}"
        rock = model.rock_inputs[which[2]].rock
        if rock.is_level_set(rock.surfaces[which[1]]):
            wanted, other = ("older", "younger") if bound.is_lower else ("younger", "older")
            says, other = f"on the {wanted} side of {bound.surface}", f"on its {other} side"
        has = f"{bound.by:.4g} {other}"
        source = bound.hole, bound.depth, None
        yield Misfit("bound", bound.rock, bound.surface, *source, bound.place, says, has, bound.by)


def _blocks(work: Work, model: ModelData, number: int, form: ClosedForm, near: float) -> Iterator[Misfit]:
    rock, seen = model.rock_inputs[number].rock, look(work, model, number, form)
    observed = rock.observed
    assert observed is not None
    begin, end = observed.places[seen.rows[:, 0]], observed.places[seen.rows[:, 1]]
    length = (1.0 - seen.share) * norm(end - begin)
    is_place = seen.rows[:, 0] == seen.rows[:, 1]
    chosen = (seen.share < 1.0) & ~seen.is_beside & ((length > near) | is_place)
    for n in np.flatnonzero(chosen).tolist():
        row, last = seen.rows[n].tolist()
        block, met = str(observed.blocks[row]), int(seen.found[n])
        name = _NO_ROCK if met == AIR else seen.names.get(met) or model.blocks[met].name
        hole, depth, *_ = Origin.of(observed.holes[row], observed.depths[row])
        to = Origin.of(hole, observed.depths[last]).depth
        says = f"{block} to {to:.6g}" if to is not None and last > row else block
        has = name if is_place[n] else f"{100 * (1 - seen.share[n]):.0f} % outside, most in {name}"
        source = hole, depth, observed.row(row)
        place = tuple(begin[n].tolist())
        low = None if is_place[n] else tuple(end[n].tolist())
        yield Misfit("block", rock.name, block, *source, place, says, has, float(length[n]), low)


def _dips(model: ModelData, which: tuple[int, int, int], tolerance: float) -> Iterator[Misfit]:
    entry = model.rock_inputs[which[2]]
    surface, dips = entry.rock.surfaces[which[1]], entry.data[which[1]].dips
    assert dips is not None
    surface_dips = surface.dips  # they come first
    rows: list[int | None] = [None] * len(dips)
    if isinstance(surface_dips, Dips):
        in_use = np.flatnonzero(surface_dips.in_use).tolist()
        rows[: len(in_use)] = map(surface_dips.row, in_use)
    slopes, heights = _slopes(model, which, np.column_stack([dips.positions, dips.heights]))
    normals, model_normals = (
        np.column_stack([-gradients, np.ones(len(gradients))]) for gradients in (dips.gradients, slopes)
    )
    z = np.where(np.isnan(dips.heights), heights, dips.heights)
    places = np.column_stack([dips.positions, z])
    return _differing((entry.rock.name, surface.name), (rows, places, normals), model_normals, tolerance)


def _dips_of_field(
    work: Work, rock: Rock, field: SeriesField, form: ClosedForm, tolerance: float
) -> Iterator[Misfit]:
    """The dips of a series that its field does not have; outside of its lattice it has none."""
    dips = next(series for series in rock.series if series.name == field.name).space_dips()
    if dips is not None:
        used = np.flatnonzero(dips.in_use)
        places, rows = dips.positions[used], [dips.row(row) for row in used.tolist()]
        model_normals = field.slopes(places, form.compartments_of(work, places))
        yield from _differing(
            (rock.name, field.name), (rows, places, dips.normals[used]), model_normals, tolerance
        )


def _differing(
    of: tuple[str, str], dips: tuple, model_normals: np.ndarray, tolerance: float
) -> Iterator[Misfit]:
    """The dips of a rock mass and something in it whose normals differ from those that the model has, (D, 3).
    dips: their rows, places and normals."""
    rows, places, normals = dips
    angles = np.degrees(atan2(norm(np.cross(normals, model_normals)), (normals * model_normals).sum(axis=1)))
    for k in np.flatnonzero(angles > tolerance).tolist():
        texts = attitude_text(normals[k]), f"{attitude_text(model_normals[k])}, {angles[k]:.0f}° off"
        place = tuple(places[k].tolist())
        yield Misfit("dip", *of, "", None, rows[k], place, *texts, float(angles[k]))


def _slopes(
    model: ModelData, which: tuple[int, int, int], places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The slopes (N, 2) of a surface along x and y, and its heights (N,), at places (N, 3), whose height may
    be NaN: of the triangle there."""
    vertices, _ = model.surface(which[0])
    step = 1e-6 * float(np.ptp(vertices[:, :2], axis=0).max())
    points = places.copy()
    at = heights_of_points(model, *which, points)
    points[:, 2] = np.where(np.isnan(places[:, 2]), at, places[:, 2])
    slopes = np.empty((len(places), 2))
    for axis in (0, 1):
        shift = np.zeros(3)
        shift[axis] = step
        ahead, behind = (heights_of_points(model, *which, points + sign * shift) for sign in (1.0, -1.0))
        one_sided = np.where(np.isnan(ahead), (at - behind) / step, (ahead - at) / step)
        both = (ahead - behind) / (2 * step)
        slopes[:, axis] = np.where(np.isnan(both), one_sided, both)
    return slopes, at


def attitude_text(normal: np.ndarray) -> str:
    """A plane by its normal (3,) toward younger rock, of any length, as dip direction and dip: "120/35",
    degrees; where that points down, it is overturned."""
    x, y, z = (float(value) for value in normal)
    if is_overturned := z < 0:
        x, y, z = -x, -y, -z
    dip = np.degrees(atan2(math.sqrt(x * x + y * y), z))
    direction = np.degrees(atan2(x + 0.0, y + 0.0)) % 360.0  # adding 0.0 makes no -0 of a level plane
    return f"{round(direction) % 360:03d}/{dip:02.0f}{' overturned' * is_overturned}"
