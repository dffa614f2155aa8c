# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats of solvers: volume meshes with their materials and patches.

Comes in: a `VolumeMesh` or `PolyhedralMesh`. Goes out: a file, or the folder of a case.
"""
