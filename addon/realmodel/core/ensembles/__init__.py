# SPDX-License-Identifier: GPL-3.0-or-later
"""Many models of one project: what is known of each block when heights are uncertain."""

from .ensemble import PERCENTILES, Ensemble, ensemble
from .places import blocks_at
from .realization import Realizer

__all__ = ["PERCENTILES", "Ensemble", "Realizer", "blocks_at", "ensemble"]
