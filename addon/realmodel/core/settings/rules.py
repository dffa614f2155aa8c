# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of surfaces: their effect on older and on younger rock: one registry (docs/dev/extending.md)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Rule:
    """label and tip: in the panel. cuts: whether the surface removes older rock above it. protects: whether
    younger surfaces cannot cut what lies below it."""

    label: str
    tip: str
    cuts: bool
    protects: bool


DEFAULT_RULE = "erosional"

RULES: dict[str, Rule] = {
    "erosional": Rule(
        "Erosional",
        "Removes older rock above it: an erosion surface, the usual case",
        cuts=True,
        protects=False,
    ),
    "conformable": Rule(
        "Conformable",
        "Only deposits: ends where it meets older rock (onlap)",
        cuts=False,
        protects=False,
    ),
    "base": Rule(
        "Base", "Only deposits, and younger surfaces cannot erode it (baselap)", cuts=False, protects=True
    ),
    "discontinuous": Rule(
        "Discontinuous",
        "Removes older rock above it, and younger surfaces cannot erode it",
        cuts=True,
        protects=True,
    ),
}
