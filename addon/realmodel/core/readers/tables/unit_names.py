# SPDX-License-Identifier: GPL-3.0-or-later
"""What the names of units in tables mean in a project."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property

from ...base.errors import InputRefused
from .hole_tables import NO_VALUE, normalized_name

# What stands for core that is not there, or that nobody examined.
_SHORT = frozenset(("lc", "nr", "nl"))  # which may be the code of a unit as well: LC is London Clay
_NO_CORE = _SHORT | frozenset(
    normalized_name(name)
    for name in (
        *("lost core", "core loss", "coreloss", "lostcore", "no core", "no recovery"),
        *("not recovered", "not logged", "not cored", "no sample", "no data", "unknown", "missing"),
    )
)
_REGULAR = re.compile(r"/(.+)/$")
_WHOLE = re.compile(r"([+-]?\d+)[.,]0+")


@dataclass(frozen=True)
class UnitNames:
    """surfaces, blocks: their names in a rock mass, oldest first; the block of each surface is beneath it.
    bodies: names. names: what a name in a table means: one of these, or "" for nothing. A name that is none
    of them is the one that differs from it in capitals, spaces, hyphens and underscores alone, if any; else
    what the first pattern in `names` means that it fits: Qal*, or a regular expression /^Q[0-9]/."""

    surfaces: Sequence[str] = ()
    blocks: Sequence[str] = ()
    bodies: Sequence[str] = ()
    names: Mapping[str, str] = field(default_factory=dict)

    def says_nothing(self, code: str) -> bool:
        """Whether an entry stands for no unit: it is empty, lost core, or has no meaning in `names`."""
        meant = self._found(code)
        if meant is not None:
            return not meant
        return _is_empty(code)

    def means_nothing(self, code: str) -> bool:
        """Whether an entry has no meaning in `names`."""
        return self._found(code) == ""

    def meaning(self, code: str) -> str:
        """What a name means; the name itself where nothing is called so."""
        name = self._found(code)
        return code if name is None else name

    def block(self, code: str) -> str | None:
        """The surface over the block that a name means, or the body, by its name; None for an unknown name,
        or one that several blocks have."""
        name = self.meaning(code)
        over = [
            surface for surface, block in zip(self.surfaces, self.blocks, strict=True) if block == name
        ] or [unit for unit in (*self.surfaces, *self.bodies) if unit == name]
        return over[0] if len(over) == 1 else None

    def surface(self, code: str) -> str:
        """The surface that a name means, that over a block of this name where no surface has it; else the
        name itself."""
        name = self.meaning(code)
        if name in self.surfaces:
            return name
        over = self.block(code)
        return over if over is not None and over in self.surfaces else name

    def is_surface(self, code: str) -> bool:
        """Whether a name is that of a surface."""
        return self.meaning(code) in self.surfaces

    def _is_known(self, name: str) -> bool:
        return name in self.surfaces or name in self.blocks or name in self.bodies

    @cached_property
    def _alike(self) -> dict[str, str | None]:
        """What names mean that are written otherwise; None where it is not clear."""
        meanings = {name: name for name in (*self.bodies, *self.blocks, *self.surfaces)} | dict(self.names)
        spellings: dict[str, str | None] = {}
        for name, meant in meanings.items():
            if spellings.setdefault(normalized_name(name), meant) != meant:
                spellings[normalized_name(name)] = None
        return spellings

    def _found(self, code: str) -> str | None:
        """_look_up of each code once."""
        if code not in self._known:
            self._known[code] = self._look_up(code)
        return self._known[code]

    @cached_property
    def _known(self) -> dict[str, str | None]:
        return {}

    def _look_up(self, code: str) -> str | None:
        """A name as `names` or the rock mass has it, None where neither does; numbers also as programs write
        them that know no whole ones (51.0)."""
        whole = _WHOLE.fullmatch(code)
        for spelling in (code, *([whole.group(1)] if whole else [])):
            if spelling in self.names:
                return self.names[spelling]
            if self._is_known(spelling):
                return spelling
        if _is_empty(code):
            return None
        alike = self._alike.get(normalized_name(code))
        return alike if alike is not None else next((m for p, m in self._patterns if fits(p, code)), None)

    @cached_property
    def _patterns(self) -> list[tuple[str, str]]:
        return [(name, meant) for name, meant in self.names.items() if "*" in name or _REGULAR.match(name)]


def fits(pattern: str, code: str) -> bool:
    """Whether a code fits a pattern of * and ?, or a regular expression between slashes that finds something
    in it, whatever the capitals. Raises InputRefused for an invalid one."""
    regular = _REGULAR.match(pattern)
    if regular is None:
        return fnmatchcase(code.casefold(), pattern.casefold())
    try:
        return re.search(regular[1], code, re.IGNORECASE) is not None
    except re.error as error:
        what = f"{pattern} is no regular expression: {error}"
        raise InputRefused(what, advice="use Qal*, or /^Q[0-9]/") from error


def may_be_a_unit(code: str) -> bool:
    """Whether an entry without a meaning may be the code of a unit."""
    return normalized_name(code) in _SHORT


def _is_empty(code: str) -> bool:
    """Whether an entry stands for nothing everywhere."""
    return code.lower() in NO_VALUE or normalized_name(code) in _NO_CORE
