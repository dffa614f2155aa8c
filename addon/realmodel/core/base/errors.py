# SPDX-License-Identifier: GPL-3.0-or-later
"""The types of errors and the warnings of a build. Every message is one line: where, what is wrong, what
to do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

_LONGEST = 500


def _one_line(text: object) -> str:
    return " ".join(str(text).split())


def _shortened(text: str) -> str:
    """The beginning and the end of a long text, such as the content of a damaged file."""
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 100]} ... {text[-95:]}"


class RealModelError(Exception):
    """Base of all errors that RealModel raises on purpose. Most are also the built-in error of their kind."""


class InputRefused(RealModelError, ValueError):
    """The input is invalid.

    what: the problem. file, line: the place (lines count from 1). item: the object, such as "rock 'base',
    surface 'S1'". advice: what to do about it. triangles: numbers of the wrong triangles, from 0 in the order
    of the input. place: (x, y, z) or (x, y) in model units.
    """

    def __init__(
        self,
        what: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        item: str | None = None,
        advice: str | None = None,
        triangles: tuple[int, ...] = (),
        place: tuple[float, ...] | None = None,
    ):
        self.what = _shortened(_one_line(what))
        self.file = None if file is None else Path(file)
        self.line = line
        self.item = item
        self.advice = advice
        self.triangles = tuple(triangles)
        self.place = place
        super().__init__(self._sentence())

    def _sentence(self) -> str:
        parts = []
        if self.file is not None:
            parts.append(f"{self.file}:{self.line}" if self.line is not None else str(self.file))
        if self.item:
            parts.append(self.item)
        text = ": ".join([*parts, self.what])
        return _one_line(f"{text}; {self.advice}" if self.advice else text)

    def within(self, item: str, *, file: str | Path | None = None, line: int | None = None) -> InputRefused:
        """The same error with the name of `item`; an existing file and line are kept."""
        has_file = self.file is not None
        return type(self)(
            self.what,
            file=self.file if has_file else file,
            line=self.line if has_file else line,
            item=item if self.item is None else f"{item}, {self.item}",
            advice=self.advice,
            triangles=self.triangles,
            place=self.place,
        )


@contextmanager
def naming(item: str, source: Callable[[], tuple[Path | None, int | None]] | None = None) -> Iterator[None]:
    """Within it errors name an item, and its file and line where they have none yet; those that name it, or
    what it is in, stay."""
    try:
        yield
    except InputRefused as error:
        if error.item is not None and error.item.startswith(item.partition(",")[0]):
            raise
        file, line = source() if source else (None, None)
        raise error.within(item, file=file, line=line) from error


class HeightsMissing(InputRefused):
    """There are points, but no heights in the chosen place; another choice may find them."""


class OutputFailed(RealModelError, OSError):
    """A result could not be written: no folder, no right to write, disk full."""


class BuildFailed(RealModelError):
    """The build itself failed: not enough memory, the native module missing, or a defect."""


class NotEnoughMemory(BuildFailed):
    """The build would need too much memory, and was not begun.

    needed: its memory in bytes; available: the free or allowed memory.
    """

    def __init__(self, what: str, *, needed: int, available: int, advice: str):
        self.needed = needed
        self.available = available
        self.advice = advice
        super().__init__(f"{what}; {advice}")


class Cancelled(RealModelError):
    """The caller's cancel() returned True."""


class UsageError(RealModelError, ValueError, TypeError):
    """A function or the command line was called with something that it does not know."""


def number_list(numbers: Iterable[object], most: int = 6) -> str:
    """'3', '3 and 5', '3, 5 and 8', or the first few and how many more."""
    texts = [str(n) for n in numbers]
    if len(texts) > most:
        return f"{', '.join(texts[:most])} and {len(texts) - most} more"
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} and {texts[-1]}"


def counted(count: int, noun: str) -> str:
    """'1 point', '2 points'. noun: with a plural in s."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def place_text(place: Iterable[float]) -> str:
    """A point in model units, with as many digits as it takes to find it."""
    return "(" + ", ".join(f"{value:.9g}" for value in place) + ")"


@dataclass(frozen=True)
class BuildWarning:
    """Something that was left out, changed, or is probably a mistake.

    text: the warning. kind: a word for programs, "" for none. rock, surface: names of the rock mass and the
    surface that it concerns, or None. items: numbers of triangles, from 0.
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
