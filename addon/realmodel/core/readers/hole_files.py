# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of tables of boreholes, also of files that hold all of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..base.errors import InputRefused
from ..base.text import Step, no_step
from ..settings.data_files import Boreholes
from .formats import HOLES, format_of
from .tables.hole_data import MEANINGS, HoleTables, read_hole_rows
from .tables.hole_tables import RawTable

_read: ContextVar[dict[str, HoleTables] | None] = ContextVar("read_tables", default=None)


@contextmanager
def read_once() -> Iterator[None]:
    """Within it the same boreholes are read from their files once: for a job that needs them several times,
    with other meanings of codes."""
    token = _read.set({})
    try:
        yield
    finally:
        _read.reset(token)


def read_hole_files(
    boreholes: Boreholes,
    model_unit: str,
    step: Step = no_step,
    needed: tuple[str, ...] | None = None,
    sheets: Mapping[str, str] | None = None,
) -> HoleTables:
    """read_hole_rows of tables and of files that hold all of them. sheets: the names of those of a workbook.
    Raises InputRefused naming file and line."""
    known, key = _read.get(), repr((boreholes, model_unit, needed))
    if known is None or key not in known:
        whole, tables_of = _whole_files(boreholes)
        tables = read_hole_rows(whole, model_unit, step, needed, {**tables_of, **(sheets or {})})
        if known is None:
            return tables
        known[key] = tables
    return known[key].copy()


def _whole_files(boreholes: Boreholes) -> tuple[Boreholes, dict[str, RawTable]]:
    """The same with the tables of files that hold all of them in the places of those that are not named, and
    these tables by their kind."""
    sheets: dict[str, RawTable] = {}
    for file in dict.fromkeys(boreholes.files[len(boreholes.log_files) :]):
        file_format = format_of(file, HOLES)
        if file_format is None:
            if file == boreholes.file:
                what = "it does not contain all tables of boreholes"
                advice = "name its tables: collars = ..., intervals = ..., picks = ..."
                raise InputRefused(what, file=file, advice=advice)
            continue
        read = file_format.read(file)
        said = {kind: getattr(boreholes, kind) for kind in MEANINGS}
        others: dict[str, Any] = {
            kind: table for kind, table in said.items() if table is not None and Path(table) != file
        }
        here = [kind for kind in read if kind not in others]
        sheets |= {kind: read[kind] for kind in here}
        tables: dict[str, Any] = dict.fromkeys(MEANINGS) | others | dict.fromkeys(here, file)
        boreholes = replace(boreholes, file=None, **tables)
        if boreholes.downward_dip is None and "survey" in sheets:
            boreholes = replace(boreholes, downward_dip=file_format.downward_dip)
    return boreholes, sheets
