# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a series to look at: its bands of equal values on a section of the model, and level sets of
any number of values in the rock of the series."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..base.algebra import norm
from ..base.errors import UsageError
from ..base.work import Work, native_module, run
from ..cells.model_data import ModelData
from ..fields import level_solids
from ..fields.series_field import SeriesField
from ..results.layer_values import local_compartments
from ..results.sections.section_data import SectionData
from ..surfaces.rock_input import RockInput
from ..validation.closed_form import ClosedForm, closed_forms

_FINE = 1.0  # edges of what is drawn on a section, of the spacing of the lattice
_ROUNDS = 14  # in which triangles of a section are halved at most
_BORDER_ROUNDS = 2  # in which triangles of level sets that leave the rock are divided
_BISECTIONS = 30  # until it is known where their edges leave it


def series_with_fields(model: ModelData) -> list[str]:
    """The names of the series of a model that have fields."""
    return [series_field.name for entry in model.rock_inputs for series_field in entry.fields]


def field_range(model: ModelData, series: str) -> tuple[float, float]:
    """The least and the greatest value of the field of a series in its rock. Raises UsageError where there is
    no such field."""
    rock, entry, series_field = _found(model, series)
    cells = np.flatnonzero(np.isin(model.cell_block, _blocks_of(model, rock, series_field)))
    faces = np.flatnonzero(np.isin(model.face_cells, cells).any(axis=1))
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    behind = model.face_cells[faces]
    cell = np.where(np.isin(behind[:, 0], cells), behind[:, 0], behind[:, 1])
    where = local_compartments(model, entry)[model.cell_compartment[np.repeat(cell, np.diff(offsets))]]
    values = _values(series_field, model.vertices[corners], where)
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def field_surfaces(model: ModelData, series: str) -> list[tuple[str, float]]:
    """The surfaces of a series, oldest first, and the value of its field on each. Raises UsageError where
    there is no such field."""
    _, entry, series_field = _found(model, series)
    levels = series_field.fields[0].levels.tolist()
    return [
        (entry.rock.surfaces[number].name, level)
        for number, level in zip(series_field.numbers, levels, strict=False)
    ]


def field_section(
    model: ModelData, series: str, found: SectionData, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The rock of a series on a section of the model, divided where its field has `values` (L,), rising:
    triangles (T, 3, 3), corner by corner, and (T,) how many of the values the field is above there. Raises
    UsageError where there is no such field."""
    rock, entry, series_field = _found(model, series)
    in_series = np.isin(found.block, _blocks_of(model, rock, series_field))
    if not in_series.any():
        return np.empty((0, 3, 3)), np.empty(0, np.int64)
    corners, begins = native_module().triangulate_faces(found.vertices, found.offsets, found.polygon_vertices)
    polygon = np.repeat(np.arange(len(found)), np.diff(begins))
    chosen = in_series[polygon]
    places = found.vertices[corners[chosen]]
    where = local_compartments(model, entry)[found.compartment[polygon[chosen]]]
    longest = _FINE * min(field.lattice.spacing[0] for field in series_field.fields)
    places, where = _halved(places, where, longest)
    of_corners = _values(series_field, places.reshape(-1, 3), np.repeat(where, 3)).reshape(-1, 3)
    for value in values.tolist():
        places, of_corners = _divided(places, of_corners, value)
    return places, np.searchsorted(values, of_corners.mean(axis=1))


def field_levels(model: ModelData, series: str, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The level sets of the field of a series at `values` (L,), rising, as far as they lie in its rock:
    triangles (T, 3, 3), corner by corner, and (T,) the number of the value of each. Raises UsageError where
    there is no such field."""
    rock, _, series_field = _found(model, series)
    form, blocks = closed_forms(model)[rock], _blocks_of(model, rock, series_field)

    def task(work: Work) -> tuple[np.ndarray, np.ndarray]:
        parts, numbers = [np.empty((0, 3, 3))], [np.empty(0, np.int64)]
        for field, compartments in series_field.distinct().items():
            field_at_values = replace(field, levels=np.ascontiguousarray(values, np.float64))
            for number, solid in enumerate(level_solids(work, field_at_values)):
                sheet = solid.level_set
                inside = _within(work, form, blocks, compartments)
                triangles = _cut_off(sheet.vertices[sheet.triangles], inside)
                parts.append(triangles)
                numbers.append(np.full(len(triangles), number))
        return np.concatenate(parts), np.concatenate(numbers)

    return run(task, threads=model.threads)


def _found(model: ModelData, series: str) -> tuple[int, RockInput, SeriesField]:
    for rock, entry in enumerate(model.rock_inputs):
        for series_field in entry.fields:
            if series_field.name == series:
                return rock, entry, series_field
    names = ", ".join(series_with_fields(model))
    raise UsageError(
        f"no series '{series}' with a field: {f'there are {names}' if names else 'there is none'}"
    )


def _blocks_of(model: ModelData, rock: int, series_field: SeriesField) -> np.ndarray:
    """The numbers of the blocks beneath the surfaces of a series."""
    first = sum(len(entry.rock.surfaces) for entry in model.rock_inputs[:rock])
    surfaces = [first + number for number in series_field.numbers]
    return np.array([n for n, block in enumerate(model.blocks) if block.surface in surfaces], np.int64)


def _values(series_field: SeriesField, points: np.ndarray, where: np.ndarray) -> np.ndarray:
    """(N,) f at points (N, 3) in the compartments `where`."""
    values = np.full(len(points), np.nan)
    for field, compartments in series_field.distinct().items():
        here = np.flatnonzero(np.isin(where, compartments))
        if len(here):
            values[here] = field.at(points[here])
    return values


def _halved(places: np.ndarray, where: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (T, 3, 3) halved across their longest edges until none is longer."""
    done, done_where = [], []
    for _ in range(_ROUNDS):
        lengths = norm((np.roll(places, -1, axis=1) - places).reshape(-1, 3)).reshape(-1, 3)
        is_long = lengths.max(axis=1) > longest
        done.append(places[~is_long])
        done_where.append(where[~is_long])
        a, b, c = _turned(places[is_long], lengths[is_long].argmax(axis=1))
        middle = 0.5 * (a + b)
        places = np.concatenate([np.stack(corners, axis=1) for corners in ((a, middle, c), (middle, b, c))])
        where = np.tile(where[is_long], 2)
        if not len(places):
            break
    return np.concatenate([*done, places]), np.concatenate([*done_where, where])


def _turned(corners: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, ...]:
    """The three corners of triangles (T, 3, ...), each beginning with the one of the number `first` (T,)."""
    rows = np.arange(len(corners))
    return tuple(corners[rows, (first + step) % 3] for step in range(3))


def _divided(places: np.ndarray, values: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (T, 3, 3) on which f is linear, with its values (T, 3) at the corners, divided where it has a
    level."""
    above = values > level
    is_met = (values.min(axis=1) < level) & (values.max(axis=1) > level)
    lone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))[is_met]
    (a, b, c), (u, v, w) = _turned(places[is_met], lone), _turned(values[is_met], lone)
    ends = []
    for other, other_value in ((b, v), (c, w)):
        share = ((level - u) / (other_value - u))[:, None]
        ends.append(a + share * (other - a))
    p, q = ends
    on = np.full(len(u), level)
    parts = ((a, p, q), (u, on, on)), ((p, b, c), (on, v, w)), ((p, c, q), (on, w, on))
    return (
        np.concatenate([places[~is_met], *(np.stack(corners, axis=1) for corners, _ in parts)]),
        np.concatenate([values[~is_met], *(np.stack(corner_values, axis=1) for _, corner_values in parts)]),
    )


def _within(
    work: Work, form: ClosedForm, blocks: np.ndarray, compartments: list[int]
) -> Callable[[np.ndarray], np.ndarray]:
    """A function of points (N, 3): whether they lie in some blocks, in some compartments."""

    def inside(points: np.ndarray) -> np.ndarray:
        in_blocks = np.isin(form.blocks_at(work, points), blocks)
        return in_blocks & np.isin(form.compartments_of(work, points), compartments)

    return inside


def _cut_off(places: np.ndarray, inside: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The parts of triangles (T, 3, 3) that lie inside. Those that partly do are divided in four, some times,
    and then cut along lines between the places where their edges leave it."""
    pieces = []
    for _ in range(_BORDER_ROUNDS):
        count = _are_inside(places, inside).sum(axis=1)
        pieces.append(places[count == 3])
        a, b, c = places[(count > 0) & (count < 3)].transpose(1, 0, 2)
        p, q, r = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        parts = (a, p, r), (p, b, q), (r, q, c), (p, q, r)
        places = np.concatenate([np.stack(corners, axis=1) for corners in parts])
    is_inside = _are_inside(places, inside)
    count = is_inside.sum(axis=1)
    pieces.append(places[count == 3])
    one, two = count == 1, count == 2
    a, b, c = _turned(places[one], is_inside[one].argmax(axis=1))
    pieces.append(np.stack([a, _border(a, b, inside), _border(a, c, inside)], axis=1))
    a, b, c = _turned(places[two], (~is_inside[two]).argmax(axis=1))
    p, q = _border(b, a, inside), _border(c, a, inside)
    pieces += [np.stack([p, b, c], axis=1), np.stack([p, c, q], axis=1)]
    return np.concatenate(pieces)


def _are_inside(places: np.ndarray, inside: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(T, 3) bool: which corners of triangles (T, 3, 3) lie inside; each position is requested once."""
    corners, number = np.unique(places.reshape(-1, 3), axis=0, return_inverse=True)
    is_inside = inside(corners) if len(corners) else np.zeros(0, bool)
    return is_inside[number.ravel()].reshape(-1, 3)


def _border(within: np.ndarray, beyond: np.ndarray, inside: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(N, 3) where one leaves what is inside on the way from points within (N, 3) to points beyond it."""
    for _ in range(_BISECTIONS if len(within) else 0):
        middle = 0.5 * (within + beyond)
        stays = inside(middle)[:, None]
        within, beyond = np.where(stays, middle, within), np.where(stays, beyond, middle)
    return within
