# SPDX-License-Identifier: GPL-3.0-or-later
"""Elementary functions, and products, lengths and axes of vectors, for what reaches a model: the same
bytes on every system.
"""

from __future__ import annotations

import math
from typing import Any, SupportsFloat

import numpy as np
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


_ROUNDING = 2.0**-50  # of the lengths of two columns: so small a product, or one of them, is rounding only
_SWEEPS = 60  # over all pairs of columns; six are enough for nearly all points


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) the products of vectors (..., D)."""
    product = np.multiply(a, b)
    if product.shape[-1] not in (2, 3, 4):
        return product.sum(axis=-1)
    # NumPy adds so few numbers in this order, too, but takes several times as long for many of them
    total = product[..., 0] + product[..., 1]
    for k in range(2, product.shape[-1]):
        total += product[..., k]
    return total


def norm(vector: np.ndarray) -> np.ndarray:
    """(...) the lengths of vectors (..., D)."""
    return np.sqrt(dot(vector, vector))


def begins_run(rows: np.ndarray) -> np.ndarray:
    """(N,) bool: the rows (N, ...) that are unlike the one before."""
    begins = np.ones(len(rows), bool)
    begins[1:] = (rows[1:] != rows[:-1]).any(axis=tuple(range(1, rows.ndim)))
    return begins


def ascending(*columns: np.ndarray) -> np.ndarray:
    """(N,) the numbers of rows in ascending order of columns (N,), of which the first counts most. Equal rows
    keep their order, NaN comes last."""
    return np.lexsort(columns[::-1])


def are_among(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(N,) bool: the rows (N, K) that are rows of others (M, K)."""
    members = set(map(tuple, others.tolist()))
    return np.array([tuple(row) in members for row in rows.tolist()], bool)


def ranks_in_runs(sizes: np.ndarray) -> np.ndarray:
    """The numbers from 0 on within each of runs of these sizes (N,), one run after another."""
    return np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)


def twice_area(ring: np.ndarray) -> float:
    """Twice the area of a ring in plan (N, 2): positive where it goes counter-clockwise."""
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def principal_axes(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The principal axes of points (N, D): the spread around their mean along D directions, and these, in
    rows.

    The widest comes first. Directions have length 1 and are orthogonal; the largest component of each is
    positive. The spread is the square root of the sum of the squares, accurate to rounding also where it is
    small (one-sided Jacobi rotations; Demmel and Veselic 1992).
    """
    moved = points - points.mean(axis=0)
    size = float(np.abs(moved).max(initial=0.0)) or 1.0
    columns, axes = list((moved / size).T.copy()), list(np.eye(points.shape[1]))
    pairs = [(p, q) for q in range(len(axes)) for p in range(q)]
    for _ in range(_SWEEPS):
        turned = [_turn(columns, axes, p, q) for p, q in pairs]
        if not any(turned):
            break
    spread = size * norm(np.array(columns))
    order = np.argsort(-spread, kind="stable")
    directions = np.array(axes)[order]
    largest = directions[np.arange(len(directions)), np.abs(directions).argmax(axis=1)]
    return spread[order], directions * np.where(largest < 0, -1.0, 1.0)[:, None]


def _turn(columns: list[np.ndarray], axes: list[np.ndarray], p: int, q: int) -> bool:
    """Rotates two columns to be orthogonal, and their axes with them. Returns whether they were not."""
    one, other = dot(columns[p], columns[p]), dot(columns[q], columns[q])
    both = dot(columns[p], columns[q])
    if min(one, other) <= _ROUNDING**2 * max(one, other) or abs(both) <= _ROUNDING * np.sqrt(one * other):
        return False
    half = float((other - one) / (2 * both))
    tangent = (1.0 if half >= 0 else -1.0) / (abs(half) + hypot(1.0, half))
    cosine = 1.0 / hypot(1.0, tangent)
    for rows in (columns, axes):
        rows[p], rows[q] = cosine * (rows[p] - tangent * rows[q]), cosine * (rows[q] + tangent * rows[p])
    return True


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
