# SPDX-License-Identifier: GPL-3.0-or-later
"""A format of files as the tables of formats have it (docs/dev/extending.md), and its choice by the ending of
a file's name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from .errors import UsageError


@dataclass(frozen=True)
class Format:
    """A format that files are written in.

    takes: what it writes, such as "model" or "parts". label, tip: of menus. write(content, file, step,
    **options) writes it to an open binary file; step(share) is called now and then, last with 1. options: the
    settings that have an effect on its files. folder: what is renewed where the format is a folder, which
    write takes instead of the file. has_files: write takes (content, path, outputs, step, **options),
    and may write several files. has_each: `{block}` in the name of a file means a file for each part. needs:
    the library that writes it and the extra that has this, if it is one.
    """

    ending: str
    label: str
    takes: tuple[str, ...]
    tip: str
    write: Callable[..., None]
    options: tuple[str, ...] = ()
    folder: str = ""
    has_files: bool = False
    has_each: bool = False
    needs: tuple[str, str] | None = None


def by_ending(path: str | Path, formats: Iterable[Format], refusal: str) -> Format:
    """The format of the path's ending. refusal: a sentence with {} for another ending. Raises UsageError."""
    endings = {file_format.ending: file_format for file_format in formats}
    ending = Path(path).suffix.lower()
    if ending not in endings:
        what = refusal.format(f"'{ending}'") if ending else "the file name has no extension"
        raise UsageError(f"{path}: {what}; use one of {', '.join(endings)}")
    return endings[ending]
