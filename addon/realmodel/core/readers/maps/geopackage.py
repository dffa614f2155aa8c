# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of GeoPackages (OGC 12-128r18), by Python's sqlite3 and a reader of well-known binary."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Mapping
from contextlib import closing, suppress
from pathlib import Path
from urllib.parse import quote

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...settings.crs import is_in_degrees
from ...settings.data_files import MapLayer
from ..tables.table_layout import names_shown
from .shapes import Heights, Selection, Shapes

_MAGIC = b"SQLite format 3\0"
# Python cannot decode SQLite's message where it contains damaged text
UNREADABLE = (sqlite3.Error, UnicodeDecodeError)
_ENVELOPES = (0, 32, 48, 48, 64)  # bytes of the bounding box, by the flags
_POINT, _LINE, _POLYGON = 1, 2, 3
_COLLECTIONS = (4, 5, 6, 7, 11, 12)  # several points, lines, polygons; of any kind; of curves, of surfaces
_CURVED = {8: "CircularString", 9: "CompoundCurve", 10: "CurvePolygon"}
_DEEPEST = 50
_ADVICE = "convert a raster to GeoTIFF, other databases to GeoPackage"
_STEP = 1000  # features
_SYSTEMS = """SELECT g.table_name, s.organization, s.organization_coordsys_id, s.definition
    FROM gpkg_geometry_columns g JOIN gpkg_spatial_ref_sys s ON s.srs_id = g.srs_id ORDER BY g.rowid"""


def is_geopackage(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.startswith(_MAGIC)


def read_geopackage(layer: MapLayer, step: Step = no_step, heights: Heights | None = None) -> Shapes:
    """The shapes of one layer, of `layer` or of the only one. Raises InputRefused naming file and layer."""
    file = Path(layer.file)
    try:
        with closing(connect(file)) as base:
            return _read(file, base, layer.layer, layer.where, step, heights)
    except UNREADABLE as error:
        changed = open_changes(file) is not None
        advice = "close it in the program that has it open, so that its last changes are in it"
        what = f"not a GeoPackage that can be read: {error}"
        raise InputRefused(what, file=file, advice=advice if changed else None) from error


def geopackage_layers(file: Path) -> list[str]:
    """The layers of features. Raises InputRefused."""
    try:
        with closing(connect(file)) as base:
            return [name for (name,) in base.execute("SELECT table_name FROM gpkg_geometry_columns")]
    except UNREADABLE as error:
        raise InputRefused(f"not a GeoPackage that can be read: {error}", file=file) from error


def system_of(file: Path, layer: str | None) -> str:
    """The coordinate system of a layer of a GeoPackage, or of its only layer: a code of EPSG's, or well-known
    text; "" where nothing."""
    with suppress(*UNREADABLE), closing(connect(file)) as base:
        for name, authority, code, text in base.execute(_SYSTEMS):
            if layer is None or name.lower() == layer.lower():
                is_coded = f"{authority}".upper() == "EPSG" and not is_in_degrees(text or "")
                return f"EPSG:{code}" if is_coded else text or ""
    return ""


def connect(file: Path) -> sqlite3.Connection:
    """A connection that only reads. Raises sqlite3.Error."""
    address = f"file:{quote(str(file.resolve()))}?mode=ro"
    if open_changes(file) is None:
        address += "&immutable=1"  # so that nothing is written beside it
    return sqlite3.connect(address, uri=True)


def open_changes(file: Path) -> Path | None:
    """The file beside a GeoPackage with what a program that has it open changed last; None: there is none."""
    changes = file.resolve()
    changes = changes.with_name(changes.name + "-wal")
    try:
        return changes if changes.stat().st_size > 0 else None
    except OSError:
        return None


def _read(
    file: Path,
    base: sqlite3.Connection,
    layer: str | None,
    where: Mapping,
    step: Step,
    heights: Heights | None,
) -> Shapes:
    try:
        layers = dict(
            base.execute("SELECT table_name, column_name FROM gpkg_geometry_columns ORDER BY rowid")
        )
    except sqlite3.OperationalError as error:  # there is no such table
        raise InputRefused("it has no layers of features", file=file, advice=_ADVICE) from error
    if not layers:
        raise InputRefused("it has no layers of features", file=file, advice=_ADVICE)
    if layer is None and len(layers) > 1:
        advice = f'say which: layer = "..."; it has {names_shown(list(layers))}'
        raise InputRefused(f"it has {len(layers)} layers", file=file, advice=advice)
    table = layer if layer is not None else next(iter(layers))
    if table not in layers:  # SQL ignores case
        table = next((name for name in layers if name.lower() == table.lower()), table)
    if table not in layers:
        what = f"it has no layer '{layer}'"
        raise InputRefused(what, file=file, advice=f"it has {names_shown(list(layers))}")
    selection = Selection(file, where, table)
    shapes = Shapes.wanted(heights)
    rows = base.execute(f"SELECT * FROM {_quoted(table)} ORDER BY rowid")
    names = [entry[0] for entry in rows.description]
    if layers[table] not in names:
        raise InputRefused(f"layer '{table}' has no column '{layers[table]}'", file=file)
    at = names.index(layers[table])
    for number, row in enumerate(rows, 1):
        if number % _STEP == 0:
            step(1 - _STEP / (number + _STEP))
        attributes = {name: value for name, value in zip(names, row, strict=True) if name != layers[table]}
        if not selection.takes(attributes) or row[at] is None:
            continue
        feature, before = f"feature {number}", shapes.counts()
        add_geometry(_without_header(bytes(row[at]), feature, file, table), feature, shapes, file, table)
        if shapes.attributes is not None:
            shapes.attributes[feature] = attributes
        if heights and heights.attribute is not None:
            shapes.set_height(before, selection.height(attributes, heights.attribute, feature))
    selection.require_some()
    return shapes


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'


def add_geometry(blob: bytes | None, feature: str, shapes: Shapes, file: Path, layer: str) -> None:
    """Adds a geometry in well-known binary (OGC 06-103r4); None is an empty one. Raises InputRefused."""
    if blob is None:
        return
    try:
        _WellKnownBinary(blob, 0).geometry(feature, shapes, 0)
    except (ValueError, struct.error, IndexError, TypeError) as error:
        raise _unreadable(error, feature, file, layer) from error


def _unreadable(error: object, feature: str, file: Path, layer: str) -> InputRefused:
    what = f"its geometry cannot be read: {error}"
    return InputRefused(what, file=file, item=f"layer '{layer}', {feature}")


def _without_header(blob: bytes, feature: str, file: Path, layer: str) -> bytes | None:
    """The well-known binary of a geometry of a GeoPackage; None of an empty one. Raises InputRefused."""
    flags = blob[3] if len(blob) > 3 else 0
    envelope = flags >> 1 & 7
    if blob[:2] != b"GP":
        raise _unreadable("it does not begin with GP", feature, file, layer)
    if flags & 0x20:
        raise _unreadable("an extended geometry", feature, file, layer)
    if flags & 0x10:
        return None
    if envelope >= len(_ENVELOPES):
        raise _unreadable("an unknown envelope", feature, file, layer)
    return blob[8 + _ENVELOPES[envelope] :]


class _WellKnownBinary:
    def __init__(self, blob: bytes, at: int):
        self.blob, self.at = blob, at

    def number(self, order: str) -> int:
        (value,) = struct.unpack_from(f"{order}I", self.blob, self.at)
        self.at += 4
        return value

    def places(self, order: str, count: int, size: int, has_z: bool, ordinates: int) -> np.ndarray:
        """(count, ordinates) of positions of `size` numbers."""
        if count * size * 8 > len(self.blob) - self.at:
            raise ValueError("it is cut off")
        numbers = np.frombuffer(self.blob, f"{order}f8", count * size, self.at)
        self.at += 8 * count * size
        places = np.full((count, ordinates), np.nan)
        stored = min(ordinates, 3 if has_z else 2)
        places[:, :stored] = numbers.reshape(count, size)[:, :stored]
        if not np.isfinite(places[:, :2]).all():
            raise ValueError("a position is not finite")
        return places

    def geometry(self, item: str, shapes: Shapes, depth: int) -> None:
        if depth > _DEEPEST:
            raise ValueError("collections nested too deep")
        order = "<" if self.blob[self.at] else ">"
        self.at += 1
        code = self.number(order)
        plain = code & 0x0FFFFFFF
        thousands = plain // 1000 if plain // 1000 < 4 else 0  # 1: Z, 2: M, 3: both
        has_z = bool(code & 0x80000000) or thousands in (1, 3)  # the bits are PostGIS's marks
        has_m = bool(code & 0x40000000) or thousands in (2, 3)
        size = 2 + has_z + has_m

        def read(count: int) -> np.ndarray:
            return self.places(order, count, size, has_z, shapes.ordinates)

        kind = plain % 1000
        if kind == _POINT:
            numbers = np.frombuffer(self.blob, f"{order}f8", size, self.at)
            if np.isnan(numbers[:2]).all():  # how an empty point is written
                self.at += 8 * size
            else:
                shapes.points.append((item, read(1)[0]))
        elif kind == _LINE:
            if len(line := read(self.number(order))):
                shapes.lines.append((item, line))
        elif kind == _POLYGON:
            rings = [read(self.number(order)) for _ in range(self.number(order))]
            shapes.add_polygon(item, [ring for ring in rings if len(ring)])
        elif kind in _COLLECTIONS:
            for _ in range(self.number(order)):
                self.geometry(item, shapes, depth + 1)
        elif kind in _CURVED:
            raise ValueError(f"a {_CURVED[kind]}, which is curved; save it with straight lines")
        else:
            raise ValueError(f"a geometry of kind {kind}, which is not read")
