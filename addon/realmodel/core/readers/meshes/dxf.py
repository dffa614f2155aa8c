# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings in DXF (Autodesk, "DXF Reference"), text or binary, of any release: the faces, lines and points of
each layer, and of each block that is inserted.

Faces: 3DFACE, polyface and polygon meshes (POLYLINE), and MESH, of which the coarsest level counts. Lines and
points: POLYLINE, LWPOLYLINE, LINE and POINT, by their vertices. What stands in a block is where it is
inserted, and on the layer of the insert if it is on layer 0.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...base.algebra import dot
from ...base.errors import InputRefused, number_list
from ...base.text import Step, no_step
from ..objects.geo_object import LINES, POINTS, STICK, SURFACE, GeoObject, ObjectName, point_object
from .dxf_tags import BINARY, DxfDrawing, Entity
from .triangle_mesh import mesh_of_corners, object_of_mesh

_BEGINNING = re.compile(rb"(?:\xef\xbb\xbf)?(?:\s*999\s*\n[^\n]*\n)*\s*0\s*\n\s*SECTION\s*\n", re.IGNORECASE)
_UNIT_NAMES = {1: "in", 2: "ft", 3: "mi", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 21: "us-ft"}
_CLOSED_M, _IS_3D, _POLYGON_MESH, _CLOSED_N, _POLYFACE = 1, 8, 16, 32, 64
_NOT_READ = ("3DSOLID", "ARC", "BODY", "CIRCLE", "ELLIPSE", "REGION", "SOLID", "SPLINE", "SURFACE", "TRACE")
_MOST_INSERTS, _DEEPEST = 100_000, 32
_Place = tuple[float, float, float]


def begins_as_dxf(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.startswith(BINARY) or bool(
        _BEGINNING.match(head.replace(b"\r", b"\n").replace(b"\n\n", b"\n"))
    )


class _Shape(NamedTuple):
    """What an entity is: the corners of its faces, and places of points or of a line."""

    faces: list[list[_Place]]
    places: list[_Place]
    is_line: bool = False


@dataclass
class _Layer:
    """What was read of a layer or a block. sizes: of faces."""

    name: str
    corners: list[_Place] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    places: list[_Place] = field(default_factory=list)
    sticks: list[int] = field(default_factory=list)  # of places: the number of their line
    kind: str = POINTS
    not_read: Counter = field(default_factory=Counter)

    def add(self, shape: _Shape) -> None:
        for face in map(_without_repeats, shape.faces):
            if len(face) > 2:
                self.corners += face
                self.sizes.append(len(face))
        self.places += shape.places
        self.sticks += [self.sticks[-1] + 1 if self.sticks else 1] * len(shape.places)
        if shape.is_line:
            self.kind = LINES


def read_dxf(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The layers, and the blocks as parts of them; names of layers that differ in case alone are one. Corners
    of faces at the same place become one vertex. A layer with faces and others has two objects. Raises
    InputRefused naming file and line."""
    file = Path(file)
    drawing = DxfDrawing()
    layers: dict[str, _Layer] = {}
    inserted: dict[str, _Layer] = {}
    reader = _Shapes(file, drawing.blocks)
    for entity, shape, layer, within in reader.shapes(drawing.entities(file, step)):
        targets = [layers.setdefault(layer.casefold(), _Layer(layer))]
        targets += [inserted.setdefault(name.casefold(), _Layer(name)) for name in within]
        for target in targets:
            if shape is None:
                target.not_read[entity.name] += 1
            else:
                target.add(shape)
    # many programs write the unit of their template, so that nothing is converted by it
    said_unit = _UNIT_NAMES.get(drawing.unit or 0)
    objects = [obj for layer in layers.values() for obj in _objects(file, layer, said_unit, False)]
    parts = [layer for name, layer in inserted.items() if name not in layers]
    objects += [obj for layer in parts for obj in _objects(file, layer, said_unit, True)]
    if not objects:
        what = "it has no 3D faces, lines or points"
        not_read = _kinds(sum((layer.not_read for layer in layers.values()), Counter()))
        what += f", but {not_read}, which are not read" if not_read else ""
        advice = "export the surface as 3D faces (3DFACE), as a polyface mesh or as contour lines"
        raise InputRefused(what, file=file, advice=advice)
    return objects


def _kinds(entities: Counter) -> str:
    return number_list(f"{count} {name}" for name, count in sorted(entities.items()))


def _objects(file: Path, layer: _Layer, said_unit: str | None, is_part: bool) -> Iterator[ObjectName]:
    kinds = _kinds(layer.not_read)
    warnings = (f"'{layer.name}' has {kinds}, which are not read",) if kinds else ()

    def surface() -> GeoObject:
        mesh = mesh_of_corners(file, layer.corners, layer.sizes)
        return object_of_mesh(layer.name, mesh, warnings, said_unit=said_unit)

    if layer.sizes:
        yield ObjectName(layer.name, SURFACE, surface, is_part=is_part)
    if layer.places:
        columns = {STICK: np.array(layer.sticks)} if layer.kind == LINES else {}
        points = point_object(
            layer.name, layer.places, layer.kind, columns, said_unit=said_unit, warnings=warnings
        )
        yield ObjectName(points.name, points.kind, points.key, is_part=is_part)


class _Shapes:
    """Gives the shapes of entities, those of blocks where they are inserted."""

    def __init__(self, file: Path, blocks: dict[str, Entity]):
        self._file, self._blocks, self._inserts = file, blocks, 0

    def shapes(
        self,
        entities: Iterable[Entity],
        change: np.ndarray | None = None,
        on: str = "0",
        within: tuple[str, ...] = (),
    ) -> Iterator[tuple[Entity, _Shape | None, str, tuple[str, ...]]]:
        """Each entity, its shape, None where such are not read, its layer, and the blocks that it stands in.
        change: (3, 4) from the places of a block to those of the drawing. on: the layer of the insert."""
        for entity in entities:
            if entity.codes.get(67) == "1":  # of a sheet of paper
                continue
            layer = entity.text(8, "0") or "0"
            layer = on if layer == "0" else layer
            try:
                if entity.name == "INSERT":
                    yield from self._inserted(entity, change, layer, within)
                elif entity.name in _NOT_READ:
                    yield entity, None, layer, within
                elif (shape := _shape(entity)) is not None:
                    yield entity, shape if change is None else _moved(shape, change), layer, within
            except InputRefused:
                raise
            except (ValueError, KeyError, IndexError, OverflowError) as error:
                what = f"a {entity.name} that cannot be read"
                raise InputRefused(what, file=self._file, line=entity.line) from error

    def _inserted(
        self, insert: Entity, change: np.ndarray | None, layer: str, within: tuple[str, ...]
    ) -> Iterator[tuple[Entity, _Shape | None, str, tuple[str, ...]]]:
        block = self._blocks.get(insert.text(2).casefold())
        if block is None:
            return
        name = block.text(2)
        if name.casefold() in map(str.casefold, within) or len(within) > _DEEPEST:
            what = f"block '{name}' is inserted into itself"
            raise InputRefused(what, file=self._file, line=insert.line)
        named = within if name.startswith("*") else (*within, name)
        for own in _insert_changes(insert, block):
            self._inserts += 1
            if self._inserts > _MOST_INSERTS:
                what = f"blocks are inserted more than {_MOST_INSERTS:,} times"
                raise InputRefused(what, file=self._file, line=insert.line)
            whole = own if change is None else _after(own, change)
            yield from self.shapes(block.parts, whole, layer, named)


def _turned(places: ArrayLike, axes: np.ndarray) -> np.ndarray:
    """(N, 3) places by other axes, the columns of (3, 3)."""
    return dot(np.reshape(places, (-1, 1, 3)), axes)


def _after(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(3, 4) one change of places, then another."""
    moved = _turned(first.T, second[:, :3])
    moved[3] += second[:, 3]
    return moved.T


def _insert_changes(insert: Entity, block: Entity) -> Iterator[np.ndarray]:
    """(3, 4) of each place where an INSERT has its block. Raises ValueError."""
    angle = insert.number(50)
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    if angle % 90.0 == 0.0:
        cosine, sine = round(cosine), round(sine)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    scales = np.array([insert.number(code, 1.0) for code in (41, 42, 43)])
    axes = _axes(insert)
    columns, rows = max(insert.whole(70, 1), 1), max(insert.whole(71, 1), 1)
    base, at = np.array(block.place()), np.array(insert.place())
    linear = _turned(axes, turn.T) * scales
    if not np.isfinite(linear).all():
        raise ValueError
    for row in range(rows):
        for column in range(columns):
            step = np.array([column * insert.number(44), row * insert.number(45), 0.0])
            yield np.column_stack([linear, dot(axes, at + dot(turn, step)) - dot(linear, base)])


def _axes(entity: Entity) -> np.ndarray:
    """(3, 3) the axes, as columns, of the places of a plane entity, by the direction in which it is extruded:
    the "arbitrary axis algorithm" of the reference. Raises ValueError."""
    normal = np.array([entity.number(code, default) for code, default in ((210, 0), (220, 0), (230, 1))])
    length = math.sqrt(float(dot(normal, normal)))
    if not length > 0.0 or ((normal[:2] == 0).all() and normal[2] > 0):
        return np.eye(3)
    normal /= length
    beside = [0.0, 1.0, 0.0] if (np.abs(normal[:2]) < 1 / 64).all() else [0.0, 0.0, 1.0]
    x = np.cross(beside, normal)
    x /= math.sqrt(float(dot(x, x)))
    return np.column_stack([x, np.cross(normal, x), normal])


def _moved(shape: _Shape, change: np.ndarray) -> _Shape:
    def moved(places: list[_Place]) -> list[_Place]:
        if not places:
            return []
        return list(map(tuple, (_turned(places, change[:, :3]) + change[:, 3]).tolist()))

    return shape._replace(faces=[moved(face) for face in shape.faces], places=moved(shape.places))


def _in_plane(entity: Entity, places: list[_Place]) -> list[_Place]:
    """Places of a plane entity in the drawing."""
    axes = _axes(entity)
    if (axes == np.eye(3)).all():
        return places
    return list(map(tuple, _turned(places, axes).tolist()))


def _without_repeats(corners: list) -> list:
    return [corner for k, corner in enumerate(corners) if corner != corners[k - 1]]


def _shape(entity: Entity) -> _Shape | None:
    """What an entity is; None where it is no shape. Raises ValueError, KeyError and IndexError."""
    name = entity.name
    if name == "3DFACE":
        return _Shape([[entity.place(corner) for corner in range(4 if 13 in entity.codes else 3)]], [])
    if name == "POLYLINE":
        return _polyline(entity)
    if name == "LWPOLYLINE":
        x, y, z = entity.all_of(10), entity.all_of(20), entity.number(38)
        return _Shape([], _in_plane(entity, [(*at, z) for at in zip(x, y, strict=True)]), True)
    if name == "LINE":
        return _Shape([], [entity.place(), entity.place(1)], True)
    if name == "POINT":
        return _Shape([], [entity.place()])
    return _Shape(_mesh_faces(entity), []) if name == "MESH" else None


def _polyline(entity: Entity) -> _Shape:
    """The faces of a polyface mesh or polygon mesh, or the vertices of a line."""
    flags, vertices = entity.whole(70), entity.parts
    if flags & _POLYFACE:
        places = [vertex.place() for vertex in vertices if vertex.whole(70) & 64]
        numbers = [  # from 1, 0 for none; below zero where the edge is hidden
            [abs(vertex.whole(code)) for code in (71, 72, 73, 74)]
            for vertex in vertices
            if vertex.whole(70) & 192 == 128
        ]
        return _Shape([[places[n - 1] for n in face if n] for face in numbers], [])
    places = [vertex.place() for vertex in vertices if not vertex.whole(70) & 16]
    if not flags & _POLYGON_MESH:
        if not flags & _IS_3D:
            places = _in_plane(entity, [(x, y, entity.number(30)) for x, y, _ in places])
        return _Shape([], places, True)
    rows, columns = int(entity.codes[71]), int(entity.codes[72])
    if rows * columns != len(places):
        raise ValueError
    around = (0, 0), (1, 0), (1, 1), (0, 1)
    return _Shape(
        [
            [places[(m + i) % rows * columns + (n + k) % columns] for i, k in around]
            for m in range(rows if flags & _CLOSED_M else rows - 1)
            for n in range(columns if flags & _CLOSED_N else columns - 1)
        ],
        [],
    )


def _mesh_faces(entity: Entity) -> list[list[_Place]]:
    """The faces of a MESH on its coarsest level: behind code 93 stand the size and the corners of each
    face."""
    places = list(zip(entity.all_of(10), entity.all_of(20), entity.all_of(30), strict=True))
    numbers, is_list = [], False
    for code, value in entity.pairs:
        is_list = code == 93 or (is_list and code != 94)
        if is_list and code == 90:
            numbers.append(int(value))
    faces, at = [], 0
    while at < len(numbers):
        corners = numbers[at + 1 : at + 1 + numbers[at]]
        if numbers[at] < 1 or len(corners) < numbers[at] or min(corners) < 0:
            raise ValueError
        faces.append([places[corner] for corner in corners])
        at += 1 + numbers[at]
    return faces
