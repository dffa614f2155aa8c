# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces.

Input: a file in a format that its content shows. Output: vertices (V, 3) float64 and triangles (T, 3)
int32, in memory or in files.
"""
