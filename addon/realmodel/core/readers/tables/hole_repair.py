# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds faults in rows of tables of boreholes, repairs them or leaves the rows out, and lists them. Correct
rows are not changed."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.no_value import OFTEN_NO_VALUE
from .hole_data import HoleTables
from .hole_problems import DECIDED, LEFT_OUT, NOT_REACHED, REPAIRED, USED, ProblemList, problem_warnings
from .hole_tables import Row, column_key, normalized_name
from .holes import end_of
from .interval_ends import with_both_ends
from .interval_repair import repair_intervals
from .survey_repair import repair_survey
from .table_layout import is_number
from .unit_names import UnitNames

_NUMBERS = {
    "collars": ("x", "y", "z", "end", "depth", "azimuth", "dip", "inclination"),
    "survey": ("depth", "azimuth", "dip", "inclination"),
    "picks": ("x", "y", "z", "depth", "elevation"),
    "intervals": ("x", "y", "z", "from", "to", "thickness"),
}
_HEIGHTS = ("x", "y", "z", "elevation")  # columns whose values may be below 0
_NULLS = frozenset(OFTEN_NO_VALUE)
_ALWAYS = 1e19  # so large nothing is
_IN_GROUPS = re.compile(r"[+-]?\d{1,3}(?:(?P<sign>[.,'’\u00a0\u202f ])\d{3})(?:(?P=sign)\d{3})*(?:[.,]\d*)?")
_WHOLE = re.compile(r"0*(\d+)(?:[.,]0+)?")  # names of holes that are numbers, as programs write these
_OTHERS = 3  # holes that have two surfaces in the other order make a hole look wrong
# Beyond the range of the others by so many times it, a collar is none of them.
_FAR = 1.0


def repair(tables: HoleTables, units: UnitNames | None = None) -> None:
    """Repairs tables, and lists their problems and warnings. units: what the names of units mean. Raises
    InputRefused where nothing of a table can be used."""
    units = units or UnitNames()
    problems = ProblemList()
    unrepaired = _taken_out(tables, problems)
    for kind, columns in _NUMBERS.items():
        rows = getattr(tables, kind)
        if rows is not None:
            rows = _cleaned(rows, columns, problems)
            factors = tables.factors.get(kind)
            setattr(tables, kind, [row.scaled(factors) for row in rows] if factors else rows)
    lacking: dict[str, str] = {}
    if tables.collars is not None:
        tables.collars, lacking = _complete_collars(tables, problems)
        _rename(tables, problems)
    with_collar = _with_collars(tables, lacking, units, problems)
    tables.survey, tables.picks, tables.intervals = with_collar
    if tables.collars is not None:
        tables.collars = _one_collar_each(tables, problems)
    if tables.survey is not None:
        tables.survey = repair_survey(tables, problems)
    if tables.intervals is not None:
        tables.intervals = with_both_ends(tables, problems)
        tables.intervals = repair_intervals(tables, units, problems)
    if tables.picks is not None:
        tables.picks = _repaired_picks(tables, units, problems)
    for kind, rows in unrepaired.items():
        scaled = [row.scaled(tables.factors.get(kind, {})) for row in rows]
        setattr(tables, kind, sorted([*getattr(tables, kind), *scaled], key=lambda row: row.line))
    tables.problems = problems.in_order()
    undecided = [problem for problem in tables.problems if problem.kind not in DECIDED]
    tables.warnings += problem_warnings(undecided)


def _taken_out(tables: HoleTables, problems: ProblemList) -> dict[str, list[Row]]:
    """The rows, by their table, that take no part in the repair and are used as they are; they and those that
    are not used are taken out of the tables. Raises InputRefused for a row that does not exist."""
    unrepaired, left_out = (
        _row_names(names) for names in (tables.boreholes.unrepaired, tables.boreholes.left_out)
    )
    taken: dict[str, list[Row]] = {}
    seen = set()
    for kind in _NUMBERS if unrepaired or left_out else ():
        others = []
        for row in getattr(tables, kind) or ():
            name = row.file.name, row.line
            if name in unrepaired:
                problems.note("unrepaired", USED, row, "used unchanged, because of 'unrepaired'")
                taken.setdefault(kind, []).append(row)
            elif name in left_out:
                problems.note("switched_off", LEFT_OUT, row, "not used, because of 'left_out'")
            else:
                others.append(row)
                continue
            seen.add(name)
        if getattr(tables, kind) is not None:
            setattr(tables, kind, others)
    for file_name, line in sorted((unrepaired | left_out) - seen):
        what = f"there is no row '{file_name}:{line}', which 'unrepaired' or 'left_out' names"
        raise InputRefused(what, file=tables.boreholes.files[0])
    return taken


def _row_names(names: Sequence[str]) -> set[tuple[str, int]]:
    """(name of the file, line) of texts such as "collars.csv:17"."""
    parts = (name.rpartition(":") for name in names)
    return {(file.strip(), int(line)) for file, _, line in parts}


def _cleaned(rows: list[Row], columns: Sequence[str], problems: ProblemList) -> list[Row]:
    """Rows whose numbers can be read, or are empty. Columns that mostly hold none stay as they are: their
    readers refuse them."""
    if not rows:
        return rows
    header = rows[0].header
    names = [column_key(name) for name in header.names]
    if names:
        repeated = [row for row in rows if [column_key(entry) for entry in row.entries] == names]
        for row in repeated:
            problems.note("no_row", LEFT_OUT, row, "the header again")
        gone = set(map(id, repeated))
        rows = [row for row in rows if id(row) not in gone]
    for column in columns:
        is_idle = column == "thickness" and {"from", "to"} <= header.columns.keys()
        if column in header.columns and not is_idle:
            rows = _cleaned_column(rows, column, problems)
    return rows


def _cleaned_column(rows: list[Row], column: str, problems: ProblemList) -> list[Row]:
    values = [_number(row, column) for row in rows]
    wrong = [n for n, value in enumerate(values) if value is None]
    if wrong:
        rows = _ungrouped(rows, column, wrong)
        values = [_number(row, column) for row in rows]
        wrong = [n for n, value in enumerate(values) if value is None]
    if 2 * len(wrong) > len(rows):
        return rows
    usual = np.array([value for value in values if value is not None and np.isfinite(value)])
    nulls = _nulls(usual, column)
    cleaned = list(rows)
    for n, (row, value) in enumerate(zip(rows, values, strict=True)):
        if value is None:
            cleaned[n] = _mended(row, column, problems)
        elif value in nulls or (np.isinf(value) and np.isfinite(usual).any()):
            problems.note_value(row, column, row.text(column))
            cleaned[n] = row.with_values({column: ""})
    return cleaned


def _number(row: Row, column: str) -> float | None:
    """The number of a column, NaN where there is no value; None where it is none."""
    if not row.has(column):
        return float("nan")
    entry = row.text(column)
    return float(entry.replace(",", ".")) if is_number(entry, row.decimal) else None


def _ungrouped(rows: list[Row], column: str, wrong: Sequence[int]) -> list[Row]:
    """Rows without signs between thousands in a column, where they are nothing else. wrong: the rows whose
    entries are no numbers."""
    changed = list(rows)
    for n in wrong:
        entry = rows[n].text(column)
        grouped = _IN_GROUPS.fullmatch(entry)
        sign = grouped["sign"] if grouped is not None else ""
        plain = entry.replace(sign, "") if sign else entry
        if sign and (sign not in ".," or entry.count(sign) > 1 or {".", ","} <= set(entry)):
            changed[n] = rows[n].with_values({column: plain.replace(",", ".").replace(".", rows[n].decimal)})
    return changed


def _nulls(values: np.ndarray, column: str) -> set[float]:
    """The numbers among those of a column that stand for no value: of heights, coordinates and depths that
    may be real only those that lie far from all others."""
    nulls = {value for value in set(values.tolist()) if value in _NULLS or abs(value) > _ALWAYS}
    others = values[~np.isin(values, list(nulls))]
    if not nulls or not len(others):
        return nulls
    signed = column in _HEIGHTS or (others < 0).sum() * 2 > (others != 0).sum()
    low, high = others.min(), others.max()
    reach = high - low
    return {
        value
        for value in nulls
        if abs(value) > _ALWAYS
        or (value < 0 and not (signed and value == round(value)))
        or not low - reach <= value <= high + reach
    }


def _mended(row: Row, column: str, problems: ProblemList) -> Row:
    """A row with a number that is written otherwise, or without one that cannot be read."""
    entry = row.text(column)
    other = "," if row.decimal == "." else "."
    plain = entry.strip("'\" ").replace("\u2212", "-").replace("\u00a0", "")
    if is_number(plain, row.decimal):
        text = plain
    elif is_number(plain, other) and len(plain.rpartition(other)[2]) != 3:  # else it may part thousands
        text = plain.replace(other, row.decimal)
    else:
        problems.note_value(row, column, f"'{entry:.40}'")
        return row.with_values({column: ""})
    problems.note("number", REPAIRED, row, f"{column} is '{entry}': read as {text}")
    return row.with_values({column: text})


def _complete_collars(tables: HoleTables, problems: ProblemList) -> tuple[list[Row], dict[str, str]]:
    """The rows of collars with a place, and why others have none, by their holes."""
    assert tables.collars is not None
    complete, lacking = [], dict[str, str]()
    for row in tables.collars:
        missing = [axis for axis in "xyz" if not row.has(axis)]
        if missing or not row.has("hole"):
            what = f"no {missing[0]}" if missing else "no name of a hole"
            called = row.called(missing[0]) if missing and missing[0] in row.columns else ""
            what += f" ({called.upper()} is empty)" if called not in ("", *missing) else ""
            if row.has("hole"):
                lacking[row.text("hole")] = f"{row.place} of {row.file} has {what}"
            said = problems.taken(row, *missing) if missing else ""
            problems.note("no_place", LEFT_OUT, row, said or f"it has {what}")
        else:
            complete.append(row)
    if not complete:
        what = next(iter(lacking.values()), "there are no holes in it")
        raise InputRefused(what, file=tables.boreholes.collars)
    return complete, lacking


def _rename(tables: HoleTables, problems: ProblemList) -> None:
    """Writes the holes of other tables as those of the collars, where these have other capitals, spaces,
    hyphens or underscores, or are the same whole number: 7, 007 and 7.0."""
    places: dict[str, dict[str, tuple]] = {}
    for row in tables.collars or ():
        place = tuple(row.number(axis) for axis in "xyz")
        places.setdefault(_spelling(row.text("hole")), {})[row.text("hole")] = place
    known = {hole for holes in places.values() for hole in holes}
    for kind in ("survey", "picks", "intervals"):
        rows = getattr(tables, kind) or []
        for n, row in enumerate(rows):
            hole = row.text("hole") if row.has("hole") else ""
            if not hole or hole in known:
                continue
            alike = places.get(_spelling(hole), {})
            if len(set(alike.values())) == 1:
                name = next(iter(alike))
                problems.note("hole_name", REPAIRED, row, f"taken for '{name}'")
                rows[n] = row.with_values({"hole": name})


def _spelling(hole: str) -> str:
    """The name of a hole, for comparing."""
    whole = _WHOLE.fullmatch(hole)
    return normalized_name(hole) if whole is None else whole[1]


def _with_collars(
    tables: HoleTables, lacking: dict[str, str], units: UnitNames, problems: ProblemList
) -> list[list[Row] | None]:
    """The rows of survey, picks and intervals whose holes have a name and a collar."""
    known = None if tables.collars is None else {row.text("hole") for row in tables.collars}
    tables_left: list[list[Row] | None] = []
    for kind, named in (("survey", ""), ("picks", "surface"), ("intervals", "block")):
        rows = getattr(tables, kind)
        if rows is None:
            tables_left.append(None)
            continue
        having = [row for row in rows if row.has("hole") and (known is None or row.text("hole") in known)]
        if rows and not having and known is not None and named:
            advice = "check how holes are written"
            what = (
                f"no hole of it has a collar in {tables.boreholes.collars}, as hole '{rows[0].text('hole')}'"
            )
            raise rows[0].refuse(what, advice)
        usable = set(map(id, having))
        for row in rows if named else ():
            code = row.text(named) if named in row.columns and row.has(named) else ""
            if id(row) in usable or not row.is_used or units.says_nothing(code):
                continue
            hole = row.text("hole") if row.has("hole") else ""
            problems.taken(row, *_NUMBERS[kind])
            reason = lacking.get(
                hole, f"it has no collar in {tables.boreholes.collars}" if hole else "it has no name"
            )
            problems.note("no_collar", LEFT_OUT, row, reason, depth_of(row), code)
        tables_left.append(having if named else [row for row in rows if row.has("hole")])
    return tables_left


def depth_of(row: Row) -> float | None:
    """The depth of a row, None if it is empty."""
    for name in ("depth", "from", "to"):
        if name in row.columns and row.has(name) and is_number(row.text(name), row.decimal):
            return row.number(name)
    return None


def _one_collar_each(tables: HoleTables, problems: ProblemList) -> list[Row]:
    """The rows of collars, one for each hole."""
    by_hole: dict[str, list[Row]] = {}
    for row in tables.collars or ():
        by_hole.setdefault(row.text("hole"), []).append(row)
    deepest = _deepest(tables)
    single = [rows[0] for rows in by_hole.values() if len(rows) == 1]
    places = np.array([[row.number(axis) for axis in "xyz"] for row in single]).reshape(-1, 3)
    chosen = []
    for hole, rows in by_hole.items():
        if len(rows) == 1:
            chosen += rows
            continue
        best = min(rows, key=lambda row: (_far(row, places), _too_short(row, deepest.get(hole, 0.0))))
        for row in rows:
            if row is best:
                continue
            if all(row.number(axis) == best.number(axis) for axis in "xyz"):
                problems.note("double", REPAIRED, row, f"the collar of {best.place} again")
                best = _joined(best, row)
            else:
                what = f"another collar than in {best.place}, which is used"
                problems.note("two_collars", LEFT_OUT, row, what)
        chosen.append(best)
    return chosen


def _joined(row: Row, other: Row) -> Row:
    """A row with what it lacks from another one."""
    return row.with_values(
        {
            name: other.text(name)
            for name, at in row.columns.items()
            if at < len(row.entries) and not row.has(name) and other.has(name)
        }
    )


def _far(row: Row, places: np.ndarray) -> bool:
    """Whether a collar is far from those of other holes (N, 3)."""
    if len(places) < 2:
        return False
    low, high = places.min(axis=0), places.max(axis=0)
    place, reach = np.array([row.number(axis) for axis in "xyz"]), _FAR * (high - low)
    return bool(((place < low - reach) | (place > high + reach)).any())


def _too_short(row: Row, depth: float) -> bool:
    return bool(end_of(row) < depth)


def _deepest(tables: HoleTables) -> dict[str, float]:
    """How deep the intervals and picks of each hole reach."""
    deepest: dict[str, float] = {}
    for row in (*(tables.intervals or ()), *(tables.picks or ())):
        for name in ("to", "depth"):
            if row.has(name):
                hole, depth = row.text("hole"), row.number(name)
                deepest[hole] = max(depth, deepest.get(hole, depth))
    return deepest


# What programs write among picks, which is no surface.
_ENDS = frozenset(("td", "t.d.", "total depth", "total_depth", "eoh", "end of hole", "bottom of hole"))


def _repaired_picks(tables: HoleTables, units: UnitNames, problems: ProblemList) -> list[Row]:
    """Picks with a surface and a depth or an elevation, each once."""
    rows, usable, seen = tables.picks or [], list[Row](), dict[tuple, Row]()
    if not rows:
        return rows
    column = next((name for name in ("depth", "elevation", "z") if name in rows[0].columns), None)
    ends = {row.text("hole"): end_of(row) for row in tables.collars or ()}
    for row in rows:
        if not row.is_used or column is None:
            usable.append(row)
            continue
        if not row.has("surface"):
            problems.note("no_row", LEFT_OUT, row, "the surface has no name", depth_of(row))
            continue
        code = row.text("surface")
        if code.strip().lower() in _ENDS and units.meaning(code) == code and code not in units.surfaces:
            problems.note("no_row", LEFT_OUT, row, f"'{code}' is the end of the hole", depth_of(row), code)
            continue
        if not row.has(column):
            if what := problems.taken(row, column):
                problems.note("no_depth", LEFT_OUT, row, what, None, code)
            else:
                problems.note(NOT_REACHED, LEFT_OUT, row, f"no {column}")
            continue
        value = row.number(column)
        if column == "depth" and value < 0:
            problems.note("minus_sign", REPAIRED, row, f"depth is {value:g}", value)
            row, value = row.with_values({"depth": -value}), -value
        key = (row.text("hole"), code, value, *(row.text(axis) for axis in "xyz" if row.has(axis)))
        if key in seen:
            problems.note("double", REPAIRED, row, f"the pick of {seen[key].place} again", value)
            continue
        seen[key] = row
        end = ends.get(row.text("hole"), np.nan)
        if column == "depth" and value > end * (1 + 1e-6):
            problems.note("below_end", USED, row, f"the hole ends at {end:g}", value)
        usable.append(row)
    if column is not None:
        _note_order(usable, column, problems)
    return usable


def _note_order(rows: list[Row], column: str, problems: ProblemList) -> None:
    """Lists picks that lie above one that all other holes have above theirs."""
    sign = 1.0 if column == "depth" else -1.0
    by_hole: dict[str, list[tuple[float, str, Row]]] = {}
    for row in rows:
        if row.is_used and row.has(column):
            by_hole.setdefault(row.text("hole"), []).append(
                (sign * row.number(column), row.text("surface"), row)
            )
    above: Counter[tuple[str, str]] = Counter()
    pairs: dict[str, set[tuple[str, str]]] = {}
    for hole, picks in by_hole.items():
        picks.sort(key=lambda pick: pick[0])
        pairs[hole] = {
            (a, b)
            for n, (_, a, _) in enumerate(picks)
            for depth, b, _ in picks[n + 1 :]
            if a != b and depth > picks[n][0]
        }
        above.update(pairs[hole])
    for hole, picks in by_hole.items():
        for depth, name, row in picks:
            others = [b for a, b in pairs[hole] if a == name and above[a, b] == 1 and above[b, a] >= _OTHERS]
            if others:
                what = f"'{name}' lies above {number_list(sorted(others))} here alone"
                problems.note("order", USED, row, what, sign * depth)
