# SPDX-License-Identifier: GPL-3.0-or-later
"""Random projects with faults and bodies, from a number: each is to be built, or to be refused for a reason
that the case names.

Heights are drawn for each surface and each combination of sides of the faults that displace it, and points
and meshes are taken from them where they lie on these sides.
"""

import itertools
import random

import numpy as np

from . import shapes, signs
from .case import BodyCase, Case, FaultCase, RockCase, SurfaceCase
from .contract import FaultSides
from .located import distances

RULES = ("erosional", "erosional", "conformable", "base", "discontinuous")
STEP = 2.0  # between surfaces, about
BASE = -14.0
TOP = 24.0  # of a surface above everything
PLACES = [(1.0, (0, 0, 0))] * 5 + [  # scale, shift
    (100.0, (452000.0, 6201000.0, -1800.0)),
    (0.1, (0, 0, 0)),
    (40.115, (4500000.37, 5300000.11, 311.7)),
]
FADES = 3.0  # so far from where a fault is not its throw is less
PLANES = ("lattice", "plane", "flat", "few")
BRANCHES = 0.25  # of faults after a plane
RAGGED = 0.3  # of faults that reach no farther than they must


class _Side(FaultSides):
    """Sides of a fault of a case, with the normals of its first triangle upward."""

    def __init__(self, fault):
        a, b, c = fault.vertices[fault.triangles[0]]
        super().__init__(fault, np.cross(b - a, c - a))


def random_case(seed):
    rng = random.Random(f"structures {seed}")
    rocks = 1 if rng.random() < 0.75 else 2
    counts = [rng.randint(1, 6) if rng.random() < 0.3 else rng.randint(2, 4) for _ in range(rocks)]
    names = [[f"{'STUV'[r]}{k}" for k in range(count)] for r, count in enumerate(counts)]
    if rocks == 2 and rng.random() < 0.3:
        names[1] = [f"S{k}" for k in range(counts[1])]  # both have surfaces of these names
    masses = [RockCase(["left", "right"][r], []) for r in range(rocks)]
    made = _faults(rng, names, masses)
    covered = [_fill(rng, rock, r, names, made) for r, rock in enumerate(masses)]
    bodies = _bodies(rng, names, masses)
    is_full = all(covered) and rng.random() < 0.4
    if is_full:
        for r, rock in enumerate(masses):
            vertices, triangles = _plan(rng)
            nodes = np.clip(vertices, 0, 10) + np.array([10.0 * r, 0.0])
            level = np.column_stack([nodes, np.full(len(nodes), TOP)])
            rock.surfaces.append(SurfaceCase("top", "conformable", vertices=level, triangles=triangles))
    case = Case(masses, [fault for fault, _ in made], bodies, rng.choice(["columns", "columns", "blocks"]))
    case.label = str(seed)
    case.is_full = is_full and not any(body.void and body.after is None for body in bodies)
    _place(rng, case)
    return case


def _youngest(rock, names, fault):
    """The number of the youngest surface of a rock mass that a fault displaces, -1 for none."""
    if fault.rocks and rock.name not in fault.rocks:
        return -1
    if fault.youngest is None:
        return len(names) - 1
    return names.index(fault.youngest) if fault.youngest in names else -1


def _faults(rng, names, masses):
    """(FaultCase, throw) each."""
    found, planes = [], []
    for n in range(rng.choice([0, 1, 1, 1, 2, 2, 3])):
        if planes and rng.random() < BRANCHES:
            fault = _branch_of_plane(rng, n, rng.choice(planes), len(masses))
            if fault is not None:
                found.append((fault, _throw(rng)))
                continue
        kind = rng.choice(shapes.KINDS)
        dies_out = kind not in ("listric", "overturned", "rough", "wall") and rng.random() < 0.3
        tip = rng.uniform(-2, 2) if dies_out else None
        vertices, triangles, uv = shapes.fault_surface(rng, kind, tip)
        fault = FaultCase(f"F{n}", vertices, triangles, np.zeros((0, 3), np.int32), dies_out=dies_out)
        if rng.random() < 0.5:
            fault.youngest = rng.choice(rng.choice(names))
        if len(masses) > 1 and rng.random() < 0.4:
            r = rng.randrange(len(masses))
            if fault.youngest is None or fault.youngest in names[r]:
                fault.rocks = [masses[r].name]
        own = np.ones(len(triangles), bool)
        if dies_out:
            own &= (uv[triangles, 0] <= tip + 1e-9).all(axis=1)
        elif found and rng.random() < 0.4:
            _branch(rng, fault, found, own)
        if not fault.ends_at and rng.random() < 0.4:  # no farther than it must reach
            own &= _needed(vertices, triangles, uv, len(masses), rng.random() < RAGGED)
        fault.triangles, fault.beyond = triangles[own], triangles[~own]
        if len(fault.triangles):
            found.append((fault, _throw(rng)))
            if kind in PLANES and (dies_out or not len(fault.beyond)):
                planes.append(fault)
    return found


def _throw(rng):
    return rng.choice([0.0, 0.5, 1.0, -1.0, rng.uniform(-1.6, 1.6)])


def _needed(vertices, triangles, uv, masses, ragged):
    """(T,) the triangles of a fault near the rock; their border runs along lines of its grid or is ragged."""
    low, high = np.array([-2.0, -2, BASE - 3]), np.array([10.0 * masses + 2, 12, 25])
    corners = vertices[triangles]
    near = ((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=1)
    if ragged or not near.any():
        return near
    own = uv[triangles]
    first, last = own[near].min(axis=(0, 1)), own[near].max(axis=(0, 1))
    return ((own >= first) & (own <= last)).all(axis=(1, 2))


def _areas(corners):
    """Twice those of triangles (T, 3, 3)."""
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


def _branch(rng, fault, found, own):
    """Lets a fault end at another one."""
    other, _ = rng.choice(found)
    if other.dies_out or len(other.beyond):
        return
    beside = _Side(other)(fault.vertices[fault.triangles].mean(axis=1))
    corner = _Side(other)(fault.vertices)
    kept = rng.choice([-1, 1])
    reaches = (corner[fault.triangles] * kept >= 0).any(axis=1) | (beside == kept)
    if reaches.all() or not reaches.any():
        return
    # beyond the other fault it goes on for some triangles, but for no larger part
    area = _areas(fault.vertices[fault.triangles])
    crossed = reaches & (corner[fault.triangles] * kept <= 0).any(axis=1)
    if area[crossed].sum() > 0.3 * area[reaches].sum():
        return
    if _comes_back(fault, reaches, other):
        return
    fault.ends_at = [other.name]
    fault.youngest, fault.rocks = other.youngest, list(other.rocks)
    own &= reaches


def _branch_of_plane(rng, number, other, masses):
    """A fault that ends at a plane, and may die out as that does; None where it does not pass that itself
    among the surfaces."""
    a, b, c = other.vertices[other.triangles[0]]
    vertices, triangles, uv, end, line = shapes.branch_surface(rng, a, np.cross(b - a, c - a))
    own = (uv[triangles, 1] <= end).all(axis=1)
    dies_out = other.dies_out and rng.random() < 0.4
    if dies_out:
        tip = rng.choice(sorted(set(uv[:, 0]))[1:-1])
        own &= (uv[triangles, 0] <= tip).all(axis=1)
    fault = FaultCase(f"F{number}", vertices, triangles[own], triangles[~own], dies_out=dies_out)
    fault.ends_at, fault.youngest, fault.rocks = [other.name], other.youngest, list(other.rocks)
    line = line[((line > [0, 0, -1]) & (line < [10.0 * masses, 10, 5])).all(axis=1)]
    met = [distances(line, each.vertices[each.triangles]) < 1e-6 for each in (fault, other)]
    return fault if np.all(met, axis=0).sum() > 2 else None


def _border(triangles):
    """The edges (a, b) that one triangle alone has."""
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return set(map(tuple, edges[count == 1].tolist()))


def _comes_back(fault, reaches, other):
    """Whether the line at which a branch is cut off passes the other fault: it would end before that."""
    corners = other.vertices[other.triangles]
    for a, b in _border(fault.triangles[reaches]) - _border(fault.triangles):
        begin, end = fault.vertices[[a]], fault.vertices[b]
        if any(signs.crossings(begin, end, each[None])[0].any() for each in corners):
            return True
    return False


def _fill(rng, rock, r, names, made):
    """Gives a rock mass its region, its base and its surfaces. Whether it has a base, and a region that the
    oldest of them covers."""
    x0 = 10.0 * r
    ring = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    if r == 0 and rng.random() < 0.2:
        ring = np.array([[0.0, 0], [10, 0], [10, 10], [6, 10], [5.5, 4], [4, 10], [0, 10]])
    shift = np.array([x0, 0.0])
    rock.rings = [ring + shift]
    if rng.random() < 0.15:
        rock.rings.append(np.array([[3.0, 3], [4, 3], [4, 5], [3.5, 5.5]]) + shift)
    rock.edge_length = rng.choice([2.5, 3.5, 5.0])
    rock.base_elevation = BASE if rng.random() < 0.7 else None
    interpolates = rng.random() < 0.6
    if not interpolates and r == 0 and rng.random() < 0.4:
        rock.rings, rock.edge_length = [], None
    sides = [_Side(fault) for fault, _ in made]
    faults = [fault for fault, _ in made]
    shared = _plan(rng) if rng.random() < 0.5 else None
    is_covered = bool(rock.rings) and rock.base_elevation is not None
    for k, name in enumerate(names[r]):
        active = [f for f, fault in enumerate(faults) if _youngest(rock, names[r], fault) >= k]
        height = _height(rng, k, [(made[f][1], _tips(faults, f)) for f in active])
        surface = SurfaceCase(name, rng.choice(RULES) if rng.random() < 0.6 else "erosional")
        own = [(faults[f], sides[f]) for f in active]
        if interpolates and rng.random() < 0.8:
            surface.points = _points(rng, own, height, x0)
            surface.method = rng.choice([None, None, "natural_neighbour", "idw", "dsi"])
        if surface.points is None or len(surface.points) < 4:
            surface.points = surface.method = None
            torn = bool(active) and rng.random() < 0.5
            is_covered &= k > 0 or not torn
            plan = shared if shared is not None and rng.random() < 0.7 else _plan(rng)
            surface.vertices, surface.triangles = _mesh(rng, own, height, plan, x0, torn, bool(rock.rings))
            if k and rng.random() < 0.3:
                surface.triangles = _with_gaps(rng, surface)
        rock.surfaces.append(surface)
    if all(surface.points is None for surface in rock.surfaces):
        rock.edge_length = None
    return is_covered


def _tips(faults, number):
    """(T, 3, 3) beyond the tips of a fault, and of those at which it ends: there it displaces nothing."""
    fault = faults[number]
    named = [fault, *(other for other in faults if other.name in fault.ends_at)]
    return np.concatenate([np.empty((0, 3, 3)), *(f.vertices[f.beyond] for f in named if f.dies_out)])


def _height(rng, k, faults):
    """Heights of surface k at plan points, by the sides of the faults that displace it. faults: (throw, what
    is beyond the tip) of each."""
    level = STEP * k + (rng.uniform(-2.5, 0.5) if rng.random() < 0.4 else 0.0)
    if rng.random() < 0.3:
        level = round(level)
    kind = rng.choice(["level", "level", "slope", "waves", "rough"])
    a, b, c = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15), rng.uniform(0, 6)
    seed = rng.randrange(10**6)

    def at(plan, row):
        x, y = plan.T
        z = np.full(len(plan), level)
        if kind == "slope":
            z = z + a * x + b * y
        elif kind == "waves":
            z = z + 0.5 * np.sin(x * 0.7 + c) * np.cos(y * 0.6)
        elif kind == "rough":
            z = z + 0.6 * np.random.default_rng(seed).uniform(-1, 1, len(plan))
        for side, (throw, beyond) in zip(row, faults, strict=True):
            share = 1.0
            if len(beyond):
                at_level = np.column_stack([plan, np.full(len(plan), level)])
                away = distances(at_level, beyond)
                share = np.clip(away / FADES, 0, 1) ** 2
            z = z + throw * side / 2 * share
        return np.round(z, 6)

    return at


def _rows(own):
    return itertools.product(*(((-1, 0, 1) if fault.ends_at else (-1, 1)) for fault, _ in own))


def _sides(own, points):
    """(N, F) sides of some faults of points, 0 beyond the faults that they end at."""
    rows = np.array([side(points) for _, side in own]).reshape(len(own), -1).T
    names = [fault.name for fault, _ in own]
    for f, (fault, side) in enumerate(own):
        for name in fault.ends_at:
            if name in names:
                other = names.index(name)
                middles = side.own.mean(axis=1)
                kept = 1 if (own[other][1](middles) * _areas(side.own)).sum() > 0 else -1
                rows[rows[:, other] == -kept, f] = 0
    return rows


def _points(rng, own, height, x0):
    random_source = np.random.default_rng(rng.randrange(10**9))
    plan = np.round(random_source.uniform([x0, 0], [x0 + 10, 10], (rng.choice([12, 40, 120]), 2)), 4)
    found = []
    for row in _rows(own):
        points = np.column_stack([plan, height(plan, row)])
        found.append(points[(_sides(own, points) == row).all(axis=1)] if own else points)
    points = np.concatenate(found)
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    return points[np.sort(first)] if rng.random() < 0.5 else points


def _plan(rng):
    """A mesh in plan that covers more than the region, or the region alone."""
    low, high = rng.choice([(0, 10), (0, 10), (-1, 11)])
    n = rng.choice([1, 2, 4, 5])
    at = [low + (high - low) * k / n for k in range(n + 1)]
    plan = np.array([(x, y) for x in at for y in at])
    if rng.random() < 0.4:
        inner = ((plan > low) & (plan < high)).all(axis=1)
        moves = np.array([[rng.uniform(-0.2, 0.2) for _ in range(2)] for _ in plan]) * (high - low) / n
        plan = np.round(plan + moves * inner[:, None], 3)
    return plan, shapes._grid(n + 1, n + 1, rng)


def _mesh(rng, own, height, plan, x0, torn, has_region):
    nodes, triangles = plan
    if not has_region or x0 > 0:  # beside another rock mass surfaces end at the wall
        nodes = np.clip(nodes, 0, 10)
    nodes = nodes + np.array([x0, 0.0])
    if not torn:
        row = (0,) * len(own)
        return np.column_stack([nodes, height(nodes, row)]), triangles
    found = []
    for row in _rows(own):
        vertices = np.column_stack([nodes, height(nodes, row)])
        inside = (_sides(own, vertices) == row).all(axis=1)
        kept = triangles[inside[triangles].all(axis=1)]
        if len(kept):
            used, number = np.unique(kept, return_inverse=True)
            found.append((vertices[used], number.reshape(-1, 3)))
    if not found:
        return _mesh(rng, own, height, plan, x0, False, has_region)
    return shapes.together(*found)


def _with_gaps(rng, surface):
    middles = surface.vertices[surface.triangles].mean(axis=1)
    at = middles[rng.randrange(len(middles))]
    away = np.linalg.norm((middles - at)[:, :2], axis=1)
    kept = away > rng.uniform(0.1, 3) if rng.random() < 0.5 else middles[:, 0] < at[0] + 0.1
    return surface.triangles[kept] if kept.any() else surface.triangles


def _bodies(rng, names, masses):
    found = []
    top = STEP * max(len(each) for each in names)
    for n in range(rng.choice([0, 0, 1, 1, 2, 3])):
        vertices, triangles = shapes.body_mesh(rng, 10.0 * len(masses), top)
        body = BodyCase(f"B{n}", vertices, np.ascontiguousarray(triangles), void=rng.random() < 0.3)
        if rng.random() < 0.6:
            body.after = rng.choice(rng.choice(names))
        if len(masses) > 1 and rng.random() < 0.3:
            r = rng.randrange(2)
            if body.after is None or body.after in names[r]:
                body.rock = masses[r].name
        found.append(body)
    return found


def _place(rng, case):
    """Moves a case as a whole: to the size of projected coordinates, or smaller."""
    scale, shift = rng.choice(PLACES)
    if scale == 1.0:
        return
    shift = np.array(shift)
    for entry in (*case.faults, *case.bodies, *(s for rock in case.rocks for s in rock.surfaces)):
        if getattr(entry, "points", None) is not None:
            entry.points = entry.points * scale + shift
        if entry.vertices is not None:
            entry.vertices = entry.vertices * scale + shift
    for rock in case.rocks:
        rock.rings = [ring * scale + shift[:2] for ring in rock.rings]
        rock.edge_length = None if rock.edge_length is None else rock.edge_length * scale
        if rock.base_elevation is not None:
            rock.base_elevation = float(rock.base_elevation * scale + shift[2])
