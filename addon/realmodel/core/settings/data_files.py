# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of data with their import options: points, tables of field data, boreholes, maps, shapes."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from ..base.units import METERS, UNIT_NAMES, factors
from .method_options import OptionRefused, check_fields
from .setting import Setting, declared, described, settings_of


def list_of(value: Any) -> list:
    """A value, or a list of values, as a list."""
    return list(value) if isinstance(value, (list, tuple)) else [value]


def _checked_columns(key: str, columns: Any) -> Any:
    if columns is None:
        return None
    said = f"'{key}' must be the names or numbers of three columns"
    advice = f'write {key} = ["X", "Y", "Z"]'
    if not isinstance(columns, (list, tuple)) or len(columns) != 3:
        raise OptionRefused(f"{said}, not {columns!r}", key, advice)
    for column in columns:
        if isinstance(column, str) and column.strip():
            continue
        if isinstance(column, bool) or not isinstance(column, int) or not 1 <= column <= 100_000:
            raise OptionRefused(f"{said}, not {column!r}", key, "column numbers start at 1")
    return columns


def checked_where(key: str, where: Any) -> Any:
    """Refuses a filter that is not a table of columns and values. Raises OptionRefused."""
    advice = f"write {key} = {{ val = 60 }}"
    if not isinstance(where, Mapping):
        raise OptionRefused(f"'{key}' must be a table of columns and values, not {where!r}", key, advice)
    for column, values in where.items():
        if not list_of(values) or not all(_is_value(value) for value in list_of(values)):
            what = f"'{key}' must give a number or text for '{column}', not {values!r}"
            raise OptionRefused(what, key, advice)
    return where


def _checked_separator(key: str, sign: Any) -> Any:
    if sign is not None and not (
        isinstance(sign, str)
        and len(sign) == 1
        and sign.isascii()
        and not sign.isalnum()
        and sign not in '.+-"#\n\r'
    ):
        raise OptionRefused(f"'{key}' must be one character, not {sign!r}", key)
    return sign


def _checked_decimal(key: str, sign: Any) -> Any:
    if sign not in (None, ".", ","):
        raise OptionRefused(f'\'{key}\' must be "." or ",", not {sign!r}', key)
    return sign


def _checked_nodata(key: str, values: Any) -> Any:
    if not all(_is_value(value) for value in list_of(values)):
        raise OptionRefused(f"'{key}' must be a number or text, not {values!r}", key)
    return values


def checked_name(key: str, name: Any) -> Any:
    """Raises OptionRefused for a name that is none; None is no name."""
    if name is not None and not (isinstance(name, str) and name.strip()):
        raise OptionRefused(f"'{key}' must be a name, not {name!r}", key)
    return name


def checked_units(key: str, units: Any) -> Any:
    """Refuses unknown units. Raises OptionRefused."""
    parts = dict(units) if isinstance(units, Mapping) else {"xy": units}
    for part, unit in parts.items():
        if part not in ("xy", "z"):
            what = f"'{key}' has a part {part!r}"
            raise OptionRefused(what, key, f'its parts are xy and z: {key} = {{ z = "ft" }}')
        checked_unit(key, unit)
    return units


def checked_unit(key: str, unit: Any) -> Any:
    """Refuses an unknown unit; None is that of the model. Raises OptionRefused."""
    if unit is not None and unit not in METERS:
        raise OptionRefused(f"unknown unit {unit!r}", key, f"there are {', '.join(METERS)}")
    return unit


def _checked_z_axis(key: str, axis: Any) -> Any:
    if axis not in ("up", "down"):
        raise OptionRefused(f'\'{key}\' must be "up" or "down", not {axis!r}', key)
    return axis


def _is_value(value: object) -> bool:
    if isinstance(value, str):
        return True
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return isinstance(value, int) or not math.isinf(value)


_UNITS = {"": ("Model Unit", "The unit of the model")} | {unit: (unit, UNIT_NAMES[unit]) for unit in METERS}

FILE = Setting(kind="file")  # the path of a file
_FILE_UNITS = Setting(
    kind="units",
    label="Units",
    check=checked_units,
    parts={
        "xy": Setting(
            kind="word",
            label="Unit of X, Y",
            tip="Unit of the plan coordinates in the file",
            words=_UNITS,
            name="plan_unit",
        ),
        "z": Setting(
            kind="word",
            label="Unit of Z",
            tip="Unit of the elevations in the file",
            words=_UNITS,
            name="height_unit",
        ),
    },
)
_Z_AXIS = Setting(
    "up",
    kind="word",
    label="Z Axis",
    tip="Direction in which z of the file increases",
    words={
        "up": ("Up", "Z is an elevation"),
        "down": ("Down", "Z is a depth: it changes its sign"),
    },
    check=_checked_z_axis,
)
_LAYER = Setting(
    kind="layer",
    label="Layer",
    tip="Layer of a GeoPackage, object of a file of several, or sheet of a workbook; needed where there are "
    "several",
    check=checked_name,
)


@dataclass(frozen=True)
class PointFile:
    """Points in a table of text or a sheet of a workbook, a raster (ESRI ASCII, GeoTIFF, ...), a file of
    shapes (GeoJSON, well-known text, a shapefile or a layer of a GeoPackage), or an object of a file.

    columns: the three of x, y and z, by name or by number from 1; None: those named so, or the first three.
    where: {column or attribute: value, or a list of them}; only rows or features that hold it count.
    separator: one character; " " means any blanks and tabs; None: detected from the content.
    decimal: "." or ","; None: detected from the content.
    nodata: no-data values: a number, a text or a list of them; such points are left out. Without it
    those that often mean no data are looked for.
    units: of the file, "ft" for all three coordinates, or {"xy": "m", "z": "ft"}; None: those that it states,
    or else those of the model.
    z_axis: "up", or "down" where z is a depth.
    height: the attribute of features or points that holds their height; None: the z of their positions.
    layer: of a GeoPackage, the object of a file of objects, or the sheet of a workbook; needed where
    there are several.
    columns, separator and decimal are for tables only, height and layer for shapes and objects.
    """

    file: str | Path = described(FILE, is_needed=True)
    columns: Sequence[str | int] | None = declared(
        kind="columns",
        label="Columns",
        parts={
            axis: Setting(
                kind="column",
                label=f"{axis.upper()} Column",
                tip=f"Column of {axis}, by name or by number from 1; all three empty: detected from "
                "their names, else the first three",
                name=f"column_{axis}",
            )
            for axis in "xyz"
        },
        check=_checked_columns,
    )
    where: Mapping = declared(
        kind="where", label="Filters", name="filters", check=checked_where, factory=dict
    )
    separator: str | None = declared(
        kind="separator",
        label="Separator",
        tip="Character between the columns, or tab, or blank; empty: detected from the file",
        check=_checked_separator,
    )
    decimal: str | None = declared(
        kind="word",
        label="Decimal Separator",
        tip="Decimal separator of the numbers in the file",
        words={
            "": ("Automatic", "Detected from the file, except for commas that could separate thousands"),
            ".": ("Point", "1234.5"),
            ",": ("Comma", "1234,5"),
        },
        check=_checked_decimal,
    )
    nodata: Sequence | float | str = declared(
        (),
        kind="values",
        label="NoData Value",
        tip="Value that marks missing data, such as -9999, or several with commas; such points are skipped",
        check=_checked_nodata,
    )
    units: str | Mapping | None = described(_FILE_UNITS)
    height: str | None = declared(
        kind="attribute",
        label="Elevation Field",
        tip="Attribute with the elevation of each feature, as of a contour line; empty: z of its coordinates",
        name="height_attribute",
        check=checked_name,
    )
    layer: str | None = described(_LAYER)
    z_axis: str = described(_Z_AXIS)

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
        check_fields(self)
        if self.decimal == "," == self.separator:
            raise OptionRefused("a comma cannot be both 'separator' and 'decimal'", "decimal")


@dataclass(frozen=True)
class MeshFile:
    """A file of a ready mesh with its own `units` and `z_axis`, as of a PointFile; None: units of the model.
    layer: the name of the surface in a file of several objects, in upper or lower case."""

    file: str | Path = described(FILE, is_needed=True)
    units: str | Mapping | None = described(_FILE_UNITS)
    z_axis: str = described(_Z_AXIS)
    layer: str | None = described(_LAYER)

    def check(self) -> None:
        """Raises OptionRefused for a unit, an axis or a name that makes no sense."""
        check_fields(self)

    def scale(self, model_unit: str) -> tuple[float, float]:
        """The factors of plan coordinates and heights."""
        plan, height = factors(self.units, model_unit)
        return plan, -height if self.z_axis == "down" else height


READING = {key: setting for key, setting in settings_of(PointFile).items() if key != "file"}
MESH_READING = {key: READING[key] for key in settings_of(MeshFile) if key != "file"}


HOLE_COLUMNS = (
    *("hole", "x", "y", "z", "surface", "depth", "elevation", "azimuth", "dip", "inclination"),
    *("from", "to", "thickness", "block", "end", "use"),
)
DOWNWARD_DIPS = ("negative", "positive")
SIGN = Setting(kind="sign")  # a character of a table


def check_column_names(columns: Any, known: Sequence[str]) -> None:
    """Refuses columns that are no table of names or numbers by known meanings. Raises OptionRefused."""
    if not isinstance(columns, Mapping):
        what = f"'columns' must be a table of column names, not {columns!r}"
        raise OptionRefused(what, "columns", f'write columns = {{ {known[0]} = "BHID" }}')
    for name, column in columns.items():
        if name not in known:
            what = f"'columns' has an unknown column '{name}'"
            raise OptionRefused(what, "columns", f"there are {', '.join(known)}")
        is_number = isinstance(column, int) and not isinstance(column, bool) and 1 <= column <= 100_000
        if column is not False and not is_number and not (isinstance(column, str) and column.strip()):
            what = f"column '{name}' must be a name or a number from 1, not {column!r}"
            raise OptionRefused(what, "columns")


def _checked_tolerance(key: str, length: Any) -> Any:
    is_number = isinstance(length, (int, float)) and not isinstance(length, bool)
    if length is not None and not (is_number and 0 <= length < math.inf):
        raise OptionRefused(f"'{key}' must be a length from 0, not {length!r}", key)
    return length


def _checked_files(key: str, files: Any) -> Any:
    if not all(isinstance(file, Path) or (isinstance(file, str) and file.strip()) for file in list_of(files)):
        advice = f'write {key} = ["h1.las", "h2.las"]'
        raise OptionRefused(f"'{key}' must be a file or a list of files, not {files!r}", key, advice)
    return files


_ROW = re.compile(r".*\S:\s*\d+\s*")


def _checked_rows(key: str, rows: Any) -> Any:
    texts = rows if isinstance(rows, (list, tuple)) else [rows]
    if not all(isinstance(text, str) and _ROW.fullmatch(text) for text in texts):
        what = f"'{key}' must be rows of tables, each a name of a file and a line, not {rows!r}"
        raise OptionRefused(what, key, f'write {key} = ["collars.csv:17"]')
    return rows


def _checked_sense(key: str, sense: Any) -> Any:
    if sense is not None and sense not in DOWNWARD_DIPS:
        raise OptionRefused(f'\'{key}\' must be "negative" or "positive", not {sense!r}', key)
    return sense


@dataclass(frozen=True)
class Boreholes:
    """Boreholes, tables or objects of a file, which give points and bounds for all surfaces of a rock mass.

    picks: a table with a row for each surface met in a hole: hole, surface, and its depth below the collar
    (along the hole), or its elevation. intervals: a table with a row for each logged interval: hole, from, to
    (along the hole) and block. One of the two, or both. collars: a table with a row for each hole: hole, x,
    y, z, azimuth and dip or inclination where it is straight but not vertical, and the depth of its end,
    which is only shown; None where the rows of picks and intervals have x, y and z themselves. survey: a
    table with a row for each place where the direction of a hole was measured: hole, depth along it, azimuth
    in degrees clockwise from north (+y), and either the inclination in degrees from the vertical or the dip
    from the horizontal; None: holes go as the collars say, or straight down. use: an optional column of picks
    and intervals, 0 where a row is switched off. downward_dip: "negative" or "positive", which dips go down;
    None: all of a table go the same way, down. columns: {"hole": "BHID", ...}, names or numbers from 1 of
    columns that are called otherwise, in whichever tables have them; False: none is read. separator, decimal:
    as of a PointFile, of all tables. units: of all, "ft", or {"xy": "m", "z": "ft"} (depths are in the unit
    of z); None: those of the model. Where `picks` or `intervals` is an OMF or geoh5 file, `layer` is its
    object with the boreholes (None: all of its boreholes), and columns names its data `surface`, `block` and
    `hole`; `collars`, `survey`, `separator`, `decimal`, `downward_dip` and `logs` are for tables. file: a
    file that holds all tables at once, as AGS, DIGGS, Petrel well tops and LAS, those given beside it count
    in their place; or one of objects. tolerance: up to which gaps and overlaps of intervals are closed at
    their middle, in the unit of depths; None: a thousandth of the depth of the hole, at most a tenth of the
    thinner interval; 0: none are. unrepaired: rows, as "collars.csv:17" for its line 17, that are used
    unchanged, without repair. left_out: rows that are not used. logs: LAS files of logs along the holes, a
    file or a list of them, each of the hole that is called as its well; their curves are shown, and their
    depths are in the unit that the file states. With collars and without picks and intervals they are shown
    alone.
    """

    picks: str | Path | None = described(FILE)
    collars: str | Path | None = described(FILE)
    columns: Mapping = declared(kind="named_columns", factory=dict)
    separator: str | None = described(SIGN)
    decimal: str | None = described(SIGN)
    units: str | Mapping | None = declared(kind="units", check=checked_units)
    survey: str | Path | None = described(FILE)
    downward_dip: str | None = declared(kind="sense", check=_checked_sense)
    intervals: str | Path | None = described(FILE)
    layer: str | None = declared(kind="layer", check=checked_name)
    file: str | Path | None = described(FILE)
    tolerance: float | None = declared(
        kind="number",
        label="Tolerance",
        tip="Gaps and overlaps of intervals up to it are closed at their middle, in the unit of depths",
        low=0.0,
        unset="a thousandth of the depth of the hole, at most a tenth of the thinner interval",
        check=_checked_tolerance,
    )
    logs: Sequence[str | Path] | str | Path = declared((), kind="files", check=_checked_files)
    unrepaired: Sequence[str] = declared((), kind="table_rows", check=_checked_rows)
    left_out: Sequence[str] = declared((), kind="table_rows", check=_checked_rows)

    @property
    def only_for_tables(self) -> list[str]:
        """The keys given that only tables can have."""
        keys = ("collars", "survey", "separator", "decimal", "downward_dip", "logs")
        return [key for key in keys if getattr(self, key)]

    @property
    def log_files(self) -> list[Path]:
        """The files of logs."""
        return [Path(file) for file in list_of(self.logs)]

    @property
    def files(self) -> list[Path]:
        """The files that there are."""
        tables = (*self.log_files, self.collars, self.survey, self.picks, self.intervals, self.file)
        return [Path(file) for file in tables if file is not None]

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        has_logs = bool(self.collars and self.logs)
        if self.picks is None and self.intervals is None and self.file is None and not has_logs:
            what = "there are neither picks nor intervals"
            raise OptionRefused(what, "picks", "give the table of picks = ... or intervals = ...")
        check_column_names(self.columns, HOLE_COLUMNS)
        check_fields(self)


@dataclass(frozen=True)
class FieldTable:
    """file: a table with a row for each place.

    columns: names or numbers from 1 of columns that are called otherwise, by the names of `known`. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    known: ClassVar[tuple[str, ...]] = ()

    file: str | Path = described(FILE, is_needed=True)
    columns: Mapping = declared(kind="named_columns", factory=dict)
    separator: str | None = described(SIGN)
    decimal: str | None = described(SIGN)
    units: str | Mapping | None = declared(kind="units", check=checked_units)

    @property
    def files(self) -> list[Path]:
        """The table."""
        return [Path(self.file)]

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_column_names(self.columns, self.known)
        check_fields(self)


OBSERVATION_COLUMNS = ("x", "y", "z", "block", "hole", "depth", "use")


@dataclass(frozen=True)
class ObservationFile(FieldTable):
    """file: a table with a row for each place that lies in a block: x, y, z and the block; where they are
    known the hole, and the depth along it. use: optional, 0 where a row is switched off.

    columns: {"block": "UNIT", ...}, names or numbers from 1 of columns that are called otherwise. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    known = OBSERVATION_COLUMNS


_WKT = re.compile(
    r"\s*(?:SRID\s*=\s*\d+\s*;\s*)?(?:MULTI)?(?:POLYGON|LINESTRING|POINT|GEOMETRYCOLLECTION)(?:ZM?|M)?\b",
    re.IGNORECASE,
)


def begins_as_wkt(text: str) -> bool:
    """Whether a text begins with the name of a geometry."""
    return bool(_WKT.match(text))


def is_wkt(text: str) -> bool:
    """Whether a text is well-known text rather than the path of a file."""
    return begins_as_wkt(text) and ("(" in text or text.rstrip().upper().endswith("EMPTY"))


LAYER = Setting(kind="line", check=checked_name)
WHERE = Setting(kind="where", check=checked_where)
UNIT = Setting(kind="unit", check=checked_unit)


@dataclass(frozen=True)
class MapLayer:
    """GeoJSON, well-known text, a shapefile, or a layer of a GeoPackage.

    layer: its name, needed where a GeoPackage has several. where: {attribute: value, or a list of them}; only
    features that hold it count. units: of the file's coordinates; None: those of the model.
    """

    file: str | Path = described(FILE, is_needed=True)
    layer: str | None = described(LAYER)
    where: Mapping = described(WHERE, factory=dict)
    units: str | None = described(UNIT)

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_fields(self)


def _checked_attribute(key: str, name: Any) -> Any:
    if not (isinstance(name, str) and name.strip()):
        what = f"'{key}' must name an attribute, not {name!r}"
        raise OptionRefused(what, key, f'write {key} = "FORMATION"')
    return name


def _checked_accuracy(key: str, accuracy: Any) -> Any:
    if accuracy is not None and not 0 <= accuracy < math.inf:
        advice = "give how far its lines may be off, or 0 where they are exact"
        raise OptionRefused(f"'{key}' must be 0 or more, not {accuracy!r}", key, advice)
    return accuracy


@dataclass(frozen=True)
class MapFile:
    """file: polygons in plan (GeoJSON, a shapefile, a GeoPackage) whose attribute `block` names the block on
    the ground there. layer, where, units: as of a MapLayer.

    ground: the heights of the ground, a raster, points or a mesh, or the name of a surface of the rock mass;
    None: the youngest surface. If that has neither points nor a mesh, it is made from the file `ground`.
    faults: lines of faults, a file or a MapLayer of one, or well-known text: what these divide is no contact.
    accuracy: how far lines may lie from where they should be, as a standard deviation in model units; None: a
    two-hundredth of the diagonal of the region, but contacts are off by a tenth of the relief at most.
    """

    file: str | Path = described(FILE, is_needed=True)
    block: str = declared(kind="line", check=_checked_attribute, is_needed=True)
    layer: str | None = described(LAYER)
    where: Mapping = described(WHERE, factory=dict)
    units: str | None = described(UNIT)
    ground: str | Path | PointFile | MeshFile | None = declared(kind="ground")
    faults: str | Path | MapLayer | None = declared(kind="layer_file", of=MapLayer)
    accuracy: float | None = declared(kind="finite", check=_checked_accuracy)

    @property
    def polygons(self) -> MapLayer:
        """The layer of the polygons."""
        return MapLayer(self.file, self.layer, self.where, self.units)

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_fields(self)
        if isinstance(self.ground, (PointFile, MeshFile)):
            self.ground.check()
