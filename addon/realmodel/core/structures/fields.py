# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of series: one in each compartment, and the level sets that are its surfaces there."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.algebra import are_among, cube_root
from ..base.errors import InputRefused, naming
from ..base.triangles import Sheet
from ..base.work import Work, refused_as
from ..fields import (
    HeldData,
    Lattice,
    LevelSetData,
    ScalarField,
    SolvedField,
    fields_with_contacts,
    level_solids,
    solve_field,
)
from ..fields.series_field import SeriesField
from ..project.series import Series
from ..settings.series_kinds import BY_DATA, FIELD
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import RockStructure, joined, sides_of
from ..surfaces.surface_heights import where_known
from .bed_thicknesses import ROUNDS, BedThicknesses
from .field_warnings import (
    leave_out,
    warn_of_contacts,
    warn_of_critical_points,
    warn_of_direction,
    warn_of_distance,
    warn_of_field,
    warn_of_lacks,
    warn_of_thicknesses,
    warn_of_volumes,
    within_rock,
)
from .parts.part_models import level
from .series_data import SeriesData
from .sheets.families import DIES_OUT, CompartmentTest, Family, families
from .slits import Slits

_BEYOND = 0.25  # of the range of heights of the data: how far above it all rock ends
_CELLS = 50_000  # of the lattice, about, where its resolution is automatic
_MOST_NODES = 20_000_000
_DIGITS = 20  # of an edge of the lattice
_NEAR = 1e-12  # of the range of f: a bound so near holds
_PLACES = 0.5  # of an edge of the lattice: how far places within intervals are apart at most
_FEW = 1500  # contacts and dips: of more each compartment has a field of its own data
MOST_TOGETHER = 32  # compartments whose fields are one function
_AT_ONCE = 1 << 20  # places at which a field is asked
_ROUNDS = 4  # in which bounds that contacts have put off are held
# By how much of a cell the lattice reaches beyond the rock at its low end: not by a simple fraction, so that
# its planes do not lie in those of other meshes.
_MARGIN = np.array([0.63, 0.71, 0.57])


def place_level_sets(inputs: list[RockInput]) -> None:
    """Gives surfaces that are level sets a level above all rock, until their fields are made: what comes
    before has rock up to there."""
    for entry in inputs:
        if any(map(entry.rock.is_level_set, entry.rock.surfaces)):
            above = level(entry.planar_mesh(), _top(entry))
            for number, surface in enumerate(entry.rock.surfaces):
                if entry.rock.is_level_set(surface):
                    entry.surfaces[number] = above


def make_fields(work: Work, inputs: list[RockInput], stage: int | None) -> None:
    """Gives rock masses whose other surfaces and compartments are made the fields of their series, and their
    surfaces the level sets of these. Raises InputRefused."""
    for entry in work.share_out(inputs):
        field_series = [series for series in entry.rock.series if series.kind == FIELD]
        waiting = [
            series for series in field_series if stage is None or entry.rock.members(series)[0] <= stage
        ]
        entry.fields = []
        top = _top_of_fields(entry) if waiting else 0.0
        for series in work.share_out(waiting):
            with work.phase(0.0, 1.0, f"making the field of {series.name}"):
                entry.fields.append(_field_of(work, entry, series, top))
    for entry in inputs:
        for series_field in entry.fields:
            _take_level_sets(work, entry, series_field)


def with_levels(work: Work, entry: RockInput) -> RockStructure:
    """The compartments of a RockInput whose sheets are not all made, with level sets in place of the levels
    above all rock: what the data alone say, for the throws that these show. Each is where its field passes
    the level once over a node of the planar mesh."""
    structure = entry.divided()
    waiting = [series for series in entry.rock.series if series.kind == FIELD and entry.rock.members(series)]
    if not waiting:
        return structure
    trial = replace(entry, warnings=[], left_out=[])  # what it says is said when the fields are made
    top = _top_of_fields(trial)
    sheets = [list(row) for row in structure.sheets]
    for series_field in (_field_of(work, trial, series, top) for series in waiting):
        for field, compartments in series_field.distinct().items():
            for number, sheet in zip(
                series_field.numbers, _single_heights(entry.planar_mesh(), field), strict=True
            ):
                for compartment in compartments:
                    sheets[compartment][number] = sheet
    return replace(structure, sheets=sheets)


def _single_heights(plan: Sheet, field: ScalarField) -> list[Sheet | None]:
    """For each level of a field the sheet of the nodes of a planar mesh over which it is passed once; None
    where there is no such triangle."""
    nodes = plan.vertices[:, :2]
    low, high = (corner[2] for corner in field.lattice.corners)
    z = np.linspace(low, high, 2 * field.lattice.counts[2])
    heights = np.full((len(field.levels), len(nodes)), np.nan)
    some = max(1, _AT_ONCE // len(z))
    for start in range(0, len(nodes), some):
        part = nodes[start : start + some]
        places = np.column_stack([np.repeat(part, len(z), axis=0), np.tile(z, len(part))])
        f = field.at(places).reshape(len(part), len(z))
        for level_heights, level_of in zip(heights, field.levels, strict=True):
            over = f - level_of
            passes = (over[:, :-1] < 0) != (over[:, 1:] < 0)
            at = passes.argmax(axis=1)[:, None]
            begin, end = (np.take_along_axis(over, index, axis=1)[:, 0] for index in (at, at + 1))
            step = np.where(end != begin, end - begin, 1.0)
            crossings = z[at[:, 0]] - begin / step * (z[1] - z[0])
            level_heights[start : start + some] = np.where(passes.sum(axis=1) == 1, crossings, np.nan)
    have_triangles = np.isfinite(heights)[:, plan.triangles].all(axis=2).any(axis=1)
    return [
        where_known(nodes, plan.triangles, level_heights) if has_triangle else None
        for level_heights, has_triangle in zip(heights, have_triangles.tolist(), strict=True)
    ]


def lattices(entry: RockInput) -> list[tuple[SeriesData, Lattice]]:
    """The data and the lattice of each series of a rock mass, which is read, whose surfaces are level sets;
    as far as they are known before other surfaces are made. Raises InputRefused."""
    field_series = [series for series in entry.rock.series if series.kind == FIELD]
    waiting = [series for series in field_series if entry.rock.members(series)]
    top = _top(entry) if waiting else 0.0
    pairs = []
    for series in waiting:
        data = SeriesData.of(entry, series, entry.rock.members(series))
        pairs.append((data, _lattice(entry, series, data.positions(), top)))
    return pairs


def spacing(entry: RockInput) -> float:
    """The smallest edge length of the lattices of the fields of a rock mass that is read; infinite where it
    has none."""
    return min((lattice.spacing[0] for _, lattice in lattices(entry)), default=math.inf)


def _top_of_fields(entry: RockInput) -> float:
    """As `_top`; of a realization that of the model, so that lattices stay the same, if that will do."""
    of_model = max((draws.top for draws in entry.field_draws.values()), default=-math.inf)
    return of_model if of_model >= _top(entry, 0.5 * _BEYOND) else _top(entry)


def _top(entry: RockInput, beyond: float = _BEYOND) -> float:
    """An elevation above all sheets and contacts of a rock mass, as far as these are known."""
    elevations = []
    for number, surface in enumerate(entry.rock.surfaces):
        if not entry.rock.is_level_set(surface):
            shapes = [entry.surfaces[number], *(sheets[number] for sheets in entry.divided().sheets)]
            elevations += [shape.vertices[:, 2] for shape in shapes if shape is not None]
        elevations.append(entry.data[number].points[:, 2])
    base = entry.rock.base_elevation
    assert base is not None  # check_series
    highest = max((float(z.max()) for z in elevations if len(z)), default=base)
    return highest + beyond * (highest - base) + 1e-3


def _field_of(work: Work, entry: RockInput, series: Series, top: float) -> SeriesField:
    numbers = entry.rock.members(series)
    lattice = _lattice(entry, series, SeriesData.of(entry, series, numbers).positions(), top)
    data = SeriesData.of(entry, series, numbers, _PLACES * lattice.spacing[0])
    warn_of_distance(entry, series, data.positions())
    structure = entry.divided()
    sides = sides_of(work, data.positions(), structure.faults)
    shared = _families(entry, series, numbers, len(data.contacts) + len(data.dips))
    fields: dict[int, ScalarField] = {}
    critical = [np.empty((0, 3))]
    draws = entry.field_draws.get(series.name)
    thicknesses = BedThicknesses.of(entry, numbers)
    for number, family in enumerate(work.share_out(shared)):
        within = CompartmentTest(work, structure, numbers[-1], family)
        names = [structure.names[compartment] for compartment in family.members]
        chosen = _chosen(entry, series, data, within.has(sides), names)
        _warn_of_sides(entry, series, data, sides, family)
        chosen_data = data.some(chosen)
        with naming(f"{entry.rock.item}, {series.item}"):
            slits = Slits.of(entry, family, within, lattice)
            where = slits.numbers(sides[chosen])
            level_data = _level_set_data(work, series, chosen_data, slits, where, None)
            sides_of_beds = sides_of(work, thicknesses.places, structure.faults)
            is_here = within.has(sides_of_beds)
            beds = thicknesses.some(is_here), slits.numbers(sides_of_beds[is_here])
            if len(beds[0]):
                level_data = _with_thicknesses(work, series, chosen_data, slits, where, beds, level_data)
            if draws is None:
                field = solve_field(lattice, level_data, work)
            else:
                field = draws.field(lattice, level_data, work, number)
            field = chosen_data.known_to(field)
        leave_out(entry, series, chosen_data, field)
        warn_of_volumes(entry, series, numbers, field)
        kept_rows = chosen_data.kept_rows(field.bounds_missed)
        solved = _Solved([field, *field.others], slits, where[kept_rows], is_drawn=draws is not None)
        made = _through_data(work, entry, series, chosen_data.some(kept_rows), solved)
        warn_of_thicknesses(entry, series, beds[0].missed(made, beds[1]))
        for side, solved_field in enumerate(made):
            points = solved_field.critical_points
            own_sides = sides_of(work, points, structure.faults)
            critical.append(points[within.has(own_sides) & (slits.numbers(own_sides) == side)])
        for solved_field, members_of in zip(made, slits.members, strict=True):
            fields |= dict.fromkeys(members_of, solved_field)
    points = np.concatenate(critical)
    warn_of_critical_points(entry, series, points[within_rock(work, entry, points)])
    of_compartment = [fields[number] for number in range(len(structure.compartments))]
    return SeriesField(series.name, numbers[0], len(numbers), of_compartment, top)


def _level_set_data(
    work: Work,
    series: Series,
    data: SeriesData,
    slits: Slits,
    where: np.ndarray,
    more: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
) -> LevelSetData:
    """For the solver. where: (N,) the combinations of sides of slits that data are on. more: further contacts
    (M, 3) with their surfaces (M,) and combinations (M,)."""
    contacts, surfaces, more_where = more or (np.empty((0, 3)), np.empty(0, np.int32), np.empty(0, np.int64))
    parts = [np.concatenate([data.contacts, contacts]), data.dips, data.bounds]
    where = np.insert(where, len(data.contacts), more_where)
    level_data = data.level_set_data(slits.data(work, parts, where), series)
    return replace(level_data, contacts=parts[0], contact_surfaces=np.concatenate([data.surfaces, surfaces]))


def _with_thicknesses(
    work: Work,
    series: Series,
    data: SeriesData,
    slits: Slits,
    where: np.ndarray,
    beds: tuple[BedThicknesses, np.ndarray],
    level_data: LevelSetData,
) -> LevelSetData:
    """The data of a field with the contacts that thicknesses give, in rounds. beds: these, and the
    combinations that they are on."""
    thicknesses, of_beds = beds
    for _ in range(ROUNDS):
        field = solve_field(slits.lattice, level_data, work)
        fields = [field, *field.others]
        contacts, surfaces, rows = thicknesses.contacts(data, fields, of_beds, slits.lattice)
        level_data = _level_set_data(work, series, data, slits, where, (contacts, surfaces, of_beds[rows]))
    return level_data


def _chosen(
    entry: RockInput, series: Series, data: SeriesData, here: np.ndarray, names: list[str]
) -> np.ndarray:
    """(N,) bool: the data that the field of compartments, by their names, is made of: those `here`, with a
    warning more where these do not say enough."""
    data_here = data.some(here)
    if lacks := data_here.missing(data):
        warn_of_lacks(entry, series, lacks, names)
        return np.ones(len(here), bool)
    if len(data.numbers) == 1 and len(data.dips) and not len(data_here.dips):
        warn_of_direction(entry, series, names)
        return here | data.of_dips()
    return here


def _warn_of_sides(
    entry: RockInput, series: Series, data: SeriesData, sides: np.ndarray, family: Family
) -> None:
    """Warns of compartments of a family on a side of a fault where no contacts lie: by how much it displaces
    rock there is not known. sides: of all data."""
    structure = entry.divided()
    dividing = [fault for fault in family.branches if not structure.faults.dies_out[fault]]
    rows = structure.compartments[:, dividing]
    of_contacts = sides[: len(data.contacts), dividing]
    is_seen = (rows[:, None] == of_contacts[None]).any(axis=1) | (rows == 0)
    if unseen := [structure.names[n] for n in np.flatnonzero(~is_seen.all(axis=1))]:
        every = [entry.rock.surfaces[number].name for number in data.numbers]
        warn_of_lacks(entry, series, every, unseen)


class _Solved(NamedTuple):
    """The fields on the combinations of sides of slits; where: (N,) the combination that each datum is on.
    is_drawn: as rough as a realization is."""

    fields: list[SolvedField]
    slits: Slits
    where: np.ndarray
    is_drawn: bool


def _through_data(
    work: Work, entry: RockInput, series: Series, data: SeriesData, solved: _Solved
) -> list[SolvedField]:
    """The fields with the contacts of tied surfaces on their levels. Bounds that do not hold any more then
    are places on the level, too: they hold in the end. Warns of what is not honored."""
    fields, slits, where, is_drawn = solved
    levels = fields[0].levels[data.bound_surfaces]
    held = HeldData(data.dips, data.normals, data.bounds, np.where(data.is_lower, -1.0, 1.0), levels)
    of_contacts, _, of_bounds = np.split(where, np.cumsum([len(data.contacts), len(data.dips)]))

    def through(places: np.ndarray, surfaces: np.ndarray, numbers: np.ndarray) -> list[SolvedField]:
        alike = slits.shared(places, numbers)
        return fields_with_contacts(work, fields, places, surfaces, alike, None if is_drawn else held)

    is_tied = np.array([entry.rock.surfaces[number].tie for number in data.numbers])[data.surfaces]
    tied = data.contacts[is_tied], data.surfaces[is_tied], of_contacts[is_tied]
    with refused_as(lambda error: InputRefused(str(error), item=f"{entry.rock.item}, {series.item}")):
        made = through(*tied)
        is_free = ~are_among(data.bounds, data.contacts)
        pinned = np.zeros(len(is_free), bool)
        for _ in range(_ROUNDS):
            new = is_free & ~pinned & data.is_off(made, of_bounds, _NEAR)
            if not new.any():
                break
            pinned |= new
            places, first = np.unique(data.bounds[pinned], axis=0, return_index=True)
            of_places = places, data.bound_surfaces[pinned][first], of_bounds[pinned][first]
            made = through(*(np.concatenate(both) for both in zip(tied, of_places, strict=True)))
    warn_of_field(entry, series, data, fields[0], np.flatnonzero(data.is_off(made, of_bounds, _NEAR)))
    return made


def _families(entry: RockInput, series: Series, numbers: list[int], count: int) -> list[Family]:
    """The compartments that share a field: all of them where there are few data, so `count`, since then those
    of each alone say little. Raises InputRefused for faults that it cannot have."""
    structure = entry.divided()
    faults = structure.faults
    active = faults.active(numbers[-1])
    series_item = f"{entry.rock.item}, {series.item}"
    for number in np.flatnonzero(faults.active(numbers[0]) & ~active):
        what = f"fault '{faults.names[number]}' displaces some of its surfaces, but not all"
        raise series.refused(what, "name", "divide it into two series, or change 'youngest'", series_item)
    separate = sorted(families(structure, numbers[-1]), key=lambda family: family.key)
    if len(separate) < 2 or len(structure.compartments) > MOST_TOGETHER or count > _FEW:
        return separate
    faulted = np.flatnonzero(active)
    rows = structure.compartments[:, faulted].tolist()
    key = tuple(DIES_OUT if is_active else 0 for is_active in active.tolist())
    return [Family(key, dict(enumerate(map(tuple, rows))), tuple(faulted.tolist()))]


def _lattice(entry: RockInput, series: Series, places: np.ndarray, top: float) -> Lattice:
    """A lattice around the rock mass and the places (N, 3) of the data of a series."""
    base = entry.rock.base_elevation
    plan = entry.planar_mesh().vertices[:, :2]
    low = np.minimum([*plan.min(axis=0), base], places.min(axis=0))
    high = np.maximum([*plan.max(axis=0), top], places.max(axis=0))
    size = high - low
    is_auto = series.resolution == BY_DATA
    step = cube_root(float(size.prod()) / _CELLS) if is_auto else float(series.resolution)
    step, unit = _short(step)
    origin = unit * np.floor((low - _MARGIN * step) / unit)
    counts = np.ceil((high - origin) / step + 0.3).astype(np.int64) + 1
    if counts.astype(float).prod() > _MOST_NODES:
        coarser = step * cube_root(float(counts.astype(float).prod()) / _MOST_NODES)
        what = f"its lattice would have {counts.astype(float).prod():,.0f} nodes"
        advice = f"use a resolution of {coarser:.2g} or more"
        raise series.refused(what, "resolution", advice, f"{entry.rock.item}, {series.item}")
    return Lattice(tuple(origin.tolist()), (step,) * 3, tuple(counts.tolist()))


def _short(step: float) -> tuple[float, float]:
    """A step as a number of 20 binary digits, and the last of these: on a lattice of such steps the middles
    of edges are numbers, too, so that points there lie exactly on their edges."""
    part, exponent = math.frexp(step)
    unit = math.ldexp(1.0, exponent - _DIGITS)
    return math.ldexp(round(math.ldexp(part, _DIGITS)), exponent - _DIGITS), unit


def _take_level_sets(work: Work, entry: RockInput, series_field: SeriesField) -> None:
    """Sets the surfaces of a rock mass, and its sheets in compartments, that are level sets of a field."""
    with refused_as(lambda error: InputRefused(str(error), item=entry.rock.item, place=error.place)):
        solids = {field: level_solids(work, field) for field in series_field.distinct()}
    entry.level_solids |= solids
    sheets = {field: [solid.level_set for solid in field_solids] for field, field_solids in solids.items()}
    for number in series_field.numbers:
        warn_of_contacts(
            entry,
            series_field,
            number,
            {field: sheets[field][number - series_field.first] for field in sheets},
        )
        level_sets = [sheets[field][number - series_field.first] for field in series_field.fields]
        if entry.structure is not None:
            for compartment, sheet in zip(entry.structure.sheets, level_sets, strict=True):
                compartment[number] = sheet
        entry.surfaces[number] = joined(list(dict.fromkeys(level_sets)))
