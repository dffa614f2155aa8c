# SPDX-License-Identifier: GPL-3.0-or-later
"""Many builds on several processes or machines, by Dask. Outside of Blender; Dask is an optional dependency.

ensemble_folder    the realizations of a model
tile_folder        a model in tiles of the plan
workers            the cluster of this machine, and tasks on a cluster in their order
"""

from .ensemble_folder import ensemble
from .tile_folder import build

__all__ = ["build", "ensemble"]
