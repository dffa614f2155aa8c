# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions in plan: degrees clockwise from north (+y), or a point of the compass."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..base.algebra import cos, sin
from .method_options import OptionRefused

COMPASS = {name: 45.0 * number for number, name in enumerate(("N", "NE", "E", "SE", "S", "SW", "W", "NW"))}
_QUARTERS = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))


def checked_direction(option: str, value: Any) -> float | str | None:
    """A direction as it is used: degrees, or a key of COMPASS. Raises OptionRefused."""
    if value is None:
        return None
    name = value.strip().upper() if isinstance(value, str) else None
    if name in COMPASS:
        return name
    try:
        degrees = math.nan if name is not None or isinstance(value, bool) else float(value)
    except (OverflowError, TypeError, ValueError):
        degrees = math.nan
    if not math.isfinite(degrees):
        raise OptionRefused(
            f"'{option}' must be a direction, not {value!r}",
            option=option,
            advice=f"write degrees clockwise from north, or one of {', '.join(COMPASS)}",
        )
    return degrees


def unit_vector(degrees: float) -> np.ndarray:
    """(2,) the vector of length 1 in a direction; exact along the axes."""
    if degrees % 90.0 == 0.0:
        return np.array(_QUARTERS[int(degrees // 90.0) % 4])
    angle = math.radians(degrees % 360.0)  # so that 361 is the same as 1
    return np.array([sin(angle), cos(angle)])


def degrees_text(vector: np.ndarray) -> str:
    """The direction of a vector (2,) for messages, in whole degrees."""
    return f"{round(math.degrees(math.atan2(vector[0], vector[1]))) % 360}"


def gradient_of(dip: float, dip_direction: float) -> np.ndarray:
    """(2,) the slope along x and y of a plane that dips so many degrees, below 90, in a direction in degrees
    clockwise from north (+y)."""
    angle = math.radians(dip)
    return -(sin(angle) / cos(angle)) * unit_vector(dip_direction) + 0.0  # no -0


def normal_of(dip: float, dip_direction: float, is_overturned: bool = False) -> np.ndarray:
    """(3,) the normal, toward younger rock, of bedding that dips so many degrees, up to 180, in a direction
    in degrees clockwise from north (+y). Beyond 90 degrees it is overturned in any case."""
    angle = math.radians(dip)
    down = np.zeros(2) if dip in (0, 180) else sin(angle) * unit_vector(dip_direction)
    upright = np.array([*down, cos(angle)])
    return -upright if is_overturned and dip <= 90 else upright
