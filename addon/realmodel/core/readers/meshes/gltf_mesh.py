# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF 2.0 (Khronos, "glTF 2.0 Specification"), .gltf and .glb: the triangles of each node, by its name,
where its scene places them, in meters. Y is up there: it is turned to z."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from ...base.algebra import dot
from ...base.errors import InputRefused
from ...base.text import Step, no_step, read_bytes
from ..objects.geo_object import SURFACE, GeoObject, ObjectName
from .triangle_mesh import UNREADABLE, mesh_of_corners, object_of_mesh, unreadable
from .vtk_mesh import strip_faces

_MAGIC, _JSON, _BINARY = b"glTF", 0x4E4F534A, 0x004E4942
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_ALLOWED = (
    *("KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "KHR_technique", "KHR_lights_"),
    *("EXT_texture_",),
)
_DEEPEST = 64
_Z_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_TURNED = ("its y axis is up, as in all of its format: it is turned to z",)


def begins_as_gltf(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    has_marks = b'"asset"' in head and b'"version"' in head
    has_marks |= any(mark in head for mark in (b'"accessors"', b'"bufferViews"', b'"bufferView"'))
    is_map = b'"Feature' in head  # GeoJSON
    return head.startswith(_MAGIC) or (head.lstrip()[:1] == b"{" and has_marks and not is_map)


def read_gltf(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The nodes that have triangles; corners at the same place become one vertex, for normals and colors
    divide them. Raises InputRefused naming the file."""
    file = Path(file)
    try:
        content = _Content(file)
        objects = [
            ObjectName(name, SURFACE, _made(file, name, corners)) for name, corners in content.surfaces()
        ]
    except InputRefused:
        raise
    except (*UNREADABLE, AttributeError, RecursionError) as error:
        raise unreadable(file, "glTF", error) from error
    step(0.5)
    if not objects:
        raise InputRefused("it has no triangles", file=file)
    return objects


def _made(file: Path, name: str, corners: np.ndarray) -> Any:
    def made() -> GeoObject:
        return object_of_mesh(name, mesh_of_corners(file, corners), _TURNED, unit="m")

    return made


class _Content:
    """What is in a file, with the files of its buffers."""

    def __init__(self, file: Path):
        self._file = file
        raw, self._binary = read_bytes(file), b""
        if raw.startswith(_MAGIC):
            raw = self._chunks(raw)
        self._json = json.loads(raw)
        version = str(self._json["asset"].get("version", ""))
        if not version.startswith("2."):
            raise InputRefused(f"glTF {version:.10} is not read", file=file, advice="export it as glTF 2.0")
        required = self._json.get("extensionsRequired", [])
        for name in required:
            if not str(name).startswith(_ALLOWED):
                what = f"it needs the extension {name}, which is not read"
                raise InputRefused(what, file=file, advice="export it without compression")
        self._buffers: dict[int, bytes] = {}

    def _chunks(self, raw: bytes) -> bytes:
        """The JSON of a binary file. Raises ValueError."""
        if raw[4:8] != (2).to_bytes(4, "little"):
            what = f"glTF {int.from_bytes(raw[4:8], 'little')} is not read"
            raise InputRefused(what, file=self._file, advice="export it as glTF 2.0")
        at, text = 12, b""
        while at + 8 <= len(raw):
            length, kind = (int.from_bytes(raw[k : k + 4], "little") for k in (at, at + 4))
            chunk = raw[at + 8 : at + 8 + length]
            if len(chunk) < length:
                raise ValueError(f"the file is cut off at byte {len(raw)}")
            if kind == _JSON:
                text = chunk
            elif kind == _BINARY:
                self._binary = chunk
            at += 8 + length
        return text

    def surfaces(self) -> Iterator[tuple[str, np.ndarray]]:
        """The name and the corners (3 T, 3) of each node with triangles."""
        nodes, scenes = self._json.get("nodes", []), self._json.get("scenes", [])
        children = {child for node in nodes for child in node.get("children", [])}
        roots = [number for number in range(len(nodes)) if number not in children]
        if scenes:
            roots = scenes[self._json.get("scene", 0)].get("nodes", roots)
        waiting = [(number, _Z_UP, 0) for number in reversed(roots)]
        while waiting:
            number, change, depth = waiting.pop()
            if depth > _DEEPEST:
                raise ValueError("its nodes are parts of one another")
            node = nodes[number]
            change = dot(change[:, None], _change(node).T[None])
            waiting += [(child, change, depth + 1) for child in reversed(node.get("children", []))]
            if "mesh" in node:
                mesh = self._json["meshes"][node["mesh"]]
                corners = [self._corners(primitive) for primitive in mesh["primitives"]]
                with np.errstate(invalid="ignore"):  # what is not finite is refused when it is read
                    places = np.concatenate([np.empty((0, 3)), *corners])
                    places = dot(places[:, None], change[:3, :3]) + change[:3, 3]
                if dot(change[0, :3], np.cross(change[1, :3], change[2, :3])) < 0:  # a mirror turns faces
                    places = places.reshape(-1, 3, 3)[:, ::-1].reshape(-1, 3)
                if len(places):
                    yield str(node.get("name") or mesh.get("name") or ""), places

    def _corners(self, primitive: dict) -> np.ndarray:
        """(3 T, 3) the corners of the triangles of a primitive, none of lines and points."""
        mode = primitive.get("mode", _TRIANGLES)
        if mode not in (_TRIANGLES, _STRIP, _FAN) or "POSITION" not in primitive["attributes"]:
            return np.empty((0, 3))
        places = self._accessor(primitive["attributes"]["POSITION"])
        numbers = np.arange(len(places))
        if "indices" in primitive:
            numbers = self._accessor(primitive["indices"]).ravel().astype(np.int64)
        if mode == _STRIP:
            numbers = np.array(strip_faces(numbers.tolist()), np.int64).ravel()
        elif mode == _FAN:
            fans = [[numbers[0], numbers[k], numbers[k + 1]] for k in range(1, len(numbers) - 1)]
            numbers = np.array(fans, np.int64).ravel()
        return places[numbers[: len(numbers) // 3 * 3]]

    def _accessor(self, number: int) -> np.ndarray:
        """(N, K) the numbers of an accessor."""
        accessor = self._json["accessors"][number]
        kind, columns = np.dtype(_TYPES[accessor["componentType"]]), _COLUMNS[accessor["type"]]
        if "bufferView" in accessor:
            rows = self._rows(number, accessor, kind, (accessor["count"], columns)).astype(np.float64)
        elif "sparse" in accessor:
            rows = np.zeros((accessor["count"], columns))
        else:
            raise ValueError(f"accessor {number} has no data")
        if sparse := accessor.get("sparse"):
            of_places = np.dtype(_TYPES[sparse["indices"]["componentType"]])
            at = self._rows(number, sparse["indices"], of_places, (sparse["count"], 1)).ravel()
            rows[at] = self._rows(number, sparse["values"], kind, (sparse["count"], columns))
        if accessor.get("normalized") and kind.kind in "iu":
            rows = np.maximum(rows / np.iinfo(kind).max, -1.0)
        return rows

    def _rows(self, number: int, place: dict, kind: np.dtype, shape: tuple[int, int]) -> np.ndarray:
        """(N, K) numbers of an accessor, at `place`."""
        view, (count, columns) = self._json["bufferViews"][place["bufferView"]], shape
        size = kind.itemsize * columns
        stride = view.get("byteStride", size)
        begin = view.get("byteOffset", 0) + place.get("byteOffset", 0)
        raw = self._buffer(view["buffer"])
        if count < 1 or stride < size or begin < 0 or begin + (count - 1) * stride + size > len(raw):
            raise ValueError(f"accessor {number} goes beyond its buffer: the file is cut off")
        return np.ndarray(shape, kind, raw, begin, (stride, kind.itemsize))

    def _buffer(self, number: int) -> bytes:
        if number not in self._buffers:
            uri = self._json["buffers"][number].get("uri")
            if uri is None:
                self._buffers[number] = self._binary
            elif uri.startswith("data:"):
                self._buffers[number] = base64.b64decode(uri.partition(",")[2])
            else:
                path = Path(unquote(uri))
                if path.is_absolute() or ".." in path.parts:
                    raise ValueError(f"its buffer '{uri:.80}' is not beside it")
                self._buffers[number] = read_bytes(self._file.parent / path)
        return self._buffers[number]


def _change(node: dict) -> np.ndarray:
    """(4, 4) from the places of a node to those of its parent."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    change = np.eye(4)
    change[:3, :3] = turn * np.array(node.get("scale", (1.0, 1.0, 1.0)), np.float64)
    change[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return change
