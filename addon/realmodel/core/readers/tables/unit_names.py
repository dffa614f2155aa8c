# SPDX-License-Identifier: GPL-3.0-or-later
"""What the names of units in tables mean in a project."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from .hole_tables import NO_VALUE

# What stands for core that is not there, or that nobody looked at; in small letters, with blanks.
_NO_CORE = frozenset(
    (
        *("lost core", "core loss", "coreloss", "lostcore", "lc", "no core", "no recovery", "nr"),
        *("not recovered", "not logged", "nl", "not cored", "no sample", "no data", "unknown", "missing"),
    )
)
_WHOLE = re.compile(r"([+-]?\d+)[.,]0+")


@dataclass(frozen=True)
class UnitNames:
    """surfaces, blocks: their names in a rock mass, oldest first; the block of each surface is beneath it.
    bodies: names. names: what a name in a table means: one of these, or "" for nothing."""

    surfaces: Sequence[str] = ()
    blocks: Sequence[str] = ()
    bodies: Sequence[str] = ()
    names: Mapping[str, str] = field(default_factory=dict)

    def says_nothing(self, code: str) -> bool:
        """Whether an entry stands for no unit: it is empty, lost core, or `names` says so."""
        given = self.names.get(code)
        if given is not None:
            return not given
        return not self._is_known(code) and (
            code.lower() in NO_VALUE or re.sub(r"[\s_-]+", " ", code.strip().lower()) in _NO_CORE
        )

    def block(self, code: str) -> str | None:
        """The surface over the block that a name means, or the body, by its name; None for an unknown name,
        or one that several blocks have."""
        name = self._meant(code)
        over = [
            surface for surface, block in zip(self.surfaces, self.blocks, strict=True) if block == name
        ] or [each for each in (*self.surfaces, *self.bodies) if each == name]
        return over[0] if len(over) == 1 else None

    def surface(self, code: str) -> str:
        """The surface that a name means, that over a block of this name where no surface has it; else the
        name itself."""
        name = self._meant(code)
        if name in self.surfaces:
            return name
        over = self.block(code)
        return over if over is not None and over in self.surfaces else name

    def is_surface(self, code: str) -> bool:
        """Whether a name is that of a surface."""
        return self._meant(code) in self.surfaces

    def _is_known(self, name: str) -> bool:
        return name in self.surfaces or name in self.blocks or name in self.bodies

    def _meant(self, code: str) -> str:
        """A name as `names` has it; numbers also as programs write them that know no whole ones (51.0)."""
        whole = _WHOLE.fullmatch(code)
        for given in (code, *([whole.group(1)] if whole else [])):
            if given in self.names:
                return self.names[given]
            if self._is_known(given):
                return given
        return code
