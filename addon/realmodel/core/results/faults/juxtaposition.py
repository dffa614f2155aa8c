# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on both sides of a fault: the polygons, areas, cutoff lines and throws of a juxtaposition diagram
(Allan 1989, AAPG Bulletin 73, 803-811)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...base.triangles import edge_numbers
from ...base.work import Work, run
from ...cells.model_data import ModelData
from ...surfaces.rock_structure import FaultShape, fault_sides
from ..displacements import Displacement
from ..sections.section_data import SectionData
from .strike_line import StrikeLine

FOOTWALL, HANGING_WALL = 0, 1  # columns of `blocks` and `cells`
SIDES = ("footwall", "hanging wall")
_BESIDE = 1e-4  # of the size of a face: how far from it a place is looked at


PairAreas = dict[tuple[str | None, str | None], float]


@dataclass(frozen=True, eq=False)
class CutoffLine:
    """Where a fault cuts off a surface on one side. side: "footwall" or "hanging wall". ends: (N, 2, 3)
    float64 of its segments."""

    surface: str
    side: str
    ends: np.ndarray


@dataclass(eq=False, repr=False)
class JuxtapositionData(SectionData):
    """The faces of a model that lie on a fault, as polygons, counter-clockwise seen from the hanging wall.

    Beside what a section has, where below is the footwall and above the hanging wall (of a vertical fault
    these are its two sides): fault: its name. strike: the line along which it is unrolled. cutoffs: of the
    surfaces that it displaces, on both sides. throws: the displacement of each of these along the fault.
    """

    fault: str = field(kw_only=True)
    strike: StrikeLine = field(kw_only=True)
    cutoffs: list[CutoffLine] = field(kw_only=True)
    throws: list[Displacement] = field(kw_only=True)

    @property
    def areas(self) -> PairAreas:
        """The area on the fault, in space, model units squared, of each pair of blocks (footwall, hanging
        wall) by their names; None where there is no rock on a side."""
        return _areas_by_pair(self.block_names, self.blocks, self.polygon_areas)

    def unrolled(self, points: np.ndarray | None = None) -> np.ndarray:
        """(N, 2) float64: distance along strike and elevation of points (N, 3), or of all vertices. The
        strike line begins at the left end of the fault, seen from the hanging wall."""
        points = self.vertices if points is None else points
        return np.column_stack([self.strike.along(points[:, :2]), points[:, 2]])

    def throw_profile(self, surface: str) -> np.ndarray:
        """(N, 2) float64 distances along strike, rising, and the throw of a surface there: how much lower the
        hanging wall lies, below 0 at a reverse fault. No rows where the fault does not displace it."""
        parts = [
            np.column_stack([self.strike.along(entry.places[:, :2]), entry.throw])
            for entry in self.throws
            if entry.surface == surface
        ]
        rows = np.concatenate([np.empty((0, 2)), *parts])
        return rows[np.argsort(rows[:, 0], kind="stable")]


def _areas_by_pair(names: list[str], blocks: np.ndarray, areas: np.ndarray) -> PairAreas:
    """The sums of areas (K,) by pairs of blocks (K, 2), -1: none."""
    pairs, pair = np.unique(blocks, axis=0, return_inverse=True)
    of_pairs = np.bincount(pair.reshape(-1), areas, len(pairs)).tolist()
    sums: PairAreas = {}
    for (low, high), area in zip(pairs.tolist(), of_pairs, strict=True):
        key = (names[low] if low >= 0 else None, names[high] if high >= 0 else None)
        sums[key] = sums.get(key, 0.0) + area
    return sums


def fault_areas(model: ModelData, number: int) -> PairAreas:
    """As JuxtapositionData.areas, of one of the model's faults by its number; none where it is not there."""
    surface = int(np.flatnonzero(model.surface_kind == 1)[number])
    shape = model.structures.fault_shapes()[number]
    _, arrays = run(lambda work: fault_faces(work, model, surface, shape), threads=model.threads)
    vectors, _ = _vectors(arrays["vertices"][arrays["polygon_vertices"]], arrays["offsets"])
    blocks = np.append(model.cell_block, np.int32(-1))[arrays["cells"]]
    return _areas_by_pair(model.blocks.names, blocks, np.linalg.norm(vectors, axis=1))


def fault_faces(work: Work, model: ModelData, surface: int, shape: FaultShape) -> tuple[np.ndarray, dict]:
    """The numbers (K,) of the faces on a fault, and the arrays of the polygons of a SectionData: each with
    the cell of the footwall first. surface: the fault's global index."""
    faces = np.flatnonzero(model.face_surface == surface)
    straight = np.zeros(len(faces), bool)
    offsets, corners = model.face_corners(faces, straight)
    vectors, middles = _vectors(model.vertices[corners], offsets)
    size = np.sqrt(np.linalg.norm(vectors, axis=1))[:, None]
    beside = middles + _BESIDE * vectors / np.where(size > 0, size, 1.0)
    cells = model.face_cells[faces]
    votes = np.where(fault_sides(work, beside, shape) > 0, 1.0, -1.0) * size[:, 0] ** 2
    second_is_above = _elected(votes, cells)
    offsets, corners = model.face_corners(faces, ~second_is_above)
    used, corners = np.unique(corners, return_inverse=True)
    return faces, {
        "vertices": model.vertices[used],
        "offsets": offsets,
        "polygon_vertices": corners.reshape(-1).astype(np.int32),
        "cells": np.where(second_is_above[:, None], cells, cells[:, ::-1]),
    }


def _elected(votes: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(K,) bool: the second cell of a face is above the fault. votes: (K,) of each face, by its area, above 0
    for yes. All faces of a cell count, as places beside a sliver may lie anywhere."""
    sums = np.zeros(int(cells.max(initial=-1)) + 2)  # the last: outside
    np.add.at(sums, cells[:, 0], votes)
    np.add.at(sums, cells[:, 1], -votes)
    sums[-1] = 0.0
    difference = sums[cells[:, 0]] - sums[cells[:, 1]]
    return np.where(cells[:, 0] == cells[:, 1], votes, difference) > 0


def _vectors(places: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(K, 3) twice: the vector of the area of each polygon, and the middle of its corners."""
    if len(offsets) == 1:
        return np.empty((0, 3)), np.empty((0, 3))
    following = np.arange(1, len(places) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    spokes = places - np.repeat(places[offsets[:-1]], np.diff(offsets), axis=0)
    vectors = np.add.reduceat(np.cross(spokes, spokes[following]), offsets[:-1], axis=0) / 2
    return vectors, np.add.reduceat(places, offsets[:-1], axis=0) / np.diff(offsets)[:, None]


def dip_direction(arrays: dict) -> np.ndarray:
    """(2,) in which a fault dips on the whole, of the arrays of fault_faces."""
    vectors, _ = _vectors(arrays["vertices"][arrays["polygon_vertices"]], arrays["offsets"])
    return vectors.sum(axis=0)[:2]


def cutoff_lines(
    model: ModelData, faces: np.ndarray, cells: np.ndarray, surfaces: list[int]
) -> list[CutoffLine]:
    """The cutoff lines of surfaces, by their global indices, at the faces (K,) on a fault, whose cells (K, 2)
    are those of footwall and hanging wall: the edges that a cell has in a face of both."""
    count, lines = len(model.vertices), []
    of_edges = _edges(model, faces)
    for surface in surfaces:
        on_surface = np.flatnonzero(model.face_surface == surface)
        face, edges = _edges(model, on_surface)
        numbers = edge_numbers(edges, count)
        keys = {
            (cell, number)
            for column in model.face_cells[on_surface].T
            for cell, number in zip(column[face].tolist(), numbers.tolist(), strict=True)
        }
        row, edges = of_edges
        numbers = edge_numbers(edges, count)
        for side, name in enumerate(SIDES):
            of_cells = cells[row, side].tolist()
            is_cut = np.array([key in keys for key in zip(of_cells, numbers.tolist(), strict=True)], bool)
            is_cut &= cells[row, side] >= 0
            _, first = np.unique(numbers[is_cut], return_index=True)
            if len(first):
                ends = model.vertices[edges[is_cut][first]]
                lines.append(CutoffLine(model.surface_names[surface], name, ends))
    return lines


def _edges(model: ModelData, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,) rows of faces and (N, 2) vertices: all their edges."""
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    face = np.repeat(np.arange(len(faces)), np.diff(offsets))
    return face, np.column_stack([corners, corners[following]])
