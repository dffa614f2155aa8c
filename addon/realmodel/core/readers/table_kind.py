# SPDX-License-Identifier: GPL-3.0-or-later
"""What a table of field data is, by its columns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from ..base.errors import InputRefused
from ..base.text import no_step
from ..base.units import MODEL_UNIT
from ..settings.data_files import Boreholes
from ..settings.dips import NORMAL
from .formats import HOLES, format_of
from .hole_files import read_hole_files
from .tables.attitudes import COMBINED, is_combined
from .tables.dialects.workbook import is_workbook, sheet_names
from .tables.dips import DIPS, NAMED
from .tables.hole_data import MEANINGS
from .tables.hole_tables import (
    COLLARS,
    DIRECTIONS,
    INTERVALS,
    OBSERVED,
    PICKS,
    PLACE_NAMES,
    SURVEY,
    Columns,
    Row,
    column_key,
    columns_in,
    may_name_units,
    rows,
)

_KNOWN = {
    "collars": COLLARS,
    "survey": SURVEY,
    "picks": PICKS,
    "intervals": INTERVALS,
    "assays": INTERVALS,
    "observations": OBSERVED,
    "dips": {**DIPS, **NAMED},
}
TABLE_KINDS = tuple(_KNOWN)
# Of structures that are measured in holes.
_STRUCTURES = {
    "structure": ("structure", "structure_type", "struct", "defect", "defect_type", "discontinuity", "joint"),
    "kind": ("fracture", "feature", "feature_type", "plane", "foliation", "bedding", "vein"),
    "alpha": ("alpha", "alpha_angle"),
}
_LOOKED_AT = 2000  # rows whose codes are listed


def table_kind(
    file: str | Path, columns: Mapping[str, str | int] | None = None, sheet: str | None = None
) -> str:
    """One of TABLE_KINDS: what a table, or the sheet of a workbook, is, by the usual names of its columns.

    columns: names or numbers of those that are called otherwise, by meaning, as of Boreholes, ObservationFile
    and DipFile; they decide where the names in the header do not: a column that is named as `surface` makes a
    table one of picks, as `block` one of intervals or observations, as `dip_direction` one of dips.
    Assays are intervals without blocks, whose other columns are shown. A file that holds all tables of
    boreholes is what its data of blocks or surfaces are.
    Raises InputRefused where it may be none of them.
    """
    file = Path(file)
    reading = Boreholes(columns=columns or {})
    if format_of(file, HOLES) is not None:
        whole = read_hole_files(Boreholes(columns=reading.columns, file=file), MODEL_UNIT)
        if whole.intervals is None and whole.picks is None:
            return "assays"
        return "picks" if whole.intervals is None else "intervals"
    hole, logged, survey, seen, dips = (
        columns_in(reading, file, meanings, sheet)
        for meanings in (COLLARS, INTERVALS, SURVEY, OBSERVED, DIPS)
    )
    if _are_places(reading, file, sheet, hole):
        for columns_of in (hole, logged, seen):
            columns_of.pop("hole", None)
    for meaning, known in (("block", INTERVALS), ("surface", COLLARS)):
        those = [columns_of for columns_of in (hole, logged, seen) if meaning in columns_of]
        if those and meaning not in reading.columns and not _are_units(reading, file, sheet, known, meaning):
            for columns_of in those:
                del columns_of[meaning]
    are_picks = {"hole", "surface"} <= hole.keys() and not {"depth", "elevation", "z"}.isdisjoint(hole)
    are_seen = {"x", "y", "z", "block"} <= seen.keys()
    named = {meaning for meaning, called in reading.columns.items() if called is not False}
    if are_picks and "surface" in named:
        return "picks"
    if {"hole", "from", "to", "block"} <= logged.keys():
        return "intervals"
    if are_seen and "block" in named:
        return "observations"
    # A name or an id beside a block is that of a place, not that of a hole.
    of_hole = {"hole", "x", "y", "z"} <= hole.keys() and ("hole" in seen or not are_seen)
    if _are_dips(dips) and not (of_hole and "dip_direction" not in named and _by_azimuth(dips)):
        return "dips"
    if are_picks and not (are_seen and "hole" not in seen and "depth" not in hole):
        return "picks"
    if are_seen:
        return "observations"
    if of_hole:
        if _repeats(reading, file, sheet, "xyz"):
            what = f"its '{hole['hole']}' has many rows with other places, so they are no collars"
            advice = "if it names units, write block = ...; points of surfaces are read as points"
            raise InputRefused(what, file=file, advice=advice)
        return "collars"
    if {"hole", "depth"} <= survey.keys() and not DIRECTIONS.keys().isdisjoint(survey):
        if "depth" not in named and columns_in(reading, file, _STRUCTURES, sheet):
            what = "its rows are structures seen in holes, no survey"
            raise InputRefused(what, file=file, advice="give dips with their places: x, y and z")
        return "survey"
    if {"hole", "from", "to"} <= logged.keys():
        return "assays"
    if {"hole", "block"} <= logged.keys() and not {"from", "to"}.isdisjoint(logged):
        return "intervals"
    raise InputRefused(
        f"its columns do not say whether it has {', '.join(TABLE_KINDS[:-1])} or {TABLE_KINDS[-1]}",
        file=file,
        advice="name its columns, as in hole = BHID; depth = FROM",
    )


def _are_places(reading: Boreholes, file: Path, sheet: str | None, columns: Mapping[str, str]) -> bool:
    """Whether what may name holes, a name or an id, rather numbers or names what is at many places."""
    if "hole" in reading.columns or not {"hole", "x", "y"} <= columns.keys():
        return False
    is_name = column_key(columns["hole"]) in map(column_key, PLACE_NAMES)
    return is_name and _repeats(reading, file, sheet, "xy")


def _are_units(reading: Boreholes, file: Path, sheet: str | None, known: Columns, meaning: str) -> bool:
    every = islice(rows(reading, file, known, (), no_step, sheet), _LOOKED_AT)
    return may_name_units(row.text(meaning) for row in every if row.has(meaning))


def _repeats(reading: Boreholes, file: Path, sheet: str | None, axes: str) -> bool:
    """Whether holes have more than two places each, one with another, by these axes."""
    places: dict[str, set[tuple[str, ...]]] = {}
    for row in islice(rows(reading, file, COLLARS, (), no_step, sheet), _LOOKED_AT):
        if all(map(row.has, ("hole", *axes))):
            places.setdefault(row.text("hole"), set()).add(tuple(map(row.text, axes)))
    return sum(map(len, places.values())) > 2 * len(places)


def sheet_kinds(
    file: str | Path, columns: Mapping[str, str | int] | None = None, chosen: str | None = None
) -> dict[str, str]:
    """The kinds of the sheets of a workbook, as table_kind, by their names; without those that are of none.
    chosen: the names of the sheets that count, with semicolons; None: all. Raises InputRefused for a name
    that no sheet has."""
    file, kinds = Path(file), dict[str, str]()
    names = sheet_names(file)
    wanted = names if chosen is None else [name.strip() for name in chosen.split(";") if name.strip()]
    for name in wanted:
        if name not in names:
            raise InputRefused(f"it has no sheet '{name}'", file=file, advice=f"it has {', '.join(names)}")
        with suppress(InputRefused):
            kinds[name] = table_kind(file, columns, name)
    return kinds


def with_sheets(boreholes: Boreholes) -> tuple[Boreholes, dict[str, str]]:
    """The same with the sheets of a workbook that is its `file` in the places of those tables that are not
    named, and the names of these sheets by their kind; other sheets are ignored. Raises InputRefused where
    there are several of a kind, or none."""
    whole = boreholes.file
    if whole is None and boreholes.picks is not None and boreholes.files == [Path(boreholes.picks)]:
        whole = boreholes.picks  # boreholes = "site.xlsx"
    file = None if whole is None else Path(whole)
    if file is None or not is_workbook(file) or (boreholes.file is None and len(sheet_names(file)) < 2):
        return boreholes, {}
    boreholes = replace(boreholes, file=file, picks=None if whole is boreholes.picks else boreholes.picks)
    sheets: dict[str, str] = {}
    for name, kind in sheet_kinds(file, boreholes.columns, boreholes.layer).items():
        if kind not in MEANINGS or getattr(boreholes, kind) is not None:
            continue
        if kind in sheets:
            what = f"sheets '{sheets[kind]}' and '{name}' both have {kind}"
            advice = f'name those that count: layer = "{"; ".join(sheets.values())}"'
            raise InputRefused(what, file=file, advice=advice)
        sheets[kind] = name
    if not sheets:
        advice = "a sheet of intervals has the columns hole, from, to and block"
        raise InputRefused(
            "no sheet has the columns of collars, surveys, picks or intervals", file=file, advice=advice
        )
    tables: dict[str, Any] = dict.fromkeys(sheets, file)
    return replace(boreholes, file=None, layer=None, **tables), sheets


def _are_dips(columns: Mapping[str, str]) -> bool:
    meanings = columns.keys()
    has_angles = "dip" in meanings and not {"dip_direction", "strike"}.isdisjoint(meanings)
    has_angles = has_angles or any(is_combined(columns.get(name, "")) for name in COMBINED)
    has_angles = has_angles or set(NORMAL) <= meanings
    return {"x", "y"} <= meanings and ({"slope_x", "slope_y"} <= meanings or has_angles)


def _by_azimuth(columns: Mapping[str, str]) -> bool:
    """Whether the dips of a table may as well be the directions of holes."""
    direction = columns.get("dip_direction")
    return "strike" not in columns and direction in DIRECTIONS["azimuth"]


def table_contents(
    file: str | Path, columns: Mapping[str, str | int] | None = None, sheet: str | None = None
) -> tuple[dict[str, str], list[str]]:
    """What is read of a table: its columns, by meaning, as columns_in, and the codes of surfaces or blocks in
    its first 2,000 rows, sorted. columns, sheet: as for table_kind. Raises InputRefused."""
    reading, kind = Boreholes(columns=columns or {}), table_kind(file, columns, sheet)
    first: Iterable[Row]
    if format_of(file, HOLES) is not None:
        whole = read_hole_files(replace(reading, file=file), MODEL_UNIT)
        first = (whole.intervals or whole.picks or [])[:_LOOKED_AT]
        header = first[0].header if first else None
        by_meaning = {} if header is None else {key: header.names[at] for key, at in header.columns.items()}
        coded = [key for key in ("surface", "block") if key in by_meaning]
    else:
        by_meaning = columns_in(reading, Path(file), _KNOWN[kind], sheet)
        coded = [key for key in ("surface", "block") if key in by_meaning and kind != "collars"]
        read = rows(reading, Path(file), _KNOWN[kind], (), no_step, sheet) if coded else iter(())
        first = islice(read, _LOOKED_AT)
    codes = {row.text(key) for row in first for key in coded if row.has(key)}
    return by_meaning, sorted(codes)
