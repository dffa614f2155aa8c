# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of points and orientations as other modeling programs have them: a file, or a data frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused
from ...base.table import Table
from ...base.text import no_step
from ...readers.tables.hole_tables import NO_VALUE, normalized_name, rows
from ...readers.tables.table_layout import plain_name
from ...settings.dips import DipFile
from ...settings.directions import normal_of

XYZ = {"x": ("x",), "y": ("y",), "z": ("z",)}
ANGLES = {
    "azimuth": ("azimuth", "dip_direction", "dipdirection"),
    "strike": ("strike",),
    "dip": ("dip",),
    "polarity": ("polarity",),
}
_VECTORS = (("G_x", "G_y", "G_z"), ("nx", "ny", "nz"), ("gx", "gy", "gz"))
VECTORS = {name: (name,) for vector in _VECTORS for name in vector}

Known = Mapping[str, Sequence[str]]  # the names that a column may have, by its meaning


def read_peer_table(given: Any, known: Known, texts: Sequence[str], label: str) -> Table:
    """The known columns of a table: (N,) texts or float64, NaN where there is no value.

    given: a CSV file, a data frame, or any mapping of columns. texts: the columns that hold names. label: of
    the table, in messages. Raises InputRefused.
    """
    if isinstance(given, (str, Path)):
        return _of_file(Path(given), known, texts)
    try:
        written = {normalized_name(plain_name(str(name))): name for name in given}
        columns = {
            meaning: np.asarray(given[written[alias]]).reshape(-1)
            for meaning, aliases in known.items()
            for alias in [next((a for a in map(normalized_name, aliases) if a in written), None)]
            if alias is not None
        }
    except (TypeError, KeyError, IndexError) as error:
        raise InputRefused(f"{label} must be a file or a data frame, not {type(given).__name__}") from error
    return Table(
        {
            name: _names(values) if name in texts else _numbers(values, name, label)
            for name, values in columns.items()
        }
    )


def _of_file(file: Path, known: Known, texts: Sequence[str]) -> Table:
    if not file.is_file():
        raise InputRefused("file not found", file=file, advice="check the path")
    table_rows = list(rows(DipFile(file), file, known, ("x", "y", "z"), no_step))
    present = table_rows[0].columns if table_rows else known
    columns: dict[str, list] = {name: [] for name in present}
    for row in table_rows:
        for name, values in columns.items():
            if name in texts:
                values.append(row.text(name).strip() if row.has(name) else "")
            else:
                values.append(row.number(name) if row.has(name) else np.nan)
    return Table(
        {name: np.array(values, str if name in texts else np.float64) for name, values in columns.items()}
    )


def _names(values: np.ndarray) -> np.ndarray:
    texts = [str(value).strip() for value in values.tolist()]
    return np.array(["" if text.lower() in NO_VALUE else text for text in texts], str)


def _numbers(values: np.ndarray, name: str, label: str) -> np.ndarray:
    try:
        return np.array([np.nan if value is None else value for value in values.tolist()], np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused(f"column '{name}' of {label} has something that is not a number") from error


def positions_of(table: Table, label: str) -> np.ndarray:
    """(N, 3) float64. Raises InputRefused where a column is missing, or a coordinate is not finite."""
    for axis in XYZ:
        if axis not in table:
            raise InputRefused(f"{label} have no column {axis.upper()}", advice="name the columns X, Y and Z")
    places = np.column_stack([table[axis] for axis in XYZ])
    bad = np.flatnonzero(~np.isfinite(places).all(axis=1))
    if len(bad):
        raise InputRefused(f"row {bad[0]} of {label} has a coordinate that is not finite")
    return places


def normals_of(table: Table) -> np.ndarray:
    """(N, 3) float64 the normals toward younger rock, NaN where a row has none: of a vector, or of azimuth
    (or strike, by the right-hand rule), dip and polarity."""
    normals = np.full((len(table), 3), np.nan)
    for vector in _VECTORS:
        if table.keys() >= set(vector):
            values = np.column_stack([table[name] for name in vector])
            is_new = np.isfinite(values).all(axis=1) & values.any(axis=1) & np.isnan(normals[:, 0])
            normals[is_new] = values[is_new]
    direction = table.get("azimuth")
    if direction is None and "strike" in table:
        direction = table["strike"] + 90.0
    if direction is not None and "dip" in table:
        polarity = table.get("polarity", np.ones(len(table)))
        has_angles = np.isfinite(direction) & np.isfinite(table["dip"]) & np.isnan(normals[:, 0])
        for row in np.flatnonzero(has_angles).tolist():
            upright = normal_of(float(table["dip"][row]), float(direction[row]))
            normals[row] = -upright if polarity[row] < 0 else upright
    return normals
