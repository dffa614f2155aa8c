# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are conformable, which a series of sheets interpolates together, and what the surfaces of
a series know of one another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

import numpy as np

from ...base.errors import BuildWarning, InputRefused, number_list
from ...base.work import Work
from ...heights.companions import Alike, Companions
from ...heights.cross_validation import validate
from ...heights.interpolation import Task
from ...project.project import Rock, Surface
from ...readers.tables.observations import Bounds
from ...settings.dips import Dips
from ...settings.methods import METHODS, checked_options
from ...settings.rules import RULES
from ...settings.series_kinds import SHEETS
from .surface_data import SurfaceData

_MOST_ALIKE = 10_000  # points of a surface: more are a survey, which says of itself how its heights vary
# contacts of a surface: fewer do not show that it follows another one; more show its own shape, and take long
_LEAST, _MOST = 8, 300
_BETTER = 0.8  # of the error alone: below it two surfaces are taken to be conformable


@dataclass(frozen=True)
class _Compared:
    """Mean squares of the errors of contacts left out, from those of their own surface and of both."""

    alone: float
    together: float


@dataclass(frozen=True)
class _Part:
    """The data of two surfaces in a part of space: of each its points (P, 3), its dips, and the variogram
    data; error: as of Alike, of both."""

    points: list[np.ndarray]
    dips: list[Dips | None]
    alike: list[Alike | None]
    error: float


def conformable_run(rock: Rock, data: Sequence[SurfaceData], number: int) -> list[int]:
    """The surfaces that are interpolated with a variogram in the run of consecutive ones that their rules
    call conformable, oldest first, with one of them; none where it has no other, or is in a series. What
    protects itself, and what cuts older rock, has its own shape."""
    surfaces = rock.surfaces

    def is_kriged(other: int) -> bool:
        return _is_kriged(surfaces[other], data[other])

    def belongs(other: int) -> bool:
        rule = RULES[surfaces[other].rule]
        return not rule.protects and (other == 0 or not rule.cuts)

    if not belongs(number) or not is_kriged(number):
        return []
    first, last = number, number
    while first > 0 and belongs(first - 1):
        first -= 1
    while last + 1 < len(surfaces) and belongs(last + 1):
        last += 1
    run = [other for other in range(first, last + 1) if is_kriged(other)]
    return run if len(run) > 1 else []


def _is_kriged(surface: Surface, data: SurfaceData) -> bool:
    """Whether a surface that is read is interpolated separately from points with a variogram."""
    if surface.series is not None or not surface.has_points:
        return False
    if not 0 < len(data.points) <= _MOST_ALIKE:
        return False
    return METHODS[surface.method_options()[0]].may_be_kriged


def alike_of(rock: Rock, data: Sequence[SurfaceData], number: int, known: dict[bytes, Any]) -> Alike | None:
    """The surfaces whose data say how heights of one vary; None where there are no others. known: as of
    Alike."""
    run = conformable_run(rock, data, number)
    if not run:
        return None
    beside = [data[member] for member in run]
    points = [np.ascontiguousarray(surface.points) for surface in beside]
    return Alike(run.index(number), points, [surface.dips for surface in beside], known, mean_error(beside))


def mean_error(surfaces: Sequence[SurfaceData]) -> float:
    """The mean variance of the errors of the heights of all points of surfaces that are read."""
    counts = [len(surface.points) for surface in surfaces]
    squares = sum(count * surface.error for count, surface in zip(counts, surfaces, strict=True))
    return squares / max(sum(counts), 1)


def proposals(
    work: Work,
    rock: Rock,
    data: Sequence[SurfaceData],
    numbers: Sequence[int],
    sides: Mapping[int, np.ndarray] | None = None,
) -> list[BuildWarning]:
    """A warning for each run of consecutive surfaces among those of a rock mass with these numbers whose
    contacts, left out one by one, are estimated better with those of the next surface: they are conformable,
    and none of them is in a series. sides: of each surface (P, F), on which side of each fault that displaces
    it its points are; None without faults."""
    runs: list[list[int]] = []
    errors: dict[tuple[int, int], _Compared] = {}
    fits: dict[bytes, Any] = {}
    known_numbers = [number for number in numbers if _is_known(rock, data, number)]
    for one, other in pairwise(known_numbers):
        if other != one + 1:
            continue
        pair = (one, other)
        comparison = _compared(work, _parts(rock, data, fits, pair, sides))
        if comparison is None or not comparison.together < _BETTER**2 * comparison.alone:
            continue
        errors[one, other] = comparison
        if runs and runs[-1][-1] == one:
            runs[-1].append(other)
        else:
            runs.append([one, other])
    return [_proposal(rock, run, [errors[pair] for pair in pairwise(run)]) for run in runs]


def _is_known(rock: Rock, data: Sequence[SurfaceData], number: int) -> bool:
    surface = rock.surfaces[number]
    count = len(data[number].points) if surface.has_points else 0
    return surface.series is None and _LEAST <= count <= _MOST


def _parts(
    rock: Rock,
    data: Sequence[SurfaceData],
    fits: dict[bytes, Any],
    pair: tuple[int, int],
    sides: Mapping[int, np.ndarray] | None,
) -> list[_Part]:
    """The data of two surfaces, by the parts of space where both have enough points. fits: as of Alike."""
    surfaces = [data[number] for number in pair]
    points = [np.ascontiguousarray(surface.points) for surface in surfaces]
    if sides is None:
        alike = [alike_of(rock, data, number, fits) for number in pair]
        return [_Part(points, [surface.dips for surface in surfaces], alike, mean_error(surfaces))]
    of_points = [sides[number] for number in pair]
    parts = []
    for key in np.unique(of_points[0], axis=0):
        part_points = [xyz[(rows == key).all(axis=1)] for xyz, rows in zip(points, of_points, strict=True)]
        if min(map(len, part_points)) >= _LEAST:
            parts.append(_Part(part_points, [None, None], [None, None], mean_error(surfaces)))
    return parts


def _compared(work: Work, parts: Sequence[_Part]) -> _Compared | None:
    """Of two surfaces, whose data these are; None where their points cannot be kriged."""
    squares: list[list[np.ndarray]] = [[], []]
    settings, nodes = checked_options("kriging", {}), np.empty((0, 2))
    try:
        for part, index in product(parts, range(2)):
            both = Companions(index, part.points, part.dips, error=part.error)
            for which, companions in enumerate((None, both)):
                task = Task(work, part.points[index], nodes, settings, dips=part.dips[index])
                task = replace(task, companions=companions, alike=part.alike[index], error=part.error)
                error = validate("kriging", task, 2).errors
                squares[which].append(error[np.isfinite(error)] ** 2)
    except InputRefused:  # it is said where the surface itself is interpolated
        return None
    alone, together = (np.concatenate([np.empty(0), *arrays]) for arrays in squares)
    if not len(alone) or not len(together):
        return None
    return _Compared(float(alone.mean()), float(together.mean()))


def _proposal(rock: Rock, run: list[int], errors: list[_Compared]) -> BuildWarning:
    names = number_list([f"'{rock.surfaces[number].name}'" for number in run])
    alone, together = (
        float(np.sqrt(np.mean([getattr(compared, key) for compared in errors])))
        for key in ("alone", "together")
    )
    text = (
        f"surfaces {names} are conformable: a contact that is left out is estimated with an error of "
        f"{alone:.3g} from its own surface, and of {together:.3g} with the next one: a series of the kind "
        '"sheets" interpolates them together, by method kriging'
    )
    return BuildWarning(text, "series", rock.name)


def sheets_beside(rock: Rock, number: int) -> list[int]:
    """The surfaces of the series of sheets of one, itself included, oldest first; none where it is in
    none."""
    name = rock.surfaces[number].series
    for series in rock.series:
        if series.kind == SHEETS and series.name == name:
            return rock.members(series)
    return []


def with_least_thickness(rock: Rock) -> Rock:
    """A rock mass whose sheets of a series do not lie below the older one of it."""
    surfaces = list(rock.surfaces)
    for number, surface in enumerate(surfaces):
        beside = sheets_beside(rock, number)
        if beside and number > beside[0] and surface.minimum_thickness is None:
            surfaces[number] = replace(surface, minimum_thickness=0.0)
    return replace(rock, surfaces=surfaces)


def companions_of(
    rock: Rock, data: Sequence[SurfaceData], number: int, known: dict[bytes, Any]
) -> Companions | None:
    """The sheets with which a surface is interpolated; None where none of the others has points. known: as
    of Alike."""
    beside = sheets_beside(rock, number)
    if not any(len(data[other].points) for other in beside if other != number):
        return None
    sheets = [data[other] for other in beside]
    points = [np.ascontiguousarray(sheet.points) for sheet in sheets]
    dips = [sheet.dips for sheet in sheets]
    return Companions(beside.index(number), points, dips, known, mean_error(sheets))


def bounds_beside(bounds: Bounds, companions: Companions | None) -> Bounds:
    """Bounds of a surface, and those by the contacts of the other sheets: it lies at or above the older
    ones, and at or below the younger ones."""
    if companions is None:
        return bounds
    parts = [bounds]
    for other, points in enumerate(companions.points):
        if other != companions.own and len(points):
            is_older = np.full(len(points), other < companions.own)
            parts.append(replace(Bounds.at_or_above(points), is_lower=is_older))
    return Bounds.joined(parts)
