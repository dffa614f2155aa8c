# SPDX-License-Identifier: GPL-3.0-or-later
"""A model with faults and bodies: the stacks of all parts of space, cut by the structures and joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.sheet import Sheet
from ..base.work import Work, native_module, refused_as
from ..structures.parts.part_models import (
    DEEP,
    FILLER,
    NOTHING,
    Stack,
    distinct_plans,
    inside_body,
    plain_stack,
)
from ..structures.parts.parts import Structures, compartment_of
from ..structures.parts.refusals import refused_structure
from ..surfaces.rock_input import RockInput
from .built_cells import BuiltCells, CellParts, NativeWarning
from .cell_complex import CellComplex
from .reach import Reach
from .stack_refusals import refused_stack

_BUILT = 0.4  # of the time: until the stacks are built; then they are cut and joined


def build_joined(
    work: Work,
    inputs: list[RockInput],
    structures: Structures,
    cells: str,
    start: float,
    end: float,
    reach: Reach | None = None,
) -> BuiltCells:
    """The cells of rock masses (RockInput) with structures, and their parts.

    Bodies that are not there yet divide nothing. reach: of the structures; None: it is made here.
    Raises InputRefused.
    """
    there = structures.there()
    if len(there) < len(structures):
        few, part = structures.only(there)
        built = build_joined(work, inputs, few, cells, start, end)
        return _renumbered(built, np.array(there, np.int64), part, len(structures))
    models: list[tuple] = []
    parts: list[int] = []
    warnings: dict[NativeWarning, None] = {}
    reach = reach or Reach(work, structures)
    begin = start + _BUILT * (end - start)

    def built_in(own_work: Work, part: int) -> BuiltCells | None:
        with own_work.phase(0.0, 1.0, "intersecting and cutting"):
            return _part_model(own_work, inputs, structures, reach, part, cells)

    with work.phase(start, begin, "intersecting and cutting"):
        made = work.each(built_in, range(len(structures.sides)))
    for number, own in enumerate(made):
        if own is not None and len(own.complex.cell_block):
            warnings |= dict.fromkeys(own.warnings)
            models.append((_native(own.complex, inputs, structures), structures.sides[number].tolist()))
            parts.append(number)
    if not models:
        return _nothing(inputs, structures, cells)
    divides = blocks_divided(inputs, structures)
    refused = refused_as(lambda error: refused_structure(error, structures))
    with work.phase(begin, end, "joining the compartments"), refused as native:
        joined = work.native(
            native.join_structured,
            models,
            structures.native(),
            divides,
            continued=structures.continued or [],
            largest=structures.largest,
        )
    part = np.array(parts, np.int32)[joined["cell_part"]]
    found = BuiltCells(CellComplex.of(joined, cells), joined["volumes"], list(warnings))
    return _with_parts(found, part, inputs, structures, divides)


def _native(own: CellComplex, inputs: list[RockInput], structures: Structures) -> dict:
    """The cells in one part of space as the native module takes them."""
    surfaces = _first_surfaces(inputs)[-1]
    return own.native(surfaces + len(inputs) * len(structures)) | {"surfaces": surfaces}


def _renumbered(built: BuiltCells, there: np.ndarray, part: np.ndarray, count: int) -> BuiltCells:
    """The cells of a model of some structures, numbered as if all `count` of them had been given. there:
    their numbers; part: (P,) the parts that theirs are of."""
    surfaces = len(built.volumes) - len(there)
    number = np.append(np.arange(surfaces), surfaces + there).astype(np.int32)
    volumes = np.zeros(surfaces + count)
    volumes[number] = built.volumes
    face = built.complex.face_surface
    renumbered = replace(
        built.complex,
        face_surface=np.where(face < 0, face, np.append(number, np.int32(-1))[face]).astype(np.int32),
        cell_block=number[built.complex.cell_block],
    )
    parts = built.parts and replace(built.parts, part=part[built.parts.part])
    return replace(built, complex=renumbered, volumes=volumes, parts=parts)


def _with_parts(
    built: BuiltCells, part: np.ndarray, inputs: list[RockInput], structures: Structures, divides: np.ndarray
) -> BuiltCells:
    """The cells with each body as one block of all rock masses, and their parts. divides: as `blocks_divided`
    has it."""
    first, count = _first_surfaces(inputs), len(structures)
    own, surfaces = built.complex.cell_block, first[-1]
    rocks = np.arange(len(inputs), dtype=np.int32)
    rock = np.append(np.repeat(rocks, np.diff(first)), np.repeat(rocks, count))
    body = own >= surfaces
    blocks = np.where(body, surfaces + (own - surfaces) % max(1, count), own).astype(np.int32)
    of_bodies = built.volumes[surfaces:].reshape(len(inputs), count).sum(axis=0)
    return BuiltCells(
        replace(built.complex, cell_block=blocks),
        np.append(built.volumes[:surfaces], of_bodies),
        built.warnings,
        CellParts(part, own, rock, divides),
    )


def _nothing(inputs: list[RockInput], structures: Structures, cells: str) -> BuiltCells:
    none = np.empty(0, np.int32)
    return BuiltCells(
        CellComplex.empty(cells),
        np.zeros(_first_surfaces(inputs)[-1] + len(structures)),
        parts=CellParts(none, none, none, np.empty((len(structures), 0), np.uint8)),
    )


def _first_surfaces(inputs: list[RockInput]) -> list[int]:
    """The number of the first surface of each rock mass, and of all."""
    return np.cumsum([0, *(len(entry.surfaces) for entry in inputs)]).tolist()


def _part_model(
    work: Work,
    inputs: list[RockInput],
    structures: Structures,
    reach: Reach,
    part: int,
    cells: str,
) -> BuiltCells | None:
    """The cells of all rock masses as they are in one part; None where there is nothing."""
    first = _first_surfaces(inputs)
    native = native_module()
    stacks = [
        _stack(inputs, structures, part, number, first[number], first[-1]) for number in range(len(inputs))
    ]
    space = reach.cells_of(part)
    columns = np.logical_or.reduce(space, axis=2)
    if structures.continued is not None and columns.any():
        # around a tile: sheets that ended here would be divided by lines that depend on what is far away
        columns = np.ones_like(columns)
    kept = {sheet: reach.over(columns, sheet) for stack in stacks for sheet in stack.sheets}
    stacks = [stack.without([not kept[sheet].any() for sheet in stack.sheets]) for stack in stacks]
    taken = [n for n, stack in enumerate(stacks) if stack.sheets]
    if not taken:
        return None
    for n in taken:
        stacks[n].sheets = [sheet.some(kept[sheet]) for sheet in stacks[n].sheets]
    rows = [sheet.of_surface for n in taken for sheet in stacks[n].sheets]
    more = _voids([(stacks[n], inputs[n].rock.base_elevation is None) for n in taken])
    built_as = "columns" if more else cells
    # blocks end at one border: those that each sheet ends at by itself leave many small ones between
    around = reach.around(columns) if built_as == "blocks" else None
    if cells == "columns" and not space.all():
        more["wanted"] = (reach.low, reach.step, space.astype(np.uint8))
    if structures.continued is not None:  # around a tile
        more["is_local"] = True
    regions = [around if inputs[n].region is None else inputs[n].region for n in taken]
    rocks = [
        (
            [sheet.arrays for sheet in stacks[n].sheets],
            None if region is None else region.arrays,
            stacks[n].base_elevation,
            stacks[n].rules,
        )
        for n, region in zip(taken, regions, strict=True)
    ]
    named = [(n, FILLER if own == DEEP else own) for n in taken for own in stacks[n].surfaces]
    surfaces = [first[n] + own if own >= 0 else own for n, own in named]
    try:
        built = BuiltCells.of(
            work.native(native.build_rock_masses, rocks, cells=built_as, **more),
            cells,
        )
    except native.InputError as error:
        if 0 <= error.surface < len(surfaces):
            error.items = rows[error.surface][error.items].tolist()
            error.surface = surfaces[error.surface]
        raise refused_stack(error, inputs) from error
    blocks = np.array([block for n in taken for block in stacks[n].blocks], np.int32)
    # faces keep -1, a wall, and -2, the base; surfaces that only fill bodies are none
    numbers = np.array([*surfaces, -2, -1], np.int32)
    own = replace(
        built.complex,
        face_surface=numbers[built.complex.face_surface],
        cell_block=blocks[built.complex.cell_block],
    )
    nothing = own.cell_block < 0
    if nothing.all():
        return None
    if nothing.any():
        own = own.without_cells(nothing)
    if cells != built_as or (cells == "blocks" and len(set(blocks.tolist())) < len(blocks)):
        own, _ = own.one_cell_each()
    warnings = [
        each
        if each.surface < 0
        else each._replace(
            surface=surfaces[each.surface], items=tuple(rows[each.surface][list(each.items)].tolist())
        )
        for each in built.warnings
    ]
    return BuiltCells(own, built.volumes, warnings)


def _voids(stacks: list[tuple[Stack, bool]]) -> dict:
    """The arguments of build_rock_masses for voids, by name; {} where there are no voids. stacks: each with
    whether the rock below the oldest surface stays."""
    if not any(stack.emptied for stack, _ in stacks):
        return {}
    tops = [
        [of == FILLER for of in stack.surfaces[: max(stack.emptied, default=0)]] if stays else []
        for stack, stays in stacks
    ]
    return {"emptied": [list(stack.emptied) for stack, _ in stacks], "fills": tops}


def _stack(
    inputs: list[RockInput], structures: Structures, part: int, number: int, first: int, surfaces: int
) -> Stack:
    """The stack of one rock mass in one part. surfaces: of all rock masses."""
    entry = inputs[number]
    sheets = entry.divided().of_compartment(compartment_of(structures, entry, part))
    rules = [surface.rule for surface in entry.rock.surfaces]
    stack = plain_stack(sheets, rules, entry.rock.base_elevation, first)
    count = len(structures.faults)
    inside = sorted(
        (times[number], body)
        for body, times in enumerate(structures.times)
        if number in times and structures.sides[part, count + body] < 0
    )
    if not inside:
        return stack
    ends = structures.ends or beyond_all(sheets, structures)
    plans = [entry.region] if entry.region is not None else distinct_plans(sheets)
    for at, (after, body) in enumerate(inside):
        given = structures.bodies[body]
        if given.void and at + 1 < len(inside) and inside[at + 1][0] == after:
            continue  # what comes next leaves nothing of it
        block = NOTHING if given.void else body_block(structures, surfaces, number, body)
        covered = distinct_plans(sheets[: after + 1])
        stack = inside_body(stack, after, block, ends, plans, covered)
    return stack


def body_block(structures: Structures, surfaces: int, rock: int, body: int) -> int:
    """The number of a body's block in one rock mass, while models are made and joined: faults may divide it
    there alone. surfaces: of all rock masses."""
    return surfaces + rock * len(structures) + len(structures.faults) + body


def beyond_all(sheets: Sequence[Sheet], structures: Structures) -> tuple[float, float]:
    """Heights below and above all sheets and bodies."""
    shapes = [*(vertices for vertices, _ in sheets), *(body.triangulation()[0] for body in structures.bodies)]
    low, high = min(each[:, 2].min() for each in shapes), max(each[:, 2].max() for each in shapes)
    away = (high - low) + 1.0
    return float(low - away), float(high + away)


def blocks_divided(inputs: list[RockInput], structures: Structures) -> np.ndarray:
    """(S, B) uint8: whether a structure divides a block, those of bodies as body_block numbers them. A fault
    divides what it displaces and the bodies that were there by then; a body what was there before it, and is
    hidden in later ones."""
    first = _first_surfaces(inputs)
    count = len(structures.faults)
    found = np.zeros((len(structures), first[-1] + len(inputs) * len(structures)), np.uint8)
    ages = [(times, number) for number, times in enumerate(structures.times)]
    for fault, displaced in enumerate(structures.displaced):
        for rock, youngest in displaced.items():
            last = min(youngest, len(inputs[rock].surfaces) - 1)
            found[fault, first[rock] : first[rock] + last + 1] = 1
            for times, body in ages:
                if rock in times and times[rock] <= youngest:
                    found[fault, body_block(structures, first[-1], rock, body)] = 1
    for times, body in ages:
        for rock, after in times.items():
            found[count + body, first[rock] : first[rock] + after + 1] = 1
            for others, other in ages:
                if rock in others and (others[rock], other) <= (after, body):
                    found[count + body, body_block(structures, first[-1], rock, other)] = 1
    return found
