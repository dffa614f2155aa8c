# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of blocks along boreholes and columns, and the bounds of surfaces that follow from a place in a
block."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...readers.tables.observations import Observations
from ...settings.rules import RULES


@dataclass
class _Run:
    """Rows of one block that follow one another in a column."""

    block: int
    rows: list[int]
    weight: float  # its length along the hole; of places without one their number


def in_wrong_order(
    observations: Observations, blocks: np.ndarray, parts: np.ndarray, may_lie_above: np.ndarray
) -> np.ndarray:
    """(N,) bool: the observations that are left out so that each block may lie above those beneath it.

    blocks: (N,) the numbers of the blocks, oldest first; -1 for what has no order. parts: (N,) the number of
    the part of space that each lies in, such as a compartment: across its border there is no order.
    may_lie_above: (B, B) bool, whether rock of the first block may lie above the second. Of each hole, or of
    the places over one another, the longest part remains that has an order. Where a hole is flatter than 45
    degrees it may cross a surface upward, and does not show the order.
    """
    wrong = np.zeros(len(observations), bool)
    for rows in _columns(observations, blocks, parts):
        runs = _runs(observations, blocks, rows[blocks[rows] >= 0])
        for run in runs:
            wrong[run.rows] = True
        for number in _longest(observations.places, runs, may_lie_above):
            wrong[runs[number].rows] = False
    return wrong


def _columns(observations: Observations, blocks: np.ndarray, parts: np.ndarray) -> Iterator[np.ndarray]:
    """The rows of each hole, or of the places without a hole over one another, from above downward; those in
    different parts of space by themselves."""
    places, holes = observations.places, observations.holes
    _, plan = np.unique(places[:, :2], axis=0, return_inverse=True)
    _, named = np.unique(holes, return_inverse=True)
    has_hole = holes != ""
    key = np.where(has_hole, named.ravel() + plan.max(initial=0) + 1, plan.ravel())
    # rows of a hole keep their order: they follow one another along it
    down = np.where(has_hole, np.arange(len(places)), -places[:, 2])
    order = np.lexsort((np.where(has_hole, 0, -blocks), down, parts, key))
    new = np.flatnonzero((np.diff(key[order]) != 0) | (np.diff(parts[order]) != 0)) + 1
    yield from np.split(order, new)


def _runs(observations: Observations, blocks: np.ndarray, rows: np.ndarray) -> list[_Run]:
    runs: list[_Run] = []
    for row in rows.tolist():
        if runs and runs[-1].block == blocks[row]:
            runs[-1].rows.append(row)
        else:
            runs.append(_Run(int(blocks[row]), [row], 0.0))
    for run in runs:
        depths = observations.depths[run.rows]
        has_depths = observations.holes[run.rows[0]] != "" and np.isfinite(depths).all()
        run.weight = float(np.ptp(depths)) if has_depths else float(len(run.rows))
    return runs


def _longest(places: np.ndarray, runs: list[_Run], may_lie_above: np.ndarray) -> list[int]:
    """The numbers of the runs that remain: of those in order the ones of the largest weight."""
    if all(_agree(places, first, second, may_lie_above) for first, second in itertools.pairwise(runs)):
        return list(range(len(runs)))
    best = [(run.weight, -1) for run in runs]
    for number, run in enumerate(runs):
        for before in range(number):
            weight = best[before][0] + run.weight
            # of equal weights the one with more runs
            if weight >= best[number][0] and _agree(places, runs[before], run, may_lie_above):
                best[number] = (weight, before)
    at = max(range(len(runs)), key=lambda number: best[number][0], default=-1)
    numbers = []
    while at >= 0:
        numbers.append(at)
        at = best[at][1]
    return numbers


def _agree(places: np.ndarray, above: _Run, below: _Run, may_lie_above: np.ndarray) -> bool:
    """Whether two runs, one after another along a hole, may be in this order."""
    x, y, z = places[below.rows[0]] - places[above.rows[-1]]
    if z * z < x * x + y * y:
        return True
    if above.rows[-1] == below.rows[0] or (x == y == z == 0.0):  # they meet: by the way into the lower one
        x, y, z = places[below.rows[-1]] - places[above.rows[0]]
        if z * z < x * x + y * y:
            return True
    upper, lower = (above, below) if z <= 0.0 else (below, above)
    return bool(may_lie_above[upper.block, lower.block])


class Succession:
    """The surfaces of a rock mass, oldest first, by their rules; and bodies, by the surface after which each
    came. Blocks are numbered as the surfaces that they lie beneath, then come the bodies.

    at_or_above: (B, S) bool, the surfaces that a place in each block lies at or below. at_or_below: (B, S)
    bool, those that it lies at or above. A place in a block satisfies all of them, and a place that satisfies
    all of them strictly is in this block, if that is one of a surface.
    """

    def __init__(self, rules: Sequence[str], bodies: Sequence[int] = ()):
        self._rules = [RULES[rule] for rule in rules]
        count = len(self._rules)
        self.at_or_above = np.zeros((count + len(bodies), count), bool)
        self.at_or_below = np.zeros((count + len(bodies), count), bool)
        for block in range(count):
            self.at_or_above[block, block] = True
            self.at_or_above[block, self.cut_later(block)] = True
            self.at_or_below[block, self._before(block)] = True
        for number, after in enumerate(bodies):
            # Whether a surface before the body protects the place is not known from the body.
            if not any(rule.protects for rule in self._rules[: after + 1]):
                self.at_or_above[count + number, self.cut_later(after)] = True

    def cut_later(self, first: int) -> list[int]:
        """The surfaces younger than one that remove rock that was there when it came: those that cut, until
        one protects the rock."""
        numbers = []
        for younger in range(first + 1, len(self._rules)):
            if younger > 0 and self._rules[younger - 1].protects:
                break
            if self._rules[younger].cuts:
                numbers.append(younger)
        return numbers

    def _before(self, block: int) -> list[int]:
        """The surfaces that make the top just before a surface came: the one before it; of each that does not
        cut the one before that, too, as it may lie on it; and of each the youngest older one that protects
        itself, as it may end on that."""
        is_before = [False] * block
        waiting = [block - 1] if block else []
        while waiting:
            number = waiting.pop()
            if is_before[number]:
                continue
            is_before[number] = True
            if number and not self._rules[number].cuts:
                waiting.append(number - 1)
            firm = next((n for n in range(number - 1, -1, -1) if self._rules[n].protects), None)
            if firm is not None:
                waiting.append(firm)
        return [number for number in range(block) if is_before[number]]

    def removes(self, block: int, after: int) -> bool:
        """Whether a place in a block can be inside a body that came after a surface: one younger than that,
        which cuts and below which the place does not lie, has removed the body there."""
        younger = self.cut_later(after)
        return block > after and any(self.at_or_below[block, number] for number in younger)

    def may_lie_above(self, is_sheet: np.ndarray) -> np.ndarray:
        """(S, S) bool: whether rock of the first block may lie above that of the second one. is_sheet: (S,)
        bool, the surfaces with one height over a place. An older block may where no sheet lies over it and
        under the younger one."""
        count = len(self._rules)
        over, under = (relation[:count, is_sheet] for relation in (self.at_or_above, self.at_or_below))
        number = np.arange(count)
        between = np.array([(row & under).any(axis=1) for row in over]).reshape(count, count)
        return ~between | (number[:, None] >= number)

    def contacts(self, blocks: Sequence[int]) -> list[int]:
        """The surfaces through a place on the boundary of all of these blocks."""
        chosen = list(blocks)
        return np.flatnonzero(
            self.at_or_above[chosen].any(axis=0) & self.at_or_below[chosen].any(axis=0)
        ).tolist()
