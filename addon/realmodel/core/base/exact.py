# SPDX-License-Identifier: GPL-3.0-or-later
"""Signs of determinants of doubles: by arithmetic in doubles where its error bound allows it, else in
rationals (Shewchuk 1997, the filters of his orient2d and orient3d)."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

_EPSILON = np.finfo(np.float64).eps / 2
_BOUND_2D = (3 + 16 * _EPSILON) * _EPSILON
_BOUND_3D = (7 + 56 * _EPSILON) * _EPSILON
_SMALLEST = 1e-290  # below it products lose bits


def orient2d(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """(N,) int: +1 where p (N, 2) lies left of the line from a to b, -1 right of it, 0 on it."""
    left, right = (a[:, 0] - p[:, 0]) * (b[:, 1] - p[:, 1]), (a[:, 1] - p[:, 1]) * (b[:, 0] - p[:, 0])
    value = left - right
    sign = np.sign(value).astype(np.int8)
    unsure = np.abs(value) <= _BOUND_2D * (np.abs(left) + np.abs(right)) + _SMALLEST
    for n in np.flatnonzero(unsure):
        sign[n] = _sign(_determinant([_difference(a[n], p[n]), _difference(b[n], p[n])]))
    return sign


def orient3d(a: np.ndarray, b: np.ndarray, c: np.ndarray, p: np.ndarray) -> np.ndarray:
    """(N,) int: +1 where p (N, 3) lies on the side of the triangle a, b, c from which it is seen
    counter-clockwise, -1 on the other side, 0 in its plane."""
    rows = [a - p, b - p, c - p]
    value, size = np.zeros(len(p)), np.zeros(len(p))
    for (u, v), w in (((0, 1), 2), ((1, 2), 0), ((2, 0), 1)):
        left, right = rows[u][:, 0] * rows[v][:, 1], rows[v][:, 0] * rows[u][:, 1]
        value += rows[w][:, 2] * (left - right)
        size += np.abs(rows[w][:, 2]) * (np.abs(left) + np.abs(right))
    sign = -np.sign(value).astype(np.int8)
    unsure = np.abs(value) <= 2 * _BOUND_3D * size + _SMALLEST
    for n in np.flatnonzero(unsure):
        exact = _determinant([_difference(corner[n], p[n]) for corner in (a, b, c)])
        sign[n] = -_sign(exact)
    return sign


def _difference(corner, origin) -> list[Fraction]:
    return [Fraction(float(x)) - Fraction(float(y)) for x, y in zip(corner, origin, strict=True)]


def _determinant(rows: list[list[Fraction]]) -> Fraction:
    if len(rows) == 2:
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _sign(value: Fraction) -> int:
    return (value > 0) - (value < 0)
