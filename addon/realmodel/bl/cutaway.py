# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutting closed meshes open with a vertical plane, for pictures.

Works on triangle soups in NumPy. The cut is filled by the even-odd rule, which needs no loops to be
found and so cannot fail where a block touches itself.
"""

import numpy as np


def keep_behind(triangles, normal, offset):
    """The part of a closed triangle soup behind the plane normal . p = offset, its cut filled.

    triangles: (T, 3, 3) float64. normal: (3,), horizontal, of length 1.
    Returns (N, 3, 3) float64: the kept part, clipped triangles, and the fill.
    """
    normal = np.asarray(normal, np.float64)
    distance = triangles @ normal - offset
    outside = distance > 0.0  # a corner on the plane counts as kept: no case is left between the two
    count = outside.sum(axis=1)
    kept = triangles[count == 0]
    one, two = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    # Turn each crossing triangle so that its odd corner, alone on its side, comes first.
    first = np.concatenate([outside[one].argmax(axis=1), (~outside[two]).argmax(axis=1)]).astype(np.int64)
    crossing = np.concatenate([one, two])
    rows = np.arange(len(crossing))[:, None]
    turn = (first[:, None] + np.arange(3)) % 3
    corner = triangles[crossing][rows, turn]
    d = distance[crossing][rows, turn]
    to_b = corner[:, 0] + (d[:, 0] / (d[:, 0] - d[:, 1]))[:, None] * (corner[:, 1] - corner[:, 0])
    to_c = corner[:, 0] + (d[:, 0] / (d[:, 0] - d[:, 2]))[:, None] * (corner[:, 2] - corner[:, 0])
    m = len(one)
    quads = (
        np.stack([to_b[:m], corner[:m, 1], corner[:m, 2]], axis=1),
        np.stack([to_b[:m], corner[:m, 2], to_c[:m]], axis=1),
    )
    tips = np.stack([corner[m:, 0], to_b[m:], to_c[m:]], axis=1)
    fill = fill_section(np.stack([to_b, to_c], axis=1), normal, offset)
    return np.concatenate([kept, *quads, tips, fill])


def fill_section(segments, normal, offset):
    """Triangles that fill the area bounded by segments in a vertical plane, by the even-odd rule.

    segments: (M, 2, 3) float64, closed curves in the plane normal . p = offset. The plane is divided
    into upright strips at all ends of segments; in each the segments are sorted by height and the
    space between the first and second, third and fourth, ... is filled. Returns (N, 3, 3), facing
    along the normal.
    """
    along = np.array([-normal[1], normal[0], 0.0])
    u, z = segments @ along, segments[:, :, 2]
    order = np.argsort(u, axis=1)
    u, z = np.take_along_axis(u, order, axis=1), np.take_along_axis(z, order, axis=1)
    upright = u[:, 0] == u[:, 1]
    u, z = u[~upright], z[~upright]
    if not len(u):
        return np.empty((0, 3, 3))
    strips = np.unique(u)
    begin, end = np.searchsorted(strips, u[:, 0]), np.searchsorted(strips, u[:, 1])
    segment = np.repeat(np.arange(len(u)), end - begin)
    strip = np.arange(len(segment)) - np.repeat(np.cumsum(end - begin) - (end - begin), end - begin)
    strip += begin[segment]
    slope = ((z[:, 1] - z[:, 0]) / (u[:, 1] - u[:, 0]))[segment]
    left = z[segment, 0] + slope * (strips[strip] - u[segment, 0])
    right = z[segment, 0] + slope * (strips[strip + 1] - u[segment, 0])
    order = np.lexsort((left + right, strip))
    strip, left, right = strip[order], left[order], right[order]
    rank = np.arange(len(strip)) - np.searchsorted(strip, strip)
    lower = np.flatnonzero(rank[:-1] % 2 == 0)
    lower = lower[strip[lower] == strip[lower + 1]]

    def place(at, height):
        return np.outer(at, along) + normal * offset + np.outer(height, [0.0, 0.0, 1.0])

    a = place(strips[strip[lower]], left[lower])
    b = place(strips[strip[lower] + 1], right[lower])
    c = place(strips[strip[lower] + 1], right[lower + 1])
    d = place(strips[strip[lower]], left[lower + 1])
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[normals.any(axis=1)]
