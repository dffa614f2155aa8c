# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a damaged file of a mesh."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputRefused

UNREADABLE = (ValueError, IndexError, KeyError, OverflowError, TypeError)


class Damaged(ValueError):
    """What is wrong, and the line or the byte where."""

    def __init__(self, what: str, line: int | None = None, byte: int | None = None):
        super().__init__(what if byte is None else f"{what} (byte {byte})")
        self.line = line


def unreadable(file: Path, kind: str, error: Exception) -> InputRefused:
    reason = " ".join(str(error).split()) or type(error).__name__
    line = getattr(error, "line", None)
    return InputRefused(f"not a {kind} file that can be read: {reason:.200}", file=file, line=line)
