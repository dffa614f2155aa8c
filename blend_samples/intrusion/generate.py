# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the intrusion: picks of four horizons (*.csv), the terrain (ground.asc), and the
closed meshes of the granite and the dike (*.off).

    python3 blend_samples/intrusion/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 3000.0, 2400.0
MIDDLE = 1550.0, 1300.0  # of the granite
HORIZONS = {"slate": -560.0, "sandstone": -330.0, "limestone": -160.0, "marl": 30.0}  # oldest first: tops
PICKS = 15, 12  # of each horizon, in x and y
CELL = 50.0  # of the terrain model


def dome(x, y):
    """How far the granite has lifted what lies above it."""
    away = math.hypot((x - MIDDLE[0]) / 780.0, (y - MIDDLE[1]) / 640.0)
    return 430.0 * math.exp(-(away**2))


def horizon(mean, x, y):
    folds = 38.0 * math.sin(x / 330.0 + 0.4) * math.cos(y / 610.0) + 0.05 * (x - MIDDLE[0])
    return mean + folds + dome(x, y)


def ground(x, y):
    hills = 75.0 * math.sin(x / 410.0 + 0.9) * math.cos(y / 370.0 + 0.5) + 26.0 * math.sin(
        (x + 2 * y) / 240.0
    )
    tor = 95.0 * math.exp(-(((x - MIDDLE[0]) / 420.0) ** 2) - ((y - MIDDLE[1]) / 360.0) ** 2)
    valley = 190.0 * math.exp(-(((x - 500.0 - 0.16 * y - 90.0 * math.sin(y / 420.0)) / 260.0) ** 2))
    return 140.0 + hills + tor - valley


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
        yield " ".join(f"{ground(CELL * column, y):.1f}" for column in range(columns))


def granite(around=40, up=26):
    """A stock that widens downward and has bulges; it reaches below the base of the model."""
    x0, y0 = MIDDLE
    rings = []
    for row in range(1, up):
        share = row / up  # from the top down
        down = math.sin(math.pi * share / 2.0)
        for k in range(around):
            angle = 2.0 * math.pi * k / around
            bulge = 1.0 + 0.16 * math.sin(3 * angle + 4.0 * share) + 0.09 * math.cos(5 * angle - 6.0 * share)
            wide = bulge * (130.0 + 470.0 * down**0.9)
            z = 350.0 - 1450.0 * share**1.25 + 40.0 * math.sin(2 * angle) * down
            rings.append((x0 + 1.25 * wide * math.cos(angle), y0 + wide * math.sin(angle), z))
    corners = [(x0, y0, 365.0), *rings, (x0, y0, -1150.0)]
    last = len(corners) - 1
    faces = [(0, 1 + k, 1 + (k + 1) % around) for k in range(around)]
    for row in range(up - 2):
        a, b = 1 + row * around, 1 + (row + 1) * around
        for k in range(around):
            n = (k + 1) % around
            faces += [(a + k, b + k, b + n), (a + k, b + n, a + n)]
    bottom = last - around
    faces += [(last, bottom + (k + 1) % around, bottom + k) for k in range(around)]
    return corners, faces


def dike(along=30, up=16):
    """A dike through granite and layers: a lens that strikes north-east and dips steeply."""
    strike = math.radians(38.0)
    corners = []
    for side in (1.0, -1.0):
        for row in range(up + 1):
            for k in range(along + 1):
                s, h = 2.0 * k / along - 1.0, 2.0 * row / up - 1.0
                thick = 24.0 * math.sqrt(max(0.0, 1.0 - s * s) * max(0.0, 1.0 - h * h))
                distance, z = 1180.0 * s, -430.0 + 760.0 * h
                across = 45.0 * math.sin(2.6 * s + 0.5) + 0.22 * (z - 200.0) - 60.0 + side * thick
                x = 1640.0 + distance * math.cos(strike) - across * math.sin(strike)
                y = 1120.0 + distance * math.sin(strike) + across * math.cos(strike)
                corners.append((x, y, z))
    size, width = (up + 1) * (along + 1), along + 1
    rim = {n for n in range(size) if n % width in (0, along) or n // width in (0, up)}
    faces = []
    for row in range(up):
        for k in range(along):
            a = row * width + k
            for face in ((a, a + 1, a + width + 1), (a, a + width + 1, a + width)):
                faces.append(face[::-1])
                faces.append(tuple(n if n in rim else n + size for n in face))
    used = sorted({n for face in faces for n in face})
    number = {n: at for at, n in enumerate(used)}
    return [corners[n] for n in used], [tuple(number[n] for n in face) for face in faces]


def off(corners, faces):
    lines = ["OFF", f"{len(corners)} {len(faces)} 0", *("{:.2f} {:.2f} {:.2f}".format(*c) for c in corners)]
    return [*lines, *(" ".join(map(str, [len(face), *face])) for face in faces)]


def write(folder):
    files = {
        f"{name}.csv": ["x,y,z", *(f"{x:.1f},{y:.1f},{z:.1f}" for x, y, z in picks(mean, seed))]
        for seed, (name, mean) in enumerate(HORIZONS.items())
    }
    files |= {"ground.asc": terrain(), "granite.off": off(*granite()), "dike.off": off(*dike())}
    for name, lines in files.items():
        (folder / name).write_bytes(("\n".join(lines) + "\n").encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
