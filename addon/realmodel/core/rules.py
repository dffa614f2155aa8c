# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface does to rock that is older, and to what is younger: one registry (docs/dev/extending.md)."""

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
        "Cuts away what lies above it: a surface of erosion, the usual case",
        cuts=True,
        protects=False,
    ),
    "conformable": Rule(
        "Conformable",
        "Only deposits: ends where it meets what is there already (onlap)",
        cuts=False,
        protects=False,
    ),
    "base": Rule(
        "Base", "Only deposits, and younger surfaces cannot cut it (baselap)", cuts=False, protects=True
    ),
    "discontinuous": Rule(
        "Discontinuous", "Cuts what is older, and younger surfaces cannot cut it", cuts=True, protects=True
    ),
}
