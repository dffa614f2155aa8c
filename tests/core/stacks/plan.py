# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulations of plan points on a small integer lattice: (points (N, 2) list, triangles list).

All are exactly single-valued in the lattice's own coordinates. rng is a random.Random.
"""

from fractions import Fraction
from itertools import pairwise


def orientation(p, q, r):
    """The sign of the area of p, q, r; exact for doubles."""
    left = (q[0] - p[0]) * (r[1] - p[1])
    right = (q[1] - p[1]) * (r[0] - p[0])
    det = left - right
    if abs(det) > 4e-15 * (abs(left) + abs(right)):
        return 1 if det > 0 else -1
    (ax, ay), (bx, by), (cx, cy) = ((Fraction(v[0]), Fraction(v[1])) for v in (p, q, r))
    det = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (det > 0) - (det < 0)


def lattice(rng, n, diagonals=None):
    """n x n squares, each cut along one of its diagonals, or into four round a middle point."""
    diagonals = diagonals or rng.choice(["rising", "falling", "random", "crossed", "zigzag"])
    points = [(float(i), float(j)) for j in range(n + 1) for i in range(n + 1)]
    triangles = []
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            b, c, d = a + 1, a + n + 2, a + n + 1
            kind = diagonals
            if kind == "random":
                kind = rng.choice(["rising", "falling"])
            elif kind == "zigzag":
                kind = "rising" if (i + j) % 2 else "falling"
            if kind == "rising":
                triangles += [(a, b, c), (a, c, d)]
            elif kind == "falling":
                triangles += [(a, b, d), (b, c, d)]
            else:
                m = len(points)
                points.append((i + 0.5, j + 0.5))
                triangles += [(a, b, m), (b, c, m), (c, d, m), (d, a, m)]
    return points, triangles


def giant(rng, n):
    """The whole square in two triangles, or one triangle round it."""
    if rng.random() < 0.3:
        return [(-1.0 * n, -1.0 * n), (3.0 * n, -1.0 * n), (-1.0 * n, 3.0 * n)], [(0, 1, 2)]
    return lattice_of_size(rng, 1, float(n))


def lattice_of_size(rng, n, size):
    points, triangles = lattice(rng, n)
    return [(x * size / n, y * size / n) for x, y in points], triangles


def triangulate(points):
    """All of a set of distinct points, swept from left to right, with the convex hull covered exactly."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    start = 2
    while start < len(order) and orientation(*(points[order[i]] for i in (0, 1, start))) == 0:
        start += 1
    if start == len(order):
        return []
    line, tip = order[:start], order[start]
    turn = orientation(points[line[0]], points[line[1]], points[tip])
    line = line if turn > 0 else line[::-1]
    triangles = [(p, q, tip) for p, q in pairwise(line)]
    hull = [*line, tip]
    for p in order[start + 1 :]:
        size = len(hull)
        seen = [
            orientation(points[hull[i]], points[hull[(i + 1) % size]], points[p]) < 0 for i in range(size)
        ]
        first = next(i for i in range(size) if seen[i] and not seen[i - 1])
        chain, i = [hull[first]], first
        while seen[i % size]:
            triangles.append((hull[(i + 1) % size], hull[i % size], p))
            i += 1
            chain.append(hull[i % size])
        inner = set(chain[1:-1])
        kept = [v for v in hull if v not in inner]
        at = kept.index(chain[0])
        hull = [*kept[: at + 1], p, *kept[at + 1 :]]
    return triangles


def flip_edges(rng, points, triangles, count):
    """Flips up to count random inner edges whose quadrilateral is strictly convex."""
    triangles = [tuple(t) for t in triangles]
    for _ in range(count):
        owner = {}
        for i, t in enumerate(triangles):
            for k in range(3):
                owner[t[k], t[(k + 1) % 3]] = i, t[(k + 2) % 3]
        inner = [e for e in owner if e[0] < e[1] and (e[1], e[0]) in owner]
        if not inner:
            break
        a, b = rng.choice(inner)
        (i, c), (j, d) = owner[a, b], owner[b, a]
        if (
            orientation(points[c], points[a], points[d]) > 0
            and orientation(points[d], points[b], points[c]) > 0
        ):
            triangles[i], triangles[j] = (c, a, d), (d, b, c)
    return triangles


def scattered(rng, n, count=None):
    """Random points of a lattice (finer than 1 at times) and the square's corners, triangulated at random."""
    step = rng.choice([1, 1, 2, 4])
    every = [(i / step, j / step) for i in range(n * step + 1) for j in range(n * step + 1)]
    count = count or rng.randint(0, 8)
    corners = [(0.0, 0.0), (float(n), 0.0), (float(n), float(n)), (0.0, float(n))]
    if rng.random() < 0.2:
        corners = corners[: rng.randint(0, 3)]
        count = max(count, 4)
    points = list(dict.fromkeys([*corners, *rng.sample(every, min(count, len(every)))]))
    triangles = triangulate(points)
    if not triangles:
        return lattice(rng, n)
    return points, flip_edges(rng, points, triangles, rng.choice([0, 3, 12, 30]))


def fan(rng, n):
    """All triangles round one point: points of the border in order, the tip inside or on the border."""
    side = [i for i in range(n) if i == 0 or rng.random() < 0.6]
    border = [(float(i), 0.0) for i in side] + [(float(n), float(i)) for i in side]
    border += [(float(n - i), float(n)) for i in side] + [(0.0, float(n - i)) for i in side]
    tip = rng.choice([(n / 2, n / 2), (rng.randint(0, 4 * n) / 4, rng.randint(0, 4 * n) / 4), border[0]])
    points = [*border, (float(tip[0]), float(tip[1]))]
    last = len(border)
    triangles = [(i, (i + 1) % last, last) for i in range(last)]
    return points, [t for t in triangles if orientation(*(points[i] for i in t)) > 0]


def bricks(rng, n):
    """Rows of rectangles, each with its own joints: long edges face several short ones (T-junctions)."""
    points, triangles = [], []
    rows = sorted({0, n, *(rng.randint(1, n - 1) for _ in range(rng.randint(1, 3)))}) if n > 1 else [0, 1]
    for low, high in pairwise(rows):
        joints = sorted({0, 2 * n, *(rng.randint(1, 2 * n - 1) for _ in range(rng.randint(0, 3)))})
        for left, right in pairwise(joints):
            a = len(points)
            points += [
                (left / 2, float(low)),
                (right / 2, float(low)),
                (right / 2, float(high)),
                (left / 2, float(high)),
            ]
            if rng.random() < 0.5:
                triangles += [(a, a + 1, a + 2), (a, a + 2, a + 3)]
            else:
                triangles += [(a, a + 1, a + 3), (a + 1, a + 2, a + 3)]
    return points, triangles


def needles(rng, n):
    """Points very close to lines of the lattice, so that triangles are as thin as 1e-6 to 1e-9."""
    thin = rng.choice([1e-6, 1e-7, 1e-8, 1e-9, 2.0**-30])
    points = {(0.0, 0.0), (float(n), 0.0), (float(n), float(n)), (0.0, float(n))}
    for _ in range(rng.randint(1, 5)):
        x, y = rng.randint(0, 2 * n) / 2, rng.randint(0, 2 * n) / 2
        kind = rng.random()
        if kind < 0.4:
            points |= {(x, y), (x, y + thin) if y < n else (x, y - thin)}
        elif kind < 0.7:
            points |= {(0.0, y + thin if y < n else y - thin), (float(n), y)}
        else:
            points |= {(x + thin if x < n else x - thin, 0.0), (x, float(n)), (x, y)}
    points = sorted(points)
    rng.shuffle(points)
    return points, flip_edges(rng, points, triangulate(points), rng.choice([0, 5, 20]))


PLANS = {
    "lattice": lattice,
    "giant": giant,
    "scattered": scattered,
    "fan": fan,
    "bricks": bricks,
    "needles": needles,
    "tiny": lambda rng, n: lattice_of_size(rng, min(4, 2 * n), float(n)),
}


def some_triangles(rng, points, triangles):
    """A part of a triangulation: random holes, an island, a half, all but one, or one alone."""
    kind = rng.choice(["random", "sparse", "island", "half", "hole", "all but one", "one"])
    middle = [tuple(sum(points[i][k] for i in t) / 3 for k in (0, 1)) for t in triangles]
    at = rng.choice(middle)
    reach = rng.choice([0.5, 1.0, 1.5])
    near = [max(abs(m[0] - at[0]), abs(m[1] - at[1])) <= reach for m in middle]
    if kind in ("random", "sparse"):
        keep = [rng.random() < (0.7 if kind == "random" else 0.3) for _ in triangles]
    elif kind in ("island", "hole"):
        keep = [inside == (kind == "island") for inside in near]
    elif kind == "half":
        a, b = rng.choice([(1, 0), (0, 1), (1, 1), (-1, 1), (-1, 0)])
        keep = [a * m[0] + b * m[1] <= a * at[0] + b * at[1] for m in middle]
    else:
        one = rng.randrange(len(triangles))
        keep = [(i == one) == (kind == "one") for i in range(len(triangles))]
    part = [t for t, kept in zip(triangles, keep, strict=True) if kept]
    return part or [rng.choice(triangles)]
