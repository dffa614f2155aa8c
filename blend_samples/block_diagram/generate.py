# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the block diagram: picks of a folded horizon (fold.csv) and of an unconformity
(unconformity.csv), and the terrain (ground.asc).

    python3 blend_samples/block_diagram/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 9000.0, 6000.0
CELL = 100.0  # of the terrain model


def fold(x, y):
    """An anticline between two synclines; their axes run north to south and plunge to the south."""
    across = (x - 700.0 - 0.22 * y) / 2300.0
    tighter = across - 0.22 * math.sin(across)
    return -400.0 + 0.075 * (y - 3000.0) + 390.0 * math.sin(2.0 * math.pi * tighter / 1.85)


def unconformity(x, y):
    """Nearly level: what was left when the folds had been eroded."""
    return 265.0 - 0.017 * (x - 4500.0) + 0.012 * (y - 3000.0) + 12.0 * math.sin(x / 1300.0)


def river(x):
    return 2350.0 + 620.0 * math.sin(x / 1500.0 + 0.8) + 0.1 * x


def ground(x, y):
    away = (y - river(x)) / 1150.0
    valley = 330.0 * math.exp(-away * away)
    brooks = 70.0 * math.sin(x / 520.0 + 0.5) * math.sin(x / 1450.0) * (1.0 - math.exp(-away * away))
    hills = 34.0 * math.sin(x / 800.0 + y / 610.0) + 22.0 * math.cos(y / 430.0 - x / 1250.0)
    return 415.0 + 0.02 * (y - 3000.0) - 0.008 * (x - 4500.0) + hills + brooks - valley


def picks(height, columns, rows, seed):
    chance = random.Random(seed)
    yield "x,y,z"
    for row in range(rows):
        for column in range(columns):
            x = WIDTH * (column + chance.uniform(0.1, 0.9)) / columns
            y = LENGTH * (row + chance.uniform(0.1, 0.9)) / rows
            yield f"{x:.0f},{y:.0f},{height(x, y):.1f}"


def terrain():
    """The lines of an ESRI ASCII grid with its nodes on the border of the region."""
    columns, rows = round(WIDTH / CELL) + 1, round(LENGTH / CELL) + 1
    yield from (f"ncols {columns}", f"nrows {rows}", f"xllcenter {0.0:.1f}", f"yllcenter {0.0:.1f}")
    yield from (f"cellsize {CELL:.1f}", "nodata_value -9999")
    for row in range(rows):
        y = LENGTH - CELL * row
        yield " ".join(f"{ground(CELL * column, y):.1f}" for column in range(columns))


def write(folder):
    files = {
        "fold.csv": picks(fold, 24, 8, 1),
        "unconformity.csv": picks(unconformity, 9, 6, 2),
        "ground.asc": terrain(),
    }
    for name, lines in files.items():
        (folder / name).write_bytes(("\n".join(lines) + "\n").encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
