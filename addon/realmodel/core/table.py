# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of volumes, for people to read on a terminal."""

from __future__ import annotations

_HEADINGS = ("block", "property", "rock", "volume", "share", "cells", "components")
_NUMBERS_FROM = 3


def volume_table(model) -> str:
    """A line for each block, youngest first as in the field, and the sum; plain text with aligned columns."""
    library = model.project.library
    total = model.volume
    rows = []
    for block in reversed(model.blocks):
        entry = library.get(block.property) if library else None
        name = entry.name if entry else str(block.property) if block.property else "none"
        rows.append(
            (
                block.name,
                name,
                model.project.rocks[block.rock].name,
                _figure(block.volume),
                f"{100 * block.volume / total if total else 0:.2f} %",
                f"{block.cells}",
                f"{block.components}",
            )
        )
    cells = sum(block.cells for block in model.blocks)
    parts = sum(block.components for block in model.blocks)
    rows.append(("total", "", "", _figure(total), "100.00 %" if total else "0.00 %", f"{cells}", f"{parts}"))
    widths = [max(len(row[i]) for row in (_HEADINGS, *rows)) for i in range(len(_HEADINGS))]
    rule = "-" * (sum(widths) + 2 * (len(widths) - 1))
    lines = [
        _line(_HEADINGS, widths),
        rule,
        *(_line(row, widths) for row in rows[:-1]),
        rule,
        _line(rows[-1], widths),
    ]
    return "\n".join(lines)


def _figure(volume: float) -> str:
    """Seven significant digits, without an exponent where that can be read."""
    if volume and not 1e-3 <= abs(volume) < 1e12:
        return f"{volume:.6e}"
    digits = max(0, 6 - len(str(int(abs(volume)))) + 1) if volume else 0
    return f"{volume:.{min(digits, 6)}f}"


def _line(row, widths) -> str:
    entries = [
        text.ljust(width) if column < _NUMBERS_FROM else text.rjust(width)
        for column, (text, width) in enumerate(zip(row, widths, strict=True))
    ]
    return "  ".join(entries).rstrip()
