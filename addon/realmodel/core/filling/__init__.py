# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in any solid: a sculpted cliff, a boulder, a scan, or a terrain down to a base.

Input: a triangulated mesh, and `Strata`, which say how beds lie. Output: the bed of any point (`Beds`),
and a `Model` whose blocks are the beds and together are the mesh. `DifferentialErosion` takes off first what
hard beds do not protect; `rock_shape` makes meshes to begin with.
"""

from .beds import Beds, lay_beds
from .divided import divided_at_beds
from .erosion import DifferentialErosion, eroded_within, joints_at, kept_of, mean_thickness
from .fill import ITEM, closed_mesh, fill_with_strata, fill_within, without_holes
from .rubble import PIECES, broken_piece, rubble_within
from .scree import scree_within
from .shapes import SHAPES, rock_shape
from .strata import PALETTES, Strata, hardness_of_beds, rocks_of_beds

__all__ = [
    "ITEM",
    "PALETTES",
    "PIECES",
    "SHAPES",
    "Beds",
    "DifferentialErosion",
    "Strata",
    "broken_piece",
    "closed_mesh",
    "divided_at_beds",
    "eroded_within",
    "fill_with_strata",
    "fill_within",
    "hardness_of_beds",
    "joints_at",
    "kept_of",
    "lay_beds",
    "mean_thickness",
    "rock_shape",
    "rocks_of_beds",
    "rubble_within",
    "scree_within",
    "without_holes",
]
