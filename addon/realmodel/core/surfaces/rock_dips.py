# SPDX-License-Identifier: GPL-3.0-or-later
"""The dips of a whole rock mass, each given to the surfaces that it counts for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.errors import BuildWarning, InputRefused, place_text
from ..base.work import Work
from ..heights import heights
from ..heights.interpolation import Task
from ..project.project import Rock, Surface, surface_item
from ..project.series import Series
from ..readers.tables.observations import LeftOut
from ..settings.dips import Dips
from ..settings.methods import (
    CONTINUATION,
    CONTINUATION_OPTIONS,
    DEFAULT_METHOD,
    DEFAULT_OPTIONS,
    METHODS,
    SURFACE_OPTIONS,
    checked_options,
)
from ..settings.rules import RULES
from .observed.derived import BlockNumbers
from .observed.dip_surfaces import beside_blocks, blocks_at, runs_of_blocks
from .rock_input import RockInput
from .wrong_sides import heights_at

_ROUNDS = 8  # surfaces that have not settled then do not
_SHOWN_BY_POINTS = 10  # fewer do not show without dips where a surface is


def apply_dips(work: Work, entry: RockInput, ground: int | None, mapped: np.ndarray | None) -> None:
    """Gives each surface of a RockInput that is read, but not interpolated, the dips of its rock mass and of
    its series of sheets that count for it. ground: the number of the surface that is the ground of a map;
    mapped: (D,) texts, the blocks that this shows at dips of the rock mass, as of FieldData. Raises
    InputRefused where a dip names a surface that uses none."""
    rock, parts = entry.rock, list[tuple[Dips, np.ndarray]]()
    if isinstance(rock.dips, Dips):
        parts.append((rock.dips, _of_rock(work, entry, rock.dips, ground, mapped)))
    for series in rock.series:
        if isinstance(series.dips, Dips):
            parts.append((series.dips, _of_sheets(entry, series, series.dips)))
    for number, data in enumerate(entry.data):
        joined = Dips.joined([dips.some(counts[:, number]) for dips, counts in parts])
        if len(joined):
            # without names, and all in use
            of_rock = Dips(joined.positions, joined.gradients, joined.heights)
            dips = of_rock if data.dips is None else Dips.joined([data.dips, of_rock])
            entry.data[number] = replace(data, dips=dips)


def _of_sheets(entry: RockInput, series: Series, dips: Dips) -> np.ndarray:
    """(D, S) bool: the surfaces that each dip of a series of sheets counts for: that which it names, or those
    of the series under and over its block; without a name all of them, as they are conformable."""
    rock, members = entry.rock, entry.rock.members(series)
    of_surfaces, of_blocks = dips.named
    counts = np.zeros((len(dips), len(rock.surfaces)), bool)
    counts[:, members] = ((of_surfaces == "") & (of_blocks == ""))[:, None]
    blocks = np.where(of_surfaces == "", BlockNumbers(rock).of(of_blocks), -1)
    for number in members:
        counts[:, number] |= of_surfaces == rock.surfaces[number].name
        counts[:, number] |= (blocks >= 0) & ((blocks == number) | (blocks == number + 1))
    counts[~dips.in_use] = False
    for row in np.flatnonzero(dips.in_use & ~counts.any(axis=1)).tolist():
        entry.left_out.append(LeftOut("dip_series", _called(dips, row), place=_place(dips, row)))
    return counts


def _of_rock(
    work: Work, entry: RockInput, dips: Dips, ground: int | None, mapped: np.ndarray | None
) -> np.ndarray:
    """(D, S) bool: the surfaces that each dip of a rock mass counts for."""
    rock = entry.rock
    counts, is_known = _named(entry, dips, ground)
    surfaces, blocks = dips.named
    without = np.flatnonzero((surfaces == "") & (blocks == ""))
    if len(without):
        runs = runs_of_blocks([surface.rule for surface in rock.surfaces], ground)
        alike = (runs[0 if rock.base_elevation is not None else 1 :] == runs[-1]).all()
        shown = None if mapped is None else mapped[without]
        if alike:
            counts[without] = runs[-1]
        else:
            counts[without] = _by_blocks(work, entry, dips.some(without), shown, runs)
    is_known &= dips.in_use
    counts[~dips.in_use] = False
    entry.warnings += _of_default_rules(rock, int((is_known & (surfaces == "")).sum()))
    for row in np.flatnonzero(is_known & ~counts.any(axis=1)).tolist():
        entry.left_out.append(LeftOut("dip_surface", _called(dips, row), place=_place(dips, row)))
    for number, surface in enumerate(rock.surfaces):
        if counts[:, number].any() and not uses_dips(rock, surface):
            entry.warnings.append(_not_used(rock, number, int(counts[:, number].sum())))
            counts[:, number] = False
    return counts


def uses_dips(rock: Rock, surface: Surface) -> bool:
    """Whether dips can have an effect on a surface."""
    return rock.is_interpolated(surface) and METHODS[surface.method or DEFAULT_METHOD].is_constrained


def _named(entry: RockInput, dips: Dips, ground: int | None) -> tuple[np.ndarray, np.ndarray]:
    """(D, S) bool: the surfaces that each dip with a name counts for; and (D,) bool: the dips that name
    nothing unknown. The others are listed."""
    rock = entry.rock
    names = [surface.name for surface in rock.surfaces]
    of_surfaces, of_blocks = dips.named
    counts = np.zeros((len(dips), len(names)), bool)
    for number, name in enumerate(names):
        counts[of_surfaces == name, number] = True
        if counts[:, number].any():
            _require_dips(rock, number)
    by_block = (of_surfaces == "") & (of_blocks != "")
    blocks = np.where(by_block, BlockNumbers(rock).of(of_blocks), -1)
    is_known = np.where(by_block, blocks >= 0, (of_surfaces == "") | np.isin(of_surfaces, names))
    beside = beside_blocks([surface.rule for surface in rock.surfaces], ground)
    counts[blocks >= 0] = beside[blocks[blocks >= 0]]
    for row in np.flatnonzero(~is_known).tolist():
        name = str(of_surfaces[row] or of_blocks[row])
        entry.left_out.append(LeftOut("dip_unit", _called(dips, row), name, place=_place(dips, row)))
    return counts, is_known


def _of_default_rules(rock: Rock, count: int) -> list[BuildWarning]:
    """The warning about dips of beds, so many, where each surface cuts those beneath it, as by default."""
    rules = [surface.rule for surface in rock.surfaces]
    if not count or len(rules) < 2 or not all(RULES[rule].cuts for rule in rules[1:]):
        return []
    text = (
        f"{count} dips of blocks count for unconformities, too, as all surfaces have a rule that cuts: give "
        "those that are parallel to the beds beneath them the rule conformable, or name the surfaces of dips"
    )
    return [BuildWarning(text, "dips", rock.name)]


def _require_dips(rock: Rock, number: int) -> None:
    """Refuses dips that name a surface which cannot use them."""
    surface = rock.surfaces[number]
    if uses_dips(rock, surface):
        return
    advice = "leave them out"
    if rock.is_level_set(surface):
        advice = "give them to its series"
    elif surface.has_points:
        advice = f"{', '.join(name for name, method in METHODS.items() if method.is_constrained)} use them"
    file, line = rock.place_of("dips")
    what = f"dips of the rock mass name it, but {_why_none(rock, surface)}"
    raise InputRefused(what, file=file, line=line, item=surface_item(rock, surface), advice=advice)


def _not_used(rock: Rock, number: int, count: int) -> BuildWarning:
    surface = rock.surfaces[number]
    text = f"{count} dips of blocks of the rock mass would count for it, but {_why_none(rock, surface)}"
    return BuildWarning(text, "dips", rock.name, surface.name)


def _why_none(rock: Rock, surface: Surface) -> str:
    """Why dips of the rock mass have no effect on a surface."""
    if rock.is_level_set(surface):
        return f"it is a level set of series '{surface.series}', which has its own"
    return f"method '{surface.method}' does not use dips" if surface.has_points else "a ready mesh uses none"


def _by_blocks(
    work: Work, entry: RockInput, dips: Dips, shown: np.ndarray | None, runs: np.ndarray
) -> np.ndarray:
    """(D, S) bool: the surfaces that dips count for, by the block that each lies in: that which a map shows,
    or by the surfaces; one without a height lies at the top of what is there. Surfaces of few points need
    dips to be known: all of them to begin with, then those of the blocks that this gave, until these stay.
    runs: of runs_of_blocks."""
    rules = [surface.rule for surface in entry.rock.surfaces]
    plan = np.ascontiguousarray(dips.positions)
    first_heights = [_first_heights(work, entry, number, plan) for number in range(len(rules))]
    counts = np.ones((len(dips), len(rules)), bool)
    counts[:, ~runs.any(axis=0)] = False
    for _ in range(_ROUNDS):
        surface_heights = [
            _heights_by_dips(work, entry, number, dips, counts[:, number]) if z is None else z
            for number, z in enumerate(first_heights)
        ]
        blocks = blocks_at(rules, np.array(surface_heights), dips.heights)
        if shown is not None:
            blocks = np.where(shown == "", blocks, BlockNumbers(entry.rock).of(shown))
        before, counts = counts, runs[blocks]
        if all(z is not None for z in first_heights) or np.array_equal(counts, before):
            break
    return counts


def _heights_by_dips(work: Work, entry: RockInput, number: int, dips: Dips, counts: np.ndarray) -> np.ndarray:
    """(D,) heights of a surface of few points at dips, from its points and the dips that count for it."""
    plan, surface_dips = np.ascontiguousarray(dips.positions), entry.data[number].dips
    joined = Dips.joined([*([] if surface_dips is None else [surface_dips]), dips.some(counts)])
    slopes = Dips(joined.positions, joined.gradients) if len(joined) else None
    with entry.named(number):
        settings = checked_options(DEFAULT_METHOD, DEFAULT_OPTIONS)
        return heights(DEFAULT_METHOD, Task(work, entry.data[number].points, plan, settings, dips=slopes)).z


def _first_heights(work: Work, entry: RockInput, number: int, plan: np.ndarray) -> np.ndarray | None:
    """(N,) heights of a surface at places (N, 2) as its points alone show them, NaN where it has none; None
    where its points are few and it uses dips."""
    surface, shape = entry.rock.surfaces[number], entry.surfaces[number]
    if shape is not None and not entry.rock.is_interpolated(surface):
        return heights_at(work, shape, plan)
    points = entry.data[number].points
    method, settings = surface.method_options()
    if len(points):
        if uses_dips(entry.rock, surface) and len(points) < _SHOWN_BY_POINTS:
            return None
        method, settings = CONTINUATION, checked_options(CONTINUATION, CONTINUATION_OPTIONS)
    elif any(isinstance(settings.get(option), str) for option in SURFACE_OPTIONS) or METHODS[method].on_mesh:
        return np.full(len(plan), np.nan)
    with entry.named(number):
        return heights(method, Task(work, points, plan, settings)).z


def _called(dips: Dips, row: int) -> str:
    """A dip in messages."""
    surface, block = (str(names[row]) for names in dips.named)
    named = surface or block
    return place_text(_place(dips, row)) + (f", '{named}'" if named else "")


def _place(dips: Dips, row: int) -> tuple[float, ...]:
    place = dips.positions[row].tolist()
    return (*place, *dips.heights[[row]].tolist()) if np.isfinite(dips.heights[row]) else tuple(place)
