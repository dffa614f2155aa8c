# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF 2.0, binary (.glb; Khronos 2021): a node for each part, a material in the color of each property.

Y is up there: model coordinates (x, y, z) are (x, z, -y). Numbers have 32 bits there, so vertices are
relative to a point of the model, the origin of the root node; its extras hold it in model coordinates.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any, BinaryIO

import numpy as np

from ...project.looks import linear
from .shape_parts import Part

_FLOAT, _UINT32, _TRIANGLES, _POSITIONS, _INDICES = 5126, 5125, 4, 34962, 34963


def write_glb(parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes parts."""
    low = np.min([part.vertices.min(axis=0) for part in parts], axis=0) if parts else np.zeros(3)
    high = np.max([part.vertices.max(axis=0) for part in parts], axis=0) if parts else np.zeros(3)
    origin = np.rint((low + high) / 2)
    materials = {part.property: part for part in reversed(parts)}
    place = {number: at for at, number in enumerate(sorted(materials))}
    x, y, z = origin.tolist()
    root = {"name": "RealModel", "translation": [x, z, -y], "extras": {"origin": [x, y, z]}}
    content: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "RealModel"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [root],
    }
    if parts:
        root["children"] = list(range(1, len(parts) + 1))
        content["materials"] = [_material(materials[number]) for number in sorted(materials)]
        content |= {name: [] for name in ("meshes", "accessors", "bufferViews")}
    arrays, at = [], 0
    for number, part in enumerate(parts):
        east, north, up = (part.vertices - origin).T
        positions = np.column_stack([east, up, -north]).astype("<f4")
        corners = np.ascontiguousarray(part.triangles, "<u4").ravel()
        for array, target in ((positions, _POSITIONS), (corners, _INDICES)):
            content["bufferViews"].append(
                {"buffer": 0, "byteOffset": at, "byteLength": array.nbytes, "target": target}
            )
            arrays.append(array)
            at += array.nbytes
        content["accessors"] += [
            {
                "bufferView": 2 * number,
                "componentType": _FLOAT,
                "count": len(positions),
                "type": "VEC3",
                "min": positions.min(axis=0).tolist(),
                "max": positions.max(axis=0).tolist(),
            },
            {
                "bufferView": 2 * number + 1,
                "componentType": _UINT32,
                "count": len(corners),
                "type": "SCALAR",
            },
        ]
        primitive = {
            "attributes": {"POSITION": 2 * number},
            "indices": 2 * number + 1,
            "material": place[part.property],
            "mode": _TRIANGLES,
        }
        content["meshes"].append({"name": part.name, "primitives": [primitive]})
        content["nodes"].append({"name": part.name, "mesh": number, "extras": {"property": part.property}})
        step(0.5 * (number + 1) / len(parts))
    if parts:
        content["buffers"] = [{"byteLength": at}]
    head = json.dumps(content, ensure_ascii=False, separators=(",", ":")).encode()
    head += b" " * (-len(head) % 4)
    chunks = len(head) + 8 + (at + 8 if parts else 0)
    file.write(b"glTF" + np.array([2, 12 + chunks, len(head)], "<u4").tobytes() + b"JSON" + head)
    if parts:
        file.write(np.array([at], "<u4").tobytes() + b"BIN\0")
        for array in arrays:
            file.write(array)
    step(1.0)


def _material(part: Part) -> dict:
    return {
        "name": part.material,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(round(linear(channel), 6) for channel in part.color), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
        "doubleSided": True,
        "extras": {"property": part.property},
    }
