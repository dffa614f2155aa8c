# SPDX-License-Identifier: GPL-3.0-or-later
"""Random shapes of faults and bodies, in the space around the unit of all cases: a region of 10 by 10."""

import math

import numpy as np

FAR = 80  # beyond all rock, whichever way a fault runs
KINDS = ("lattice", "plane", "flat", "listric", "overturned", "rough", "wall", "few")


def _grid(nu, nv, rng):
    """Triangles of a grid of nodes, row by row in u, each square divided along one or the other diagonal."""
    at = np.arange(nu * nv).reshape(nu, nv)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    other = np.array([rng.random() < 0.5 for _ in a])[:, None]
    one = np.where(other, np.stack([a, b, d], 1), np.stack([a, b, c], 1))
    two = np.where(other, np.stack([b, c, d], 1), np.stack([a, c, d], 1))
    return np.concatenate([one, two]).astype(np.int32)


def _between(rng, low, high, count):
    """Values from -FAR to FAR, most of them between low and high."""
    inner = sorted(round(rng.uniform(low, high), 2) for _ in range(count))
    return [-FAR, *(x for n, x in enumerate(inner) if n == 0 or x - inner[n - 1] > 0.3), FAR]


def fault_surface(rng, kind, tip=None):
    """Vertices (V, 3) and triangles of a surface that divides all of the space around the rock, and the
    (u, v) of its vertices: along its strike and up its dip. tip: a value of u that a line of edges has."""
    whole = rng.random() < 0.6
    count = (rng.randint(1, 4), rng.randint(1, 4))
    u, v = _between(rng, -9, 9, count[0]), _between(rng, -14, 9, count[1])
    origin = np.array([rng.uniform(2.5, 7.5), rng.uniform(2.5, 7.5), rng.uniform(0, 5)])
    if kind == "few":
        u = v = [-FAR, FAR]
    if kind in ("lattice", "wall"):
        along, up = rng.choice(
            [
                ((0, 1, 0), (0, 0, 1)),
                ((1, 0, 0), (0, 0, 1)),
                ((0, 1, 0), (1, 0, 1)),
                ((1, 1, 0), (0, 0, 1)),
                ((1, 0, 0), (0, 1, 2)),
                ((0, 1, 0), (-2, 0, 1)),
            ]
        )
        origin = np.round(origin)
        if kind == "wall":
            along, up = ((0, 1, 0), (0, 0, 1)) if rng.random() < 0.6 else ((1, 0, 0), (0, 0, 1))
            origin = np.array([rng.choice([0.0, 10.0])] * 2 + [0.0])
        u, v = (sorted({round(x) for x in values}) for values in (u, v))
        along, up = np.array(along, float), np.array(up, float)
    else:
        strike = rng.uniform(0, 2 * math.pi)
        low, high = {"flat": (5, 20), "listric": (45, 70), "overturned": (78, 90)}.get(kind, (35, 90))
        dip = math.radians(rng.uniform(low, high))
        along = np.array([-math.sin(strike), math.cos(strike), 0.0])
        up = np.array([math.cos(dip) * math.cos(strike), math.cos(dip) * math.sin(strike), math.sin(dip)])
        if kind == "plane" and whole:
            along, up = np.round(along, 2), np.round(up, 2)
    if tip is not None:
        u = sorted({*(x for x in u if abs(x - tip) > 0.3), tip})
    if kind == "listric":
        v = _between(rng, -14, 6, 5)
    normal = np.cross(along, up)
    uv = np.array([(a, b) for a in u for b in v], float)
    bend = np.zeros(len(uv))
    near = np.clip(uv[:, 1], -20, 8)
    if kind == "listric":
        bend = rng.uniform(0.005, 0.03) * np.minimum(near - 4, 0) ** 2 * rng.choice([-1, 1])
    elif kind == "overturned":
        bend = rng.uniform(0.3, 0.9) * np.sin(near * rng.uniform(0.3, 0.7) + uv[:, 0] * rng.uniform(0, 0.2))
    elif kind == "rough":
        bend = np.array([rng.uniform(-0.5, 0.5) for _ in uv])
    vertices = origin + uv[:, :1] * along + uv[:, 1:] * up + bend[:, None] * normal
    return vertices, _grid(len(u), len(v), rng), uv


def branch_surface(rng, point, normal):
    """As fault_surface, of a plane that passes the one through a point at right angles to a normal: v is 0
    where they meet; the least v above 0 of a line of edges; and places (N, 3) where the planes meet."""
    strike, dip = rng.uniform(0, 2 * math.pi), math.radians(rng.uniform(35, 90))
    across = np.array([math.sin(dip) * math.cos(strike), math.sin(dip) * math.sin(strike), math.cos(dip)])
    along = np.cross(across, normal)
    along /= np.linalg.norm(along)
    up = np.cross(across, along)
    origin = np.array([rng.uniform(2.5, 7.5), rng.uniform(2.5, 7.5), rng.uniform(0, 5)])
    # to the other plane within its own
    origin = origin + ((point - origin) @ normal / (up @ normal)) * up
    end = rng.choice([0.01, 0.3, 1.0])
    u, v = _between(rng, -9, 9, rng.randint(1, 3)), [-FAR, *rng.choice([[], [-6.0], [-7.0, -3.5]]), end, FAR]
    uv = np.array([(a, b) for a in u for b in v], float)
    vertices = origin + uv[:, :1] * along + uv[:, 1:] * up
    return vertices, _grid(len(u), len(v), rng), uv, end, origin + np.linspace(-20, 20, 400)[:, None] * along


def box(low, high):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    triangles = [
        *([0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]),
        *([2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]),
    ]
    return np.asarray(low) + corners * (np.asarray(high, float) - low), np.array(triangles, np.int32)


def ball(rng, center, radius, rough):
    """A sphere of rings whose nodes lie nearer or farther from its middle."""
    n, m = rng.randint(2, 5), rng.randint(3, 8)
    angles = [math.pi * (k / n - 0.5) for k in range(1, n)]
    rows = [[0.0, 0.0, -1.0]]
    for a in angles:
        for k in range(m):
            t = 2 * math.pi * k / m + 0.1
            far = rng.uniform(1 - rough, 1 + rough)
            rows.append([far * math.cos(a) * math.cos(t), far * math.cos(a) * math.sin(t), far * math.sin(a)])
    rows.append([0.0, 0.0, 1.0])
    last, triangles = len(rows) - 1, []
    for k in range(m):
        turn = (k + 1) % m
        triangles.append([0, 1 + turn, 1 + k])
        for row in range(n - 2):
            a, b = 1 + row * m, 1 + (row + 1) * m
            triangles += [[a + k, a + turn, b + k], [a + turn, b + turn, b + k]]
        triangles.append([last - m + k, last - m + turn, last])
    return center + radius * np.array(rows), np.array(triangles, np.int32)


def torus(rng, center, large, small):
    n, m = rng.randint(3, 7), rng.randint(3, 5)
    tilt = rng.uniform(0, math.pi)
    rows, triangles = [], []
    for i in range(n):
        a = 2 * math.pi * i / n
        for k in range(m):
            t = 2 * math.pi * k / m + 0.2
            far = large + small * math.cos(t)
            rows.append([far * math.cos(a), far * math.sin(a), small * math.sin(t)])
            p, q = i * m + k, ((i + 1) % n) * m + k
            r, s = i * m + (k + 1) % m, ((i + 1) % n) * m + (k + 1) % m
            triangles += [[p, q, s], [p, s, r]]
    c, s = math.cos(tilt), math.sin(tilt)
    turned = np.array(rows) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return center + turned, np.array(triangles, np.int32)


def together(*meshes):
    """Several meshes as one."""
    begin = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    triangles = [triangles + first for (_, triangles), first in zip(meshes, begin, strict=False)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(triangles).astype(np.int32)


def body_mesh(rng, width, top):
    """A closed surface in some position, vertices and triangles: boxes on a lattice or not, balls, rings, two
    parts, a hollow, slabs. width: of all rock along x."""
    center = np.array([rng.uniform(0, width), rng.uniform(0, 10), rng.uniform(-1, top)])
    kind = rng.choice(["lattice", "box", "ball", "ball", "star", "ring", "two", "hollow", "slab", "pit"])
    size = rng.uniform(0.7, 3.0)
    if kind == "lattice":
        low = np.round(center) - [rng.randint(1, 3) for _ in range(3)]
        mesh = box(low, low + [rng.randint(1, 5) for _ in range(3)])
    elif kind == "box":
        low = center - [rng.uniform(0.3, 3) for _ in range(3)]
        mesh = box(low, low + [rng.uniform(0.5, 5) for _ in range(3)])
    elif kind == "slab":
        mesh = box([-3, -3, -0.3], [3, 3, 0.3])
        turn, _ = np.linalg.qr(np.array([[rng.gauss(0, 1) for _ in range(3)] for _ in range(3)]))
        mesh = mesh[0] @ turn + center, mesh[1] if np.linalg.det(turn) > 0 else mesh[1][:, ::-1]
    elif kind == "ring":
        mesh = torus(rng, center, size + 0.5, 0.4 * size)
    elif kind == "two":
        other = center + np.array([rng.uniform(-1, 1) + 2.5 * size, rng.uniform(-1, 1), rng.uniform(-1, 1)])
        mesh = together(ball(rng, center, size, 0.0), ball(rng, other, size, 0.0))
    elif kind == "hollow":
        inner = ball(rng, center, 0.5 * size, 0.1)
        mesh = together(ball(rng, center, 1.7 * size, 0.0), (inner[0], inner[1][:, ::-1]))
    elif kind == "pit":
        low = np.array([*np.round(center[:2], 1), top - rng.uniform(0.5, 5)])
        mesh = box(low, [low[0] + rng.uniform(0.5, 4), low[1] + rng.uniform(0.5, 4), top + 5])
    else:
        mesh = ball(rng, center, size, 0.5 if kind == "star" else 0.0)
    if rng.random() < 0.2:
        mesh = mesh[0], np.ascontiguousarray(mesh[1][:, ::-1])
    return mesh
