# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats of shapes: OBJ, PLY, STL, glTF, DXF, TSurf.

Comes in: named polygon meshes with a property and a color (`Part`). Goes out: bytes in an open file.
"""
