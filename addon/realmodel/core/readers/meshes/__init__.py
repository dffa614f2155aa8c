# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces.

Comes in: a file in a format that its content shows. Goes out: vertices (V, 3) float64 and triangles (T, 3)
int32, in memory or in files.
"""
