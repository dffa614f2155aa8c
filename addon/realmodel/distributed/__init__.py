# SPDX-License-Identifier: GPL-3.0-or-later
"""Many builds on several processes or machines, by Dask. Outside of Blender; Dask is an optional dependency.

ensemble_folder    the realizations of a model
tile_folder        a model in tiles of the plan
faulted_folder     one with faults, bodies or fields
tile_inputs        what the tiles are built from
run_folder         the files of a run
workers            the cluster of this machine, and tasks on a cluster in their order
"""

from .ensemble_folder import ensemble
from .tile_folder import build

__all__ = ["build", "ensemble"]
