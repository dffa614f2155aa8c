# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters and shapes in the formats that GDAL reads and we do not (https://gdal.org/drivers), by rasterio and
pyogrio, which bring GDAL with them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused
from ..base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, in_memory
from ..base.packages import extra, quiet
from ..base.text import Step, no_step
from ..settings.data_files import MapLayer
from .maps.geopackage import add_geometry
from .maps.shapes import Heights, Selection, Shapes
from .rasters.raster import Raster, without_values
from .tables.table_layout import names_shown

RASTER_ENDINGS = (
    *(".nc", ".img", ".adf", ".hgt", ".dt0", ".dt1", ".dt2", ".bil", ".bip", ".bsq", ".flt", ".ers"),
    *(".sdat", ".jp2", ".vrt", ".dem", ".bag", ".gxf", ".rst", ".hf2", ".gtx", ".bt"),
)
SHAPE_ENDINGS = (
    *(".kml", ".kmz", ".gml", ".fgb", ".gdb.zip", ".tab", ".mif", ".gpx", ".dgn", ".sqlite", ".e00"),
)
# How the files begin that can be told so; a text may come after blanks and the declaration of XML.
_RASTERS = (
    *(b"CDF\x01", b"CDF\x02", b"CDF\x05", b"EHFA_HEADER_TAG", b"GRID1.", b"UHL1", b"\0\0\0\x0cjP  "),
    *(b"HF2\0", b"binterr1", b"<VRTDataset", b"DatasetHeader Begin"),
)
# USGS, *Standards for Digital Elevation Models* (1993): after the name and the level the pattern, regular or
# random, and the system in plan.
_DEM = re.compile(rb".{144} {5}[1-4] {5}[14](?: {5}[0-3]| -9999)", re.DOTALL)
_GXF = re.compile(rb"(?m)^#(?:POINTS|ROWS)\s*$")
_SHAPES = (b"fgb\x03", b"!table", b"Version 300", b"Version 450", b"EXP  0 ")
_ZIP, _ZIPPED = b"PK\x03\x04", (b".gdb/", b".kml")  # a file geodatabase, KMZ
_ROOTS = (
    *(b"<kml", b"<gml:", b"<gpx", b"<ogr:featurecollection", b"<wfs:featurecollection"),
    *(b"<featurecollection",),
)


def begins_as_gdal_raster(head: bytes, _size: int = 0) -> bool:
    """Whether a file begins as a raster that is left to GDAL."""
    if head.lstrip().startswith(_RASTERS) or _DEM.match(head):
        return True
    return len(_GXF.findall(head.replace(b"\r", b"\n"))) == 2


def begins_as_gdal_shapes(head: bytes, _size: int = 0) -> bool:
    """Whether a file begins as one of shapes that is left to GDAL."""
    if head.startswith(_ZIP):
        return any(name in head for name in _ZIPPED)
    start = b" ".join(head[:40].split())
    return start.startswith(_SHAPES) or (
        head.lstrip(b"\xef\xbb\xbf \r\n\t").startswith(b"<") and any(root in head.lower() for root in _ROOTS)
    )


def read_gdal_raster(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """The only band of a raster, at the centers of its pixels, scaled by the factors of the file. nodata:
    further numbers that mean no height. Raises InputRefused, and UsageError where rasterio is missing."""
    file = Path(file)
    rasterio = extra("rasterio", f"{file}: reading a raster of this format", "gdal")
    try:
        with quiet(), rasterio.open(file) as dataset:
            _require_one_band(file, dataset)
            z = gather(_heights(dataset, nodata, step), np.empty(0)).reshape(dataset.shape)
            place, crs, unit = dataset.transform, dataset.crs, (dataset.units or (None,))[0]
    except rasterio.errors.RasterioError as error:
        raise InputRefused(f"GDAL cannot read it: {error}", file=file) from error
    if place.is_identity:
        advice = "save it as GeoTIFF with its coordinates"
        raise InputRefused("it does not say where it is", file=file, advice=advice)
    warnings = []
    if unit:
        text = f"its elevations are in '{unit}', as the file states"
        warnings.append(f"{text}: if that is another unit, set units = {{ z = ... }}")
    across, down = (place.a, place.d), (place.b, place.e)
    origin = (place.c + (place.a + place.b) / 2, place.f + (place.d + place.e) / 2)
    raster = Raster(z, origin, across, down, warnings)
    return raster.warned_of_degrees() if crs is not None and crs.is_geographic else raster


def _require_one_band(file: Path, dataset: Any) -> None:
    if dataset.subdatasets:
        names = [name.rpartition(":")[2] for name in dataset.subdatasets]
        advice = "save the one with the elevations as GeoTIFF"
        raise InputRefused(f"it has several rasters: {names_shown(names)}", file=file, advice=advice)
    if dataset.count != 1:
        advice = "save the band with the elevations in a separate file"
        raise InputRefused(f"it has {dataset.count} bands; elevations are one", file=file, advice=advice)


def _heights(dataset: Any, nodata: Sequence[float], step: Step) -> Iterator[np.ndarray]:
    """The heights row by row, NaN where there are none, some rows at once."""
    rows, columns = dataset.shape
    stored = np.dtype(dataset.dtypes[0])
    none = [*([] if dataset.nodata is None else [dataset.nodata]), *nodata]
    (scale,), (offset,) = dataset.scales, dataset.offsets
    count = max(ROWS_AT_ONCE // columns, 1)
    for top in range(0, rows, count):
        window = ((top, min(top + count, rows)), (0, columns))
        z = dataset.read(1, window=window).astype(np.float64).ravel()
        yield without_values(z, none, stored) * scale + offset
        step(min(top + count, rows) / rows)


def gdal_layers(file: Path) -> list[str]:
    """The layers of a file of shapes. Raises InputRefused, UsageError where pyogrio is missing."""
    library = extra("pyogrio", f"{file}: reading shapes of this format", "gdal")
    try:
        with quiet():
            names = [str(name) for name in library.list_layers(file)[:, 0]]
    except (library.errors.DataSourceError, ValueError) as error:
        raise InputRefused(f"GDAL cannot read it: {error}", file=file) from error
    if not names:
        raise InputRefused("GDAL cannot read it: it has no layers", file=file)
    return names


def read_gdal_shapes(layer: MapLayer, step: Step = no_step, heights: Heights | None = None) -> Shapes:
    """The shapes of one layer, of `layer` or of the only one. Raises InputRefused, and UsageError where
    pyogrio is missing."""
    file = Path(layer.file)
    names = gdal_layers(file)
    library = extra("pyogrio", "reading shapes", "gdal")
    if layer.layer is None and len(names) != 1:
        advice = f'say which: layer = "..."; it has {names_shown(names)}'
        raise InputRefused(f"it has {len(names)} layers", file=file, advice=advice)
    wanted = layer.layer or names[0]
    name = next((name for name in names if name.lower() == wanted.lower()), None)
    if name is None:
        advice = f"it has {names_shown(names)}"
        raise InputRefused(f"it has no layer '{wanted}'", file=file, advice=advice)
    try:
        with quiet():
            about, _, blobs, columns = library.raw.read(file, layer=name)
    except (library.errors.DataSourceError, library.errors.DataLayerError, ValueError) as error:
        raise InputRefused(f"GDAL cannot read layer '{name}': {error}", file=file) from error
    selection = Selection(file, layer.where, name)
    shapes = Shapes.wanted(heights)
    shapes.system = about["crs"] or ""
    for number, (blob, *values) in enumerate(zip(blobs, *columns, strict=True), 1):
        attributes = {field: _plain(value) for field, value in zip(about["fields"], values, strict=True)}
        if not selection.takes(attributes) or blob is None:
            continue
        feature, before = f"feature {number}", shapes.counts()
        add_geometry(blob, feature, shapes, file, name)
        if shapes.attributes is not None:
            shapes.attributes[feature] = attributes
        if heights and heights.attribute is not None:
            shapes.set_height(before, selection.height(attributes, heights.attribute, feature))
    selection.require_some()
    step(1.0)
    return shapes


def _plain(value: Any) -> Any:
    """A number or text of Python; None where there is none."""
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, np.ndarray):  # a list in one field
        return ", ".join(map(str, value.tolist()))
    return None if value != value else value
