# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of boreholes as a project reads them, for Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import UsageError
from ..base.table import Table
from ..base.units import MODEL_UNIT
from ..settings.data_files import Boreholes
from .borehole_input import read_repaired
from .hole_values import read_logs
from .point_input import reading_keys
from .tables.hole_data import HoleTables
from .tables.hole_problems import HoleProblem
from .tables.hole_tables import Row
from .tables.holes import Holes, end_of
from .tables.interval_values import IntervalValues


@dataclass(frozen=True)
class BoreholeTables:
    """Boreholes, in model units; what is not known is NaN or "".

    collars: hole, x, y, z, end (the depth of the end). survey: hole, depth, azimuth (degrees clockwise from
    north), inclination (degrees from the vertical), dip (from the horizontal). intervals: hole, from, to,
    block. picks: hole, surface, depth, elevation. logs: hole, from, to, and the curves of LAS files by their
    names with units, "GR (GAPI)": a row for each sample, up to the middle between it and the next one.
    problems: of rows that were repaired, left out, or are used although something is wrong. warnings:
    sentences.
    """

    collars: Table
    survey: Table
    intervals: Table
    picks: Table
    logs: Table
    problems: list[HoleProblem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def read_boreholes(
    file: Boreholes | Mapping | str | Path | None = None,
    units: str = MODEL_UNIT,
    *,
    file_units: str | Mapping | None = None,
    **keys: Any,
) -> BoreholeTables:
    """Boreholes as a project reads them, repaired.

    file: of a format that holds all tables; else keys say which there are: collars, survey, intervals, picks,
    and the other keys of Boreholes, here or as a mapping in the place of the file. units: of the model;
    file_units: of files that do not state one. Raises InputRefused naming file and line, UsageError for an
    unknown unit or key.

    >>> holes = read_boreholes(collars="collars.csv", intervals="lithology.csv")  # doctest: +SKIP
    """
    boreholes = boreholes_of(file, units, file_units, keys)
    tables = read_repaired(boreholes, units)
    scale = tables.scale(units)
    height = scale[2]
    return BoreholeTables(
        _collars(tables, scale),
        _survey(tables, height),
        _intervals(tables, height),
        _picks(tables, height),
        _logs(tables, units),
        tables.problems,
        tables.warnings,
    )


def boreholes_of(
    given: Any, units: str, file_units: Any = None, keys: Mapping[str, Any] | None = None
) -> Boreholes:
    """The Boreholes of a file, or of their keys as a mapping, with other `keys`; as read_boreholes. Raises
    UsageError."""
    if isinstance(given, Boreholes) and not keys and file_units is None:
        return given
    if isinstance(given, Boreholes):
        raise UsageError("Boreholes have keys already; leave the others out")
    if isinstance(given, BoreholeTables):
        raise UsageError("boreholes are given by their files or a Boreholes, not by tables that were read")
    every = {**given, **(keys or {})} if isinstance(given, Mapping) else {"file": given, **(keys or {})}
    every = {key: value for key, value in every.items() if value is not None}
    if file_units is None:
        file_units = every.pop("units", None)
    return reading_keys(Boreholes, every.pop("file", None), units, file_units, every)


def _texts(rows: list[Row], column: str) -> np.ndarray:
    return np.array([row.text(column) if row.has(column) else "" for row in rows], str)


def _numbers(rows: list[Row], column: str, scale: float = 1.0) -> np.ndarray:
    """(N,) float64; NaN where there is no such column or no value."""
    return np.array([row.number(column) if row.has(column) else np.nan for row in rows]) * scale


def _collars(tables: HoleTables, scale: np.ndarray) -> Table:
    """Without a table of collars, those that the rows of picks and intervals say."""
    rows, is_table = tables.collars, tables.collars is not None
    if rows is None:
        by_hole: dict[str, Row] = {}
        for row in (*(tables.intervals or ()), *(tables.picks or ())):
            by_hole.setdefault(row.text("hole"), row)
        rows = list(by_hole.values())
    # without a depth z is where a pick is
    known = [
        row if is_table or row.has("depth") or row.has("from") else row.with_values({"z": ""}) for row in rows
    ]
    places = {axis: _numbers(known, axis, scale[n]) for n, axis in enumerate("xyz")}
    ends = np.array([end_of(row) if is_table else np.nan for row in rows]) * scale[2]
    return Table({"hole": _texts(rows, "hole"), **places, "end": ends})


def _survey(tables: HoleTables, height: float) -> Table:
    rows = tables.survey or []
    return Table(
        {
            "hole": _texts(rows, "hole"),
            "depth": _numbers(rows, "depth", height),
            "azimuth": _numbers(rows, "azimuth"),
            "inclination": _numbers(rows, "inclination"),
            "dip": _numbers(rows, "dip"),
        }
    )


def _intervals(tables: HoleTables, height: float) -> Table:
    rows = [row for row in tables.intervals or () if row.is_used]
    depths = {name: _numbers(rows, name, height) for name in ("from", "to")}
    return Table({"hole": _texts(rows, "hole"), **depths, "block": _texts(rows, "block")})


def _logs(tables: HoleTables, unit: str) -> Table:
    logs = read_logs(tables, Holes(tables), unit) if tables.boreholes.logs else []
    values = IntervalValues.joined(logs) if logs else None
    if values is None:
        return Table({"hole": np.array([], str), "from": np.zeros(0), "to": np.zeros(0)})
    begins, ends = values.depths.T * tables.scale(unit)[2]
    return Table({"hole": values.holes, "from": begins, "to": ends, **values.columns})


def _picks(tables: HoleTables, height: float) -> Table:
    rows = [row for row in tables.picks or () if row.is_used]
    names = {name: _texts(rows, name) for name in ("hole", "surface")}
    columns = rows[0].columns if rows else {}
    elevation = "elevation" if "elevation" in columns or "depth" in columns else "z"
    heights = {"depth": _numbers(rows, "depth", height), "elevation": _numbers(rows, elevation, height)}
    return Table(names | heights)
