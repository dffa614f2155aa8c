# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of a rock mass's surfaces: each surface once for each combination of sides of the faults that
displace it, from the data in these compartments."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from ..build_warning import BuildWarning
from ..errors import InputRefused
from ..mapped_arrays import Keep, as_it_is
from ..project import surface_item
from ..surface_heights import interpolation_order
from ..work import Work
from ..wrong_sides import Triangulation, points_too_low
from .families import Family, around_tips, families
from .interpolated_sheets import InterpolatedSurface
from .ready_sheets import ReadyMesh


def make_sheets(
    work: Work,
    entry,
    start: float,
    end: float,
    threads: int,
    stage: int | None = None,
    keep: Keep = as_it_is,
) -> None:
    """Gives each surface of a RockInput with faults its sheets, in `entry.structure`, those up to `stage`.
    Progress goes from `start` to `end`. keep: where a surface's arrays are kept once its sheets are made.

    Raises InputRefused for a surface that has data in no compartment.
    """
    rock = entry.rock
    count = len(rock.surfaces) if stage is None else min(stage + 1, len(rock.surfaces))
    interpolated = interpolation_order(rock, stage)
    ready = [number for number in range(count) if number not in interpolated]
    steps = np.linspace(start, end, count + 1).tolist()[len(ready) :]

    def sheets_of(part: Work, number: int, own_threads: int) -> list:
        with part.phase(0.0, 1.0, f"interpolating {rock.surfaces[number].name}"):
            return _make_named(ReadyMesh, part, entry, number, own_threads, keep)

    # ready meshes need no others
    with work.phase(start, steps[0], "interpolating surfaces"):
        for warnings in work.each(sheets_of, ready, threads):
            entry.structure.warnings += warnings
    for number, (begin, finish) in zip(interpolated, itertools.pairwise(steps), strict=True):
        with work.phase(begin, finish, f"interpolating {rock.surfaces[number].name}"):
            entry.structure.warnings += _make_named(InterpolatedSurface, work, entry, number, threads, keep)
    for number in sorted(interpolated):
        _warn_of_points_too_low(work, entry, number, threads)


def _make_named(kind, work: Work, entry, number: int, threads: int, keep: Keep) -> list:
    """_make; its errors name the surface."""
    rock = entry.rock
    try:
        warnings = _make(entry, number, kind(work, entry, number, threads))
    except InputRefused as error:
        if error.item is not None and error.item.startswith("rock '"):
            raise
        surface = rock.surfaces[number]
        file, line = surface.shape_source()
        raise error.within(surface_item(rock, surface), file=file, line=line) from error
    _keep(entry, number, keep)
    return warnings


def _keep(entry, number: int, keep: Keep) -> None:
    """Keeps the arrays of a surface elsewhere. Sheets and arrays that are the same object stay so."""
    arrays: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    made: dict[int, tuple[Triangulation, Triangulation]] = {}

    def kept(array: np.ndarray) -> np.ndarray:
        if id(array) not in arrays:
            arrays[id(array)] = array, keep(array)
        return arrays[id(array)][1]

    for sheets in entry.structure.sheets:
        sheet = sheets[number]
        if id(sheet) not in made:
            made[id(sheet)] = sheet, tuple(map(kept, sheet))
        sheets[number] = made[id(sheet)][1]
    if number in entry.attributes:
        entry.attributes[number] = {name: keep(of) for name, of in entry.attributes[number].items()}


def _warn_of_points_too_low(work: Work, entry, number: int, threads: int) -> None:
    """Adds the warnings of points_too_low, compartment by compartment."""
    structure, surfaces = entry.structure, entry.rock.surfaces
    points = np.asarray(surfaces[number].points, np.float64).reshape(-1, 3)
    sides = structure.points[number]
    for compartment, row in enumerate(structure.compartments):
        own = (sides == row).all(axis=1)
        if not own.any():
            continue
        its = [*surfaces[:number], replace(surfaces[number], points=points[own]), *surfaces[number + 1 :]]
        one = replace(
            entry,
            rock=replace(entry.rock, surfaces=its),
            surfaces=structure.sheets[compartment],
            warnings=[],
            structure=None,
        )
        for warning in points_too_low(work, one, [number], threads):
            structure.warn([compartment], warning)


def _make(entry, number: int, surface) -> list:
    """Makes the sheets of a surface. Returns warnings, as a RockStructure has them, of compartments without
    data."""
    structure, warnings = entry.structure, []
    every = families(structure, number)
    with_data = [family for family in every if surface.has_data(family)]
    if not with_data:
        raise InputRefused(
            f"its {surface.data} lie in no compartment of the rock mass",
            advice="check the coordinates of the surface and of the faults",
        )
    made = {family.key: surface.sheets(family) for family in with_data}
    counts = {family.key: surface.count(family) for family in every}
    lacking = [family for family in every if family.key not in made]
    while lacking:
        sources = {family.key: _neighbor(family.key, made, counts) for family in lacking}
        if not any(sources.values()):  # none of them is across one fault only
            sources = dict.fromkeys(sources, max(made, key=lambda key: (counts[key], key)))
        for family in lacking:
            if (source := sources[family.key]) is not None:
                made[family.key] = _taken_over(surface, family, made[source])
                origin = next(each for each in every if each.key == source)
                warnings.append(_taken_over_warning(entry, number, surface, family, origin))
        lacking = [family for family in lacking if family.key not in made]
    for family in every:
        for compartment, sides in family.members.items():
            structure.sheets[compartment][number] = made[family.key][sides]
    for together in around_tips(structure, number, every):
        sheets = {sides: structure.sheets[each][number] for each, sides in together.members.items()}
        drawn = _drawn_together(surface, together, sheets)
        for compartment, sides in together.members.items():
            structure.sheets[compartment][number] = drawn[sides]
    surface.finish(structure.distinct(number))
    return warnings


def _neighbor(key, made, counts):
    """The family with the most data among those with sheets across one fault; None where there is none."""
    near = [other for other in made if sum(a != b for a, b in zip(key, other, strict=True)) == 1]
    return max(near, key=lambda other: (counts[other], other), default=None)


def _taken_over(surface, family: Family, sheets: dict) -> dict:
    """Sheets of another family by the sides of this one, whose faults that die out may differ."""
    first = next(iter(sheets.values()))
    taken = {sides: sheets.get(sides, first) for sides in family.members.values()}
    return _drawn_together(surface, family, taken)


def _drawn_together(surface, family: Family, sheets: dict) -> dict:
    """Sheets by sides, equal beyond the tips; the same ones where they were."""
    drawn = surface.drawn_together(family, sheets)
    return {
        sides: sheet if np.array_equal(drawn[sides][0], sheet[0]) else drawn[sides]
        for sides, sheet in sheets.items()
    }


def _taken_over_warning(entry, number: int, surface, family: Family, source: Family):
    names = entry.structure.names
    here, there = (names[next(iter(each.members))] for each in (family, source))
    text = f"it has no {surface.data} in compartment '{here}': there it goes on as in compartment '{there}'"
    warning = BuildWarning(text, "compartment", entry.rock.name, entry.rock.surfaces[number].name)
    return list(family.members), warning
