# SPDX-License-Identifier: GPL-3.0-or-later
"""Block volumes of a stack in exact arithmetic: the closed form of design.md section 2, integrated.

The plan is divided into convex polygons in each of which every surface is either absent or one
plane, then along the lines on which two planes that are compared have equal height. On what is
left the thickness of every block is linear, so its integral follows from the polygon's moments.
Everything is an integer: doubles are dyadic, so one power of two for the plan and one for the
heights make all input integral; plan points are homogeneous (x, y, w) with w > 0.

Nothing is shared with the program under test. Slow: meant for some surfaces of some ten triangles.
"""

from fractions import Fraction
from itertools import pairwise
from math import gcd

CUTS = {"erosional": True, "conformable": False, "base": False, "discontinuous": True}
PROTECTS = {"erosional": False, "conformable": False, "base": True, "discontinuous": True}


def _power_of_two(values):
    """The least power of two that makes all the doubles integers."""
    return max((float(v).as_integer_ratio()[1] for v in values), default=1)


def _integer(value, scale):
    numerator, denominator = float(value).as_integer_ratio()
    return numerator * (scale // denominator)


def line_through(p, q):
    """(a, b, c): a x + b y + c is positive to the left of the way from p to q, integer plan points."""
    return p[1] - q[1], q[0] - p[0], p[0] * q[1] - p[1] * q[0]


def split(polygon, line):
    """The parts of a convex polygon left and right of a line; None for a part without area."""
    a, b, c = line
    side = [a * x + b * y + c * w for x, y, w in polygon]
    if min(side) >= 0:
        return polygon, None
    if max(side) <= 0:
        return None, polygon
    left, right = [], []
    for i, (q, sq) in enumerate(zip(polygon, side, strict=True)):
        p, sp = polygon[i - 1], side[i - 1]
        if (sp > 0 > sq) or (sp < 0 < sq):
            crossing = _crossing(p, sp, q, sq)
            left.append(crossing)
            right.append(crossing)
        if sq >= 0:
            left.append(q)
        if sq <= 0:
            right.append(q)
    return left, right


def _crossing(p, sp, q, sq):
    if sp < 0:
        p, sp, q, sq = q, sq, p, sp
    x, y, w = (sp * q[i] - sq * p[i] for i in range(3))
    common = gcd(gcd(x, y), w)
    return x // common, y // common, w // common


def moments(polygon):
    """Twice the area, and six times the integrals of x and of y, over a convex polygon: three fractions."""
    x0, y0, w0 = polygon[0]
    area = mx = my = Fraction(0)
    for (x1, y1, w1), (x2, y2, w2) in pairwise(polygon[1:]):
        doubled = Fraction(
            x0 * (y1 * w2 - y2 * w1) - x1 * (y0 * w2 - y2 * w0) + x2 * (y0 * w1 - y1 * w0), w0 * w1 * w2
        )
        area += doubled
        mx += doubled * (Fraction(x0, w0) + Fraction(x1, w1) + Fraction(x2, w2))
        my += doubled * (Fraction(y0, w0) + Fraction(y1, w1) + Fraction(y2, w2))
    return area, mx, my


class ExactTriangle:
    """A triangle with area in plan: its counter-clockwise outline, its edge lines and its plane.

    The plane is z = (a x + b y + c) / d with integers and d > 0.
    """

    def __init__(self, corners):
        p, q, r = corners
        doubled = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        if doubled < 0:
            q, r, doubled = r, q, -doubled
        self.doubled = doubled
        if doubled == 0:
            return
        self.outline = [(p[0], p[1], 1), (q[0], q[1], 1), (r[0], r[1], 1)]
        self.lines = [line_through(p, q), line_through(q, r), line_through(r, p)]
        self.low = min(p[0], q[0], r[0]), min(p[1], q[1], r[1])
        self.high = max(p[0], q[0], r[0]), max(p[1], q[1], r[1])
        if len(p) == 3:
            # each weight is an edge line, which vanishes on the edge opposite its corner
            weights = self.lines[1], self.lines[2], self.lines[0]
            self.plane = (
                *(sum(w[i] * s[2] for w, s in zip(weights, (p, q, r), strict=True)) for i in range(3)),
                doubled,
            )

    def part_inside(self, polygon):
        """(the part of a convex polygon inside, its convex parts outside); (None, [polygon]) where apart."""
        outside = []
        inside = polygon
        for line in self.lines:
            inside, rest = split(inside, line)
            if inside is None:
                return None, [polygon]
            if rest is not None:
                outside.append(rest)
        return inside, outside

    def overlaps(self, other):
        """Whether two triangles share an area in plan."""
        for i in (0, 1):
            if self.high[i] <= other.low[i] or other.high[i] <= self.low[i]:
                return False
        return self.part_inside(other.outline)[0] is not None


def _exact_triangles(vertices, triangles, plan_scale, height_scale):
    rows = []
    for row in vertices:
        x, y = _integer(row[0], plan_scale), _integer(row[1], plan_scale)
        rows.append((x, y, _integer(row[2], height_scale)) if len(row) == 3 else (x, y))
    return [ExactTriangle([rows[int(i)] for i in triangle]) for triangle in triangles]


def flat_triangles(vertices, triangles):
    """Numbers of the triangles without area in plan (vertical ones and those with corners in one line)."""
    scale = _power_of_two(v for row in vertices for v in row[:2])
    exact = _exact_triangles([row[:2] for row in vertices], triangles, scale, 1)
    return [i for i, t in enumerate(exact) if t.doubled == 0]


def double_valued_pairs(vertices, triangles):
    """Pairs (i, j), i < j, of triangles that overlap in plan by an area; exact."""
    scale = _power_of_two(v for row in vertices for v in row[:2])
    exact = _exact_triangles([row[:2] for row in vertices], triangles, scale, 1)
    proper = [(i, t) for i, t in enumerate(exact) if t.doubled]
    return [(i, j) for n, (i, t) in enumerate(proper) for j, u in proper[n + 1 :] if t.overlaps(u)]


class _SplitFirst(Exception):
    """Two planes cross inside the polygon: divide it along the line before going on."""

    def __init__(self, line):
        super().__init__()
        self.line = line


class _Column:
    """Planes over one convex polygon, compared where their order is the same all over it."""

    def __init__(self, polygon):
        self.polygon = polygon

    def order(self, p, q):
        """-1, 0 or 1: p lies below, on or above q over the whole polygon."""
        if p == q:
            return 0
        a, b, c = (p[i] * q[3] - q[i] * p[3] for i in range(3))
        side = [a * x + b * y + c * w for x, y, w in self.polygon]
        low, high = min(side), max(side)
        if low < 0 < high:
            raise _SplitFirst((a, b, c))
        return 1 if high > 0 else -1 if low < 0 else 0

    def higher(self, p, q):
        return p if self.order(p, q) >= 0 else q

    def lower(self, p, q):
        return p if self.order(p, q) <= 0 else q


def _bounds(column, planes, rules, base):
    """For every block that exists over the column (k, lower plane, upper plane)."""
    top = floor = None
    level, before = [], []
    for plane, rule in zip(planes, rules, strict=True):
        before.append(top)
        if plane is None:
            level.append(None)
            continue
        e = plane
        if not CUTS[rule] and top is not None:
            e = column.higher(e, top)
        if floor is not None:
            e = column.higher(e, floor)
        level.append(e)
        top = e
        if PROTECTS[rule]:
            floor = e
    envelope = None
    for k in reversed(range(len(planes))):
        if level[k] is None:
            continue
        envelope = level[k] if envelope is None else column.lower(envelope, level[k])
        under = base if k == 0 else before[k]
        if under is not None and column.order(under, envelope) < 0:
            yield k, under, envelope


def _add_volumes(polygon, planes, rules, base, volumes):
    waiting = [polygon]
    while waiting:
        part = waiting.pop()
        try:
            bounds = list(_bounds(_Column(part), planes, rules, base))
        except _SplitFirst as crossing:
            waiting += [piece for piece in split(part, crossing.line) if piece is not None]
            continue
        if not bounds:
            continue
        area, mx, my = moments(part)
        for k, under, over in bounds:
            for (a, b, c, d), sign in ((over, 1), (under, -1)):
                volumes[k] += sign * (a * mx + b * my + 3 * c * area) / (6 * d)


def block_volumes(surfaces, rules=None, region=None, base_elevation=None):
    """Exact volumes of the blocks, a Fraction for every surface k (block 0 only with a base elevation).

    surfaces: (vertices (V, 3), triangles (T, 3)), oldest first; region: None or (vertices (R, 2), triangles).
    """
    rules = list(rules) if rules else ["erosional"] * len(surfaces)
    plan = [v for vertices, _ in surfaces for row in vertices for v in row[:2]]
    plan += [] if region is None else [v for row in region[0] for v in row]
    heights = [row[2] for vertices, _ in surfaces for row in vertices]
    heights += [] if base_elevation is None else [base_elevation]
    plan_scale, height_scale = _power_of_two(plan), _power_of_two(heights)

    sheets = [_exact_triangles(v, t, plan_scale, height_scale) for v, t in surfaces]
    sheets = [[t for t in sheet if t.doubled] for sheet in sheets]
    cells = [(outline, ()) for outline in _start(region, sheets, plan_scale)]
    for sheet in sheets:
        cells = [cell for outline, planes in cells for cell in _overlay(outline, planes, sheet)]
    base = None if base_elevation is None else (0, 0, _integer(base_elevation, height_scale), 1)
    volumes = [Fraction(0)] * len(surfaces)
    for outline, planes in cells:
        if any(plane is not None for plane in planes):
            _add_volumes(outline, planes, rules, base, volumes)
    return [v / (plan_scale**2 * height_scale) for v in volumes]


def _start(region, sheets, plan_scale):
    """The convex polygons to begin with: the region's triangles, or a rectangle round everything."""
    if region is not None:
        triangles = _exact_triangles(*region, plan_scale, 1)
        return [t.outline for t in triangles if t.doubled]
    everything = [t for sheet in sheets for t in sheet]
    if not everything:
        return []
    x0, y0 = (min(t.low[i] for t in everything) for i in (0, 1))
    x1, y1 = (max(t.high[i] for t in everything) for i in (0, 1))
    return [[(x0, y0, 1), (x1, y0, 1), (x1, y1, 1), (x0, y1, 1)]]


def _overlay(outline, planes, sheet):
    """The polygon divided by one surface's triangles, with that surface's plane (or None) added."""
    remaining = [outline]
    for triangle in sheet:
        rest = []
        for polygon in remaining:
            inside, outside = triangle.part_inside(polygon)
            if inside is not None:
                yield inside, (*planes, triangle.plane)
            rest += outside
        remaining = rest
        if not remaining:
            return
    for polygon in remaining:
        yield polygon, (*planes, None)
