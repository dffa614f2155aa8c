# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of points with its import options: columns, filters, separators, units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..base.units import METERS, factors
from .method_options import OptionRefused


@dataclass(frozen=True)
class PointFile:
    """Points in a table of text, an ESRI ASCII grid, a GeoTIFF, a file of shapes (GeoJSON, well-known text, a
    shapefile or a layer of a GeoPackage), or an object of an OMF or geoh5 file.

    columns: the three of x, y and z, by name or by number from 1; None: those named so, or the first three.
    where: {column or attribute: value, or a list of them}; only rows or features that hold it count.
    separator: one character; " " means any blanks and tabs; None: detected from the content.
    decimal: "." or ","; None: detected from the content.
    nodata: no-data values: a number, a text or a list of them; such points are left out.
    units: of the file, "ft" for all three coordinates, or {"xy": "m", "z": "ft"}; None: those of the model.
    z_axis: "up", or "down" where z is a depth.
    height: the attribute of features or points that holds their height; None: the z of their positions.
    layer: of a GeoPackage, or the object of an OMF or geoh5 file; needed where there are several.
    columns, separator and decimal are for tables only, height and layer for shapes and objects.
    """

    file: str | Path
    columns: Sequence[str | int] | None = None
    where: Mapping = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    nodata: Sequence | float | str = ()
    units: str | Mapping | None = None
    height: str | None = None
    layer: str | None = None
    z_axis: str = "up"

    @property
    def nodata_values(self) -> list:
        """The no-data values as a list."""
        return list_of(self.nodata)

    @property
    def plan_unit(self) -> str | None:
        """Of x and y; None: that of the model."""
        return self.units.get("xy") if isinstance(self.units, Mapping) else self.units

    @property
    def height_unit(self) -> str | None:
        """Of heights; None: that of the model."""
        return self.units.get("z") if isinstance(self.units, Mapping) else self.units

    @property
    def only_for_tables(self) -> list[str]:
        """The keys given that only a table of text can have."""
        return [key for key in ("columns", "separator", "decimal") if getattr(self, key)]

    @property
    def only_for_shapes(self) -> list[str]:
        """The keys given that only a file of shapes can have."""
        return [key for key in ("height", "layer") if getattr(self, key)]

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        if self.columns is not None:
            check_columns(self.columns)
        check_where(self.where)
        if self.separator is not None and not (
            isinstance(self.separator, str)
            and len(self.separator) == 1
            and self.separator.isascii()
            and not self.separator.isalnum()
            and self.separator not in '.+-"#\n\r'
        ):
            raise OptionRefused(f"'separator' must be one character, not {self.separator!r}", "separator")
        if self.decimal not in (None, ".", ","):
            raise OptionRefused(f'\'decimal\' must be "." or ",", not {self.decimal!r}', "decimal")
        if self.decimal == "," == self.separator:
            raise OptionRefused("a comma cannot be both 'separator' and 'decimal'", "decimal")
        if not all(_is_value(value) for value in self.nodata_values):
            raise OptionRefused(f"'nodata' must be a number or text, not {self.nodata!r}", "nodata")
        for key in ("height", "layer"):
            check_name(key, getattr(self, key))
        check_units(self.units)
        check_z_axis(self.z_axis)


@dataclass(frozen=True)
class MeshFile:
    """A file of a ready mesh with its own `units` and `z_axis`, as of a PointFile; None: units of the model.
    layer: the name of the surface in a file of several objects (OMF, geoh5)."""

    file: str | Path
    units: str | Mapping | None = None
    z_axis: str = "up"
    layer: str | None = None

    def check(self) -> None:
        """Raises OptionRefused for a unit, an axis or a name that makes no sense."""
        check_name("layer", self.layer)
        check_units(self.units)
        check_z_axis(self.z_axis)

    def scale(self, model_unit: str) -> tuple[float, float]:
        """The factors of plan coordinates and heights."""
        plan, height = factors(self.units, model_unit)
        return plan, -height if self.z_axis == "down" else height


def list_of(value: Any) -> list:
    """A value, or a list of values, as a list."""
    return list(value) if isinstance(value, (list, tuple)) else [value]


def check_columns(columns: Any) -> None:
    said = "'columns' must be the names or numbers of three columns"
    advice = 'write columns = ["X", "Y", "Z"]'
    if not isinstance(columns, (list, tuple)) or len(columns) != 3:
        raise OptionRefused(f"{said}, not {columns!r}", "columns", advice)
    for column in columns:
        if isinstance(column, str) and column.strip():
            continue
        if isinstance(column, bool) or not isinstance(column, int) or not 1 <= column <= 100_000:
            raise OptionRefused(f"{said}, not {column!r}", "columns", "column numbers start at 1")


def check_where(where: Any) -> None:
    advice = "write where = { val = 60 }"
    if not isinstance(where, Mapping):
        raise OptionRefused(f"'where' must be a table of columns and values, not {where!r}", "where", advice)
    for column, values in where.items():
        if not list_of(values) or not all(_is_value(value) for value in list_of(values)):
            what = f"'where' must give a number or text for '{column}', not {values!r}"
            raise OptionRefused(what, "where", advice)


def check_name(key: str, name: object) -> None:
    """Raises OptionRefused for a name that is none; None is no name."""
    if name is not None and not (isinstance(name, str) and name.strip()):
        raise OptionRefused(f"'{key}' must be a name, not {name!r}", key)


def check_units(units: object) -> None:
    parts = dict(units) if isinstance(units, Mapping) else {"xy": units}
    for part, unit in parts.items():
        if part not in ("xy", "z"):
            what = f"'units' has a part {part!r}"
            raise OptionRefused(what, "units", 'its parts are xy and z: units = { z = "ft" }')
        if unit is not None and unit not in METERS:
            raise OptionRefused(f"unknown unit {unit!r}", "units", f"there are {', '.join(METERS)}")


def check_z_axis(axis: object) -> None:
    if axis not in ("up", "down"):
        raise OptionRefused(f'\'z_axis\' must be "up" or "down", not {axis!r}', "z_axis")


def _is_value(value: object) -> bool:
    if isinstance(value, str):
        return True
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return isinstance(value, int) or not math.isinf(value)
