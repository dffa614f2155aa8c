# SPDX-License-Identifier: GPL-3.0-or-later
"""The models of rock masses in one part of space: the stack of sheets there, with the bodies in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.triangles import Sheet
from ...settings.rules import RULES

NOTHING = -1
FILLER, FLOOR = -1, -2  # surfaces that only fill a body, or lie instead of the base elevation
LID = -3  # a level above all rock, instead of a level set: it cuts off what reaches up there
DEEP = -4  # below everything, under a body where no base elevation is
_DEPOSITS = "conformable"


@dataclass
class Stack:
    """A stack as the builder takes it. blocks: of each surface the number of the block beneath it, NOTHING
    for none. surfaces: of each surface its number in the rock mass, FILLER, FLOOR or DEEP. emptied: surfaces,
    ascending, before which all that is there becomes air; of those before the last of them stays what they
    protect, and, of a rock mass without a base elevation, what is below the oldest of them."""

    sheets: list[Sheet]
    rules: list[str]
    base_elevation: float | None
    blocks: list[int]
    surfaces: list[int]
    emptied: tuple[int, ...] = ()

    def without(self, empty: list[bool]) -> Stack:
        """Without the surfaces that do not exist here. Where the oldest is none, no block is on the base."""
        existing = [k for k, is_empty in enumerate(empty) if not is_empty]
        if len(existing) == len(empty):
            return self
        blocks, base = [self.blocks[k] for k in existing], self.base_elevation
        if existing and existing[0] > 0:
            base, blocks[0] = None, NOTHING
        sheets, rules = [self.sheets[k] for k in existing], [self.rules[k] for k in existing]
        emptied = tuple(sorted({sum(k < at for k in existing) for at in self.emptied} - {0}))
        if emptied and emptied[-1] == len(existing):
            return _EMPTY
        return Stack(sheets, rules, base, blocks, [self.surfaces[k] for k in existing], emptied)

    def some(self, kept: Mapping[Sheet, np.ndarray]) -> Stack:
        """With some triangles (T,) bool of each sheet alone."""
        return replace(self, sheets=[sheet.some(kept[sheet]) for sheet in self.sheets])


_EMPTY = Stack([], [], None, [], [])


def plain_stack(sheets: list[Sheet], rules: list[str], base: float | None, first: int) -> Stack:
    """first: the number of the oldest surface in the project, which blocks are numbered by."""
    numbers = list(range(len(sheets)))
    blocks = [first + k for k in numbers]
    if base is None:
        blocks[0] = NOTHING
    return Stack(list(sheets), list(rules), base, blocks, numbers)


def between_levels(stack: Stack, beneath: Mapping[int, bool], top: float, plan: Sheet) -> Stack:
    """The stack between level sets of fields. beneath: of each surface that is one, by its number, whether it
    is beneath the surface here: then that is as a level at `top`, above all rock, else as the base. plan: a
    triangulation of the region."""
    base = stack.base_elevation
    assert base is not None  # fields have one
    levels = {True: level(plan, top), False: level(plan, base)}
    sheets = [
        levels[beneath[number]] if number in beneath else sheet
        for sheet, number in zip(stack.sheets, stack.surfaces, strict=True)
    ]
    if all(beneath.values()):
        return replace(stack, sheets=sheets)
    return Stack(  # the base is beneath a surface at the same height
        [levels[False], *sheets],
        [_DEPOSITS, *stack.rules],
        None,
        [NOTHING, *stack.blocks],
        [FLOOR, *stack.surfaces],
    )


def cut_at_base(stack: Stack, base: float | None) -> Stack:
    """The stack with each surface as if it were at the base where it reaches below that: a level at the base,
    with no block beneath it, comes after the surface, over what this covers."""
    heights = [
        float(sheet.vertices[:, 2].min(initial=np.inf)) if of >= 0 else np.inf
        for sheet, of in zip(stack.sheets, stack.surfaces, strict=True)
    ]
    lowest = min(heights, default=np.inf)
    if base is None or lowest > base or (lowest == base and stack.base_elevation is None):
        return stack
    # a flat base is beneath all; a surface that touches it needs one that it may touch
    rows = [] if stack.base_elevation is None else [(level(stack.sheets[0], base), _DEPOSITS, NOTHING, FLOOR)]
    begin = []
    for z, row in zip(
        heights, zip(stack.sheets, stack.rules, stack.blocks, stack.surfaces, strict=True), strict=True
    ):
        begin.append(len(rows))
        rows.append(row)
        rows += [(level(row[0], base), _DEPOSITS, NOTHING, FLOOR)] if z < base else []
    sheets, rules, blocks, surfaces = map(list, zip(*rows, strict=True))
    return Stack(sheets, rules, None, blocks, surfaces, tuple(begin[at] for at in stack.emptied))


def inside_body(
    stack: Stack,
    after: int,
    block: int,
    ends: tuple[float, float],
    plans: list[Sheet],
    covered: list[Sheet],
) -> Stack:
    """The stack inside of a body that came after surface `after`: all that was there, air and rock, is the
    body, block `block`, or NOTHING in a void. ends: heights below and above all. plans: triangulations that
    together cover the rock mass in plan; covered: what the surfaces up to `after` cover.
    """
    older = sum(number <= after for number in stack.surfaces)  # with floors, and fillers of earlier bodies
    base = stack.base_elevation
    if FLOOR in stack.surfaces:
        base = float(stack.sheets[stack.surfaces.index(FLOOR)].vertices[0, 2])
    if block == NOTHING:
        stack = stack.without([number == DEEP for number in stack.surfaces])
        return _emptied(stack, after, base, ends[0], covered)
    first = stack.emptied[-1] if stack.emptied else 0  # of those before it stays what they protect alone
    # what is protected depends on all that was there, and so does what is below the oldest surface
    keeps = base is None or any(RULES[rule].protects for rule in stack.rules[:older])
    retained = [k for k in range(first, older) if stack.surfaces[k] != FLOOR] if keeps else []
    lowest = [] if base is None else [(level(plan, base), FLOOR) for plan in plans]
    # a body also lies where no older surface is: upon a level that raises nothing where one is
    deep = [(level(plan, ends[0]), DEEP) for plan in plans if base is None and DEEP not in stack.surfaces]
    inside = Stack(
        [
            *stack.sheets[:first],
            *(sheet for sheet, _ in lowest),
            *(stack.sheets[k] for k in retained),
            *(sheet for sheet, _ in deep),
        ],
        [
            *stack.rules[:first],
            *[_DEPOSITS] * len(lowest),
            *(stack.rules[k] for k in retained),
            *[_DEPOSITS] * len(deep),
        ],
        None,
        [
            *[NOTHING] * (first + len(lowest)),
            *(NOTHING if base is None and stack.blocks[k] == NOTHING else block for k in retained),
            *[NOTHING] * len(deep),
        ],
        [
            *stack.surfaces[:first],
            *(of for _, of in lowest),
            *(stack.surfaces[k] for k in retained),
            *(of for _, of in deep),
        ],
        stack.emptied,
    )
    for plan in plans:
        inside.sheets.append(level(plan, ends[1]))
        inside.rules.append(_DEPOSITS)
        inside.blocks.append(block)
        inside.surfaces.append(FILLER)
    return Stack(
        [*inside.sheets, *stack.sheets[older:]],
        [*inside.rules, *stack.rules[older:]],
        None,
        [*inside.blocks, *stack.blocks[older:]],
        [*inside.surfaces, *stack.surfaces[older:]],
        stack.emptied,
    )


def _below_bodies(stack: Stack, older: int, deep: float) -> list[tuple[Sheet, int]]:
    """Levels below everything, over surfaces that came upon a body: where no surface was before, the body
    was all that there was, and the void reaches as deep."""
    first = stack.emptied[-1] if stack.emptied else 0
    body = next((k for k in range(first, older) if stack.surfaces[k] == FILLER), older)
    upon = [k for k in range(body, older) if stack.surfaces[k] >= 0]
    return [(level(stack.sheets[k], deep), stack.surfaces[k]) for k in upon]


def _emptied(stack: Stack, after: int, base: float | None, deep: float, covered: list[Sheet]) -> Stack:
    """Inside of a void: what came before is air, and younger surfaces fill it from the base, or from the top
    of what is below the oldest surface. The older ones only stay for that, and where they protect."""
    older = sum(number <= after for number in stack.surfaces)
    if older == len(stack.surfaces):
        return _EMPTY
    if base is None:
        floors, retained = _below_bodies(stack, older, deep), older
    else:
        # where no older surface was, none that comes later forms a block; bodies do not count
        floors = [(level(plan, base), FLOOR) for plan in covered]
        protects = any(RULES[rule].protects for rule in stack.rules[:older])
        # upon a base the first that comes finds nothing to cut
        may_cut = any(RULES[rule].cuts for rule in stack.rules[older + 1 :])
        retained = older if protects and may_cut else 0
    return Stack(
        [*stack.sheets[:retained], *(sheet for sheet, _ in floors), *stack.sheets[older:]],
        [*stack.rules[:retained], *[_DEPOSITS] * len(floors), *stack.rules[older:]],
        None,
        [*[NOTHING] * (retained + len(floors)), *stack.blocks[older:]],
        [*stack.surfaces[:retained], *(of for _, of in floors), *stack.surfaces[older:]],
        (*stack.emptied, retained) if retained else (),
    )


def distinct_plans(sheets: Sequence[Sheet]) -> list[Sheet]:
    """One of each group of sheets that cover the same triangles in plan."""
    plans: list[Sheet] = []
    for sheet in sheets:
        if not any(sheet.has_plan_of(other) for other in plans):
            plans.append(sheet)
    return plans


def level(plan: Sheet, height: float) -> Sheet:
    """A level surface over the area of a sheet or a region."""
    vertices, triangles = plan
    return Sheet(np.column_stack([vertices[:, :2], np.full(len(vertices), height)]), triangles)
