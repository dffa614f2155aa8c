# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines, lines and points from files; their format is detected from the content."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step, read_bytes, read_text
from ...base.units import MODEL_UNIT, factor
from ...settings.crs import is_in_degrees
from ...settings.map_layer import MapLayer, begins_as_wkt
from .geojson import read_geojson
from .geopackage import is_geopackage, open_changes, read_geopackage, system_of
from .shapefile_reader import beside, is_shapefile, read_shapefile
from .shapes import Heights, Shapes
from .wkt import parse_wkt

MAP_ENDINGS = (".geojson", ".json", ".gpkg", ".shp", ".wkt")
_HEAD = 512
_JSON = (".json", ".geojson", ".geojsonl", ".geojsons")
_CRS = re.compile(rb'"crs"\s*:\s*\{[^}]*?"name"\s*:\s*"([^"]*)"')
_FIRST = 1 << 16  # bytes in which it says so
_MOST_DEGREES = 360.0
_BOM = b"\xef\xbb\xbf"
_RECORD_SEPARATOR = b"\x1e"  # begins each text of a GeoJSON text sequence (RFC 8142)
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_BESIDE_SHAPEFILE = (".shx", ".dbf", ".prj", ".cpg", ".sbn", ".sbx", ".qix")


def is_map_layer(file: Path, head: bytes) -> bool:
    """Whether a file that begins so is one of shapes rather than a table or a raster."""
    if is_geopackage(head) or is_shapefile(head) or _is_json(file, head):
        return True
    return begins_as_wkt(head.removeprefix(_BOM).decode("latin-1"))


def _is_json(file: Path, head: bytes) -> bool:
    first = head.removeprefix(_BOM).lstrip()[:1]
    return file.suffix.lower() in _JSON or first in (b"{", b"[", _RECORD_SEPARATOR)


def read_shapes(
    given: MapLayer, model_unit: str = MODEL_UNIT, step: Step = no_step, heights: Heights | None = None
) -> Shapes:
    """The shapes of a file, in the model's unit; with heights where requested. Raises InputRefused naming the
    file."""
    shapes = _read(given, step, heights)
    _refuse_degrees(given, shapes)
    return shapes.scaled(factor(given.units, model_unit))


def _refuse_degrees(given: MapLayer, shapes: Shapes) -> None:
    """Raises InputRefused where a file says that its coordinates are degrees, and they may be: as lengths
    they would be a few meters."""
    rings = [ring for polygon in shapes.polygons for ring in polygon.rings]
    places = [*rings, *(line for _, line in shapes.lines), *(place for _, place in shapes.points)]
    if any(np.abs(np.asarray(each, np.float64)[..., :2]).max(initial=0.0) > _MOST_DEGREES for each in places):
        return
    file = Path(given.file)
    if file.suffix.lower() == ".shp":
        named = (file.with_suffix(ending) for ending in (".prj", ".PRJ"))
        system = next((each.read_text("latin-1") for each in named if each.is_file()), "")
    elif file.suffix.lower() == ".gpkg":
        system = system_of(file, given.layer)
    else:
        found = _CRS.search(read_bytes(file)[:_FIRST]) if file.suffix.lower() in _JSON else None
        system = "" if found is None else found[1].decode("latin-1")
    if is_in_degrees(system):
        raise InputRefused(
            "its coordinates are degrees of longitude and latitude, as it says itself",
            file=file,
            advice="project it (to UTM, say) in a GIS; if they are lengths, take its coordinate system out",
        )


def _read(given: MapLayer, step: Step, heights: Heights | None) -> Shapes:
    file = Path(given.file)
    try:
        with file.open("rb") as opened:
            head = opened.read(_HEAD)
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    if is_geopackage(head):
        return read_geopackage(file, given.layer, given.where, step, heights)
    if given.layer is not None:
        what = f"it is not a GeoPackage, so it has no layer '{given.layer}'"
        raise InputRefused(what, file=file, advice="take 'layer' out")
    if file.suffix.lower() in _BESIDE_SHAPEFILE:
        raise InputRefused("this is only a part of a shapefile", file=file, advice="name the .shp beside it")
    if is_shapefile(head):
        return read_shapefile(file, given.where, step, heights)
    if _is_json(file, head):
        return read_geojson(file, given.where, heights)
    text = "" if b"\0" in head and not head.startswith(_UTF16) else read_text(file)
    if not begins_as_wkt(text):
        what = "neither GeoJSON, well-known text, a shapefile (.shp) nor a GeoPackage"
        raise InputRefused(what, file=file, advice="export it in one of these formats")
    if given.where:
        raise InputRefused("well-known text has no attributes, so 'where' has no effect", file=file)
    if heights and heights.attribute is not None:
        what = "well-known text has no attributes, so 'height' has no effect"
        raise InputRefused(what, file=file, advice="write the heights as z")
    return parse_wkt(text, file, heights is not None)


def read_region(file: str | Path | MapLayer) -> tuple[list[np.ndarray], list[str]]:
    """The rings (N, 2) float64 of all polygons of a file, not repeated at their end, unchecked, for the
    even-odd rule; and warnings about lines and points, which have no area and are left out.

    Raises InputRefused naming the file and the line, or the feature.
    """
    given = file if isinstance(file, MapLayer) else MapLayer(file)
    shapes = read_shapes(given)
    require_polygons(shapes, Path(given.file))
    rings = [ring for polygon in shapes.polygons for ring in polygon.rings]
    return rings, shapes.without_area(Path(given.file))


def require_polygons(shapes: Shapes, file: Path | None) -> None:
    """Refuses shapes that bound no region."""
    if not shapes.polygons:
        advice = "a region needs polygons: Polygon or MultiPolygon"
        raise InputRefused("there is no polygon in it", file=file, advice=advice)


def map_companions(file: Path) -> list[Path]:
    """Other files that are read with a file of outlines."""
    if file.suffix.lower() == ".shp":
        return beside(file)
    return [changes] if file.suffix.lower() == ".gpkg" and (changes := open_changes(file)) else []
