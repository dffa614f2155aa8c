# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks for numbers that are finite as doubles."""

from __future__ import annotations

import math
from typing import SupportsFloat

import numpy as np


def is_finite(value: SupportsFloat) -> bool:
    """Whether a number is neither infinite nor NaN, nor a whole number beyond the range of doubles."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def is_number(value: object) -> bool:
    """Whether a value is a finite number (a truth value is none)."""
    return (
        isinstance(value, (int, float, np.integer, np.floating))
        and not isinstance(value, bool)
        and is_finite(value)
    )
