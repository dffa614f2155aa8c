# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of blocks and cells for display.

Input: `ModelData`. Output: polygons with their blocks, their place in the layers as deposited, or fewer
polygons, in the form that Blender takes.
"""
