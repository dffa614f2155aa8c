# SPDX-License-Identifier: GPL-3.0-or-later
"""Elementary functions for what reaches a model: the same bytes on every system.

Those of `math` and NumPy are of the C library or of the processor, and differ in the last digit. Arguments
are numbers or arrays, angles in radians. Raise BuildFailed where the compiled part is missing.
"""

from __future__ import annotations

import math
from typing import Any

from numpy.typing import ArrayLike

from .work import native_module


def sin(x: ArrayLike) -> Any:
    return native_module().sin(x)


def cos(x: ArrayLike) -> Any:
    return native_module().cos(x)


def exp(x: ArrayLike) -> Any:
    return native_module().exp(x)


def atan2(y: ArrayLike, x: ArrayLike) -> Any:
    return native_module().atan2(y, x)


def hypot(x: ArrayLike, y: ArrayLike) -> Any:
    return native_module().hypot(x, y)


def cube_root(value: float) -> float:
    """Of a number above 0, by Newton's method."""
    root = math.ldexp(1.0, math.frexp(value)[1] // 3)
    for _ in range(20):
        root = (2.0 * root + value / (root * root)) / 3.0
    return root
