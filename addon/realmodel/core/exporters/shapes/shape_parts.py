# SPDX-License-Identifier: GPL-3.0-or-later
"""Named meshes of polygons for programs that take shapes: blocks, surfaces and sections."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ...base.work import native_module
from ...cells.joining import near_positions
from ...cells.model_data import ModelData, UsedSurfaces
from ...results.sections.section_data import SectionData

_PLAIN = (0.7, 0.7, 0.7)  # for parts without a property


@dataclass(frozen=True, eq=False)
class Part:
    """A shape: vertices (V, 3) float64, polygons as offsets (F + 1,) int64 and corners int32, those of a
    closed shape counter-clockwise seen from outside.

    name: no other part of the list has it. property: id of the library, 0: none. material: the name of what
    it is made of. color: red, green, blue from 0 to 1, sRGB.
    """

    name: str
    vertices: np.ndarray
    offsets: np.ndarray
    corners: np.ndarray
    property: int = 0
    material: str = ""
    color: tuple[float, float, float] = field(default=_PLAIN)

    @classmethod
    def of_triangles(cls, name: str, vertices: np.ndarray, triangles: np.ndarray, **more: Any) -> Part:
        offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
        return cls(name, vertices, offsets, triangles.ravel(), **more)

    @cached_property
    def triangles(self) -> np.ndarray:
        """(T, 3) int32: the polygons divided; what they close is closed."""
        if (np.diff(self.offsets) == 3).all():
            return np.ascontiguousarray(self.corners, np.int32).reshape(-1, 3)
        offsets = np.ascontiguousarray(self.offsets, np.int64)
        return native_module().triangulate_faces(self.vertices, offsets, self.corners)[0]


@dataclass(frozen=True, eq=False)
class FaceTriangles:
    """The faces around blocks, each divided into triangles once, so that the blocks on both of its sides have
    the same ones. Vertices that only rounding keeps apart are one, as programs that take shapes join them:
    triangles that have no area then are not there, and triangles with the same corners are one.

    corners (T, 3) int32: vertices of the model, counter-clockwise seen from outside the first block. face
    (T,) int64: the face of each. blocks (T, 2) int32: the block on each side, -1 outside.
    """

    corners: np.ndarray
    face: np.ndarray
    blocks: np.ndarray

    @classmethod
    def of(cls, model: ModelData) -> FaceTriangles:
        """Those of all blocks of a model."""
        blocks = model.face_blocks
        faces = np.flatnonzero(blocks[:, 0] != blocks[:, 1])
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        triangles, begins = native_module().triangulate_faces(model.vertices, offsets, corners)
        face = np.repeat(faces, np.diff(begins))
        corners = near_positions(model.vertices).astype(np.int32)[triangles.reshape(-1, 3)]
        has_area = (corners != corners[:, [1, 2, 0]]).all(axis=1)
        return cls(*_once_each(corners[has_area], face[has_area], blocks[face[has_area]]))

    def around(self, block: int) -> tuple[np.ndarray, np.ndarray]:
        """Of one block the numbers of its triangles, and their corners (N, 3), counter-clockwise seen from
        outside of it."""
        numbers = np.flatnonzero((self.blocks == block).any(axis=1))
        corners = self.corners[numbers]
        turned = self.blocks[numbers, 1] == block
        corners[turned] = corners[turned, ::-1]
        return numbers, corners


def _once_each(corners: np.ndarray, face: np.ndarray, blocks: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of triangles with the same corners those that lie between two blocks when what is between them is not
    there. Arguments and result as in FaceTriangles."""
    _, same, counts = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True)
    several = np.flatnonzero(counts[same.ravel()] > 1)
    if not len(several):
        return corners, face, blocks
    several = several[np.argsort(same.ravel()[several], kind="stable")]
    corners, blocks, is_kept = corners.copy(), blocks.copy(), np.ones(len(corners), bool)
    is_kept[several] = False
    for group in np.split(several, np.cumsum(counts[counts > 1])[:-1]):
        first, between = corners[group[0]], Counter[int]()
        for triangle in group.tolist():
            at = int(np.flatnonzero(corners[triangle] == first[0])[0])
            is_turned = corners[triangle, (at + 1) % 3] != first[1]
            below, above = blocks[triangle, ::-1] if is_turned else blocks[triangle]
            between[int(below)] += 1
            between[int(above)] -= 1
        sides = sorted((+between).elements()), sorted((-between).elements())
        for triangle, below, above in zip(group.tolist(), *sides, strict=False):
            is_kept[triangle], corners[triangle], blocks[triangle] = True, first, (below, above)
    return corners[is_kept], face[is_kept], blocks[is_kept]


def model_parts(model: ModelData, triangles: FaceTriangles | None = None) -> list[Part]:
    """The closed boundary of each existing block, named after it. Blocks share the triangles between them.
    triangles: those of the model, where they are known already."""
    names = distinct_names(block.name for block in model.blocks)
    materials, colors = block_materials(model), model.block_colors.tolist()
    parts = []
    triangles = triangles or FaceTriangles.of(model)
    for number, block in enumerate(model.blocks):
        if not block.cells:
            continue
        used, corners = np.unique(triangles.around(number)[1], return_inverse=True)
        parts.append(
            Part.of_triangles(
                names[number],
                model.vertices[used],
                corners.reshape(-1, 3).astype(np.int32),
                property=block.property,
                material=materials[block.property],
                color=tuple(colors[number]),
            )
        )
    return parts


def block_materials(model: ModelData) -> dict[int, str]:
    """The name of the property of each block."""
    library = model.project.library
    used = {block.property for block in model.blocks}
    entries = {number: library.get(number) if library else None for number in sorted(used)}
    named = {number: entry.name if entry else f"property {number}" for number, entry in entries.items()}
    return dict(zip(named, distinct_names(named.values()), strict=True))


def surface_parts(surfaces: UsedSurfaces) -> list[Part]:
    """The surfaces of a SurfaceSet or a Model, each as it was used."""
    parts = []
    for number, name in enumerate(distinct_names(surfaces.surface_names)):
        vertices, triangles = surfaces.surface(number)
        parts.append(Part.of_triangles(name, vertices, triangles))
    return parts


def section_parts(section: SectionData) -> list[Part]:
    """The polygons of a section or fence, those of each block together."""
    names = distinct_names(section.block_names)
    sizes = np.diff(section.offsets)
    parts = []
    for block in np.unique(section.block).tolist():
        in_block = section.block == block
        corners = section.polygon_vertices[np.repeat(in_block, sizes)]
        used, corners = np.unique(corners, return_inverse=True)
        prop = int(section.property[in_block][0])
        parts.append(
            Part(
                names[block],
                section.vertices[used],
                np.concatenate([[0], np.cumsum(sizes[in_block])]).astype(np.int64),
                corners.ravel().astype(np.int32),
                prop,
                f"property {prop}",
                tuple(section.block_colors[block].tolist()),
            )
        )
    return parts


def distinct_names(given: Iterable[str]) -> list[str]:
    """The same names, each in one line; a number is appended to repeated ones."""
    taken: set[str] = set()
    names = []
    for name in given:
        base = " ".join(name.split()) or "unnamed"
        free, number = base, 1
        while free in taken:
            number += 1
            free = f"{base} ({number})"
        taken.add(free)
        names.append(free)
    return names


def plain_words(names: Sequence[str]) -> list[str]:
    """Names for formats without blanks: characters other than letters, digits, - and . become _."""
    words = ["".join(c if c.isalnum() or c in "-._" else "_" for c in name) for name in names]
    unique: list[str] = []
    for word in words:
        number, free = 1, word
        while free in unique:
            number += 1
            free = f"{word}_{number}"
        unique.append(free)
    return unique
