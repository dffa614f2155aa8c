# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of GOCAD and SKUA as text: surfaces (TSurf), points (VSet), lines (PLine) and wells (Well), any
number of them in a file (Paradigm, "GOCAD ASCII file formats"; open readers of RING and LoopStructural follow
it).

Depths that are positive downward become heights. Units of the axes are those that the file states.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.algebra import norm
from ...base.errors import InputRefused, number_list
from ...base.text import Step, no_step, text_lines
from ...base.units import unit_of
from ..objects.geo_object import (
    HOLE,
    LINES,
    POINTS,
    STICK,
    GeoObject,
    ObjectName,
    Values,
    point_object,
    stated_text,
)
from .triangle_mesh import UNREADABLE, surface_object

_WORD = re.compile(r'"([^"]*)"|(\S+)')
_NAME = re.compile(r"\*?name\s*:\s*(.*?)\s*(?:\}.*)?$", re.IGNORECASE)
_TYPES = {"TSurf": "surface", "VSet": POINTS, "PLine": LINES, "Well": HOLE}


def begins_as_gocad(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(re.match(rb"(?:\xef\xbb\xbf)?\s*(?:#[^\n]*\n\s*)*GOCAD\s+\w", head))


@dataclass
class _Object:
    """What was read of an object. index: the vertices by their numbers in the file."""

    kind: str
    name: str = ""
    up: float = 1.0
    units: list[str | None] = field(default_factory=list)
    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    index: dict[int, int] = field(default_factory=dict)
    faces: list[tuple[int, ...]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    properties: list[str] = field(default_factory=list)
    no_data: list[str] = field(default_factory=list)
    rows: dict[int, list[str]] = field(default_factory=dict)  # values of the properties by vertex
    collar: tuple[float, float, float] | None = None
    path: list[tuple[float, float, float, float]] = field(default_factory=list)  # depth, z, dx, dy
    part: int = 0  # of a PLine
    parts: list[int] = field(default_factory=list)  # by vertex
    markers: list[tuple[str, float]] = field(default_factory=list)
    zones: list[tuple[str, float, float]] = field(default_factory=list)


def read_gocad(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The surfaces, sets of points, lines and wells of a file, by the name in their header. Properties of
    surfaces are not read, with a warning; those of points are columns. Raises InputRefused naming file and
    line."""
    file = Path(file)
    objects: list[_Object] = []
    others: list[_Object] = []
    current = _Object("")
    for number, line in _lines(file, step):
        words = [quoted or plain for quoted, plain in _WORD.findall(line)]
        if words[0] == "GOCAD":
            current = _Object(words[1] if len(words) > 1 else "")
            (objects if current.kind in _TYPES else others).append(current)
            continue
        try:
            _read_line(current, words, line, number)
        except UNREADABLE as error:
            raise InputRefused(f"'{line:.40}' cannot be read", file=file, line=number) from error
    if not objects:
        what = f"it holds a GOCAD {number_list([obj.kind for obj in others])}, which is not read"
        advice = f"export {number_list(_TYPES)} objects"
        raise InputRefused(what, file=file, advice=advice)
    return [_named(file, obj) for obj in objects]


def _lines(file: Path, step: Step) -> Iterator[tuple[int, str]]:
    for first, lines, share in text_lines(file):
        for number, line in enumerate(lines, first):
            text = line.partition("#")[0] if line.lstrip().startswith("#") or " #" in line else line
            if text and not text.isspace():
                yield number, text.strip()
        step(share)


def _read_line(obj: _Object, words: list[str], line: str, number: int) -> None:
    """Reads a line of an object. Raises the errors of UNREADABLE."""
    key = words[0]
    if key in ("VRTX", "PVRTX") and obj.kind != "Well":
        _read_vertex(obj, words)
    elif key in ("ATOM", "PATOM"):
        obj.index[int(words[1])] = obj.index[int(words[2])]
    elif key == "TRGL":
        a, b, c = words[1:4]
        obj.faces.append((obj.index[int(a)], obj.index[int(b)], obj.index[int(c)]))
        obj.lines.append(number)
    elif key == "ILINE":
        obj.part += 1
    elif key == "ZPOSITIVE":
        obj.up = -1.0 if words[1].lower() == "depth" else 1.0
    elif key == "AXIS_UNIT":
        obj.units = [stated_text(word) for word in words[1:4]]
    elif key == "PROPERTIES":
        obj.properties = words[1:]
    elif key == "NO_DATA_VALUES":
        obj.no_data = words[1:]
    elif obj.kind == "Well":
        _read_well(obj, words)
    if not obj.name and (match := _NAME.search(line)) and not key.startswith(("PROP", "AXIS", "NAME")):
        obj.name = match[1].strip('"')


def _read_vertex(obj: _Object, words: list[str]) -> None:
    x, y, z = map(float, words[2:5])
    if words[0] == "PVRTX" and obj.properties:
        obj.rows[len(obj.vertices)] = words[5 : 5 + len(obj.properties)]
    obj.index[int(words[1])] = len(obj.vertices)
    obj.vertices.append((x, y, obj.up * z))
    obj.parts.append(obj.part)


def _read_well(obj: _Object, words: list[str]) -> None:
    key, values = words[0], words[1:]
    if key == "WREF":
        x, y, z = map(float, values[:3])
        obj.collar = (x, y, obj.up * z)
    elif key == "PATH":
        depth, z, x, y = map(float, values[:4])
        obj.path.append((depth, obj.up * z, x, y))
    elif key in ("VRTX", "PVRTX"):
        x, y, z = map(float, values[:3])
        obj.vertices.append((x, y, obj.up * z))
    elif key == "MRKR":
        obj.markers.append((values[0], float(values[2 if len(values) > 2 else 1])))
    elif key == "ZONE":
        obj.zones.append((values[0], float(values[1]), float(values[2])))


def _named(file: Path, obj: _Object) -> ObjectName:
    units = _units(file, obj)
    if obj.kind == "TSurf":
        warnings = [f"its properties {', '.join(obj.properties)} are not read"] if obj.properties else []
        return surface_object(
            file, obj.name, obj.vertices, obj.faces, obj.lines, unit=units, warnings=tuple(warnings)
        )
    if obj.kind == "Well":
        return ObjectName(obj.name, HOLE, _well(obj, units))
    return point_object(obj.name, obj.vertices, _TYPES[obj.kind], _columns(obj), unit=units)


def _units(file: Path, obj: _Object) -> str | dict | None:
    """The units of the axes: one, or those of the plan and of heights."""
    x, y, z = (*obj.units, None, None, None)[:3]
    if (unit_of(x or "") or x) != (unit_of(y or "") or y):
        what = f"its axes x and y have different units, {x} and {y}"
        raise InputRefused(what, file=file, item=f"object '{obj.name}'", advice="correct AXIS_UNIT")
    return x if x == z else {"xy": x, "z": z}


def _columns(obj: _Object) -> dict[str, np.ndarray]:
    """(V,) numbers of each property; NaN where there is none. Those of lines are sticks."""
    columns = {STICK: np.array(obj.parts)} if obj.kind == "PLine" else {}
    for number, name in enumerate(obj.properties):
        missing = obj.no_data[number] if number < len(obj.no_data) else None
        column = np.full(len(obj.vertices), np.nan)
        for vertex, row in obj.rows.items():
            if number < len(row) and row[number] != missing:
                column[vertex] = float(row[number])
        columns[name] = column
    return columns


def _well(obj: _Object, units: str | dict | None) -> Callable[[], GeoObject]:
    """A well: its markers are values "surface" at places, its zones values "block" of intervals."""

    def made() -> GeoObject:
        depths, places = _path(obj)

        def at(depth: Sequence[float]) -> np.ndarray:
            return np.column_stack([np.interp(depth, depths, column) for column in places.T])

        values = []
        if obj.markers:
            names, marked = zip(*obj.markers, strict=True)
            values.append(Values(at(marked), {"surface": np.array(names, object)}))
        if obj.zones:
            names, begins, ends = zip(*obj.zones, strict=True)
            columns = {"block": np.array(names, object)}
            values.append(Values(at(begins), columns, at(ends), np.column_stack([begins, ends])))
        return GeoObject(obj.name, HOLE, places, None, values, places[0], unit=units)

    return made


def _path(obj: _Object) -> tuple[np.ndarray, np.ndarray]:
    """The depths (N,) along a well and their places (N, 3): of its path or its vertices, straight on from
    these to what is deeper, or straight down. Raises ValueError where it has no place."""
    if obj.path and obj.collar:
        path = np.array(obj.path)
        places = np.column_stack([obj.collar[0] + path[:, 2], obj.collar[1] + path[:, 3], path[:, 1]])
        depths = path[:, 0]
        if depths[0] > 0.0:
            depths, places = np.append(0.0, depths), np.vstack([obj.collar, places])
    elif obj.vertices or obj.collar:
        places = np.array(obj.vertices) if obj.vertices else np.array([obj.collar])
        depths = np.append(0.0, np.cumsum(norm(np.diff(places, axis=0))))
    else:
        raise ValueError(f"the well '{obj.name}' has neither a place (WREF) nor a path")
    deepest = max([0.0, *(depth for _, depth in obj.markers), *(end for *_, end in obj.zones)])
    if deepest <= depths[-1]:
        return depths, places
    down = np.array([0.0, 0.0, -1.0])
    if len(depths) > 1 and depths[-1] > depths[-2]:
        down = (places[-1] - places[-2]) / (depths[-1] - depths[-2])
    end = places[-1] + (deepest - depths[-1]) * down
    return np.append(depths, deepest), np.vstack([places, end])
