# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks by family. Each family leans on one kind of degenerate position; "mixture" takes them all.

random_stack(rng, family) works with any random.Random: a plain one (the hunt) or Hypothesis's own.
Every stack is accepted input: single-valued surfaces, a base below everything.
"""

import math
from fractions import Fraction

import numpy as np

from . import heights as height
from .case import Stack, as_region, as_surface
from .plan import PLANS, lattice, some_triangles
from .rational import double_valued_pairs, flat_triangles

# Those that the outside checker knows; the native fuzzer draws from all there are.
RULES = ("erosional", "conformable", "base", "discontinuous")

CONFORMING = ("lattice", "scattered", "fan")
USUAL = {
    "plans": ("lattice", "scattered", "fan"),  # of each surface
    "shared": 0.3,  # chances from here on: all surfaces on one plan mesh
    "heights": ("integers", "plane", "folded"),
    "partial": 0.0,  # a surface covers a part only
    "jumps": 0.0,
    "repeated": 0.0,  # a surface takes over its predecessor's mesh and heights, perhaps changed a little
    "ulp_heights": 0.0,
    "ulp_plan": 0.0,
    "flat": 0.0,  # triangles without area
    "disorder": 0.3,
    "region": 0.0,
    "base": 0.25,
    "placements": ("lattice",),
    "surfaces": (2, 5),
    "apart": 0.0,  # a surface moved aside by whole steps
    "rules": 0.0,  # each surface has a rule of its own
}

FAMILIES = {
    "shared lattice": {"plans": ("lattice",), "shared": 1.0, "heights": ("integers",)},
    "own lattices": {"shared": 0.0, "heights": ("integers", "plane", "folded", "level")},
    "partial": {"partial": 0.8},
    "jumps": {"jumps": 0.7, "partial": 0.2},
    "coinciding": {"heights": ("plane", "level", "folded"), "repeated": 0.5, "partial": 0.3},
    "ulp apart": {
        "repeated": 0.7,
        "ulp_heights": 0.7,
        "heights": ("plane", "decimals", "random", "integers"),
    },
    "ulp borders": {
        "partial": 0.6,
        "repeated": 0.4,
        "ulp_plan": 0.7,
        "region": 0.4,
        "placements": ("lattice", "decimal", "utm", "rotated"),
    },
    "needles": {"plans": ("needles", "needles", "lattice"), "shared": 0.2, "partial": 0.2, "region": 0.2},
    "utm": {
        "placements": ("utm", "rotated"),
        "heights": ("decimals", "integers", "plane", "waves"),
        "partial": 0.2,
        "region": 0.2,
    },
    "magnitudes": {"heights": ("magnitudes", "magnitudes", "integers", "random"), "partial": 0.2},
    "giant over tiny": {"plans": ("giant", "tiny", "giant", "scattered"), "shared": 0.0, "partial": 0.1},
    "T-junctions": {"plans": ("bricks", "bricks", "lattice"), "partial": 0.2, "jumps": 0.2},
    "disorder": {"flat": 0.6, "disorder": 1.0, "partial": 0.3, "jumps": 0.3},
    "regions": {"region": 1.0, "partial": 0.2, "base": 0.5},
    "apart": {"apart": 0.8, "surfaces": (1, 4), "partial": 0.3, "base": 0.5},
    "general": {
        "heights": ("waves", "random", "decimals"),
        "placements": ("decimal", "lattice"),
        "region": 0.2,
    },
    "rules": {"rules": 1.0, "partial": 0.3, "surfaces": (2, 6), "base": 0.5, "repeated": 0.2},
    "rules in general": {
        "rules": 1.0,
        "heights": ("waves", "random", "decimals"),
        "partial": 0.3,
        "jumps": 0.2,
        "region": 0.3,
        "base": 0.5,
        "placements": ("lattice", "decimal", "utm", "rotated"),
    },
    "mixture": {
        "rules": 0.3,
        "plans": tuple(PLANS),
        "heights": tuple(height.HEIGHTS),
        "partial": 0.3,
        "jumps": 0.2,
        "repeated": 0.3,
        "ulp_heights": 0.2,
        "ulp_plan": 0.2,
        "flat": 0.1,
        "region": 0.3,
        "placements": ("lattice", "decimal", "utm", "rotated"),
        "apart": 0.1,
        "surfaces": (1, 6),
    },
}


def placement(rng, kind):
    """A map from the lattice to model coordinates, plan and height; its rounding is part of the test."""
    if kind == "lattice":
        return lambda v: v.copy()
    turn = 30 if kind == "rotated" else 0
    c, s = (float(np.sqrt(0.75)), 0.5) if turn else (1.0, 0.0)
    step = (
        rng.choice([0.1, 1.0, 12.34, 40.115, 1 / 3])
        if kind != "decimal"
        else rng.choice([0.1, 1 / 3, 1e-3, 700.1])
    )
    origin = (0.0, 0.0) if kind == "decimal" else (4.5e6 + rng.random(), 5.3e6 + rng.random())
    lift, stretch = rng.choice([(0.0, 1.0), (-1700.0, 0.1), (0.0, 0.01), (311.7, 1.0)])

    def place(v):
        x, y = v[:, 0] * step, v[:, 1] * step
        return np.stack(
            [origin[0] + c * x - s * y, origin[1] + s * x + c * y, lift + stretch * v[:, 2]], axis=1
        )

    return place


def single_valued(vertices, triangles):
    """The triangles that are left when the later of each two that overlap is dropped; flat ones stay."""
    flat = set(flat_triangles(vertices, triangles))
    vertical = {i for i in flat if len({tuple(vertices[k]) for k in triangles[i]}) == 3}
    dropped = {j for _, j in double_valued_pairs(vertices, triangles)}
    # three different corners in one plan line may stand upright; only those in one line of space may stay
    dropped |= {i for i in vertical if _has_area(vertices[triangles[i]])}
    return triangles[[i for i in range(len(triangles)) if i not in dropped]]


def _has_area(corners):
    if corners.shape[1] == 2:
        return False
    a, b, c = ([Fraction(float(x)) for x in row] for row in corners)
    u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
    return any(u[i] * v[j] != u[j] * v[i] for i, j in ((0, 1), (1, 2), (2, 0)))


def random_stack(rng, family, largest=3):
    """A stack of the family named, made with a random.Random, on a lattice of at most largest^2 squares."""
    how = {**USUAL, **FAMILIES[family]}

    def chance(name):
        return how[name] > 0 and rng.random() < how[name]

    size = rng.randint(1, largest)
    where = rng.choice(how["placements"])
    place = placement(rng, where)
    if where in ("utm", "rotated"):  # slopes of 1e6 there: no double can say where such a plane lies
        how["heights"] = tuple(kind for kind in how["heights"] if kind != "magnitudes")
    shared = PLANS[rng.choice(how["plans"])](rng, size) if chance("shared") else None
    surfaces, previous = [], None
    for _ in range(rng.randint(*how["surfaces"])):
        raw = _raw_surface(rng, how, chance, shared, size, previous)
        previous = raw
        vertices, triangles = place(raw[0]), raw[1]
        if chance("ulp_heights"):
            vertices = height.ulp_heights(rng, vertices)
        if chance("ulp_plan"):
            vertices = height.ulp_plan(rng, vertices)
        if chance("flat"):
            vertices, triangles = height.with_flat_triangles(rng, vertices, triangles)
        if chance("disorder"):
            vertices, triangles = height.disordered(rng, vertices, triangles)
        triangles = single_valued(vertices, triangles)
        surfaces.append(as_surface(vertices, triangles))
    region = random_region(rng, size, place, shared, chance("ulp_plan")) if chance("region") else None
    base = base_below(rng, surfaces) if chance("base") else None
    rules = [rng.choice(RULES) for _ in surfaces] if chance("rules") else []
    return Stack(surfaces, region, base, rules, family)


def _raw_surface(rng, how, chance, shared, size, previous):
    """Vertices and triangles in lattice coordinates."""
    if previous is not None and chance("repeated"):
        vertices, triangles = previous[0].copy(), previous[1].copy()
        for _ in range(rng.choice([0, 0, 1, 3])):
            vertices[rng.randrange(len(vertices)), 2] += rng.choice([-1, 1, 1, 2])
        if rng.random() < 0.3:
            plan = [tuple(row) for row in vertices[:, :2]]
            triangles = np.array(some_triangles(rng, plan, [tuple(t) for t in triangles]), np.int32)
        return vertices, triangles
    points, triangles = shared or PLANS[rng.choice(how["plans"])](rng, size)
    z = height.HEIGHTS[rng.choice(how["heights"])](rng)
    vertices = np.array([(x, y, z(x, y)) for x, y in points])
    if chance("apart"):
        vertices[:, :2] += [rng.randint(-size, size), rng.randint(-size, size)]
    if chance("partial"):
        triangles = some_triangles(rng, points, triangles)
    triangles = np.array(triangles, np.int32)
    if chance("jumps"):
        vertices, triangles = height.with_jumps(rng, vertices, triangles)
    return vertices, triangles


def random_region(rng, size, place, shared, nudged):
    """A region as a conforming triangulation: whole, concave, with holes, in parts, on the lattice or off."""
    plan = rng.choice(CONFORMING)
    points, triangles = shared if shared and rng.random() < 0.3 else PLANS[plan](rng, size)
    if rng.random() < 0.6:
        triangles = some_triangles(rng, points, triangles)
    stretch, shift = rng.choice([(1, 0), (1, 0), (1, 0), (0.75, 0.125), (2, -0.5), (0.3, 0.1), (1, 1 / 3)])
    vertices = np.array([(stretch * x + shift, stretch * y + shift, 0.0) for x, y in points])
    vertices = place(vertices)
    if nudged:
        vertices = height.ulp_plan(rng, vertices)
    triangles = single_valued(vertices, np.array(triangles, np.int32))
    flat = set(flat_triangles(vertices, triangles))
    keep = [i for i in range(len(triangles)) if i not in flat]
    if not keep:
        return None
    used, inverse = np.unique(triangles[keep], return_inverse=True)
    return as_region(vertices[used, :2], inverse.reshape(-1, 3))


def base_below(rng, surfaces):
    """An elevation under all vertices that triangles use: just below, a little, or far."""
    lowest = min((v[t, 2].min() for v, t in surfaces if len(t)), default=0.0)
    return float(
        rng.choice(
            [np.nextafter(lowest, -np.inf), lowest - 1.0, lowest - 1.0, np.floor(lowest) - 2.0, lowest - 1e6]
        )
    )


def sine_surface(rng, cells, size, lift, amplitude, shift=0.0):
    """A surface of cells x cells squares with jittered nodes of its own; a sum of sines by math.sin."""
    terms = [
        (rng.uniform(1, 4), rng.uniform(1, 4), rng.uniform(0, 2 * math.pi), rng.uniform(0.3, 1))
        for _ in range(4)
    ]
    points, triangles = lattice(rng, cells, "random")
    step = size / cells
    vertices = []
    for x, y in points:
        u, v = x * step, y * step
        if 0 < x < cells:
            u += rng.uniform(-0.2, 0.2) * step
        if 0 < y < cells:
            v += rng.uniform(-0.2, 0.2) * step
        angle = 2 * math.pi / size
        z = lift + amplitude * sum(h * math.sin(angle * (a * u + b * v) + s) for a, b, s, h in terms)
        vertices.append((u + shift, v + shift, z))
    return as_surface(vertices, triangles)
