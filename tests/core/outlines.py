# SPDX-License-Identifier: GPL-3.0-or-later
"""Nasty outlines of our own making, each with the area of the region that it bounds."""

import numpy as np

# A project file of one flat surface, for `region` in TOML.
PROJECT_OF_REGION = """format = 1
name = "x"
[[rock]]
name = "r"
region = {region}
edge_length = 1
base_elevation = -1
[[rock.surface]]
name = "S0"
method = "constant"
value = 0
"""


def area(ring):
    """Signed area of a ring."""
    x, y = (np.asarray(ring, float) - ring[0]).T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def spikes(count=200, depth=1e-6):
    """A square out of whose top needles rise, `depth` wide at their foot and a thousandth apart."""
    top = []
    for k in range(count):
        x = 1 - (k + 0.5) / count
        top += [(x + depth / 2, 1.0), (x, 1.5), (x - depth / 2, 1.0)]
    return np.array([(0, 0), (1, 0), (1, 1), *top, (0, 1)], float)


def comb(teeth=500, gap=1e-9):
    """Teeth from a spine, with slits of a width near rounding between them."""
    outline = [(0.0, -1.0), (float(teeth), -1.0)]
    for k in range(teeth - 1, -1, -1):
        outline += [(k + 1 - gap, 0.0), (k + 1 - gap, 1.0), (k + gap, 1.0), (k + gap, 0.0)]
    return np.array(outline, float)


def spiral(turns=20, steps=60, width=0.3):
    """A band wound up, one unit from turn to turn."""
    angle = np.linspace(0, 2 * np.pi * turns, turns * steps + 1)
    radius = 1 + angle / (2 * np.pi)
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.concatenate([way * radius[:, None], (way * (radius + width)[:, None])[::-1]])


def near_touching(distance):
    """Two lobes whose tips come within a distance of each other."""
    return np.array(
        [(0, 0), (4, 0), (4, 1.5), (2 + distance / 2, 1.5), (3.9, 1.6), (4, 3), (0, 3), (0.1, 1.6),
         (2 - distance / 2, 1.5), (0, 1.5)]
    )  # fmt: skip


def figure_of_eight():
    """Touches itself in its middle."""
    return np.array([(0, 0), (1, 1), (2, 0), (2, 2), (1, 1), (0, 2)], float)


def inner_loop():
    """Touches itself in a corner, from where an inner loop hangs that leaves a hole."""
    return np.array([(0, 0), (4, 0), (4, 4), (2, 4), (1, 2), (3, 2), (2, 4), (0, 4)], float)


def repeated(outline, times=3):
    """Every corner several times, the first one again at the end."""
    several = np.repeat(outline, times, axis=0)
    return np.concatenate([several, several[:1]])


def squares_in_squares(depth=50):
    """Rings around each other, every second one an island's."""
    return [np.array([(-s, -s), (s, -s), (s, s), (-s, s)], float) for s in range(depth, 0, -1)]


def many_holes(across=100):
    """An outline with across^2 square holes."""
    corners = np.array([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)])
    holes = [corners + np.array([i, j]) for i in range(across) for j in range(across)]
    return np.array([(0, 0), (across, 0), (across, across), (0, across)], float), holes


def star(corners, seed):
    """A random star: simple, with very different edges."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
    return np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.05, 1, (corners, 1))


SQUARE = np.array([(0, 0), (4, 0), (4, 4), (0, 4)], float)

ACCEPTED = {
    "spikes": (spikes(), [], 1 + 200 * 0.25e-6),
    "comb": (comb(), [], 500 + 500 * (1 - 2e-9)),
    "spiral": (spiral(), [], None),
    "near touching": (near_touching(1e-7), [], None),
    "lobes that touch": (near_touching(0.0), [], None),
    "figure of eight": (figure_of_eight(), [], 2.0),
    "inner loop": (inner_loop(), [], 16 - 2.0),
    "repeated corners": (repeated(SQUARE), [repeated([(1, 1), (2, 1), (2, 2)])], 15.5),
    "clockwise": (SQUARE[::-1], [[(1, 1), (2, 1), (2, 2)]], 15.5),
    "far away": (spiral() + np.array([5e6, 7e6]), [], None),
    "hole touches outline in a corner": (SQUARE, [[(0, 0), (2, 1), (1, 2)]], 14.5),
    "hole touches outline in an edge's middle": (SQUARE, [[(2, 0), (3, 1), (1, 1)]], 15.0),
    "holes touch each other": (SQUARE, [[(1, 1), (2, 1), (2, 2)], [(2, 2), (3, 2), (3, 3)]], 15.0),
    "island in a hole": (
        SQUARE, [[(1, 1), (3, 1), (3, 3), (1, 3)], [(1.5, 1.5), (2.5, 1.5), (2.5, 2.5)]], 12.5,
    ),
    "rings in rings": (
        squares_in_squares()[0], squares_in_squares()[1:], 4 * sum(k**2 * (-1) ** k for k in range(51)),
    ),
    "10,000 holes": (*many_holes(), 100 * 100 * 0.75),
    "triangle of one part in 1e12": ([(0, 0), (1, 0), (0.5, 1e-12)], [], 0.5e-12),
}  # fmt: skip

# outline, holes, what is said of it, and the place
REFUSED = {
    "bow tie": ([(0, 0), (4, 4), (4, 0), (0, 4)], [], "crosses itself", (2, 2)),
    "crosses by a hair": ([(0, 0), (4, 0), (4, 4), (2, -1e-9), (0, 4)], [], "crosses itself", None),
    "spike without width": (
        [(0, 0), (4, 0), (4, 4), (2, 4), (2, 9), (2, 4), (0, 4)], [], "runs along itself", (2, 6.5),
    ),
    "twice around": ([*SQUARE, *SQUARE], [], "runs along itself", None),
    "hole outside": (SQUARE, [[(5, 5), (6, 5), (6, 6)]], "does not lie inside its outline", (5, 5)),
    "hole across": (SQUARE, [[(3, 1), (5, 1), (5, 2)]], "crosses", (4, 1)),
    "hole around": (
        SQUARE, [[(-1, -1), (9, -1), (9, 9), (-1, 9)]], "does not lie inside its outline", (-1, -1),
    ),
    "hole is the outline": (SQUARE, [SQUARE], "runs along", None),
    "hole along the outline": (SQUARE, [[(1, 0), (2, 0), (2, 1), (1, 1)]], "runs along", (1.5, 0)),
    "hole outside in the bay": (
        [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)], [[(1.5, 2), (2.5, 2), (2, 3)]],
        "does not lie inside its outline", (1.5, 2),
    ),
    "second hole outside, touching": (
        SQUARE, [[(1, 1), (2, 1), (2, 2)], [(4, 4), (5, 4), (5, 5)]], "hole 2", (4, 4),
    ),
    "all in one line": ([(0, 0), (1, 1), (3, 3), (2, 2)], [], "one line", (0, 0)),
    "one place": ([(1, 1)] * 5, [], "three different corners", (1, 1)),
    "two places": ([(1, 1), (2, 2), (1, 1), (2, 2)], [], "three different corners", (1, 1)),
    "NaN": ([(0, 0), (4, 0), (4, np.nan), (0, 4)], [], "corner 2 is (4, nan)", None),
}  # fmt: skip
