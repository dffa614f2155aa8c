# SPDX-License-Identifier: GPL-3.0-or-later
"""What a rock mass is in one part of space: the stack of its sheets there, and what bodies make of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..rules import RULES
from .rock_structure import Triangulation
from .voids import Build, Older, level

NOTHING = -1
FILLER, FLOOR = -1, -2  # surfaces that only fill a body, or lie in the place of the base elevation
_DEPOSITS, _PROTECTS = "conformable", "base"


@dataclass
class Stack:
    """A stack as the builder takes it. blocks: of each surface the number of the block beneath it, NOTHING
    for none. surfaces: of each surface its number in the rock mass, FILLER or FLOOR."""

    sheets: list[Triangulation]
    rules: list[str]
    base_elevation: float | None
    blocks: list[int]
    surfaces: list[int]

    def without(self, empty: list[bool]) -> Stack:
        """Without the surfaces that do not exist here. Where the oldest is none, no block is on the base."""
        kept = [k for k, is_empty in enumerate(empty) if not is_empty]
        if len(kept) == len(empty):
            return self
        blocks, base = [self.blocks[k] for k in kept], self.base_elevation
        if kept and kept[0] > 0:
            base, blocks[0] = None, NOTHING
        sheets, rules = [self.sheets[k] for k in kept], [self.rules[k] for k in kept]
        return Stack(sheets, rules, base, blocks, [self.surfaces[k] for k in kept])


def plain_stack(sheets: list[Triangulation], rules: list[str], base: float | None, first: int) -> Stack:
    """first: the number of the oldest surface in the project, which blocks are numbered by."""
    numbers = list(range(len(sheets)))
    blocks = [first + k for k in numbers]
    if base is None:
        blocks[0] = NOTHING
    return Stack(list(sheets), list(rules), base, blocks, numbers)


def distinct_plans(sheets: list[Triangulation]) -> list[Triangulation]:
    """Of sheets, one of each that cover the same triangles in plan."""
    found: list[Triangulation] = []
    for sheet in sheets:
        if not any(_same_plan(sheet, other) for other in found):
            found.append(sheet)
    return found


def _same_plan(one: Triangulation, other: Triangulation) -> bool:
    return one is other or (
        np.array_equal(one[1], other[1]) and np.array_equal(one[0][:, :2], other[0][:, :2])
    )


def inside_body(
    stack: Stack,
    after: int,
    block: int,
    top: float,
    plans: list[Triangulation],
    region: Triangulation | None,
    build: Build,
) -> Stack:
    """The stack inside of a body that came after surface `after`: all that was there, air and rock, is the
    body, block `block`, or NOTHING in a void. top: a height above all sheets and bodies. plans:
    triangulations that together cover the rock mass in plan; region: the one that bounds it, or None.
    """
    older = sum(number <= after for number in stack.surfaces)  # with floors, and fillers of earlier bodies
    base = stack.base_elevation
    if FLOOR in stack.surfaces:
        base = float(stack.sheets[0][0][0, 2])
    if block == NOTHING:
        sheets = stack.sheets[:older]
        before = Older(build, sheets, stack.rules[:older], distinct_plans(sheets), region)
        return _emptied(stack, older, base, before)
    # what is protected depends on all that was there
    protects = any(RULES[rule].protects for rule in stack.rules[:older])
    kept = [k for k in range(older) if stack.surfaces[k] != FLOOR] if protects or base is None else []
    inside = Stack(
        [*(stack.sheets[k] for k in kept), *(level(plan, top) for plan in plans)],
        [*(stack.rules[k] for k in kept), *[_DEPOSITS] * len(plans)],
        None,
        [block] * (len(kept) + len(plans)),
        [*(stack.surfaces[k] for k in kept), *[FILLER] * len(plans)],
    )
    if base is None:
        inside.blocks[0] = NOTHING
    return _upon(base, plans, inside, stack, older)


def _upon(base: float | None, plans, lower: Stack, stack: Stack, older: int) -> Stack:
    """Floors at a base elevation, which all else lies on, then one stack, then the younger surfaces of
    another."""
    floors = [] if base is None else [level(plan, base) for plan in plans]
    return Stack(
        [*floors, *lower.sheets, *stack.sheets[older:]],
        [*[_DEPOSITS] * len(floors), *lower.rules, *stack.rules[older:]],
        None,
        [*[NOTHING] * len(floors), *lower.blocks, *stack.blocks[older:]],
        [*[FLOOR] * len(floors), *lower.surfaces, *stack.surfaces[older:]],
    )


def _emptied(stack: Stack, older: int, base: float | None, before: Older) -> Stack:
    """Inside of a void: what came before is air, and younger surfaces fill it from the base, or from the top
    of what is below the oldest surface. What they fill below the top of what was protected stays: it is there
    before they come as they do elsewhere."""
    if base is not None:
        # where no older surface was, none that comes later forms a block
        floors = [(level(plan, base), FLOOR) for plan in before.plans]
    else:
        floors = [(piece.sheet, stack.surfaces[piece.of]) for piece in before.never()]
    young = range(older, len(stack.sheets))
    kept: list[tuple[Triangulation, int, int]] = []  # with their blocks and surfaces
    if any(RULES[stack.rules[k]].cuts for k in young[1:]) and (tops := before.protected()):
        for k in young:
            for piece in before.lower(tops, stack.sheets[k], k):
                kept.append((piece.sheet, stack.blocks[k], stack.surfaces[piece.of]))
    parts = [
        *((sheet, _DEPOSITS, NOTHING, of) for sheet, of in floors),
        *((sheet, _DEPOSITS, block, of) for sheet, block, of in kept),
        *((sheet, _PROTECTS, NOTHING, of) for sheet, of in floors if kept),  # protects what there is
        *((stack.sheets[k], stack.rules[k], stack.blocks[k], stack.surfaces[k]) for k in young),
    ]
    sheets, rules, blocks, surfaces = map(list, zip(*parts, strict=True)) if parts else ([], [], [], [])
    return Stack(sheets, rules, None, blocks, surfaces)
