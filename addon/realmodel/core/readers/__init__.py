# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of the files that geologists bring: points, meshes, regions."""

from .boreholes import Picks, read_boreholes
from .map_input import MAP_ENDINGS, read_region, read_shapes
from .mesh_file import MESH_ENDINGS, read_mesh
from .off import read_off
from .point_input import RASTER_ENDINGS, read_point_file
from .points import read_points

__all__ = [
    "MAP_ENDINGS",
    "MESH_ENDINGS",
    "RASTER_ENDINGS",
    "Picks",
    "read_boreholes",
    "read_mesh",
    "read_off",
    "read_point_file",
    "read_points",
    "read_region",
    "read_shapes",
]
