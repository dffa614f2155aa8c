# SPDX-License-Identifier: GPL-3.0-or-later
"""The geological map and contours as GeoJSON (RFC 7946) and GeoPackage (OGC 12-128r18).

Areas: a feature for each block, in each compartment, where it crops out. Contours and faults: a feature for
each line. GeoPackages have maps of tops, thickness and standard deviations, too, a layer each, and the styles
in which QGIS shows the layers.

Coordinates are those of the model; the files name its coordinate reference system where the project does:
GeoJSON as its first edition (2008) has it, since RFC 7946 knows longitudes and latitudes alone.
"""

from __future__ import annotations

import json
import sqlite3
import struct
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..base.algebra import twice_area
from ..base.atomic import Outputs
from ..base.errors import OutputFailed
from ..base.text import Step
from ..cells.model_data import ModelData
from ..results.contours import contours
from ..results.geological_map import fault_lines, geological_map, ground_of
from ..results.samples import CellSize
from ..results.value_areas import ValueMap, value_maps
from ..settings.crs import epsg_code
from ..simulation.patches import solver_names
from .map_styles import areas_style, classes_style, lines_style
from .shapes.shape_parts import distinct_names

AREAS, CONTOURS, FAULTS = "geology", "contours", "faults"
_TOP = "top of the model"
_POLYGONS, _LINE = 6, 2  # well-known binary: several polygons, a line
_Shape = list | np.ndarray  # polygons, each a list of closed rings (N, 2), or a line (N, 2)
_BLACK, _BROWN = "0,0,0,255", "107,69,33,255"
_KINDS = {"top": "top", "thickness": "thickness", "deviation": "standard deviation"}
_UNDEFINED = -1  # the plane system that is not known, of GeoPackages


@dataclass(eq=False)
class _Layer:
    """columns: of attributes, name to SQL type. rows: (values, rings) each: polygons, each a list of closed
    rings, or a line. style: of QGIS. title: what it is called there, "": its name."""

    name: str
    columns: dict[str, str]
    rows: list[tuple[list, _Shape]]
    style: str = ""
    title: str = ""

    @property
    def is_of_lines(self) -> bool:
        return self.name in (CONTOURS, FAULTS)


def write_geojson(
    model: ModelData, path: Path, outputs: Outputs, step: Step, contour_interval: float | None = None
) -> None:
    """Writes one collection of the features of all layers; `layer` is the name of the layer of each."""
    layers = _layers(model, step, contour_interval)
    with outputs.file(path) as file:
        head: dict = {"type": "FeatureCollection", "name": model.project.name or path.stem}
        if model.project.crs is not None:
            head["crs"] = {"type": "name", "properties": {"name": _urn(model.project.crs)}}
        file.write(json.dumps(head, ensure_ascii=False)[:-1].encode() + b', "features": [')
        first = True
        for layer in layers:
            for values, shape in layer.rows:
                feature = {
                    "type": "Feature",
                    "properties": {"layer": layer.name, **dict(zip(layer.columns, values, strict=True))},
                    "geometry": _geometry(shape),
                }
                file.write(b"\n" if first else b",\n")
                file.write(json.dumps(feature, ensure_ascii=False, allow_nan=False).encode())
                first = False
        file.write(b"\n]}\n")
    step(1.0)


def _geometry(shape: _Shape) -> dict:
    if isinstance(shape, np.ndarray):
        return {"type": "LineString", "coordinates": shape.tolist()}
    return {"type": "MultiPolygon", "coordinates": [[ring.tolist() for ring in rings] for rings in shape]}


def _urn(crs: str) -> str:
    """The name of a system as OGC writes it."""
    authority, _, code = crs.partition(":")
    return f"urn:ogc:def:crs:{authority.upper()}::{code}"


def write_geopackage(
    model: ModelData,
    path: Path,
    outputs: Outputs,
    step: Step,
    contour_interval: float | None = None,
    cell_size: CellSize = None,
) -> None:
    """A table for each layer. cell_size: of the maps of values, as of plan_grids."""
    layers = _layers(model, step, contour_interval)
    layers += _value_layers(value_maps(model, cell_size, contour_interval))
    step(0.9)
    try:
        with outputs.path(path) as target, closing(sqlite3.connect(target)) as base:
            base.executescript(_SCHEMA)
            srs = _write_system(base, model.project.crs)
            for layer in layers:
                _write_layer(base, layer, srs)
            _write_styles(base, layers)
            base.commit()
    except sqlite3.Error as error:
        raise OutputFailed(f"{path}: cannot be written: {error}") from error
    step(1.0)


def _layers(model: ModelData, step: Step, interval: float | None) -> list[_Layer]:
    ground = ground_of(model)
    step(0.3)
    library = model.project.library
    columns = {"block": "TEXT", "property": "INTEGER", "rock": "TEXT", "compartment": "TEXT"}
    columns |= {"color": "TEXT", "area": "REAL"}
    colors = np.rint(model.block_colors * 255).astype(np.int64).tolist()
    names = model.compartment_names
    areas = _Layer(AREAS, columns, [])
    for area in geological_map(model, ground):
        block = model.blocks[area.block]
        entry = library.get(block.property) if library else None
        values = [block.name, block.property, entry.name if entry else None]
        values.append(names[area.compartment] if len(names) > 1 else None)
        values += ["#{:02x}{:02x}{:02x}".format(*colors[area.block]), area.area]
        areas.rows.append((values, [[_closed(ring) for ring in rings] for rings in area.polygons]))
    step(0.5)
    lines = _Layer(CONTOURS, {"surface": "TEXT", "elevation": "REAL"}, [])
    for line in contours(model, interval, ground):
        lines.rows.append(([line.surface or _TOP, line.elevation], line.points))
    step(0.7)
    faults = _Layer(FAULTS, {"fault": "TEXT"}, [([name], line) for name, line in fault_lines(model, ground)])
    faults.style = lines_style("fault", _different(faults), 0.6, _BLACK)
    lines.style = lines_style("surface", _different(lines), 0.2, _BROWN, shown=1)
    shades = {values[0]: values[4] for values, _ in areas.rows}
    areas.style = areas_style("block", list(shades.items()))
    return [areas, lines, *([faults] if faults.rows else [])]


def _different(layer: _Layer) -> list[str]:
    """The texts of its first column."""
    return list(dict.fromkeys(values[0] for values, _ in layer.rows))


def _value_layers(maps: list[ValueMap]) -> list[_Layer]:
    """A layer for each map of values."""
    titles = distinct_names(f"{_KINDS[made.kind]} of {made.of}" for made in maps)
    columns = {"low": "REAL", "high": "REAL", "area": "REAL"}
    layers = []
    for made, name, title in zip(maps, solver_names(titles), titles, strict=True):
        rows: list[tuple[list, _Shape]] = []
        for low, high, polygons in made.areas:
            area = float(sum(twice_area(ring) / 2 for rings in polygons for ring in rings))
            rows.append(([low, high, area], [[_closed(ring) for ring in rings] for rings in polygons]))
        style = classes_style([(low, high) for low, high, _ in made.areas])
        layers.append(_Layer(name, columns, rows, style, title))
    return layers


def _closed(ring: np.ndarray) -> np.ndarray:
    return np.concatenate([ring, ring[:1]])


# The date of the last change is always the same: so the same model gives the same bytes.
_SCHEMA = """
PRAGMA application_id = 1196444487;
PRAGMA user_version = 10300;
CREATE TABLE gpkg_spatial_ref_sys (
    srs_name TEXT NOT NULL,
    srs_id INTEGER PRIMARY KEY,
    organization TEXT NOT NULL,
    organization_coordsys_id INTEGER NOT NULL,
    definition TEXT NOT NULL,
    description TEXT);
INSERT INTO gpkg_spatial_ref_sys VALUES
    ('Undefined Cartesian', -1, 'NONE', -1, 'undefined', NULL),
    ('Undefined geographic', 0, 'NONE', 0, 'undefined', NULL),
    ('WGS 84', 4326, 'EPSG', 4326,
        'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],' ||
        'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]', NULL);
CREATE TABLE gpkg_contents (
    table_name TEXT NOT NULL PRIMARY KEY,
    data_type TEXT NOT NULL,
    identifier TEXT UNIQUE,
    description TEXT DEFAULT '',
    last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
    min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
    srs_id INTEGER REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (
    table_name TEXT NOT NULL,
    column_name TEXT NOT NULL,
    geometry_type_name TEXT NOT NULL,
    srs_id INTEGER NOT NULL,
    z TINYINT NOT NULL,
    m TINYINT NOT NULL,
    CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
    CONSTRAINT uk_gc_table_name UNIQUE (table_name),
    CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
    CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
"""


_STYLES = """
CREATE TABLE layer_styles (
    id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
    f_table_catalog TEXT(256),
    f_table_schema TEXT(256),
    f_table_name TEXT(256),
    f_geometry_column TEXT(256),
    styleName TEXT(30),
    styleQML TEXT,
    styleSLD TEXT,
    useAsDefault BOOLEAN,
    description TEXT,
    owner TEXT(30),
    ui TEXT(30),
    update_time DATETIME DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')));
INSERT INTO gpkg_contents (table_name, data_type, identifier, last_change)
    VALUES ('layer_styles', 'attributes', 'layer_styles', '1970-01-01T00:00:00.000Z');
"""


def _write_system(base: sqlite3.Connection, crs: str | None) -> int:
    """The number of the coordinate system in the file. EPSG's get their row: programs know the definition by
    the code. That of others we do not have."""
    number = epsg_code(crs)
    if number is None:
        return _UNDEFINED
    base.execute(
        "INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, 'EPSG', ?, 'undefined', NULL)", [crs, number, number]
    )
    return number


def _write_layer(base: sqlite3.Connection, layer: _Layer, srs: int) -> None:
    kind = "LINESTRING" if layer.is_of_lines else "MULTIPOLYGON"
    columns = ", ".join(f"{name} {form}" for name, form in layer.columns.items())
    base.execute(
        f"CREATE TABLE {layer.name} (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {kind}, {columns})"
    )
    boxes = np.array([_box(shape) for _, shape in layer.rows]).reshape(-1, 4)
    whole = (
        [*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist()] if len(boxes) else [None] * 4
    )
    base.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, last_change, min_x, min_y, max_x, "
        "max_y, srs_id) VALUES (?, 'features', ?, '1970-01-01T00:00:00.000Z', ?, ?, ?, ?, ?)",
        [layer.name, layer.title or layer.name, *whole, srs],
    )
    base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 0, 0)", [layer.name, kind, srs])
    marks = ", ".join("?" * (len(layer.columns) + 1))
    base.executemany(
        f"INSERT INTO {layer.name} (geom, {', '.join(layer.columns)}) VALUES ({marks})",
        (
            [_blob(shape, box, srs), *values]
            for (values, shape), box in zip(layer.rows, boxes.tolist(), strict=True)
        ),
    )


def _write_styles(base: sqlite3.Connection, layers: list[_Layer]) -> None:
    """The table in which QGIS looks for the style of a layer that it opens."""
    base.executescript(_STYLES)
    base.executemany(
        "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, "
        "styleName, styleQML, styleSLD, useAsDefault, description, owner, ui, update_time) "
        "VALUES ('', '', ?, 'geom', ?, ?, '', 1, '', '', NULL, '1970-01-01T00:00:00.000Z')",
        ([layer.name, layer.name[:30], layer.style] for layer in layers),
    )


def _box(shape: _Shape) -> list[float]:
    places = shape if isinstance(shape, np.ndarray) else np.concatenate([rings[0] for rings in shape])
    return [*places.min(axis=0).tolist(), *places.max(axis=0).tolist()]


def _blob(shape: _Shape, box: list[float], srs: int) -> bytes:
    """A header with the bounding box, then well-known binary, little-endian."""
    head = b"GP\0\3" + struct.pack("<i4d", srs, box[0], box[2], box[1], box[3])
    if isinstance(shape, np.ndarray):
        return head + struct.pack("<BII", 1, _LINE, len(shape)) + shape.astype("<f8").tobytes()
    parts = [head, struct.pack("<BII", 1, _POLYGONS, len(shape))]
    for rings in shape:
        parts.append(struct.pack("<BII", 1, 3, len(rings)))
        for ring in rings:
            parts += [struct.pack("<I", len(ring)), ring.astype("<f8").tobytes()]
    return b"".join(parts)
