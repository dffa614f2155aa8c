# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats of shapes: OBJ, PLY, STL, glTF, DXF, TSurf.

Input: named polygon meshes with a property and a color (`Part`). Output: bytes in an open file.
"""
