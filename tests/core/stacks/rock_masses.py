# SPDX-License-Identifier: GPL-3.0-or-later
"""Random rock masses side by side: triangles of one plan mesh dealt out as regions, each with its own stack.

Their borders are shared exactly, in whole edges or in parts of edges; a rock mass may enclose another.
"""

import numpy as np

from .case import as_region, as_surface
from .generate import placement, random_stack, single_valued
from .plan import PLANS, some_triangles

STACKS = ("own lattices", "partial", "jumps", "coinciding", "rules", "general", "regions", "T-junctions")


def random_rock_masses(rng, largest=3):
    """Two or three stacks whose regions share borders and no area; on the lattice, or placed elsewhere."""
    size = rng.randint(1, largest)
    masses = []
    for region in _dealt(rng, size):
        stack = random_stack(rng, rng.choice(STACKS), size)
        stack.region = as_region(*region)
        masses.append(stack)
    if rng.random() < 0.5:  # at rounded coordinates its long edge would overlap the short ones
        masses.append(_neighbour(rng, size))
    elif rng.random() < 0.5 and "general" not in (stack.label for stack in masses):
        _place_together(masses, placement(rng, rng.choice(("decimal", "utm", "rotated"))))
    return masses


def _dealt(rng, size):
    """Regions (vertices, triangles) dealt out from one plan mesh; one may be meshed again more coarsely."""
    plan = rng.choice(("lattice", "scattered", "fan"))
    points, triangles = PLANS[plan](rng, size)
    count = rng.choice((2, 2, 3))
    if rng.random() < 0.5:
        owner = [rng.randrange(count) for _ in triangles]
    else:  # one connected piece or a half for the first, the rest for the others
        first = set(some_triangles(rng, points, triangles))
        owner = [0 if t in first else rng.randrange(1, count) for t in triangles]
    points = np.array(points)
    regions = []
    for k in range(count):
        own = np.array([t for t, o in zip(triangles, owner, strict=True) if o == k], np.int32)
        if len(own):
            used, inverse = np.unique(own, return_inverse=True)
            regions.append((points[used], inverse.reshape(-1, 3)))
    return regions


def _neighbour(rng, size):
    """A stack beside the square: its region's one long edge faces several shorter ones."""
    stack = random_stack(rng, rng.choice(STACKS), size)
    stack.surfaces = [as_surface(v + np.array([float(size), 0, 0]), t) for v, t in stack.surfaces]
    corners = [(size, 0), (2 * size, 0), (2 * size, size), (size, size)]
    stack.region = as_region(corners, [(0, 1, 2), (0, 2, 3)])
    return stack


def _place_together(masses, place):
    """Moves all rock masses by one map; bases stay below."""
    for stack in masses:
        placed = [(place(v), t) for v, t in stack.surfaces]
        stack.surfaces = [as_surface(v, single_valued(v, t)) for v, t in placed]
        region = np.column_stack([stack.region[0], np.zeros(len(stack.region[0]))])
        stack.region = as_region(place(region)[:, :2], stack.region[1])
        if stack.base_elevation is not None:
            lowest = min(v[:, 2].min() for v, _ in stack.surfaces)
            stack.base_elevation = float(lowest - 1.0)
