# SPDX-License-Identifier: GPL-3.0-or-later
"""What a proposal has chosen, and why."""

from __future__ import annotations

from dataclasses import dataclass, field

from .lenses import Conflict, Lens, Repeat
from .order import Alternative
from .rules import RuleChoice


@dataclass
class Proposal:
    """The reasons of the choices of a project.

    order: names of units, oldest first. alternatives: pairs of units whose order the data do not decide, and
    the other order. conflicts: units in the wrong order, by hole and depth. lenses: units that became bodies.
    repeats: where several units come again in a hole. rules: of the surface over each unit, with reasons.
    reasons: of the other choices, by the key of the project file. warnings: sentences; the last of them are
    about `uncertain`, in its order.
    """

    order: list[str]
    alternatives: list[Alternative] = field(default_factory=list)
    conflicts: list[Conflict] = field(default_factory=list)
    lenses: list[Lens] = field(default_factory=list)
    repeats: list[Repeat] = field(default_factory=list)
    rules: list[RuleChoice] = field(default_factory=list)
    reasons: dict[str, str] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    @property
    def uncertain(self) -> list[Alternative | Conflict | Lens | Repeat]:
        """What the data do not decide, or what they contradict."""
        return [*self.alternatives, *self.conflicts, *self.lenses, *self.repeats]
