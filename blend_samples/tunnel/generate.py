# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the tunnel: picks of four horizons (*.csv), the terrain (ground.asc), and the
closed meshes of the tunnel and of its ventilation shaft (*.off).

    python3 blend_samples/tunnel/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 640.0, 320.0
AXIS = 160.0  # y of the tunnel
HORIZONS = {"gneiss": -34.0, "arkose": 2.0, "sandstone": 36.0, "mudstone": 62.0}  # oldest first: their tops
PICKS = 13, 7  # of each horizon, in x and y
CELL = 10.0  # of the terrain model
RADIUS, WALL = 8.0, 4.0  # of the roof of the tunnel, and the height of its walls


def floor(x):
    """The elevation of the roadway."""
    return 22.0 + 0.012 * x


def horizon(mean, x, y):
    bend = 17.0 * math.sin(x / 88.0 + 0.6) * math.exp(-(((x - 330.0) / 260.0) ** 2))
    return mean - 0.13 * (x - 320.0) + 0.05 * (y - AXIS) + bend + 3.0 * math.sin(y / 47.0)


def ground(x, y):
    ridge = 96.0 * math.exp(-(((x - 315.0 - 0.25 * (y - AXIS)) / 165.0) ** 2))
    gullies = 9.0 * math.sin(y / 31.0 + x / 70.0) * math.exp(-(((x - 320.0) / 150.0) ** 2))
    return 15.0 + ridge + gullies + 3.5 * math.sin(x / 41.0) * math.cos(y / 53.0)


def picks(mean, seed):
    """(x, y, z) of a horizon, spread over the region."""
    chance = random.Random(seed)
    columns, rows = PICKS
    for row in range(rows):
        for column in range(columns):
            x = WIDTH * (column + chance.uniform(0.1, 0.9)) / columns
            y = LENGTH * (row + chance.uniform(0.1, 0.9)) / rows
            yield x, y, horizon(mean, x, y)


def terrain():
    """The lines of an ESRI ASCII grid with its nodes on the border of the region."""
    columns, rows = round(WIDTH / CELL) + 1, round(LENGTH / CELL) + 1
    yield from (f"ncols {columns}", f"nrows {rows}", f"xllcenter {0.0:.1f}", f"yllcenter {0.0:.1f}")
    yield from (f"cellsize {CELL:.1f}", "nodata_value -9999")
    for row in range(rows):
        y = LENGTH - CELL * row
        yield " ".join(f"{ground(CELL * column, y):.2f}" for column in range(columns))


def prism(rings):
    """A closed mesh through rings of as many corners each, counter-clockwise around the way they go."""
    count = len(rings[0])
    corners = [corner for ring in rings for corner in ring]
    faces = []
    for a in range(0, len(corners) - count, count):
        faces += [
            (a + k, a + (k + 1) % count, a + count + (k + 1) % count, a + count + k) for k in range(count)
        ]
    return corners, [tuple(range(count))[::-1], *faces, tuple(range(len(corners) - count, len(corners)))]


def tunnel():
    """A horseshoe, longer than the hill at both ends."""
    arch = [math.pi * k / 10 for k in range(11)]
    profile = [(-RADIUS, 0.0), (RADIUS, 0.0)]
    profile += [(RADIUS * math.cos(a), WALL + RADIUS * math.sin(a)) for a in arch]
    return prism([[(x, AXIS + y, floor(x) + z) for y, z in profile] for x in (-12.0, 652.0)])


def shaft():
    """A round shaft from the roof of the tunnel into the air."""
    around = [math.pi * (2 * k + 0.5) / 12 for k in range(12)]
    return prism(
        [[(300.0 + 3.0 * math.cos(a), AXIS + 3.0 * math.sin(a), z) for a in around] for z in (33.0, 150.0)]
    )


def off(corners, faces):
    lines = ["OFF", f"{len(corners)} {len(faces)} 0", *("{:.3f} {:.3f} {:.3f}".format(*c) for c in corners)]
    return [*lines, *(" ".join(map(str, [len(face), *face])) for face in faces)]


def write(folder):
    files = {
        f"{name}.csv": ["x,y,z", *(f"{x:.1f},{y:.1f},{z:.2f}" for x, y, z in picks(mean, seed))]
        for seed, (name, mean) in enumerate(HORIZONS.items())
    }
    files |= {"ground.asc": terrain(), "tunnel.off": off(*tunnel()), "shaft.off": off(*shaft())}
    for name, lines in files.items():
        (folder / name).write_bytes(("\n".join(lines) + "\n").encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
