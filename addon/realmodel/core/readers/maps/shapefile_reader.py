# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapefiles (ESRI, July 1998), by pyshp: outlines, lines and points, and the table beside them."""

from __future__ import annotations

import os
import struct
import warnings
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused
from ...base.packages import vendored
from ...base.text import Step, no_step
from ...settings.data_files import MapLayer
from .shapes import Heights, Selection, Shapes

_MULTIPATCH = 31
_MAGIC = b"\0\0\x27\x0a"
_POINTS, _LINES, _POLYGONS, _MULTIPOINTS = (1, 11, 21), (3, 13, 23), (5, 15, 25), (8, 18, 28)
_WITH_Z = (11, 13, 15, 18)
_STEP = 1000  # features
_FIRST = 100  # the byte where the shapes begin


def is_shapefile(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is the .shp of one."""
    return head.startswith(_MAGIC)


def beside(file: Path) -> list[Path]:
    """The files beside a .shp that are read with it."""
    endings = (".dbf", ".DBF", ".shx", ".SHX")
    return [path for ending in endings if (path := file.with_suffix(ending)).is_file()]


def read_shapefile(layer: MapLayer, step: Step = no_step, heights: Heights | None = None) -> Shapes:
    """The shapes of a shapefile. Its rings follow the even-odd rule, for any direction: many programs
    write outlines and holes in the wrong directions.
    Raises InputRefused, and BuildFailed without pyshp."""
    file, where = Path(layer.file), layer.where
    shapefile = vendored("shapefile", "pyshp", "reading shapefiles")
    files = {path.suffix.lower(): path for path in beside(file)}
    attribute = heights.attribute if heights else None
    has_table = bool(where) or attribute is not None
    if has_table and ".dbf" not in files:
        what = "its .dbf file, which has the attributes, is missing"
        advice = f"put it into the same folder, or leave out '{'where' if where else 'height'}'"
        raise InputRefused(what, file=file, advice=advice)
    selection, shapes = Selection(file, where), Shapes.wanted(heights)
    has_table |= shapes.attributes is not None and ".dbf" in files
    try:
        with open(file, "rb") as shp, _opened(files.get(".dbf") if has_table else None) as dbf:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of sizes in headers that many writers get wrong
                reader = shapefile.Reader(shp=shp, dbf=dbf, encoding="utf-8", encodingErrors="replace")
            records = reader.iterRecords() if has_table else None
            is_new = hasattr(reader, "shp_reader")  # pyshp 3; the vendored one is
            shapes_there = _shapes(reader.shp_reader) if is_new else reader.iterShapes()
            for number, shape in enumerate(shapes_there, 1):
                if number % _STEP == 0:
                    step(1 - _STEP / (number + _STEP))
                attributes = next(records).as_dict() if records is not None else {}
                if selection.takes(attributes):
                    feature, before = f"feature {number}", shapes.counts()
                    if shape.shapeType == _MULTIPATCH:
                        raise _multipatch(file)
                    _add(shape, feature, shapes)
                    if shapes.attributes is not None:
                        shapes.attributes[feature] = attributes
                    if attribute is not None:
                        shapes.set_height(before, selection.height(attributes, attribute, feature))
    except OSError as error:
        what = f"cannot be read: {error.strerror or error}"
        raise InputRefused(what, file=file, advice="check the path") from error
    except InputRefused:
        raise
    except (shapefile.ShapefileException, struct.error, ValueError, IndexError, TypeError, KeyError) as error:
        raise InputRefused(f"a damaged shapefile: {error}", file=file) from error
    except (StopIteration, AssertionError, AttributeError, MemoryError, OverflowError) as error:
        raise InputRefused("a damaged shapefile", file=file) from error
    selection.require_some()
    return shapes


def _shapes(shp: Any) -> Iterator:
    """The shapes one after another. The iterator of pyshp remembers where each one was."""
    at, number, size = _FIRST, 0, shp.file.seek(0, os.SEEK_END)
    while at < size:
        shp.file.seek(at)
        _, words = struct.unpack(">2i", shp.file.read(8))
        yield shp.shape(number, at, 2 * words)
        at, number = at + 8 + 2 * words, number + 1


class _opened:
    """A file, or None where there is none."""

    def __init__(self, path: Path | None):
        self.file = None if path is None else path.open("rb")

    def __enter__(self) -> Any:
        return self.file

    def __exit__(self, *_error: object) -> None:
        if self.file is not None:
            self.file.close()


def _add(shape: Any, feature: str, shapes: Shapes) -> None:
    if shape.shapeType == 0:  # a feature without a shape
        return
    places = np.array([point[:2] for point in shape.points], np.float64).reshape(-1, 2)
    if not np.isfinite(places).all():
        raise ValueError(f"{feature} has a position that is not finite")
    if shapes.has_heights:
        z = np.full(len(places), np.nan)
        if shape.shapeType in _WITH_Z:
            z[:] = shape.z
        places = np.column_stack([places, z])
    if shape.shapeType in (*_POINTS, *_MULTIPOINTS):
        shapes.points += [(feature, place) for place in places]
        return
    starts = [*shape.parts, len(places)]
    parts = [places[begin:end] for begin, end in pairwise(starts) if end > begin]
    if shape.shapeType in _LINES:
        shapes.lines += [(feature, part) for part in parts]
    elif shape.shapeType in _POLYGONS:
        shapes.add_polygon(feature, parts, has_roles=False)
    else:
        raise ValueError(f"{feature} is of kind {shape.shapeTypeName}, which is not read")


def _multipatch(file: Path) -> InputRefused:
    advice = "save the surface as LandXML or as a raster, or its corners as points with heights"
    return InputRefused("its shapes are multipatches, which are not read", file=file, advice=advice)
