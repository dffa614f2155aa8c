# SPDX-License-Identifier: GPL-3.0-or-later
"""OMF 1, the Open Mining Format, by the library omf."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...base.packages import omf_library, quiet
from ...base.text import Step, no_step
from .geo_object import (
    HOLE,
    LINES,
    POINTS,
    SURFACE,
    GeoObject,
    ObjectName,
    OpenFile,
    Values,
    stated_text,
    texts,
)

_MAGIC = b"\x84\x83\x82\x81"
_HOLES = "borehole"  # subtype of lines


def begins_as_omf(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one; OMF 2 is a zip file."""
    return head.startswith(_MAGIC)


@contextmanager
def open_omf(file: Path, _step: Step = no_step) -> Iterator[OpenFile]:
    """A file, while it is open. Raises UsageError where the library is missing."""
    omf = omf_library("reading OMF")
    with quiet(), file.open("rb") as opened:
        yield _OmfFile(omf, opened)


class _OmfFile:
    def __init__(self, omf: Any, opened: BinaryIO):
        self._omf, self._opened = omf, opened

    def names(self) -> list[ObjectName]:
        """As OpenFile."""
        objects = []
        for element in self._reader().get_project_overview().elements:
            kind = _kind(self._omf, element)
            if kind is not None:
                objects.append(ObjectName(element.name, kind, str(element.uid)))
        return objects

    def read(self, wanted: ObjectName) -> GeoObject:
        """As OpenFile."""
        omf, project = self._omf, self._reader().get_project([wanted.key])
        (element,) = project.elements
        geometry = element.geometry
        origin = np.array(project.origin, np.float64) + np.array(geometry.origin, np.float64)
        triangles = segments = None
        if isinstance(geometry, omf.SurfaceGridGeometry):
            vertices, triangles = _grid(geometry)
        else:
            vertices = _array(geometry.vertices)
        if isinstance(geometry, omf.SurfaceGeometry):
            triangles = _array(geometry.triangles)
        elif isinstance(geometry, omf.LineSetGeometry):
            segments = _array(geometry.segments)
        vertices = vertices + origin
        by_place: dict[str, dict[str, np.ndarray]] = {}
        for data in element.data:
            column = _column(omf, data)
            if column is not None:
                by_place.setdefault(data.location, {})[data.name] = column
        values = [Values(vertices, by_place.get("vertices", {}))]
        if segments is not None:
            begins, ends = vertices[segments[:, 0]], vertices[segments[:, 1]]
            values.append(Values(begins, by_place.get("segments", {}), ends))
        unit = stated_text(project.units)
        return GeoObject(wanted.name, wanted.kind, vertices, triangles, values, unit=unit)

    def _reader(self) -> Any:
        """A reader changes what it has read, so that each time needs another, which closes its file."""
        return self._omf.OMFReader(os.fdopen(os.dup(self._opened.fileno()), "rb"))


def _kind(omf: Any, element: Any) -> str | None:
    if isinstance(element, omf.PointSetElement):
        return POINTS
    if isinstance(element, omf.SurfaceElement):
        return SURFACE
    if isinstance(element, omf.LineSetElement):
        return HOLE if element.subtype == _HOLES else LINES
    return None


def _array(omf_array: Any) -> np.ndarray:
    return np.asarray(omf_array.array).view(np.ndarray)


def _grid(geometry: Any) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a grid, along u first, and two triangles for each of its cells."""
    u, v = (np.append(0.0, np.cumsum(tensor)) for tensor in (geometry.tensor_u, geometry.tensor_v))
    along_u, along_v = (np.array(axis, np.float64) for axis in (geometry.axis_u, geometry.axis_v))
    vertices = np.tile(u, len(v))[:, None] * along_u + np.repeat(v, len(u))[:, None] * along_v
    if geometry.offset_w is not None:
        vertices = vertices + _array(geometry.offset_w)[:, None] * np.cross(along_u, along_v)
    number = np.arange(len(u) * len(v)).reshape(len(v), len(u))
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    return vertices, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _column(omf: Any, data: Any) -> np.ndarray | None:
    """The values of data as texts or numbers; None of other kinds."""
    if isinstance(data, omf.MappedData):
        legend = next((entry for entry in data.legends if isinstance(entry.values, omf.StringArray)), None)
        if legend is None:
            return _array(data.array)
        return texts(_array(data.array), dict(enumerate(legend.values.array)))
    if isinstance(data, omf.StringData):
        return np.array([str(text) for text in data.array.array], object)
    return _array(data.array) if isinstance(data, omf.ScalarData) else None
