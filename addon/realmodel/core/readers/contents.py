# SPDX-License-Identifier: GPL-3.0-or-later
"""The choices in a file of points: its columns or attributes, their values, its layers."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np

from ..base.errors import InputRefused
from ..settings.data_files import MapLayer
from .formats import MESH, OBJECTS, RASTER, SHAPES, TABLE, format_of
from .map_input import read_shapes
from .maps.geopackage import UNREADABLE, connect
from .maps.shapes import NothingSelected
from .object_input import objects_in, read_object
from .point_input import OF_POINTS
from .tables.points import KNOWN, body_rows, open_table
from .tables.table_layout import Expected
from .tables.workbook import sheet_names

_NOTHING = "\0"  # no attribute is called so, and none has it


def column_names(file: Path, layer: str | None = None) -> list[str]:
    """The names of the columns of a table, or numbers from 1 where it has no header; or of the attributes of
    the features of a layer, or the points of an object; none of a raster or a mesh. Raises InputRefused."""
    holds = _holds(file)
    if holds in (RASTER, MESH):
        return []
    if holds == OBJECTS:
        return list(read_object(file, layer, OF_POINTS).columns)
    if holds == SHAPES:
        return list(_nothing_selected(file, layer, _NOTHING).names)
    table = open_table(file, Expected(known=KNOWN), layer)
    row = next(body_rows(table), [])
    names = table.layout.names or ()
    return [name or str(n) for n, name in enumerate(names, 1)] or [str(n + 1) for n in range(len(row))]


def column_values(file: Path, column: str, layer: str | None = None) -> list[str]:
    """The different values of a column, or attribute, in the order of the file. Raises InputRefused."""
    holds = _holds(file)
    if holds == OBJECTS:
        values = read_object(file, layer, OF_POINTS).columns.get(column, np.empty(0))
        return list(dict.fromkeys(str(value) for value in values.tolist() if value != ""))
    if holds == SHAPES:
        return list(_nothing_selected(file, layer, column).values)
    table = open_table(file, Expected(None, (column,), KNOWN), layer)
    at = table.column(column)
    return list(dict.fromkeys(row[at] for row in body_rows(table) if at < len(row) and row[at]))


def layer_names(file: Path) -> list[str]:
    """What `layer` may name in a file: the layers of a GeoPackage, the objects of a file of objects, the
    sheets of a workbook; none of other files. Raises InputRefused."""
    file_format = format_of(file, OBJECTS, SHAPES)
    if file_format is not None and file_format.holds == OBJECTS:
        return list(dict.fromkeys(obj.name for obj in objects_in(file)))
    if file_format is None:
        table = format_of(file, TABLE)
        return sheet_names(file) if table is not None and table.has_layers else []
    if not file_format.has_layers:
        return []
    try:
        with closing(connect(file)) as base:
            return [name for (name,) in base.execute("SELECT table_name FROM gpkg_geometry_columns")]
    except UNREADABLE as error:
        raise InputRefused(f"not a GeoPackage that can be read: {error}", file=file) from error


def _holds(file: Path) -> str | None:
    file_format = format_of(file, RASTER, OBJECTS, MESH, SHAPES)
    return None if file_format is None else file_format.holds


def _nothing_selected(file: Path, layer: str | None, attribute: str) -> NothingSelected:
    """The error of a layer that has no matching feature; geometries are not read."""
    try:
        read_shapes(MapLayer(file, layer, {attribute: _NOTHING}))
    except NothingSelected as error:
        return error
    return NothingSelected("it has no features")
