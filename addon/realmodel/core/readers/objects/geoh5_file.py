# SPDX-License-Identifier: GPL-3.0-or-later
"""geoh5, the files of Geoscience ANALYST, by the library geoh5py."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.packages import extra, quiet
from ...base.text import Step, no_step
from ...base.units import unit_of
from .geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject, ObjectName, OpenFile, Values, texts

_MAGIC = b"\x89HDF\r\n\x1a\n"
_ENDING = ".geoh5"  # the library takes no other
_DEPTHS = ("FROM", "TO", "DEPTH")  # data that say where others are


def begins_as_geoh5(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one, or another of HDF5."""
    return head.startswith(_MAGIC)


@contextmanager
def open_geoh5(file: Path, _step: Step = no_step) -> Iterator[OpenFile]:
    """A file, while it is open. Raises UsageError where the library is missing."""
    library = extra("geoh5py", "reading geoh5", "geoh5")
    if file.suffix != _ENDING:
        raise ValueError(f"its name does not end in {_ENDING}")
    with quiet(), library.Workspace(file, mode="r") as workspace:
        yield _Geoh5File(workspace)


class _Geoh5File:
    def __init__(self, workspace: Any):
        self._workspace = workspace

    def names(self) -> list[ObjectName]:
        """As OpenFile."""
        with_kinds = [(obj, _kind(obj)) for obj in self._workspace.objects]
        return [ObjectName(obj.name, kind, obj.uid) for obj, kind in with_kinds if kind is not None]

    def read(self, wanted: ObjectName) -> GeoObject:
        """As OpenFile."""
        # "meter" is what every program writes that does not ask
        said = unit_of(str(self._workspace.distance_unit))
        return replace(self._object(wanted), unit=None if said == "m" else said)

    def _object(self, wanted: ObjectName) -> GeoObject:
        (obj,) = self._workspace.get_entity(wanted.key)
        if wanted.kind == HOLE:
            return _hole(obj, wanted)
        vertices = np.array(obj.vertices, np.float64)
        values = [Values(vertices, _columns(obj, "VERTEX"))]
        if wanted.kind == LINES:
            values.append(_along(obj, vertices))
        triangles = np.array(obj.cells) if wanted.kind == SURFACE else None
        return GeoObject(wanted.name, wanted.kind, vertices, triangles, values)


def _kind(obj: Any) -> str | None:
    from geoh5py.objects import Curve, Drillhole, Points, Surface

    if isinstance(obj, Drillhole):
        return HOLE
    if isinstance(obj, Surface):
        return SURFACE
    if isinstance(obj, Curve):
        return LINES
    return POINTS if type(obj) is Points else None


def _hole(obj: Any, wanted: ObjectName) -> GeoObject:
    collar = np.array(obj.collar.tolist(), np.float64)
    values = []
    if obj.vertices is not None:
        vertices = np.array(obj.vertices, np.float64)
        values.append(Values(vertices, _columns(obj, "VERTEX")))
        if obj.cells is not None:
            values.append(_along(obj, vertices))
    else:
        vertices = collar[None]
        values = list(_tables(obj))
    return GeoObject(wanted.name, HOLE, vertices, None, values, collar)


def _along(obj: Any, vertices: np.ndarray) -> Values:
    """The intervals between vertices, with the depths of a drillhole."""
    begins, ends = (vertices[np.array(obj.cells)[:, end]] for end in (0, 1))
    columns = _columns(obj, "CELL")
    depth_columns = [columns.pop(name) for name in ("FROM", "TO") if name in columns]
    depths = np.column_stack(depth_columns) if len(depth_columns) == 2 else None
    return Values(begins, columns, ends, depths)


def _tables(obj: Any) -> Iterator[Values]:
    """The tables of a drillhole in a group of drillholes, each with its own depths."""
    for group in obj.property_groups or ():
        limits = [getattr(group, name, None) for name in ("from_", "to_")]
        depths = [limit.values for limit in limits if limit is not None and limit.values is not None]
        point = getattr(group, "depth_", None)
        members = [obj.workspace.get_entity(uid)[0] for uid in group.properties or ()]
        members = [member for member in members if member is not None and member.name.upper() not in _DEPTHS]
        columns = {member.name: column for member in members if (column := _column(member)) is not None}
        if len(depths) == 2:
            yield Values(obj.desurvey(depths[0]), columns, obj.desurvey(depths[1]), np.column_stack(depths))
        elif point is not None and point.values is not None:
            yield Values(obj.desurvey(point.values), columns)


def _columns(obj: Any, where: str) -> dict[str, np.ndarray]:
    """The data of an object's vertices or cells, as texts or numbers."""
    columns = {}
    for child in obj.children:
        if getattr(getattr(child, "association", None), "name", None) == where:
            column = _column(child)
            if column is not None:
                columns[child.name] = column
    return columns


def _column(data: Any) -> np.ndarray | None:
    from geoh5py.data import NumericData, ReferencedData, TextData

    values = data.values
    if values is None:
        return None
    if isinstance(data, ReferencedData):
        names = {} if data.value_map is None else dict(data.value_map.map.tolist())
        named = {number: _plain(name) for number, name in names.items() if number}
        return texts(np.asarray(values), named)
    if isinstance(data, TextData):
        return np.array([_plain(text) for text in np.atleast_1d(values)], object)
    return np.asarray(values) if isinstance(data, NumericData) else None


def _plain(text: Any) -> str:
    return text.decode() if isinstance(text, bytes) else str(text)
