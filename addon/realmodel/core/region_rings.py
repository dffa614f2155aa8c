# SPDX-License-Identifier: GPL-3.0-or-later
"""The rings that bound a region in plan: outlines and holes, counted even-odd."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .errors import InputRefused, place_text


def checked_ring(ring, item: str) -> np.ndarray:
    """One ring as (N, 2) float64, neither closed by repeating its first corner nor with repeated corners
    in a row. Raises InputRefused where it bounds nothing."""
    try:
        corners = np.array(ring, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("an outline must be corners [x, y]", item=item) from error
    if corners.ndim != 2 or corners.shape[1] != 2:
        raise InputRefused(f"an outline must be an array (N, 2), not {corners.shape}", item=item)
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=1))
    if len(bad):
        raise InputRefused(f"corner {bad[0]} is {place_text(corners[bad[0]])}, not finite", item=item)
    corners = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]
    if len(np.unique(corners, axis=0)) < 3:
        raise InputRefused("an outline needs at least three different corners", item=item)
    return corners


def region_rings(outline, holes: Iterable = ()) -> list[np.ndarray]:
    """The checked rings of an outline with its holes."""
    rings = [checked_ring(outline, "region")]
    return rings + [checked_ring(hole, f"hole {number}") for number, hole in enumerate(holes, 1)]
