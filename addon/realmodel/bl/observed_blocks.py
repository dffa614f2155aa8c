# SPDX-License-Identifier: GPL-3.0-or-later
"""The observations of blocks of a rock mass, stored in its row."""

import numpy as np

from ..core import Observations
from . import stored_arrays

_NAMES = ("places", "blocks", "holes", "depths")


def keep(row, observations):
    """Stores realmodel.core.Observations, or None."""
    row.observations = ""
    if observations is not None and len(observations):
        row.observations = stored_arrays.pack(**{name: getattr(observations, name) for name in _NAMES})


def of_rock(row):
    """The stored Observations; None where there are none. Raises InputRefused for damaged text."""
    if not row.observations:
        return None
    arrays = stored_arrays.unpack(row.observations)
    return Observations(*(arrays[name] for name in _NAMES))


def rename(row, old, new):
    """Gives the blocks beneath a surface, or a body, its new name."""
    found = of_rock(row)
    if found is not None and (found.blocks == old).any():
        blocks = np.where(found.blocks == old, new, found.blocks)
        keep(row, Observations(found.places, blocks, found.holes, found.depths))
