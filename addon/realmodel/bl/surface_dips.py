# SPDX-License-Identifier: GPL-3.0-or-later
"""The dips of a surface, stored in its row."""

from dataclasses import replace

import numpy as np

from ..core import Dips
from . import stored_arrays


def keep(row, dips):
    """Stores realmodel.core.Dips, or None."""
    row.dips = ""
    if dips is not None and len(dips):
        given = {key: each for key, each in vars(dips).items() if each is not None}
        row.dips = stored_arrays.pack(**given)


def add(row, dips):
    """Adds Dips to those that a surface has."""
    known = of_surface(row)
    keep(row, dips if known is None else joined([known, dips]))


def of_surface(row):
    """The stored Dips; None where there are none. Raises InputRefused for damaged text."""
    return Dips(**stored_arrays.unpack(row.dips)) if row.dips else None


def joined(parts):
    """Several Dips, one after another."""
    heights = [np.full(len(part), np.nan) if part.z is None else part.z for part in parts]
    positions, gradients = (
        np.concatenate([getattr(part, key) for part in parts]) for key in ("positions", "gradients")
    )
    used = np.concatenate([np.ones(len(part), bool) if part.used is None else part.used for part in parts])
    return Dips(positions, gradients, np.concatenate(heights), None if used.all() else used)


def with_used(dips, number, used):
    """Dips of which one is switched off, or on."""
    in_use = np.ones(len(dips), bool) if dips.used is None else dips.used.copy()
    in_use[number] = used
    return replace(dips, used=None if in_use.all() else in_use)


def moved(dips, number, place):
    """Dips of which one is at a place (x, y, z); a height that is not known stays so."""
    positions, z = dips.positions.copy(), None if dips.z is None else dips.z.copy()
    positions[number] = place[:2]
    if z is not None and not np.isnan(z[number]):
        z[number] = place[2]
    return replace(dips, positions=positions, z=z)
