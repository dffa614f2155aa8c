# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of a rock mass's surfaces: each surface once for each combination of sides of the faults that
displace it, from the data in these compartments."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from ...base.mapped_arrays import StoreArray, unchanged
from ...base.triangles import Sheet
from ...base.work import Work
from ...project.project import Rock
from ...surfaces.doubtful_heights import Compartment, doubtful_heights
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import RockStructure, fault_sides
from ...surfaces.surface_heights import interpolation_order
from ...surfaces.wrong_sides import points_too_low
from .compartment_sheets import CompartmentSheets, make_borrowed
from .fitted_throws import fit_throws
from .interpolated_sheets import InterpolatedSurface
from .ready_sheets import ReadyMesh
from .throws import Throws


def make_sheets(
    work: Work,
    entry: RockInput,
    stage: int | None = None,
    keep: StoreArray = unchanged,
    numbers: Collection[int] | None = None,
    with_levels: Callable[[Work, RockInput], RockStructure] = lambda _, entry: entry.divided(),
) -> None:
    """Gives each surface of a RockInput with faults its sheets, in `entry.structure`, those up to `stage`.
    keep: where a surface's arrays are kept once its sheets are made.
    numbers: of the surfaces, with those that they need; None: of all that have no sheets yet.
    with_levels: the compartments with sheets of level sets, if others need the throws that these show.

    Surfaces without enough data in a compartment come last, for the throw of others is needed there: also
    that of those younger than `stage`, so that a stage is as in the whole. Raises InputRefused for a surface
    that has data in no compartment.
    """
    rock = entry.rock
    interpolated, ready = (
        [
            number
            for number in group
            if (numbers is None or number in numbers) and not entry.divided().is_made(number)
        ]
        for group in _by_kind(rock, stage)
    )
    steps = np.linspace(0.0, 1.0, len(ready) + len(interpolated) + 1).tolist()[len(ready) :]

    def begin(part: Work, number: int) -> CompartmentSheets:
        kind = InterpolatedSurface if rock.is_interpolated(rock.surfaces[number]) else ReadyMesh
        with entry.named(number):
            sheets = CompartmentSheets(entry, number, kind(part, entry, number))
        sheets.make_own()
        if not sheets.waiting:
            finish(sheets)
        return sheets

    def begin_ready(part: Work, number: int) -> CompartmentSheets:
        with part.phase(0.0, 1.0, f"interpolating {rock.surfaces[number].name}"):
            return begin(part, number)

    def finish(sheets: CompartmentSheets) -> None:
        with entry.named(sheets.number):
            sheets.finish()
        _keep(entry, sheets.number, keep)

    few = entry.divided().few
    with work.phase(0.0, steps[0], "interpolating surfaces"):
        if entry.divided().steps is None:
            entry.divided().steps = fit_throws(work, entry)
        started = work.each(begin_ready, ready)  # ready meshes need no others
    for number, (low, high) in zip(interpolated, itertools.pairwise(steps), strict=True):
        with work.phase(low, high, f"interpolating {rock.surfaces[number].name}"):
            started.append(begin(work, number))
    few += [sheets.number for sheets in started if sheets.few and not sheets.waiting]
    unfinished = [sheets for sheets in started if sheets.waiting]
    if unfinished:
        with work.phase(1.0, 1.0, "interpolating surfaces"):
            begun = {*ready, *interpolated}
            for number in itertools.chain(*reversed(_by_kind(rock, None))):
                if number not in begun and not entry.divided().is_made(number):
                    unfinished.append(begin(work, number))
            for sheets in unfinished:
                sheets.surface.work = work
            make_borrowed(unfinished, Throws(work, with_levels(work, entry), few), finish)
        younger = {surface.name for surface in rock.surfaces[_count(rock, stage) :]}
        warnings = entry.divided().warnings
        entry.divided().warnings = [row for row in warnings if row[1].surface not in younger]


def _by_kind(rock: Rock, stage: int | None) -> tuple[list[int], list[int]]:
    """The surfaces that are interpolated, each after those that it needs, and the others."""
    interpolated = interpolation_order(rock, stage)
    return interpolated, [number for number in range(_count(rock, stage)) if number not in interpolated]


def _count(rock: Rock, stage: int | None) -> int:
    """The number of surfaces up to a stage."""
    return len(rock.surfaces) if stage is None else min(stage + 1, len(rock.surfaces))


def warn_of_doubts(work: Work, entry: RockInput, stage: int | None, keep: StoreArray) -> None:
    """Adds the warnings about heights of a RockInput with sheets, compartment by compartment."""
    for number in sorted(interpolation_order(entry.rock, stage)):
        _warn_of_doubts(work, entry, number, keep)
    entry.untied.clear()


def _keep(entry: RockInput, number: int, keep: StoreArray) -> None:
    """Keeps the arrays of a surface elsewhere. Sheets and arrays that are the same object stay so."""
    made: dict[Sheet, Sheet] = {}

    def kept(sheet: Sheet, name: str) -> np.ndarray:
        array = getattr(sheet, name)
        for old, new in made.items():
            if getattr(old, name) is array:
                return getattr(new, name)
        return keep(array)

    structure = entry.divided()
    for compartment, sheets in enumerate(structure.sheets):
        sheet = structure.sheet(compartment, number)
        if sheet not in made:
            made[sheet] = Sheet(kept(sheet, "vertices"), kept(sheet, "triangles"))
        sheets[number] = made[sheet]
    if number in entry.attributes:
        entry.attributes[number] = {name: keep(of) for name, of in entry.attributes[number].items()}


def _warn_of_doubts(work: Work, entry: RockInput, number: int, keep: StoreArray) -> None:
    """Adds the warnings of points_too_low and, but for tiles, doubtful_heights, compartment by
    compartment."""
    structure, data = entry.divided(), entry.data[number]
    points = data.points
    sides = structure.points[number]
    for compartment, row in enumerate(structure.compartments):
        inside = (sides == row).all(axis=1)
        one = replace(
            entry,
            surfaces=structure.sheets[compartment],
            warnings=[],
            structure=None,
            data=[*entry.data[:number], data.some(inside), *entry.data[number + 1 :]],
        )

        def holds(places: np.ndarray, row: np.ndarray = row) -> np.ndarray:
            held = np.ones(len(places), bool)
            for fault in np.flatnonzero(row).tolist():  # where another is not, these sides say so
                shape = structure.faults.shapes[fault]
                held[held] = fault_sides(work, places[held], shape) == row[fault]
            return held

        warnings = points_too_low(work, one, [number])
        if keep is unchanged:
            of_sheet = points[((sides == row) | ~structure.faults.active(number)).all(axis=1)]
            warnings += doubtful_heights(work, one, [number], Compartment(of_sheet, holds))
        for warning in warnings:
            structure.warn([compartment], warning)
