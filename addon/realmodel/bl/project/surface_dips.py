# SPDX-License-Identifier: GPL-3.0-or-later
"""The dips of a surface, a series, a rock mass or a fault, stored in its row."""

from dataclasses import replace

import numpy as np

from ...core import Dips, SpaceDips


def keep(row, dips):
    """Stores realmodel.core.Dips, SpaceDips, or None."""
    has_some = dips is not None and len(dips)
    row.dips = {key: array for key, array in vars(dips).items() if array is not None} if has_some else {}


def add(row, dips):
    """Adds Dips, or SpaceDips, to those that a row has; together with Dips all are of sheets. Raises
    InputRefused where sheets would get a vertical or an overturned one."""
    parts = [part for part in (of_row(row), dips) if part is not None]
    if any(isinstance(part, Dips) for part in parts):
        flat = [part if isinstance(part, Dips) else part.checked().of_sheets() for part in parts]
        keep(row, Dips.joined(flat))
    else:
        keep(row, SpaceDips.joined(parts))


def forget(row, again):
    """Removes the Dips at the places of others."""
    earlier = of_row(row)
    if isinstance(earlier, Dips):
        places = {tuple(place) for place in again.positions.tolist()}
        keep(row, earlier.some(np.array([tuple(p) not in places for p in earlier.positions.tolist()], bool)))


def of_row(row):
    """The stored Dips, or SpaceDips; None where there are none. Raises InputRefused for damaged arrays."""
    return _class(row)(**row.dips) if row.dips else None


def outline_of(row):
    """The same, but empty ones, without a look at the data."""
    return _class(row)(np.empty((0, 3)), np.empty((0, 3))) if row.dips else None


def _class(row):
    return SpaceDips if "normals" in row.dips else Dips


def with_used(dips, number, used):
    """Dips or SpaceDips of which one is switched off, or on."""
    in_use = dips.in_use.copy()
    in_use[number] = used
    return replace(dips, used=None if in_use.all() else in_use)


def moved(dips, number, place):
    """Dips or SpaceDips of which one is at a place (x, y, z); a height that is not known stays so."""
    positions = dips.positions.copy()
    positions[number] = place[: positions.shape[1]]
    if isinstance(dips, SpaceDips):
        return replace(dips, positions=positions)
    z = None if dips.z is None else dips.z.copy()
    if z is not None and not np.isnan(z[number]):
        z[number] = place[2]
    return replace(dips, positions=positions, z=z)


def rename(row, old, new):
    """Gives a surface, and the block beneath it, its new name in the dips of a rock mass."""
    dips = of_row(row)
    if dips is not None:
        surfaces, blocks = (np.where(names == old, new, names) for names in dips.named)
        keep(row, replace(dips, surfaces=surfaces, blocks=blocks))
