# SPDX-License-Identifier: GPL-3.0-or-later
"""What a place in a block says of the surfaces over and under it: the replay of their rules, reversed.

The replay (docs/dev/geometry.md) leaves a place in block k exactly if it was above the top when surface k
came, and no surface since then removed it. Both are inequalities between the heights of surfaces and the
place, one for each surface; no other heights matter.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...settings.rules import RULES


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
