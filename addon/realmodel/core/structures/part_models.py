# SPDX-License-Identifier: GPL-3.0-or-later
"""What a rock mass is in one part of space: the stack of its sheets there, and what bodies make of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputRefused
from ..rules import RULES
from .entries import body_item
from .rock_structure import Triangulation

NOTHING = -1
_DEPOSITS = "conformable"


@dataclass
class Stack:
    """A stack as the builder takes it. blocks: of each surface the number of the block beneath it, NOTHING
    for none. surfaces: of each surface its number in the rock mass, -1 for one that only fills a body."""

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


def inside_body(stack: Stack, after: int, block: int, top: float, body) -> Stack:
    """The stack inside of a body that came after surface `after`: all that was there, air and rock, is the
    body, block `block`, or NOTHING in a void. top: a height above all sheets and bodies. Raises InputRefused.
    """
    older = sum(number <= after for number in stack.surfaces)  # with fillers of earlier bodies
    if block == NOTHING:
        return _emptied(stack, older, body)
    kept = _that_bound(stack, older)
    filler = _level(stack.sheets[0], top)
    return Stack(
        [*(stack.sheets[k] for k in kept), filler, *stack.sheets[older:]],
        [*(stack.rules[k] for k in kept), _DEPOSITS, *stack.rules[older:]],
        stack.base_elevation,
        [
            *(NOTHING if stack.blocks[k] == NOTHING and k == 0 else block for k in kept),
            block,
            *stack.blocks[older:],
        ],
        [*(stack.surfaces[k] for k in kept), -1, *stack.surfaces[older:]],
    )


def _that_bound(stack: Stack, older: int) -> list[int]:
    """Of the older surfaces those that still tell where rock begins, or what is protected: the others vanish
    in the body."""
    first = stack.sheets[0]
    if stack.base_elevation is not None and all(_same_plan(first, sheet) for sheet in stack.sheets[:older]):
        return [k for k in range(older) if RULES[stack.rules[k]].protects]
    return list(range(older))


def _same_plan(one: Triangulation, other: Triangulation) -> bool:
    return one is other or (
        np.array_equal(one[1], other[1]) and np.array_equal(one[0][:, :2], other[0][:, :2])
    )


def _emptied(stack: Stack, older: int, body) -> Stack | None:
    """Inside of a void: what came before is air, and younger surfaces fill it from the base."""
    if older == len(stack.sheets):
        return Stack([], [], None, [], [])
    if stack.base_elevation is None:
        if not RULES[stack.rules[older]].cuts:
            raise InputRefused(
                "younger surfaces fill this void, and there is no base elevation that they fill it from",
                item=body_item(body),
                advice="give the rock mass a base_elevation, or leave out 'after'",
            )
        blocks = [NOTHING, *[stack.blocks[older]] * (older - 1), *stack.blocks[older:]]
        return Stack(stack.sheets, stack.rules, None, blocks, stack.surfaces)
    floor = _level(stack.sheets[0], stack.base_elevation)
    return Stack(
        [floor, *stack.sheets[older:]],
        [_DEPOSITS, *stack.rules[older:]],
        None,
        [NOTHING, *stack.blocks[older:]],
        [-1, *stack.surfaces[older:]],
    )


def _level(sheet: Triangulation, height: float) -> Triangulation:
    """A level surface over what a sheet covers."""
    vertices, triangles = sheet
    return np.column_stack([vertices[:, :2], np.full(len(vertices), height)]), triangles
