# SPDX-License-Identifier: GPL-3.0-or-later
"""GeoTIFF: heights of a raster with its place in plan (OGC 19-008, TIFF 6.0).

tifffile reads the structure of the file; strips and tiles are decoded here, because the package does
LZW and the predictor of floating-point numbers only with a compiled one that cannot travel with us.
"""

from __future__ import annotations

import logging
import re
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, in_memory, in_pieces
from ...base.packages import vendored
from ...base.text import Step, no_step
from ...base.work import native_module, refused_as
from .raster import Raster, without_values

_MAGIC = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_PIXEL_SCALE, _TIEPOINTS, _TRANSFORMATION, _GEO_KEYS = 33550, 33922, 34264, 34735
_GDAL_METADATA, _GDAL_NODATA = 42112, 42113
_MODEL_TYPE, _RASTER_TYPE, _PROJECTED, _PLAN_UNIT = 1024, 1025, 3072, 3076  # geokeys
_HEIGHT_UNIT = 4099
_OF_USER = 32767  # for a system without a code
_GEOGRAPHIC, _PIXEL_IS_POINT = 2, 2
_UNITS = {9001: "m", 9002: "ft", 9003: "us-ft", 9036: "km"}  # by EPSG's numbers
_NONE, _LZW, _DEFLATE, _PACKBITS = 1, 5, (8, 32946), 32773
_MOST_COMPRESSED = 3000  # bytes of one, of LZW; DEFLATE stays below
_MOST_WITHOUT_BYTES = 1 << 24  # pixels of a strip or tile that is not stored
_BYTES_PER_PIXEL = 40  # of the height, of its point, and of their raw data
_WORLD_FILES = (".tfw", ".tifw", ".tiffw", ".wld")


def is_tiff(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head[:4] in _MAGIC


def world_file(file: Path) -> Path | None:
    """The world file beside a TIFF, which has its position, if there is one."""
    beside = (file.with_suffix(ending) for ending in _WORLD_FILES)
    return next((path for path in beside if path.is_file()), None)


def read_geotiff(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """The first image of a GeoTIFF with one number a pixel: whole or floating-point, in strips or tiles,
    uncompressed or by LZW, DEFLATE or PackBits. Elevations are at the centers of pixels, or at their corners
    if the file states so. nodata: further numbers that mean no height.

    Raises InputRefused naming the file, BuildFailed where tifffile is not there.
    """
    file = Path(file)
    tifffile = vendored("tifffile", "tifffile", "reading GeoTIFF")
    try:
        with _no_logging(), tifffile.TiffFile(file) as tiff:
            page = tiff.pages[0]
            _check(file, tiff, page, gather is in_memory)
            tags = {tag.code: tag.value for tag in page.tags}
            none = [*_no_value(file, tags), *nodata]

            def heights() -> Iterator[np.ndarray]:
                for band in _bands(file, tifffile, tiff, page, step):
                    for z in in_pieces(band.ravel()):
                        yield _scaled(without_values(z, none, page.dtype), tags.get(_GDAL_METADATA))

            z = gather(heights(), np.empty(0)).reshape(page.imagelength, page.imagewidth)
    except OSError as error:
        what = error.strerror or str(error)
        raise InputRefused(f"cannot be read: {what}", file=file, advice="check the path") from error
    except InputRefused:
        raise
    except (tifffile.TiffFileError, ValueError, KeyError, IndexError, TypeError, zlib.error) as error:
        raise InputRefused(f"a damaged TIFF: {error}", file=file) from error
    keys = _geo_keys(tags.get(_GEO_KEYS, ()))
    origin, across, down = _place(file, tags, keys)
    units = (_unit(keys.get(_PLAN_UNIT)), _unit(keys.get(_HEIGHT_UNIT)))
    raster = Raster(z, origin, across, down, units=units)
    return raster.warned_of_degrees() if keys.get(_MODEL_TYPE) == _GEOGRAPHIC else raster


def geotiff_system(file: str | Path) -> int | None:
    """EPSG's number of the projected coordinate system that a GeoTIFF names; None of others, and of other
    files."""
    with Path(file).open("rb") as opened:
        if not is_tiff(opened.read(4)):
            return None
    tifffile = vendored("tifffile", "tifffile", "reading GeoTIFF")
    with _no_logging(), tifffile.TiffFile(file) as tiff:
        directory = tiff.pages[0].tags.get(_GEO_KEYS)  # its value is read when it is requested
        number = _geo_keys(() if directory is None else directory.value).get(_PROJECTED, _OF_USER)
    return None if number == _OF_USER else number


@contextmanager
def _no_logging() -> Iterator[None]:
    """Suppresses the log messages of tifffile about tags; errors are raised."""
    logger = logging.getLogger("tifffile")
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before


def _check(file: Path, tiff: Any, page: Any, is_kept_in_memory: bool) -> None:
    """Raises InputRefused for an image that is no raster of heights, or that cannot be read."""

    def refuse(what: str, advice: str | None = None) -> InputRefused:
        return InputRefused(what, file=file, advice=advice)

    if page.samplesperpixel != 1:
        advice = "save the band with the elevations in a separate file"
        raise refuse(f"it has {page.samplesperpixel} numbers per pixel; elevations have one", advice)
    if page.dtype is None or page.dtype.kind not in "iuf" or page.bitspersample != 8 * page.dtype.itemsize:
        raise refuse(f"pixels of {page.bitspersample} bits are not supported")
    if page.compression not in (_NONE, _LZW, *_DEFLATE, _PACKBITS):
        name = getattr(page.compression, "name", page.compression)
        raise refuse(
            f"its compression, {name}, is not supported", "save it with LZW or DEFLATE, or uncompressed"
        )
    if page.predictor not in (1, 2, 3):
        raise refuse(f"its predictor {page.predictor} is not known")
    rows, columns = page.imagelength, page.imagewidth
    high, wide = _part_shape(page)
    if not (0 < high <= 1 << 20 and 0 < wide <= 1 << 20 and rows and columns):
        raise refuse("a damaged TIFF: strips or tiles without size")
    sizes = list(page.databytecounts)
    if min(len(sizes), len(page.dataoffsets)) < -(-columns // wide) * -(-rows // high):
        raise refuse("a damaged TIFF: strips or tiles are missing")
    there_are = min(sum(sizes), tiff.filehandle.size)
    is_too_much = rows * columns * page.dtype.itemsize > _MOST_COMPRESSED * there_are
    if is_too_much and (all(sizes) or min(high, rows) * min(wide, columns) > _MOST_WITHOUT_BYTES):
        raise refuse(f"a damaged TIFF: {columns} x {rows} pixels cannot come of so few bytes")
    room = native_module().available_memory()
    if is_kept_in_memory and _BYTES_PER_PIXEL * rows * columns > room:
        raise refuse(
            f"its {columns} x {rows} pixels do not fit the {room / 1e9:.2g} GB of memory that are free"
        )


def _part_shape(page: Any) -> tuple[int, int]:
    """Rows and columns of a tile, or of a strip."""
    if page.is_tiled:
        return page.tilelength, page.tilewidth
    return min(page.rowsperstrip, page.imagelength), page.imagewidth


def _bands(file: Path, tifffile: Any, tiff: Any, page: Any, step: Step) -> Iterator[np.ndarray]:
    """Rows of heights (rows, columns) float64, one row of tiles, or a part of a strip, after another."""
    rows, columns = page.imagelength, page.imagewidth
    stored = page.dtype.newbyteorder(tiff.byteorder)
    high, wide = _part_shape(page)
    places = list(zip(page.dataoffsets, page.databytecounts, strict=True))
    if page.compression == _NONE and not page.is_tiled:
        high, places = _divided(file, places, high, rows, wide * stored.itemsize)
    a_row = -(-columns // wide)
    for top in range(0, rows, high):
        band_rows = min(high, rows - top)
        z = np.full((band_rows, columns), np.nan)
        first = top // high * a_row
        for number, (offset, size) in enumerate(places[first : first + a_row]):
            left = wide * number
            if not size:  # a part without bytes is all nodata
                continue
            expected = (high if page.is_tiled else band_rows) * wide * stored.itemsize
            tiff.filehandle.seek(offset)
            data = tiff.filehandle.read(min(size, tiff.filehandle.size))
            data = _decompressed(tifffile, page.compression, data, expected)
            if len(data) < band_rows * wide * stored.itemsize:
                raise _cut_off(file)
            data = data[: len(data) // (wide * stored.itemsize) * wide * stored.itemsize]
            part = _unpredicted(page.predictor, data, stored, wide)
            with np.errstate(invalid="ignore"):  # NaN of any kind is no height
                z[:, left : left + wide] = part[:band_rows, : columns - left]
        yield z
        step((top + band_rows) / rows)


def _divided(
    file: Path, places: list[tuple[int, int]], high: int, rows: int, row: int
) -> tuple[int, list[tuple[int, int]]]:
    """Divides uncompressed strips into lower ones of this many rows; and the height of these. row: bytes."""
    lower = max(1, ROWS_AT_ONCE * 8 // row)
    if lower >= high:
        return high, places
    while high % lower:
        lower -= 1
    parts = []
    for top, (offset, size) in zip(range(0, rows, high), places, strict=False):
        strip_rows = min(high, rows - top)
        if 0 < size < strip_rows * row:
            raise _cut_off(file)
        for begin in range(0, strip_rows, lower):
            parts.append((offset + begin * row, size and min(lower, strip_rows - begin) * row))
    return lower, parts


def _cut_off(file: Path) -> InputRefused:
    return InputRefused("a damaged TIFF: a strip or tile is cut off", file=file)


def _decompressed(tifffile: Any, compression: int, data: bytes, size: int) -> bytes:
    """At least the bytes that are there, at most `size`."""
    if compression == _LZW:
        if data[:2] == b"\0\1":
            raise ValueError("LZW from before 1992 is not supported")
        with refused_as(lambda error: ValueError(str(error))) as native:
            return native.decode_lzw(data, size)
    if compression in _DEFLATE:
        return zlib.decompressobj().decompress(data, size)
    if compression == _PACKBITS:
        return bytes(tifffile.tifffile.imagecodecs.packbits_decode(data))[:size]
    return data[:size]


def _unpredicted(predictor: int, data: bytes, stored: np.dtype, wide: int) -> np.ndarray:
    """(rows, wide) numbers, of which the file may hold differences."""
    if predictor == 3:  # bytes of a row by weight, the heaviest first, each less the one before
        steps = np.frombuffer(data, np.uint8).reshape(-1, stored.itemsize * wide)
        planes = np.cumsum(steps, axis=1, dtype=np.uint8).reshape(-1, stored.itemsize, wide)
        heavy_first = np.ascontiguousarray(planes.transpose(0, 2, 1))
        return heavy_first.view(stored.newbyteorder(">"))[:, :, 0]
    numbers = np.frombuffer(data, stored).reshape(-1, wide)
    if predictor == 2:
        whole = np.dtype(f"u{stored.itemsize}")
        bits = numbers.astype(stored.newbyteorder("=")).view(whole)
        numbers = np.cumsum(bits, axis=1, dtype=whole).view(stored.newbyteorder("="))
    return numbers


def _geo_keys(directory: Sequence[int]) -> dict[int, int]:
    """The geokeys that hold one number themselves."""
    entries = [tuple(directory[at : at + 4]) for at in range(4, len(directory) - 3, 4)]
    return {key: value for key, location, _, value in entries if location == 0}


def _no_value(file: Path, tags: dict) -> list[float]:
    text = str(tags.get(_GDAL_NODATA, "")).strip("\0 ")
    try:
        return [float(text)] if text else []
    except ValueError as error:
        raise InputRefused(f"its nodata is not a number: '{text:.40}'", file=file) from error


def _scaled(z: np.ndarray, metadata: Any) -> np.ndarray:
    """Heights that GDAL stored as integers with a scale and an offset."""
    parts = {}
    for role in ("scale", "offset"):
        match = re.search(rf'<Item [^>]*role="{role}"[^>]*>([^<]+)</Item>', str(metadata or ""))
        parts[role] = float(match.group(1)) if match else None
    if parts["scale"] is not None:
        z = z * parts["scale"]
    return z if parts["offset"] is None else z + parts["offset"]


def _place(
    file: Path, tags: dict, keys: dict
) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
    """The position of the first height, and the steps to the next one across and down."""
    matrix: tuple[float, ...] | None = None
    if _TRANSFORMATION in tags and len(tags[_TRANSFORMATION]) == 16:
        m = tags[_TRANSFORMATION]
        matrix = (m[0], m[1], m[3], m[4], m[5], m[7])
    elif _PIXEL_SCALE in tags and len(tags.get(_TIEPOINTS, ())) >= 6:
        (dx, dy), (i, j, _, x, y, _) = tags[_PIXEL_SCALE][:2], tags[_TIEPOINTS][:6]
        matrix = (dx, 0.0, x - i * dx, 0.0, -dy, y + j * dy)
    shift = 0.0 if keys.get(_RASTER_TYPE) == _PIXEL_IS_POINT else 0.5
    if matrix is None and (beside := world_file(file)) is not None:
        matrix, shift = _world(beside), 0.0
    if matrix is None:
        raise InputRefused(
            "it has no georeference (no tags, no .tfw beside it)",
            file=file,
            advice="save it as GeoTIFF from a GIS",
        )
    a, b, c, d, e, f = (float(number) for number in matrix)
    if not np.isfinite([a, b, c, d, e, f]).all() or a * e - b * d == 0:
        raise InputRefused("its georeference is invalid: pixels have no area", file=file)
    return (c + shift * (a + b), f + shift * (d + e)), (a, d), (b, e)


def _world(file: Path) -> tuple[float, ...]:
    """A world file: a, d, b, e, and the place of the first pixel's center."""
    try:
        a, d, b, e, c, f = (float(word.replace(",", ".")) for word in file.read_text("latin-1").split())
    except ValueError as error:
        raise InputRefused("a world file needs six numbers", file=file) from error
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file) from error
    return a, b, c, d, e, f


def _unit(number: int | None) -> str:
    return "" if number in (None, 0, _OF_USER) else _UNITS.get(int(number or 0), f"EPSG:{number}")
