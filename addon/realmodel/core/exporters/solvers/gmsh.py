# SPDX-License-Identifier: GPL-3.0-or-later
"""Gmsh MSH 4.1, binary (Gmsh Reference Manual, "MSH file format"): a volume and physical group for each
block, a
surface and physical group for each patch and each surface inside."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import VolumeMesh
from ...simulation.elements import ElementFaces, joint_sets
from ..shapes.shape_parts import distinct_names

_VOLUMES = {"tetrahedron": 4, "hexahedron": 5, "prism": 6, "pyramid": 7}
_SURFACES = {"triangle": 2, "quadrilateral": 3}


def write_msh(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements, and the faces of patches and surfaces as elements of two dimensions. Patches of one
    group have the physical group of that name, too."""
    sets = ElementFaces(mesh).sets()
    step(0.3)
    groups = list(joint_sets(sets))[len(sets) :]
    surface_tags = [
        [k, *([1 + len(sets) + groups.index(s.group)] if s.group in groups else [])]
        for k, s in enumerate(sets, 1)
    ]
    physical = distinct_names([*(s.name for s in sets), *groups])
    blocks = np.unique(mesh.of_all(mesh.element_block)).tolist()
    names = distinct_names(mesh.block_names)
    file.write(b"$MeshFormat\n4.1 1 8\n" + np.array([1], "<i4").tobytes() + b"\n$EndMeshFormat\n")
    lines = [f'2 {k} "{name}"' for k, name in enumerate(physical, 1)]
    lines += [f'3 {block + 1} "{_quoted(names[block])}"' for block in blocks]
    file.write(("\n".join(["$PhysicalNames", str(len(lines)), *lines, "$EndPhysicalNames", ""])).encode())
    low, high = (mesh.points.min(axis=0), mesh.points.max(axis=0)) if len(mesh.points) else np.zeros((2, 3))
    box = np.concatenate([low, high]).astype("<f8").tobytes()
    file.write(b"$Entities\n" + _sizes(0, 0, len(sets), len(blocks)))
    for k, tags in enumerate(surface_tags, 1):
        file.write(_ints(k) + box + _sizes(len(tags)) + _ints(*tags) + _sizes(0))
    for block in blocks:
        file.write(_ints(block + 1) + box + _sizes(1) + _ints(block + 1) + _sizes(0))
    file.write(b"\n$EndEntities\n$Nodes\n")
    count = len(mesh.points)
    file.write(_sizes(1, count, 1, count) + _ints(3, blocks[0] + 1 if blocks else 1, 0) + _sizes(count))
    file.write(np.arange(1, count + 1, dtype="<u8"))
    file.write(np.ascontiguousarray(mesh.points, "<f8"))
    file.write(b"\n$EndNodes\n$Elements\n")
    step(0.5)
    parts = [
        (2, k, _SURFACES[shape], corners)
        for k, s in enumerate(sets, 1)
        for shape, corners in s.corners.items()
        if len(corners)
    ]
    for kind, elements in mesh.elements.items():
        of = mesh.element_block[kind]
        for block in np.unique(of).tolist():
            parts.append((3, block + 1, _VOLUMES[kind], elements[of == block]))
    total = sum(len(part[3]) for part in parts)
    file.write(_sizes(len(parts), total, 1, total))
    first = 1
    for dimension, entity, gmsh_kind, corners in parts:
        file.write(_ints(dimension, entity, gmsh_kind) + _sizes(len(corners)))
        rows = np.empty((len(corners), 1 + corners.shape[1]), "<u8")
        rows[:, 0] = np.arange(first, first + len(corners))
        rows[:, 1:] = corners
        rows[:, 1:] += 1
        file.write(rows)
        first += len(corners)
    file.write(b"\n$EndElements\n")
    step(1.0)


def _quoted(name: str) -> str:
    return name.replace('"', "'")[:127]  # Gmsh's own limit


def _ints(*numbers: int) -> bytes:
    return np.array(numbers, "<i4").tobytes()


def _sizes(*numbers: int) -> bytes:
    return np.array(numbers, "<u8").tobytes()
