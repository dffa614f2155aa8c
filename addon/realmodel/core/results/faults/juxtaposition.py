# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on both sides of a fault: the polygons, areas, cutoff lines and throws of a juxtaposition diagram
(Allan 1989, AAPG Bulletin 73, 803-811)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...base.triangles import edge_numbers, edges_numbered, joined_edges
from ...base.work import Work, run
from ...cells.model_data import ModelData
from ...surfaces.rock_structure import fault_sides
from ..displacements import Displacement
from ..sections.section_data import SectionData
from .strike_line import StrikeLine

FOOTWALL, HANGING_WALL = 0, 1  # columns of `blocks` and `cells`
SIDES = ("footwall", "hanging wall")
_BESIDE = 1e-4  # of the size of a face: how far from it a place is examined
_INWARD = 0.1  # of the way from an edge to the middle of its face


PairAreas = dict[tuple[str | None, str | None], float]


@dataclass(frozen=True, eq=False)
class CutoffLine:
    """Where a fault cuts off a surface on one side. side: "footwall" or "hanging wall". lines: of (N, 3)
    float64 places."""

    surface: str
    side: str
    lines: list[np.ndarray]


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
    _, arrays = run(lambda work: fault_faces(work, model, number), threads=model.threads)
    vectors, _ = _vectors(arrays["vertices"][arrays["polygon_vertices"]], arrays["offsets"])
    blocks = np.append(model.cell_block, np.int32(-1))[arrays["cells"]]
    return _areas_by_pair(model.blocks.names, blocks, np.linalg.norm(vectors, axis=1))


def fault_faces(work: Work, model: ModelData, number: int) -> tuple[np.ndarray, dict]:
    """The numbers (K,) of the faces on one of the model's faults, and the arrays of the polygons of a
    SectionData: each with the cell of the footwall first."""
    faces = np.flatnonzero(model.face_surface == np.flatnonzero(model.surface_kind == 1)[number])
    cells = model.face_cells[faces]
    first, second = _cell_sides(model, cells, number).T
    second_is_above = second > first
    is_open = np.flatnonzero(first == second)
    offsets, corners = model.face_corners(faces[is_open], np.zeros(len(is_open), bool))
    vectors, middles = _vectors(model.vertices[corners], offsets)
    size = np.sqrt(np.linalg.norm(vectors, axis=1))[:, None]
    beside = middles + _BESIDE * vectors / np.where(size > 0, size, 1.0)
    second_is_above[is_open] = fault_sides(work, beside, model.structures.fault_shapes()[number]) > 0
    offsets, corners = model.face_corners(faces, ~second_is_above)
    used, corners = np.unique(corners, return_inverse=True)
    return faces, {
        "vertices": model.vertices[used],
        "offsets": offsets,
        "polygon_vertices": corners.reshape(-1).astype(np.int32),
        "cells": np.where(second_is_above[:, None], cells, cells[:, ::-1]),
    }


def _cell_sides(model: ModelData, cells: np.ndarray, number: int) -> np.ndarray:
    """The sides of a fault on which cells are: -1 below, 1 above; 0 where there is no cell, or one that it
    does not divide."""
    assert model.compartment_sides is not None  # the model has faults
    return np.append(model.compartment_sides[:, number][model.cell_compartment], 0)[cells]


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
    work: Work, model: ModelData, faces: np.ndarray, number: int, surfaces: list[int]
) -> list[CutoffLine]:
    """The cutoff lines of surfaces, by their global indices, at the faces (K,) on a fault: the edges that
    these and the surface have, on the side of the surface's face."""
    count, cutoffs = len(model.vertices), []
    on_fault = edge_numbers(_edges(model, faces)[1], count)
    shape = model.structures.fault_shapes()[number]
    for surface in surfaces:
        on_surface = np.flatnonzero(model.face_surface == surface)
        face, edges = _edges(model, on_surface)
        numbers = edge_numbers(edges, count)
        is_cut = np.isin(numbers, on_fault)
        face, edges, numbers = on_surface[face[is_cut]], edges[is_cut], numbers[is_cut]
        sides = _cell_sides(model, model.face_cells[face], number).sum(axis=1)
        is_open = np.flatnonzero(sides == 0)
        offsets, corners = model.face_corners(face[is_open], np.zeros(len(is_open), bool))
        middles = model.vertices[edges[is_open]].mean(axis=1)
        inward = _vectors(model.vertices[corners], offsets)[1] - middles
        sides[is_open] = fault_sides(work, middles + _INWARD * inward, shape)
        for name, is_here in zip(SIDES, (sides < 0, sides > 0), strict=True):
            once = edges_numbered(np.unique(numbers[is_here]), count)
            if len(once):
                lines = [model.vertices[line] for line in joined_edges(once)]
                cutoffs.append(CutoffLine(model.surface_names[surface], name, lines))
    return cutoffs


def _edges(model: ModelData, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,) rows of faces and (N, 2) vertices: all their edges."""
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    face = np.repeat(np.arange(len(faces)), np.diff(offsets))
    return face, np.column_stack([corners, corners[following]])
