# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for simulation, in the plain form that writers of solvers' formats take."""

from .volume_mesh import CORNERS, PlanMesh, PolyhedralMesh, VolumeMesh

__all__ = ["CORNERS", "PlanMesh", "PolyhedralMesh", "VolumeMesh"]
