# SPDX-License-Identifier: GPL-3.0-or-later
"""Which borehole the data of a rock mass come from, and from which depth."""

from __future__ import annotations

import numpy as np

from ..project.project import Rock
from ..readers.tables.observations import Observations

Sources = dict[tuple[float, ...], tuple[str, float | None]]  # by place (x, y, z): hole and depth


def depth_of(value: float) -> float | None:
    """None where a depth is not known, NaN."""
    return None if np.isnan(value) else float(value)


def sources_of(given: Observations) -> Sources:
    """The hole and the depth of places."""
    rows = zip(given.places.tolist(), given.holes.tolist(), given.depths.tolist(), strict=True)
    return {tuple(place): (hole, depth_of(depth)) for place, hole, depth in rows}


def sources_of_rock(rock: Rock) -> Sources:
    """The hole and the depth of places: of observations, and of picks, which have a depth in vertical
    holes."""
    found = {} if rock.observed is None else sources_of(rock.observed)
    for hole, (collar, picks) in rock.hole_picks.items():
        for _, place in picks:
            is_below = collar is not None and tuple(collar[:2]) == tuple(place[:2])
            key = tuple(float(value) for value in place)
            found.setdefault(key, (hole, float(collar[2] - place[2]) if is_below else None))
    return found
