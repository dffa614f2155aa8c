# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of the libraries that notebooks are full of, which are imported when they are needed.

Input: arrays, or rows of a table. Output: a mesh of PyVista, or a DataFrame.
"""

from .frames import data_frame
from .grids import VtkCells, blocks_of_meshes, polygon_mesh, polyhedron_grid, volume_grid, with_data
from .short_repr import ShortRepr

__all__ = [
    "ShortRepr",
    "VtkCells",
    "blocks_of_meshes",
    "data_frame",
    "polygon_mesh",
    "polyhedron_grid",
    "volume_grid",
    "with_data",
]
