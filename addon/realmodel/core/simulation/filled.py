# SPDX-License-Identifier: GPL-3.0-or-later
"""Models without columns filled with tetrahedra: faults that are not vertical, bodies, cuts."""

from __future__ import annotations

import numpy as np

from ..base.work import Work, native_module
from ..cells.model_data import ModelData
from .native_call import call_native
from .volume_mesh import model_arrays

_FAULT = 1  # of surface_kind


def filled(work: Work, model: ModelData, edge_length: float, tolerance: float, sizes: list[tuple]) -> dict:
    """Tetrahedra of a model: points (P, 3), corners (E, 4), block and compartment (E,), triangles (F, 3)
    outside, between blocks or compartments and on faults, and surface (F,) of these.

    tolerance: how far boundaries may lie from the exact ones, model units. sizes: as local_lengths gives
    them.
    """
    parts = np.stack([model.cell_block, model.cell_compartment], axis=1)
    regions, of_cell = np.unique(parts, axis=0, return_inverse=True)
    made = call_native(
        work,
        native_module().filled_mesh,
        model_arrays(model),
        of_cell.ravel().astype(np.int32),
        (np.asarray(model.surface_kind) == _FAULT).astype(np.uint8),
        edge_length,
        tolerance,
        sizes,
    )
    block, compartment = regions[made["region"]].T.astype(np.int32)
    return {
        "points": made["points"],
        "corners": made["tetrahedra"],
        "block": np.ascontiguousarray(block),
        "compartment": np.ascontiguousarray(compartment),
        "triangles": made["triangles"],
        "surface": made["surface"],
    }


def tetrahedron_volumes(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(E,) float64, positive where corners are in order."""
    a, b, c = (points[corners[:, 1:]] - points[corners[:, :1]]).transpose(1, 0, 2)
    return np.einsum("ij,ij->i", np.cross(a, b), c) / 6


def smallest_dihedral_angle(points: np.ndarray, corners: np.ndarray) -> float:
    """The smallest angle between two faces of a tetrahedron, degrees; 180 without tetrahedra."""
    smallest = np.pi
    for i in range(4):
        for j in range(i + 1, 4):
            k, m = (n for n in range(4) if n not in (i, j))
            edge = points[corners[:, j]] - points[corners[:, i]]
            edge /= np.linalg.norm(edge, axis=1, keepdims=True)
            sides = []
            for n in (k, m):
                side = points[corners[:, n]] - points[corners[:, i]]
                sides.append(side - (side * edge).sum(axis=1, keepdims=True) * edge)
            across = np.linalg.norm(np.cross(*sides), axis=1)
            along = (sides[0] * sides[1]).sum(axis=1)
            smallest = min(smallest, float(np.arctan2(across, along).min(initial=np.pi)))
    return float(np.degrees(smallest))
