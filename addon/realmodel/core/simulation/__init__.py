# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for simulation, in a plain form for the writers of solvers' formats.

Input: the cells and surfaces of a model, and edge lengths. Output: a `SimulationMesh` of elements that
share their faces, or `CleanedCells` without small details.
"""

from .cleaned_cells import CleanedCells, cleaned_cells, cleaned_entry
from .simulation_mesh import SimulationMesh, mesh_entry, simulation_mesh
from .volume_mesh import CORNERS, PlanMesh, PolyhedralMesh, VolumeMesh

__all__ = [
    "CORNERS",
    "CleanedCells",
    "PlanMesh",
    "PolyhedralMesh",
    "SimulationMesh",
    "VolumeMesh",
    "cleaned_cells",
    "cleaned_entry",
    "mesh_entry",
    "simulation_mesh",
]
