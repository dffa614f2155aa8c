# SPDX-License-Identifier: GPL-3.0-or-later
"""Signs of determinants of doubles, exact: doubles with an error bound first, fractions in doubt."""

from fractions import Fraction

import numpy as np


def _exact(rows):
    """The sign of the determinant of differences to the last row."""
    points = [[Fraction(float(x)) for x in row] for row in rows]
    m = [[x - y for x, y in zip(row, points[-1], strict=True)] for row in points[:-1]]
    if len(m) == 2:
        value = m[0][0] * m[1][1] - m[0][1] * m[1][0]
    else:
        value = (
            m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
        )
    return (value > 0) - (value < 0)


def _signs(value, bound, rows):
    sign = np.sign(value).astype(np.int8)
    for n in np.flatnonzero(np.abs(value) <= bound):
        sign[n] = _exact([row[n] for row in rows])
    return sign


def turn(a, b, p):
    """(N,) sign: +1 where p is left of the way from a to b in plan; (N, 2) each."""
    a, b, p = (np.broadcast_to(x, np.broadcast_shapes(a.shape, b.shape, p.shape)) for x in (a, b, p))
    u, v = a - p, b - p
    one, two = u[:, 0] * v[:, 1], u[:, 1] * v[:, 0]
    bound = 1e-14 * (np.abs(one) + np.abs(two))
    bound[(a[:, :2] == b[:, :2]).all(axis=1)] = -1.0  # 0 without doubt
    return _signs(one - two, bound, (a, b, p))


def over(a, b, c, p):
    """(N,) sign: +1 where p sees the triangle a, b, c counter-clockwise; (N, 3) each."""
    a, b, c, p = (
        np.broadcast_to(x, np.broadcast_shapes(a.shape, b.shape, c.shape, p.shape)) for x in (a, b, c, p)
    )
    u, v, w = (x - p for x in (a, b, c))
    one, two = v[:, [1, 2, 0]] * w[:, [2, 0, 1]], v[:, [2, 0, 1]] * w[:, [1, 2, 0]]
    value = (u * (one - two)).sum(axis=1)
    bound = 1e-14 * (np.abs(u) * (np.abs(one) + np.abs(two))).sum(axis=1)
    return -_signs(value, bound, (a, b, c, p))


def pairs_of_boxes(low, high, low2, high2):
    """Pairs of boxes (N, d), (M, d) that touch: two arrays of rows."""
    meet = np.ones((len(low), len(low2)), bool)
    for k in range(low.shape[1]):
        meet &= (low[:, None, k] <= high2[None, :, k]) & (high[:, None, k] >= low2[None, :, k])
    return np.nonzero(meet)


def crossings(points, to, corners):
    """How often the ways from points (N, 3) to the point `to` (3,) cross triangles (M, 3, 3): to the side
    that sees them counter-clockwise less to the other one, (N,); and (N,) bool, if none touches an edge."""
    count, clean = np.zeros(len(points), int), np.ones(len(points), bool)
    rows, numbers = pairs_of_boxes(
        np.minimum(points, to), np.maximum(points, to), corners.min(axis=1), corners.max(axis=1)
    )
    if not len(rows):
        return count, clean
    a, b, c = corners[numbers].transpose(1, 0, 2)
    p, q = points[rows], np.broadcast_to(to, (len(rows), 3))
    first, last = over(a, b, c, p), over(a, b, c, q)
    apart = (first * last < 0) | ((first == 0) ^ (last == 0)) | ((first == 0) & (last == 0))
    rows, a, b, c, p, q, first, last = (x[apart] for x in (rows, a, b, c, p, q, first, last))
    turns = np.array([over(p, q, u, v) for u, v in ((a, b), (b, c), (c, a))]).reshape(3, -1)
    out = (turns > 0).any(axis=0) & (turns < 0).any(axis=0)
    touched = ~out & ((turns == 0).any(axis=0) | (first == 0) | (last == 0))
    clean[rows[touched]] = False
    hit = ~out & ~touched
    np.add.at(count, rows[hit], np.where(last[hit] > 0, 1, -1))
    return count, clean


def triangles_over(plan, corners):
    """Pairs of plan points (N, 2) and triangles (M, 3, 2+) that contain them: rows, numbers, and (K,) bool,
    whether the point is on an edge."""
    flat = corners[:, :, :2]
    rows, numbers = pairs_of_boxes(plan, plan, flat.min(axis=1), flat.max(axis=1))
    a, b, c = flat[numbers].transpose(1, 0, 2)
    p = plan[rows]
    turns = np.array([turn(u, v, p) for u, v in ((a, b), (b, c), (c, a))]).reshape(3, -1)
    has_area = (turns != 0).any(axis=0)
    within = has_area & ~((turns > 0).any(axis=0) & (turns < 0).any(axis=0))
    return rows[within], numbers[within], (turns[:, within] == 0).any(axis=0)
