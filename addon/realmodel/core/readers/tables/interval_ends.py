# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of intervals that have only tops, only bases, or a top and a thickness: the other end of each
interval follows from the next one of its hole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .hole_data import HoleTables
from .hole_problems import LEFT_OUT, ProblemList
from .hole_tables import Row
from .holes import end_of

OTHER_END = {
    "from": "it has no column 'to': each interval ends where the next one of its hole begins, and the last "
    "one at the end of its hole",
    "to": "it has no column 'from': each interval begins where the one above ends, and the first one at the "
    "collar",
    "thickness": "it has no column 'to': each interval ends by its thickness below where it begins",
}


def with_both_ends(tables: HoleTables, problems: ProblemList) -> list[Row]:
    """The rows of the table of intervals, each with both ends; those whose other end is not known are left
    out, and listed. A warning says how the ends were found."""
    rows = tables.intervals or []
    if not rows or {"from", "to"} <= rows[0].columns.keys():
        return rows
    has_thickness = {"from", "thickness"} <= rows[0].columns.keys()
    known = "from" if "from" in rows[0].columns else "to"
    tables.warnings.append(f"{rows[0].file}: {OTHER_END['thickness' if has_thickness else known]}")
    missing = "to" if known == "from" else "from"
    count = max(len(rows[0].header.names), *(len(row.entries) for row in rows))
    header = replace(rows[0].header, columns={**rows[0].columns, missing: count})
    ends = {row.text("hole"): end_of(row) for row in tables.collars or ()}
    tops = {row.text("hole"): row.number("z") for row in tables.collars or () if row.has("z")}
    by_hole: dict[str, list[Row]] = {}
    for row in rows:
        if row.has(known) and row.is_used:
            by_hole.setdefault(row.text("hole"), []).append(row)
    others: dict[int, float] = {}
    for hole, of_hole in by_hole.items():
        if has_thickness:
            falls = _falls(of_hole, known)
            thick = [row.number("thickness") if row.has("thickness") else np.nan for row in of_hole]
            others |= {
                id(row): row.number(known) + (-length if falls else length)
                for row, length in zip(of_hole, thick, strict=True)
            }
        else:
            others |= _neighbors(of_hole, known, ends.get(hole, np.nan), tops.get(hole, np.nan))
    whole = []
    for row in rows:
        entries = [*row.entries, *[""] * (count + 1 - len(row.entries))]
        other = others.get(id(row), np.nan)
        new = replace(row, header=header, entries=entries)
        if np.isfinite(other):
            whole.append(new.with_values({missing: other}))
        elif row.has(known) and row.is_used:
            what = "neither a deeper row nor the end of its hole says where it ends"
            what = "its thickness has no value" if has_thickness else what
            code = row.text("block") if row.has("block") else ""
            problems.note("no_depth", LEFT_OUT, row, what, row.number(known), code)
        else:
            whole.append(new)
    return whole


def _falls(rows: list[Row], column: str) -> bool:
    """Whether the numbers of rows of a hole fall in the order of the table: elevations, or below 0."""
    values = [row.number(column) for row in rows]
    return len(values) > 1 and values == sorted(values, reverse=True) and values[0] > values[-1]


def _neighbors(rows: list[Row], known: str, end: float, top: float) -> dict[int, float]:
    """The other end of each row of a hole. end: the depth of the hole's end; top: the elevation of its
    collar; NaN where they are not known."""
    sign = -1.0 if _falls(rows, known) else 1.0
    ordered = sorted(rows, key=lambda row: sign * row.number(known))
    values = [row.number(known) for row in ordered]
    are_elevations = sign < 0 and max(values) > 0
    first = top if are_elevations else 0.0
    last = (top - end if are_elevations else sign * end) if known == "from" else first
    others = [*values[1:], last] if known == "from" else [last, *values[:-1]]
    if known == "from" and sign * last < sign * values[-1]:
        others[-1] = np.nan  # the hole ends above it
    return {id(row): other for row, other in zip(ordered, others, strict=True)}
