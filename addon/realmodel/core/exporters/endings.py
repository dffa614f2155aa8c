# SPDX-License-Identifier: GPL-3.0-or-later
"""The formats of outputs, by the ending of their names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from ..base.errors import UsageError

Entry = TypeVar("Entry")


def by_ending(path: str | Path, known: Mapping[str, Entry], refusal: str) -> Entry:
    """The entry of `known` under the path's ending. refusal: a sentence with {} for another ending. Raises
    UsageError."""
    ending = Path(path).suffix.lower()
    if ending not in known:
        what = refusal.format(f"'{ending}'") if ending else "the file name has no extension"
        raise UsageError(f"{path}: {what}; use one of {', '.join(known)}")
    return known[ending]
