# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects that the tests build, made from formulas."""

import math

import numpy as np
from realmodel.core import Library, Project, Property, Rock, Surface

EAST, NORTH = 377400.25, 5397900.5  # UTM: float32 knows steps of 0.5 m there

LIBRARY = Library(
    [
        Property(1, "Granite", color="#8a2be2", density=2650.0),
        Property(2, "Sandstone", rock="sandstone", age="Triassic", color="#e02020"),
        Property(3, "Marl", color="#20a040", description="grün, weich"),
        Property(4, "Gravel", structure="bedded", color="#e0c020"),
        Property(9, "Unused", color="#123456"),
    ]
)


def at_corner(ring):
    return np.array(ring, float) + np.array([EAST, NORTH])


# An L with a square hole
OUTLINE = at_corner([[0, 0], [100, 0], [100, 35], [60, 35], [60, 70], [0, 70]])
HOLE = at_corner([[20, 20], [20, 30], [32, 30], [32, 20]])


def grid(height, columns=14, rows=10, x0=-6.0, y0=-5.0, width=112.0, depth=80.0, east=EAST, north=NORTH):
    """A triangulated grid: vertices (V, 3) float64 and triangles (T, 3) int32."""
    vertices = []
    for j in range(rows + 1):
        for i in range(columns + 1):
            x, y = x0 + width * i / columns, y0 + depth * j / rows
            vertices.append((east + x, north + y, height(x, y)))
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return np.array(vertices), np.array(triangles, np.int32)


def surface(name, height, **settings):
    vertices, triangles = grid(height, **settings.pop("grid", {}))
    return Surface(name, vertices=vertices, triangles=triangles, **settings)


def _top_of_granite(x, y):
    return 12.0 + 3.0 * math.sin(x / 13.0) * math.cos(y / 17.0)


def _top_of_sandstone(x, y):
    return 20.0 + 0.03 * x + math.cos((x + y) / 11.0)


def _valley(x, y):
    return 27.0 - 16.0 * math.exp(-(((x - 48.0 + 0.2 * y) / 11.0) ** 2))


def main_rock():
    """Five surfaces; the block of "S2" is eroded away again, "S4" has no property."""
    return Rock(
        "hill",
        [
            surface("S0", _top_of_granite, property=1, block="Granite"),
            surface("S1", _top_of_sandstone, property=2),
            surface("S2", lambda x, y: 30.0, property=3, block="Gone"),
            surface("S3", _valley, property=3, grid={"columns": 17, "rows": 9}),
            surface("S4", lambda x, y: max(_valley(x, y) - 1.0, 17.5)),
        ],
        region=OUTLINE,
        holes=[HOLE],
        base_elevation=2.5,
    )


def other_rock():
    """A second rock mass, apart from the first, with surfaces of the same names."""
    apart = {"east": EAST + 160.0, "columns": 6, "rows": 6, "width": 40.0}
    return Rock(
        "outlier",
        [
            surface("S0", lambda x, y: 8.0 + 0.1 * x, property=1, grid=apart),
            surface("S1", lambda x, y: 15.0 + 0.05 * y, property=2, grid=apart),
            surface("S2", lambda x, y: 21.0 + 2.0 * math.sin(x / 6.0), property=4, grid=apart),
        ],
    )


def two_rocks():
    return Project("Zwei Körper", [main_rock(), other_rock()], LIBRARY)


def one_rock():
    return Project("Hill", [main_rock()], LIBRARY)


def interpolated():
    """Two kriged surfaces and one by inverse distance, with every kind of option."""

    def points(height, count):
        places = [(7.0 + 37.0 * n % 89.0, 3.0 + 23.0 * n % 61.0) for n in range(count)]
        return np.array([(EAST + x, NORTH + y, height(x, y)) for x, y in places])

    variogram = {"model": "spherical", "range": 60.0, "sill": 4.0, "nugget": 0.1}
    rock = Rock(
        "hill",
        [
            Surface("S0", points=points(_top_of_granite, 40), method="kriging", property=1),
            Surface(
                "S1",
                points=points(_top_of_sandstone, 50),
                method="kriging",
                options={
                    "neighbours": 12,
                    "variogram": variogram,
                    "anisotropy": {"ratio": 2.0, "azimuth": 30.0},
                },
                property=2,
            ),
            Surface("S2", points=points(_valley, 60), method="idw", options={"power": 3.0}, property=3),
        ],
        region=OUTLINE,
        holes=[HOLE],
        edge_length=6.0,
        base_elevation=0.1,
    )
    return Project("Interpolated", [rock], LIBRARY)
