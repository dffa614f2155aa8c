# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights over the lattice, and the jumps, ulps and disorder that surfaces come with."""

import math

import numpy as np


def plane(rng):
    """z = a x + b y + c with small integers: equal over areas whatever the triangulations are."""
    a, b, c = rng.randint(-1, 1), rng.randint(-1, 1), rng.randint(-2, 3)
    return lambda x, y: float(a * x + b * y + c)


def integers(rng):
    highest = rng.choice([1, 2, 3, 3, 6])
    return lambda x, y: float(rng.randint(0, highest))


def level(rng):
    z = float(rng.randint(-1, 4))
    return lambda x, y: z


def folded(rng):
    """The lower or the higher of two planes at each corner."""
    one, other, pick = plane(rng), plane(rng), rng.choice([min, max])
    return lambda x, y: pick(one(x, y), other(x, y))


def waves(rng):
    terms = [
        (rng.uniform(0.3, 2), rng.uniform(0.3, 2), rng.uniform(0, 6), rng.uniform(0.2, 2)) for _ in range(3)
    ]
    lift = rng.uniform(-1, 2)
    return lambda x, y: lift + sum(h * math.sin(a * x + b * y + s) for a, b, s, h in terms)


def decimals(rng):
    """Three decimals, as a grid file has them."""
    wave = waves(rng)
    return lambda x, y: round(wave(x, y), 3)


def random_heights(rng):
    lift = rng.randint(0, 2)
    return lambda x, y: lift + rng.random()


def magnitudes(rng):
    """1e-6 beside 1e6."""
    sizes = rng.choice([(1e-6, 1e6), (1e-6, 1.0), (1.0, 1e6), (1e-12, 1e-6, 1.0, 1e6)])
    return lambda x, y: rng.randint(-3, 3) * rng.choice(sizes)


HEIGHTS = {
    "plane": plane,
    "integers": integers,
    "level": level,
    "folded": folded,
    "waves": waves,
    "decimals": decimals,
    "random": random_heights,
    "magnitudes": magnitudes,
}


def unwelded(vertices, triangles):
    """Every triangle with corners of its own."""
    vertices = vertices[triangles.ravel()].copy()
    return vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3)


def with_jumps(rng, vertices, triangles):
    """Some triangles, or patches of them, lifted by whole numbers; corners doubled there."""
    lifted = [float(rng.choice([0, 0, 0, 1, 1, -1, 2])) for _ in range(len(triangles))]
    vertices, triangles = unwelded(vertices, triangles)
    vertices[:, 2] += np.repeat(lifted, 3)
    if rng.random() < 0.5:
        vertices, inverse = np.unique(vertices, axis=0, return_inverse=True)
        triangles = inverse.reshape(-1, 3).astype(np.int32)
    return vertices, triangles


def _nudge(rng, value, towards=None):
    """The neighbouring double; beside zero rarely that, mostly a number of the size of rounding errors."""
    towards = towards or rng.choice([-np.inf, np.inf])
    if value == 0 and rng.random() < 0.9:
        return float(np.copysign(2.0**-53, towards))
    return float(np.nextafter(value, towards))


def ulp_heights(rng, vertices):
    """Some heights moved to the neighbouring double, in one direction or in both."""
    vertices = vertices.copy()
    towards = rng.choice([-np.inf, np.inf, None])
    share = rng.choice([0.2, 0.5, 1.0])
    for row in vertices:
        if rng.random() < share:
            row[2] = _nudge(rng, row[2], towards)
    return vertices


def ulp_plan(rng, vertices):
    """Some plan coordinates moved to the neighbouring double (or by 1e-3 rounded decimals)."""
    vertices = vertices.copy()
    share = rng.choice([0.1, 0.4, 1.0])
    decimals_kept = rng.choice([None, None, None, 3])
    for row in vertices:
        for i in (0, 1):
            if rng.random() < share:
                row[i] = (
                    _nudge(rng, row[i])
                    if decimals_kept is None
                    else round(row[i] + rng.choice([0, 0.001]), 3)
                )
    return vertices


def disordered(rng, vertices, triangles):
    """The same surface with vertices and triangles permuted, triangles turned, some vertices doubled."""
    vertices, triangles = vertices.copy(), triangles.copy()
    if rng.random() < 0.4:
        vertices, triangles = unwelded(vertices, triangles)
    if rng.random() < 0.3:
        extra = [rng.randrange(len(vertices)) for _ in range(3)]
        first = len(vertices)
        vertices = np.vstack([vertices, vertices[extra]])
        for double, of in enumerate(extra):
            places = np.argwhere(triangles == of)
            if len(places):
                i, k = places[rng.randrange(len(places))]
                triangles[i, k] = first + double
    order = list(range(len(vertices)))
    rng.shuffle(order)
    position = np.empty(len(order), np.int32)
    position[order] = np.arange(len(order))
    vertices, triangles = vertices[order], position[triangles]
    rows = list(range(len(triangles)))
    rng.shuffle(rows)
    turned = [t[::-1] if rng.random() < 0.5 else t for t in triangles[rows]]
    rolled = [np.roll(t, rng.randrange(3)) for t in turned]
    return vertices, np.array(rolled, np.int32).reshape(-1, 3)


def with_flat_triangles(rng, vertices, triangles):
    """Adds triangles without area: a corner repeated, corners in one line, equal points by other numbers."""
    rows = [tuple(t) for t in triangles]
    for _ in range(rng.randint(1, 3)):
        a, b, _ = rng.choice(rows)
        kind = rng.randrange(3)
        if kind == 0:
            new = (a, b, b)
        else:
            # kind 1: the middle of an edge where the doubles give it exactly; kind 2: a copy of a corner
            middle = vertices[a] + (vertices[b] - vertices[a]) / 2 if kind == 1 else vertices[a]
            exact = np.array_equal(middle - vertices[a], vertices[b] - middle)
            new = (a, len(vertices), b)
            vertices = np.vstack([vertices, middle if exact else vertices[a]])
        rows.insert(rng.randrange(len(rows) + 1), new)
    return vertices, np.array(rows, np.int32)
