# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and meshes that cannot be meant for a region, as they lie far from it: other coordinates, other
units."""

from __future__ import annotations

import numpy as np

from ..base.errors import InputRefused
from ..base.units import length_text
from ..project.project import surface_item
from .rock_input import RockInput

_FARTHEST = 3.0  # times the extent of points and region
_TOWARDS = ("east", "northeast", "north", "northwest", "west", "southwest", "south", "southeast")


def require_points_near(entry: RockInput, unit: str) -> None:
    """Refuses a surface whose points are all far away from the region of its rock mass, or whose mesh lies
    beside it.

    Points do if the gap between their bounding box and that of the region, in plan, is more than three times
    the diagonals of both; meshes, which say nothing beyond their borders, where there is any. Raises
    InputRefused with the distance.
    """
    rock = entry.rock
    if rock.region is None:
        return
    low, high = _box(np.concatenate(rock.rings()))
    for surface, data in zip(rock.surfaces, entry.data, strict=True):
        is_interpolated = rock.is_interpolated(surface)
        points = data.points if is_interpolated else surface.vertices
        if points is None or not len(points):
            continue
        first, last = _box(points[:, :2])
        gap = np.where(first > high, first - high, np.where(last < low, last - low, 0.0))
        away = float(np.hypot(*gap))
        most = _FARTHEST if is_interpolated else 0.0
        if away > most * max(np.hypot(*(high - low)), np.hypot(*(last - first))):
            towards = _TOWARDS[round(float(np.degrees(np.arctan2(gap[1], gap[0]))) / 45.0) % 8]
            what = "its points lie" if is_interpolated else "its mesh lies"
            raise InputRefused(
                f"{what} {length_text(away, unit)} {towards} of the region",
                item=surface_item(rock, surface),
                file=surface.shape_file,
                advice="check the coordinates and units of both; the region must lie where the surface is",
            )


def farthest(region: np.ndarray, places: np.ndarray) -> tuple[int, float] | None:
    """The place of some (P, 2 or 3) that lies farthest from the bounding box of a region (N, 2) in plan, and
    how far, if that is more than three times the diagonal of the box."""
    low, high = _box(region)
    beyond = np.maximum(np.maximum(low - places[:, :2], places[:, :2] - high), 0.0)
    away = np.hypot(*beyond.T)
    if not (away > _FARTHEST * np.hypot(*(high - low))).any():
        return None
    worst = int(away.argmax())
    return worst, float(away[worst])


def _box(plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return plan.min(axis=0), plan.max(axis=0)
