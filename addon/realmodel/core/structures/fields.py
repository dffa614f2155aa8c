# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of series: one in each compartment, and the level sets that are its surfaces there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.errors import InputRefused, naming, place_text
from ..base.sheet import Sheet
from ..base.work import Work, refused_as
from ..fields import (
    FieldData,
    Lattice,
    ScalarField,
    are_on,
    level_solids,
    solve_field,
    with_contacts,
    within_lattice,
)
from ..project.series import Series, members
from ..settings.series import AUTO, FIELD
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import joined
from ..surfaces.series_field import SeriesField
from ..surfaces.sides import sides_of
from .parts.part_models import level

_BEYOND = 0.25  # of the range of heights of the data: how far above it all rock ends
_CELLS = 50_000  # of the lattice, about, where its resolution is automatic
_MOST_NODES = 20_000_000
# By how much of a cell the lattice reaches beyond the rock at its low end: not by a simple fraction, so that
# its planes do not lie in those of other meshes.
_MARGIN = np.array([0.63, 0.71, 0.57])


@dataclass(frozen=True)
class SeriesData:
    """What is known of a series. contacts: (C, 3) with the number (C,) of the surface in the series that each
    is on. dips, normals: (D, 3)."""

    contacts: np.ndarray
    surfaces: np.ndarray
    dips: np.ndarray
    normals: np.ndarray

    @classmethod
    def of(cls, entry: RockInput, series: Series, numbers: list[int]) -> SeriesData:
        points = [entry.rock.surfaces[number].point_array() for number in numbers]
        dips = series.space_dips()
        positions, normals = (np.empty((0, 3)),) * 2 if dips is None else (dips.positions, dips.normals)
        lengths = np.sqrt((normals * normals).sum(axis=1, keepdims=True))
        surfaces = np.repeat(np.arange(len(points)), [len(each) for each in points])
        return cls(np.concatenate(points), surfaces.astype(np.int32), positions, normals / lengths)

    def some(self, contacts: np.ndarray, dips: np.ndarray) -> SeriesData:
        """Some contacts (C,) bool, and some dips (D,) bool."""
        return SeriesData(
            self.contacts[contacts], self.surfaces[contacts], self.dips[dips], self.normals[dips]
        )

    def positions(self) -> np.ndarray:
        return np.concatenate([self.contacts, self.dips])


def place_level_sets(inputs: list[RockInput]) -> None:
    """Gives surfaces that are level sets a level above all rock, until their fields are made: what comes
    before has rock up to there."""
    for entry in inputs:
        if any(surface.is_level_set for surface in entry.rock.surfaces):
            above = level(entry.planar_mesh(), _top(entry))
            for number, surface in enumerate(entry.rock.surfaces):
                if surface.is_level_set:
                    entry.surfaces[number] = above


def make_fields(work: Work, inputs: list[RockInput], stage: int | None) -> None:
    """Gives rock masses whose other surfaces and compartments are made the fields of their series, and their
    surfaces the level sets of these. Raises InputRefused."""
    for entry in work.share_out(inputs):
        given = [series for series in entry.rock.series if series.kind == FIELD]
        waiting = [each for each in given if stage is None or members(entry.rock, each)[0] <= stage]
        entry.fields = []
        top = _top(entry) if waiting else 0.0
        for series in work.share_out(waiting):
            with work.phase(0.0, 1.0, f"making the field of {series.name}"):
                entry.fields.append(_field_of(work, entry, series, top))
    for entry in inputs:
        for own in entry.fields:
            _take_level_sets(work, entry, own)


def _top(entry: RockInput) -> float:
    """An elevation above all sheets and contacts of a rock mass, as far as these are known."""
    known = []
    for number, surface in enumerate(entry.rock.surfaces):
        sheets = [] if surface.is_level_set else entry.divided().sheets
        shapes = [entry.surfaces[number], *(own[number] for own in sheets)]
        known += [shape.vertices[:, 2] for shape in shapes if shape is not None and not surface.is_level_set]
        known.append(surface.point_array()[:, 2])
    base = entry.rock.base_elevation
    assert base is not None  # check_series
    highest = max((float(each.max()) for each in known if len(each)), default=base)
    return highest + _BEYOND * (highest - base) + 1e-3


def _field_of(work: Work, entry: RockInput, series: Series, top: float) -> SeriesField:
    numbers = members(entry.rock, series)
    data = SeriesData.of(entry, series, numbers)
    lattice = _lattice(entry, series, data, top)
    families = _families(entry, series, numbers)
    sides = sides_of(work, data.positions(), entry.divided().faults)
    fields = []
    for row in work.share_out(list(families.rows)):
        own = _within(data, sides, row, families)
        names = [surface.name for surface in entry.rock.surfaces[numbers[0] : numbers[-1] + 1]]
        with naming(f"{entry.rock.item}, {series.item}"):
            field = solve_field(
                lattice, FieldData(names, own.contacts, own.surfaces, own.dips, own.normals), work
            )
        fields.append(with_contacts(field, own.contacts, own.surfaces))
    of_compartment = [fields[own] for own in families.of_compartment]
    return SeriesField(series.name, numbers[0], len(numbers), of_compartment, top)


@dataclass(frozen=True)
class _Families:
    """rows: (N, A) int8 the sides of the faults that displace a series, which compartments with one field
    have in common. of_compartment: of each compartment its row. active: (F,) bool, these faults."""

    rows: np.ndarray
    of_compartment: list[int]
    active: np.ndarray


def _families(entry: RockInput, series: Series, numbers: list[int]) -> _Families:
    structure = entry.divided()
    faults = structure.faults
    active = faults.active(numbers[-1])
    item = f"{entry.rock.item}, {series.item}"
    for number in np.flatnonzero(faults.active(numbers[0]) & ~active):
        what = f"fault '{faults.names[number]}' displaces some of its surfaces, but not all"
        raise series.refused(what, "name", "divide it into two series, or change 'youngest'", item)
    for number in np.flatnonzero(active):
        if faults.dies_out[number]:
            what = f"fault '{faults.names[number]}', which dies out, displaces it: a field cannot do that yet"
            raise series.refused(what, "name", "let the fault end outside, or use sheets", item)
    rows, of_compartment = np.unique(structure.compartments[:, active], axis=0, return_inverse=True)
    return _Families(rows, of_compartment.ravel().tolist(), active)


def _within(data: SeriesData, sides: np.ndarray, row: np.ndarray, families: _Families) -> SeriesData:
    """The data in the compartments of a row of sides; all data where some surface has none there."""
    own = sides[:, families.active]
    here = ((own == row) | (row == 0)).all(axis=1)
    contacts, dips = here[: len(data.contacts)], here[len(data.contacts) :]
    some = data.some(contacts, dips)
    has_all = len(np.unique(some.surfaces)) == len(np.unique(data.surfaces))
    return some if has_all else data


def _lattice(entry: RockInput, series: Series, data: SeriesData, top: float) -> Lattice:
    """A lattice around the rock mass and the data of a series."""
    base = entry.rock.base_elevation
    plan = entry.planar_mesh().vertices[:, :2]
    places = data.positions()
    low = np.minimum([*plan.min(axis=0), base], places.min(axis=0))
    high = np.maximum([*plan.max(axis=0), top], places.max(axis=0))
    size = high - low
    is_auto = series.resolution == AUTO
    step = _cube_root(float(size.prod()) / _CELLS) if is_auto else float(series.resolution)
    origin = low - _MARGIN * step
    counts = np.ceil((high - origin) / step + 0.3).astype(np.int64) + 1
    if counts.astype(float).prod() > _MOST_NODES:
        coarser = step * _cube_root(float(counts.astype(float).prod()) / _MOST_NODES)
        what = f"its lattice would have {counts.astype(float).prod():,.0f} nodes"
        advice = f"use a resolution of {coarser:.2g} or more"
        raise series.refused(what, "resolution", advice, f"{entry.rock.item}, {series.item}")
    return Lattice(tuple(origin.tolist()), (step,) * 3, tuple(counts.tolist()))


def _cube_root(value: float) -> float:
    """By Newton's method: the same on all machines."""
    root = math.ldexp(1.0, math.frexp(value)[1] // 3)
    for _ in range(20):
        root = (2.0 * root + value / (root * root)) / 3.0
    return root


def _warn_of_missed(
    entry: RockInput, own: SeriesField, number: int, sheets: dict[ScalarField, Sheet]
) -> None:
    """Adds the warning about contacts of a surface that its level set does not pass through."""
    missed = []
    for field, sheet in sheets.items():
        contacts = field.points[field.point_values == field.levels[number - own.first]]
        missed += contacts[~are_on(contacts, sheet)].tolist()
    if missed:
        count = "a contact lies" if len(missed) == 1 else f"{len(missed)} contacts lie"
        text = f"{count} beside it, one at {place_text(tuple(missed[0]))}: use a finer resolution"
        surface = entry.rock.surfaces[number].name
        entry.warnings.append(BuildWarning(text, "contacts", entry.rock.name, surface))


def _take_level_sets(work: Work, entry: RockInput, own: SeriesField) -> None:
    """Sets the surfaces of a rock mass, and its sheets in compartments, that are level sets of a field."""
    with refused_as(lambda error: InputRefused(str(error), item=entry.rock.item, place=error.place)):
        sheets = {
            field: [within_lattice(field, solid) for solid in level_solids(work, field)]
            for field in own.distinct()
        }
    for number in own.numbers:
        _warn_of_missed(entry, own, number, {field: sheets[field][number - own.first] for field in sheets})
        each = [sheets[field][number - own.first] for field in own.fields]
        if entry.structure is not None:
            for compartment, sheet in zip(entry.structure.sheets, each, strict=True):
                compartment[number] = sheet
        entry.surfaces[number] = joined(list(dict.fromkeys(each)))
