# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes in plan and regions from files; the format follows from the content."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..base.errors import InputRefused
from ..base.text import Step, no_step, read_bytes
from ..base.units import MODEL_UNIT, factor
from ..settings.crs import MOST_DEGREES, is_in_degrees
from ..settings.data_files import MapLayer
from .formats import SHAPES, format_of
from .maps.geopackage import open_changes, system_of
from .maps.shapefile_reader import beside
from .maps.shapes import Heights, Shapes
from .maps.wkt import read_wkt

_CRS = re.compile(rb'"crs"\s*:\s*\{[^}]*?"name"\s*:\s*"([^"]*)"')
_FIRST = 1 << 16  # bytes in which it says so
_BESIDE_SHAPEFILE = (".shx", ".dbf", ".prj", ".cpg", ".sbn", ".sbx", ".qix")


def read_shapes(
    given: MapLayer, model_unit: str = MODEL_UNIT, step: Step = no_step, heights: Heights | None = None
) -> Shapes:
    """The shapes of a file, in the model's unit; with heights where requested. Raises InputRefused naming the
    file."""
    shapes = _read(given, step, heights)
    _refuse_degrees(given, shapes)
    return shapes.scaled(factor(given.units, model_unit))


def _refuse_degrees(layer: MapLayer, shapes: Shapes) -> None:
    """Raises InputRefused if a file states that its coordinates are degrees, and they may be: as lengths they
    would be a few meters."""
    rings = [ring for polygon in shapes.polygons for ring in polygon.rings]
    places = [*rings, *(line for _, line in shapes.lines), *(place for _, place in shapes.points)]
    if any(
        np.abs(np.asarray(corners, np.float64)[..., :2]).max(initial=0.0) > MOST_DEGREES for corners in places
    ):
        return
    if is_in_degrees(shapes.system or system_of_map(layer)):
        raise InputRefused(
            "its coordinates are degrees of longitude and latitude, as the file states",
            file=Path(layer.file),
            advice="project it (to UTM, say) in a GIS; if they are lengths, take its coordinate system out",
        )


def system_of_map(layer: MapLayer) -> str:
    """The coordinate system of a shapefile, a GeoPackage or GeoJSON; "" where nothing."""
    file = Path(layer.file)
    if file.suffix.lower() == ".shp":
        named = (file.with_suffix(ending) for ending in (".prj", ".PRJ"))
        return next((path.read_text("latin-1") for path in named if path.is_file()), "")
    if file.suffix.lower() == ".gpkg":
        return system_of(file, layer.layer)
    match = _CRS.search(read_bytes(file)[:_FIRST])
    return "" if match is None else match[1].decode("latin-1")


def _read(layer: MapLayer, step: Step, heights: Heights | None) -> Shapes:
    file = Path(layer.file)
    file_format = format_of(file, SHAPES)
    if layer.layer is not None and (file_format is None or not file_format.layers):
        what = f"it is not a GeoPackage, so it has no layer '{layer.layer}'"
        raise InputRefused(what, file=file, advice="take 'layer' out")
    if file.suffix.lower() in _BESIDE_SHAPEFILE:
        raise InputRefused("this is only a part of a shapefile", file=file, advice="name the .shp beside it")
    return (file_format.read if file_format is not None else read_wkt)(layer, step, heights)


def read_region(file: str | Path | MapLayer) -> tuple[list[np.ndarray], list[str]]:
    """The rings (N, 2) float64 of all polygons of a file, not repeated at their end, unchecked, for the
    even-odd rule; and warnings about lines and points, which have no area and are left out.

    Raises InputRefused naming the file and the line, or the feature.
    """
    layer = file if isinstance(file, MapLayer) else MapLayer(file)
    shapes = read_shapes(layer)
    require_polygons(shapes, Path(layer.file))
    rings = [ring for polygon in shapes.polygons for ring in polygon.rings]
    return rings, shapes.without_area(Path(layer.file))


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
