# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the quarry: picks of three horizons (*.csv), the terrain (ground.asc), and the
closed meshes of the pit with its benches and of the ramps between them (*.off).

    python3 blend_samples/quarry/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 440.0, 330.0
HORIZONS = {"marl": 58.0, "lower_limestone": 75.0, "marl_band": 79.0, "massive_limestone": 95.0}
LOAM = 2.6  # meters above rockhead, with what the terrain model rounds off
CELL = 10.0  # of the terrain model

# The pit: its floor, counter-clockwise, and benches of one height above it.
FLOOR = ((146, 104), (282, 96), (318, 132), (310, 204), (262, 230), (152, 222), (122, 166))
BOTTOM, BENCH, BENCHES = 62.0, 12.0, 5  # meters; the uppermost bench is higher than the ground
BATTER, BERM = 2.6, 11.0  # how far a face leans back, and the width of a bench
RAMP = 8.5  # its width
RAMPS = ((0, 0, 0.2, 0.85), (1, 4, 0.15, 0.85), (2, 0, 0.1, 0.75))  # bench, side of the floor, from, to


def ground(x, y):
    hill = 9.0 * math.exp(-(((x - 70.0) / 150.0) ** 2) - ((y - 260.0) / 120.0) ** 2)
    return 106.0 + hill - 0.012 * (x - 220.0) + 1.6 * math.sin(x / 37.0 + 0.5) * math.cos(y / 44.0)


def horizon(mean, x, y):
    return mean + 0.028 * (x - WIDTH / 2) - 0.02 * (y - LENGTH / 2) + 1.1 * math.sin(x / 63.0 + y / 90.0)


def picks(mean, seed):
    chance = random.Random(seed)
    for row in range(6):
        for column in range(8):
            x = WIDTH * (column + chance.uniform(0.05, 0.95)) / 8
            y = LENGTH * (row + chance.uniform(0.05, 0.95)) / 6
            z = horizon(mean, x, y)
            if z < ground(x, y) - LOAM:  # elsewhere erosion has removed it
                yield x, y, z


def terrain():
    """The lines of an ESRI ASCII grid with its nodes on the border of the region."""
    columns, rows = round(WIDTH / CELL) + 1, round(LENGTH / CELL) + 1
    yield from (f"ncols {columns}", f"nrows {rows}", f"xllcenter {0.0:.1f}", f"yllcenter {0.0:.1f}")
    yield from (f"cellsize {CELL:.1f}", "nodata_value -9999")
    for row in range(rows):
        y = LENGTH - CELL * row
        yield " ".join(f"{ground(CELL * column, y):.2f}" for column in range(columns))


def outward(a, b):
    """The unit normal of a side of the floor, away from the pit."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    size = math.hypot(dx, dy)
    return dy / size, -dx / size


def ring(away):
    """The corners of the floor moved outwards: where the moved sides meet."""
    found = []
    for k, corner in enumerate(FLOOR):
        n, m = outward(FLOOR[k - 1], corner), outward(corner, FLOOR[(k + 1) % len(FLOOR)])
        share = away / (1.0 + n[0] * m[0] + n[1] * m[1])
        found.append((corner[0] + share * (n[0] + m[0]), corner[1] + share * (n[1] + m[1])))
    return found


def levels():
    """(distance from the floor, elevation) of each ring of the pit, from the bottom."""
    away, up = 0.0, BOTTOM
    for bench in range(BENCHES):
        yield away, up
        away, up = away + BATTER, up + BENCH
        yield away, up
        if bench < BENCHES - 1:
            away += BERM


def pit():
    rings = [[(x, y, up) for x, y in ring(away)] for away, up in levels()]
    count = len(FLOOR)
    corners = [corner for each in rings for corner in each]
    faces = [tuple(range(count))[::-1], tuple(range(len(corners) - count, len(corners)))]
    for a in range(0, len(corners) - count, count):
        for k in range(count):
            after = (k + 1) % count
            faces += [
                (a + k, a + after, a + count + after),
                (a + k, a + count + after, a + count + k),
            ]
    return corners, faces


def ramps():
    """Wedges cut into the faces, from each bench down to the one below."""
    corners, faces = [], []
    for bench, side, first, last in RAMPS:
        low = BOTTOM + BENCH * bench
        away = (BATTER + BERM) * bench
        a, b = ring(away)[side], ring(away)[(side + 1) % len(FLOOR)]
        n = outward(a, b)
        start = len(corners)
        for share, height in ((first, low), (last, low + BENCH)):
            x, y = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
            for out, up in ((-1.0, height), (RAMP, height), (RAMP, low + BENCH + 1), (-1.0, low + BENCH + 1)):
                corners.append((x + out * n[0], y + out * n[1], up))
        sides = [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]
        for face in ((3, 2, 1, 0), (4, 5, 6, 7), *sides):
            faces.append(tuple(start + k for k in face))
    return corners, faces


def off(corners, faces):
    lines = ["OFF", f"{len(corners)} {len(faces)} 0", *("{:.3f} {:.3f} {:.3f}".format(*c) for c in corners)]
    return [*lines, *(" ".join(map(str, [len(face), *face])) for face in faces)]


def write(folder):
    files = {
        f"{name}.csv": ["x,y,z", *(f"{x:.1f},{y:.1f},{z:.2f}" for x, y, z in picks(mean, seed))]
        for seed, (name, mean) in enumerate(HORIZONS.items())
    }
    files |= {"ground.asc": terrain(), "pit.off": off(*pit()), "ramps.off": off(*ramps())}
    for name, lines in files.items():
        (folder / name).write_bytes(("\n".join(lines) + "\n").encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
