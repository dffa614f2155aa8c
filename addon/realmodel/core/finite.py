# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that a double can hold."""

from __future__ import annotations

import math


def is_finite(value: float) -> bool:
    """Whether a number is neither infinite nor NaN, nor a whole number beyond the range of doubles."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
