# SPDX-License-Identifier: GPL-3.0-or-later
"""A model with faults and bodies: the stacks of all parts of space, cut by the structures and joined."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from ..base.errors import BuildFailed, InputRefused
from ..base.triangles import Sheet
from ..base.work import NativeError, Work, refused_as
from ..fields import LevelSolid, ScalarField, level_solids
from ..structures.parts.part_models import (
    DEEP,
    FILLER,
    FLOOR,
    LID,
    NOTHING,
    Stack,
    between_levels,
    cut_at_base,
    distinct_plans,
    inside_body,
    plain_stack,
)
from ..structures.parts.parts import Structures, compartment_of, refused_structure
from ..surfaces.rock_input import RockInput
from .built_cells import BuiltCells, CellParts, NativeWarning
from .cell_complex import CellComplex
from .reach import PartExtents
from .stack_refusals import refused_stack


def build_joined(
    work: Work,
    inputs: list[RockInput],
    structures: Structures,
    cells: str,
    reach: PartExtents | None = None,
) -> BuiltCells:
    """The cells of rock masses (RockInput) with structures, and their parts.

    Bodies that are not there yet divide nothing. reach: of the structures; None: it is made here.
    Raises InputRefused.
    """
    present = structures.there()
    if len(present) < len(structures):
        few, part = structures.only(present)
        built = build_joined(work, inputs, few, cells)
        return _renumbered(built, np.array(present, np.int64), part, len(structures))
    if reach is None and structures.is_divided:
        reach = PartExtents(work, structures)
    solids = SolidsOfFields(work, inputs)
    surfaces = _first_surfaces(inputs)[-1]
    piece = None if structures.continued is None else (structures.continued, structures.largest)
    refused = refused_as(lambda error: _refused(error, inputs, structures))
    with work.phase(0.0, 1.0, "intersecting and cutting", has_steps=True), refused as native:
        joined = work.native(
            native.build_parts,
            [_part(work, structures, reach, part, cells, solids) for part in range(len(structures.sides))],
            (surfaces, structures.native()),
            blocks_divided(inputs, structures),
            cells,
            piece=piece,
        )
    _level_bases(joined, inputs)
    return built_cells(joined, cells, inputs, structures)


def _level_bases(joined: dict, inputs: list[RockInput]) -> None:
    """Makes faces on bases that cut surfaces off level to the last bit: those levels are rounded as surfaces
    are, of which two heights that are nearly equal may get neighboring numbers."""
    bases = np.array([entry.rock.base_elevation for entry in inputs if entry.reaches_base])
    if len(bases):
        count, corners = np.diff(joined["face_offsets"]), joined["face_vertices"]
        rows = np.unique(corners[np.repeat(joined["face_surface"] == FLOOR, count)])
        z = joined["vertices"][rows, 2]
        joined["vertices"][rows, 2] = bases[np.abs(z[:, None] - bases).argmin(axis=1)]


def _refused(
    error: NativeError, inputs: list[RockInput], structures: Structures
) -> InputRefused | BuildFailed:
    """The refusal for a native InputError of build_parts, which counts structures after all surfaces."""
    surfaces = _first_surfaces(inputs)[-1]
    if error.kind in ("rocks_overlap", "base_not_below", "bad_region") or 0 <= error.surface < surfaces:
        return refused_stack(error, inputs)
    error.surface -= surfaces
    return refused_structure(error, structures.faults, structures.bodies)


def _renumbered(built: BuiltCells, present: np.ndarray, part: np.ndarray, count: int) -> BuiltCells:
    """The cells of a model of some structures, numbered as if all `count` of them had been given. present:
    their numbers; part: (P,) the parts that theirs are of."""
    surfaces = len(built.volumes) - len(present)
    number = np.append(np.arange(surfaces), surfaces + present).astype(np.int32)
    volumes = np.zeros(surfaces + count)
    volumes[number] = built.volumes
    face = built.complex.face_surface
    renumbered = replace(
        built.complex,
        face_surface=np.where(face < 0, face, number[np.maximum(face, 0)]).astype(np.int32),
        cell_block=number[built.complex.cell_block],
    )
    parts = replace(built.parts, part=part[built.parts.part])
    return replace(built, complex=renumbered, volumes=volumes, parts=parts)


def built_cells(
    arrays: Mapping[str, Any], cells: str, inputs: list[RockInput], structures: Structures
) -> BuiltCells:
    """The cells of a result of the native module, with each body as one block of all rock masses, and their
    parts: one where nothing divides rock masses."""
    cell_complex = CellComplex.of(arrays, cells)
    first, count = _first_surfaces(inputs), len(structures)
    block, surfaces = cell_complex.cell_block, first[-1]
    rocks = np.arange(len(inputs), dtype=np.int32)
    rock = np.append(np.repeat(rocks, np.diff(first)), np.repeat(rocks, count))
    of_body = surfaces + (block - surfaces) % max(1, count)
    of_bodies = arrays["volumes"][surfaces:].reshape(len(inputs), count).sum(axis=0)
    part = arrays["cell_part"] if "cell_part" in arrays else np.zeros(len(block), np.int32)
    return BuiltCells(
        replace(cell_complex, cell_block=np.where(block >= surfaces, of_body, block).astype(np.int32)),
        np.append(arrays["volumes"][:surfaces], of_bodies),
        CellParts(part, block, rock, blocks_divided(inputs, structures)),
        [
            NativeWarning(kind, int(surface), tuple(map(int, items)), text)
            for kind, surface, items, text in arrays["warnings"]
        ],
    )


def _first_surfaces(inputs: list[RockInput]) -> list[int]:
    """The number of the first surface of each rock mass, and of all."""
    return np.cumsum([0, *(len(entry.surfaces) for entry in inputs)]).tolist()


@dataclass(frozen=True)
class PartPlace:
    """A part of space, by its number; between levels, of each rock mass the level sets, by their numbers, and
    whether it is beneath them."""

    structures: Structures
    part: int
    beneath: tuple[Mapping[int, bool], ...]


def _part(
    work: Work,
    structures: Structures,
    reach: PartExtents | None,
    part: int,
    cells: str,
    solids: SolidsOfFields,
) -> tuple:
    """One part of space, with all rock masses as they are there, as native build_parts takes it."""
    work.check()
    inputs = solids.inputs
    sides = structures.sides[part].tolist()
    level_sets = solids.of([compartment_of(structures, entry, part) for entry in inputs])
    divides = np.array([len(triangles) > 0 for _, triangles, _ in level_sets], bool)
    places = [
        PartPlace(structures, part, tuple(beneath)) for beneath in itertools.product(*map(_levels, inputs))
    ]
    within = np.array([_sides_at(place) for place in places], np.int8).reshape(len(places), -1)
    # nothing is beneath a surface of which the field has no level here
    possible = np.flatnonzero((within[:, ~divides] > 0).all(axis=1))
    places = [places[number] for number in possible.tolist()]
    stacks = [_stacks_at(inputs, place) for place in places]
    wanted, around = None, None
    if reach is not None:
        stacks, wanted, around = _in_reach(reach, stacks, part, cells)
    first = _first_surfaces(inputs)
    rocks = [
        [
            _rock_stack(entry, stack, entry.region or around, begin, beneath)
            for entry, stack, begin, beneath in zip(
                inputs, place_stacks, first[:-1], place.beneath, strict=True
            )
        ]
        for place_stacks, place in zip(stacks, places, strict=True)
    ]
    if len(places) == 1:
        return sides, rocks[0], wanted, None
    between = list(zip(within[possible][:, divides].tolist(), rocks, strict=True))
    return sides, [], wanted, ([level_sets[number] for number in np.flatnonzero(divides)], between)


def _levels(entry: RockInput) -> list[dict[int, bool]]:
    """Of the places between the level sets of a rock mass: of each level set, by its number, whether the
    place is beneath it."""
    of_fields = [
        [
            {number: number >= lowest for number in field.numbers}
            for lowest in (*field.numbers, field.numbers.stop)
        ]
        for field in entry.fields
    ]
    return [
        dict(itertools.chain(*(beneath.items() for beneath in row))) for row in itertools.product(*of_fields)
    ]


def _sides_at(place: PartPlace) -> list[int]:
    """1 outside of each solid, -1 inside, as SolidsOfFields.of has them."""
    return [-1 if inside else 1 for beneath in place.beneath for inside in beneath.values()]


class SolidsOfFields:
    """The closed boundaries of where the fields of series are at most a level."""

    def __init__(self, work: Work, inputs: list[RockInput]):
        self.inputs = inputs
        self._solids: dict[ScalarField, list[LevelSolid]] = {}
        for entry in inputs:
            for series_field in entry.fields:
                for field in series_field.distinct():
                    solids = entry.level_solids.pop(field, None)
                    self._solids[field] = solids or level_solids(work, field)

    def of(self, compartments: list[int]) -> list[tuple]:
        """Those in the compartments of each rock mass, as native build_parts takes them."""
        boundaries = []
        firsts = _first_surfaces(self.inputs)[:-1]
        for entry, compartment, first in zip(self.inputs, compartments, firsts, strict=True):
            for series_field in entry.fields:
                solids = self._solids[series_field.fields[compartment]]
                boundaries += [
                    (*solids[n - series_field.first].boundary.arrays, first + n) for n in series_field.numbers
                ]
        return boundaries


def _stacks_at(inputs: list[RockInput], place: PartPlace) -> list[Stack]:
    """The stacks of all rock masses in one place."""
    first = _first_surfaces(inputs)
    return [_stack(inputs, place, number, first[number], first[-1]) for number in range(len(inputs))]


def _in_reach(reach: PartExtents, stacks: list[list[Stack]], part: int, cells: str) -> tuple:
    """Stacks where a part may be, what space of it is wanted, and the region around that if it has one."""
    structures = reach.structures
    space = reach.cells_of(part)
    columns = np.logical_or.reduce(space, axis=2)
    if structures.continued is not None and columns.any():
        # around a tile: sheets that ended here would be divided by lines that depend on what is far away
        columns = np.ones_like(columns)
    masks = {
        sheet: reach.over(columns, sheet)
        for place_stacks in stacks
        for stack in place_stacks
        for sheet in stack.sheets
    }
    stacks = [
        [stack.without([not masks[sheet].any() for sheet in stack.sheets]) for stack in place_stacks]
        for place_stacks in stacks
    ]
    around = None
    all_stacks = list(itertools.chain(*stacks))
    is_there, has_void = any(stack.sheets for stack in all_stacks), any(stack.emptied for stack in all_stacks)
    if cells == "blocks" and is_there and not has_void:
        # blocks end at one border: those that each sheet ends at by itself leave many small ones between
        around = reach.around(columns)
    is_bounded = cells == "columns" and not space.all()
    wanted = (reach.low, reach.step, space.astype(np.uint8)) if is_bounded else None
    return [[stack.some(masks) for stack in place_stacks] for place_stacks in stacks], wanted, around


def _rock_stack(
    entry: RockInput, stack: Stack, region: Sheet | None, first: int, beneath: Mapping[int, bool]
) -> tuple:
    """One rock mass in one part of space as native build_parts takes it. first: the number of its first
    surface. beneath: as PartPlace has it."""
    # what a surface that only fills a body, or lies below everything, bounds is a wall; a level set is a
    # level here, above all rock or at the base
    named = {DEEP: FILLER} | {number: LID if below else FLOOR for number, below in beneath.items()}
    own_numbers = [named.get(number, number) for number in stack.surfaces]
    numbers = [first + number if number >= 0 else number for number in own_numbers]
    surfaces = [
        (number, block, sheet.numbers)
        for number, block, sheet in zip(numbers, stack.blocks, stack.sheets, strict=True)
    ]
    fills = []
    if entry.rock.base_elevation is None:  # else nothing stays below the oldest surface
        fills = [of == FILLER for of in stack.surfaces[: max(stack.emptied, default=0)]]
    sheets = [sheet.arrays for sheet in stack.sheets]
    stack_arrays = (sheets, None if region is None else region.arrays, stack.base_elevation, stack.rules)
    return stack_arrays, surfaces, list(stack.emptied), fills


def _stack(inputs: list[RockInput], place: PartPlace, number: int, first: int, surfaces: int) -> Stack:
    """The stack of one rock mass in one place. surfaces: of all rock masses."""
    structures, part, entry = place.structures, place.part, inputs[number]
    sheets = entry.divided().of_compartment(compartment_of(structures, entry, part))
    rules = [surface.rule for surface in entry.rock.surfaces]
    stack = plain_stack(sheets, rules, entry.rock.base_elevation, first)
    if entry.fields:
        top = max(field.top for field in entry.fields)
        stack = between_levels(stack, place.beneath[number], top, entry.planar_mesh())
        sheets = [sheet for sheet, of in zip(stack.sheets, stack.surfaces, strict=True) if of >= 0]
    count = len(structures.faults)
    inside = sorted(
        (times[number], body)
        for body, times in enumerate(structures.times)
        if number in times and structures.sides[part, count + body] < 0
    )
    if not inside:
        return cut_at_base(stack, entry.rock.base_elevation)
    ends = structures.ends or beyond_all(sheets, structures)
    plans = [entry.region] if entry.region is not None else distinct_plans(sheets)
    for at, (after, body) in enumerate(inside):
        input_body = structures.bodies[body]
        if input_body.void and at + 1 < len(inside) and inside[at + 1][0] == after:
            continue  # what comes next leaves nothing of it
        block = NOTHING if input_body.void else body_block(structures, surfaces, number, body)
        covered = distinct_plans(sheets[: after + 1])
        stack = inside_body(stack, after, block, ends, plans, covered)
    return cut_at_base(stack, entry.rock.base_elevation)


def body_block(structures: Structures, surfaces: int, rock: int, body: int) -> int:
    """The number of a body's block in one rock mass, while models are made and joined: faults may divide it
    there alone. surfaces: of all rock masses."""
    return surfaces + rock * len(structures) + len(structures.faults) + body


def beyond_all(sheets: Sequence[Sheet], structures: Structures) -> tuple[float, float]:
    """Heights below and above all sheets and bodies."""
    shapes = [*(vertices for vertices, _ in sheets), *(body.triangulation()[0] for body in structures.bodies)]
    low, high = (
        min(vertices[:, 2].min() for vertices in shapes),
        max(vertices[:, 2].max() for vertices in shapes),
    )
    away = (high - low) + 1.0
    return float(low - away), float(high + away)


def blocks_divided(inputs: list[RockInput], structures: Structures) -> np.ndarray:
    """(S, B) uint8: whether a structure divides a block, those of bodies as body_block numbers them. A fault
    divides what it displaces and the bodies that were there by then; a body what was there before it, and is
    hidden in later ones."""
    first = _first_surfaces(inputs)
    count = len(structures.faults)
    divided = np.zeros((len(structures), first[-1] + len(inputs) * len(structures)), np.uint8)
    ages = [(times, number) for number, times in enumerate(structures.times)]
    for fault, displaced in enumerate(structures.displaced):
        for rock, youngest in displaced.items():
            last = min(youngest, len(inputs[rock].surfaces) - 1)
            divided[fault, first[rock] : first[rock] + last + 1] = 1
            for times, body in ages:
                if rock in times and times[rock] <= youngest:
                    divided[fault, body_block(structures, first[-1], rock, body)] = 1
    for times, body in ages:
        for rock, after in times.items():
            divided[count + body, first[rock] : first[rock] + after + 1] = 1
            for others, other in ages:
                if rock in others and (others[rock], other) <= (after, body):
                    divided[count + body, body_block(structures, first[-1], rock, other)] = 1
    return divided


_ROUNDINGS = 64  # positions nearer than so many units in the last place are one
_MIXED = np.array([0x2545F4914F6CDD1D, 0x1B873593CC9E2D51, 0x3C6EF372FE94F82B])  # odd; of cells that differ


def apart(positions: np.ndarray) -> float:
    """How near positions (N, D) are one, along each axis."""
    return _ROUNDINGS * float(np.spacing(np.abs(positions).max(initial=1.0)))


def near_positions(positions: np.ndarray) -> np.ndarray:
    """(N,) int64: of each of positions (N, D) in 1 to 3 dimensions the first that it is one with. Those that
    are nearer than `apart` along all axes are one, those farther than twice that are not unless others
    between join them."""
    size, count = 2.0 * apart(positions), len(positions)
    cells, members, numbers = [np.empty(0, np.int64)], [np.empty(0, np.int64)], 0
    # near ones share a cell of one of these grids
    for shift in product((0.0, 0.5), repeat=positions.shape[1]):
        indices = np.floor((positions - positions[:1]) / size + shift).astype(np.int64)
        mixed = (indices * _MIXED[: indices.shape[1]]).sum(axis=1)
        _, key, sharing = np.unique(mixed, return_inverse=True, return_counts=True)
        shared = np.flatnonzero(sharing[key.ravel()] > 1)  # few; and some that are not, by chance
        _, cell = np.unique(indices[shared], axis=0, return_inverse=True)
        cells.append(cell.ravel() + numbers)
        members.append(shared)
        numbers += len(shared)
    cell, member = np.concatenate(cells), np.concatenate(members)
    first = np.arange(count)
    first[member] = _joined(cell, member)
    return first


def _joined(group: np.ndarray, member: np.ndarray) -> np.ndarray:
    """For each (group, member) the least member of all that such groups connect."""
    _, group = np.unique(group, return_inverse=True)
    named, member = np.unique(member, return_inverse=True)
    group, member = group.ravel(), member.ravel()
    label = np.arange(len(named))
    while True:
        least = np.full(int(group.max(initial=-1)) + 1, len(label))
        np.minimum.at(least, group, label[member])
        lower = label.copy()
        np.minimum.at(lower, member, least[group])
        lower = lower[lower]
        if (lower == label).all():
            return named[label[member]]
        label = lower
