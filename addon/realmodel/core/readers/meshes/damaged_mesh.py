# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of damaged mesh files."""

from __future__ import annotations

from pathlib import Path

from ...base.errors import InputRefused

UNREADABLE = (ValueError, IndexError, KeyError, OverflowError, TypeError)


class DamagedError(ValueError):
    """An error in a file, with its line or byte."""

    def __init__(self, what: str, line: int | None = None, byte: int | None = None):
        super().__init__(what if byte is None else f"{what} (byte {byte})")
        self.line = line


def unreadable(file: Path, kind: str, error: Exception) -> InputRefused:
    reason = " ".join(str(error).split()) or type(error).__name__
    line = getattr(error, "line", None)
    return InputRefused(f"not a {kind} file that can be read: {reason:.200}", file=file, line=line)
