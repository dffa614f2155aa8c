# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats of solvers: volume meshes with their materials and patches.

Input: a `VolumeMesh` or `PolyhedralMesh`. Output: a file, or the folder of a case.
"""
