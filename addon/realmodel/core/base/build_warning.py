# SPDX-License-Identifier: GPL-3.0-or-later
"""The warnings of a build."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BuildWarning:
    """Something that was left out, changed, or is probably a mistake.

    text: what, in words. kind: a word for programs, "" where there is none. rock, surface: names of the rock
    mass and the surface that it is about, None for none. items: numbers of triangles, from 0.
    """

    text: str
    kind: str = ""
    rock: str | None = None
    surface: str | None = None
    items: tuple[int, ...] = ()

    def __str__(self) -> str:
        where = [f"rock '{self.rock}'"] if self.rock else []
        where += [f"surface '{self.surface}'"] if self.surface else []
        return f"{', '.join(where)}: {self.text}" if where else self.text
