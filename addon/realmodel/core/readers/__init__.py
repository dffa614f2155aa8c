# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of input files.

Input: a path and its reading options. Output: points, dips, triangulated surfaces, shapes in plan, picks
of boreholes, blocks at places, in meters, as arrays in memory or in files; damaged files are refused with
their line.
"""

from .borehole_input import read_picks
from .map_input import read_region, read_shapes
from .mesh_input import is_mesh_file, read_mesh
from .meshes.off import read_off
from .object_input import objects_in
from .point_input import PointData, read_point_file, read_points
from .table_kind import TABLE_KINDS, table_contents, table_kind
from .tables.boreholes import Picks
from .tables.dips import (
    dip_warnings,
    gradient_of,
    names_units,
    normal_of,
    read_dips,
    read_dips_of_rock,
    read_space_dips,
)
from .tables.observations import read_observed_places
from .tables.table_preview import TablePreview, preview_table
from .tables.unit_names import UnitNames

__all__ = [
    "TABLE_KINDS",
    "Picks",
    "PointData",
    "TablePreview",
    "UnitNames",
    "dip_warnings",
    "gradient_of",
    "is_mesh_file",
    "names_units",
    "normal_of",
    "objects_in",
    "preview_table",
    "read_dips",
    "read_dips_of_rock",
    "read_mesh",
    "read_observed_places",
    "read_off",
    "read_picks",
    "read_point_file",
    "read_points",
    "read_region",
    "read_shapes",
    "read_space_dips",
    "table_contents",
    "table_kind",
]
