# SPDX-License-Identifier: GPL-3.0-or-later
"""Many builds on several processes or machines, by Dask. Outside of Blender; Dask is an optional dependency.

ensemble_folder    the realizations of a model
workers            the cluster of this machine, and tasks on a cluster in their order
"""

from .ensemble_folder import ensemble

__all__ = ["ensemble"]
