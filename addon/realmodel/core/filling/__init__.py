# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in any solid: a sculpted cliff, a boulder, a scan, or a terrain down to a base.

Input: a triangulated mesh, and `Strata`, which say how beds lie. Output: the bed of any point (`Beds`),
and a `Model` whose blocks are the beds and together are the mesh.
"""

from .beds import Beds, lay_beds
from .fill import ITEM, closed_mesh, fill_with_strata, fill_within
from .strata import PALETTES, Strata, rocks_of_beds

__all__ = [
    "ITEM",
    "PALETTES",
    "Beds",
    "Strata",
    "closed_mesh",
    "fill_with_strata",
    "fill_within",
    "lay_beds",
    "rocks_of_beds",
]
