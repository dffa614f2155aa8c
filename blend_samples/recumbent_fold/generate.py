# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the recumbent fold: contacts of three beds in twelve boreholes (*.csv), fifty
dips with polarity (dips.csv), and points of an unconformity and of the ground.

    python3 blend_samples/recumbent_fold/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 1000.0, 800.0
BASE = -600.0
BEDS = {"lower_bed": 120.0, "middle_bed": 230.0, "upper_bed": 340.0}  # oldest first: their levels
HOLES = 12
DIPS = 50


def bedding(x, y, z):
    """It rises from older to younger rock; each bed is a level of it. The axial planes lie nearly level."""
    return 0.5 * x + 150.0 * math.sin((z + 0.12 * y) / 85.0) + 0.08 * z


def unconformity(x, y):
    return -70.0 + 25.0 * math.sin(x / 260.0) - 0.03 * y


def ground(x, y):
    return 10.0 + 30.0 * math.sin(x / 330.0 + 0.7) * math.cos(y / 290.0)


def normal(x, y, z):
    """Of the bedding, toward younger rock, of length 1."""
    step = 1e-3
    slope = [
        bedding(x + dx, y + dy, z + dz) - bedding(x - dx, y - dy, z - dz)
        for dx, dy, dz in ((step, 0, 0), (0, step, 0), (0, 0, step))
    ]
    size = math.sqrt(sum(each * each for each in slope))
    return [each / size for each in slope]


def contacts(x, y, level):
    """The elevations at which a vertical hole meets a level below the unconformity, from the base up."""
    found, step = [], 5.0
    z = BASE
    while z + step < unconformity(x, y):
        low, high = z, z + step
        is_below = bedding(x, y, low) < level
        if is_below != (bedding(x, y, high) < level):
            for _ in range(50):
                middle = (low + high) / 2
                low, high = (middle, high) if (bedding(x, y, middle) < level) == is_below else (low, middle)
            found.append(low)
        z += step
    return found


def dip_row(x, y, z):
    """x, y, z, dip, dip direction and polarity."""
    n = normal(x, y, z)
    polarity = 1 if n[2] >= 0 else -1
    n = [polarity * each for each in n]
    dip = math.degrees(math.acos(n[2]))
    direction = math.degrees(math.atan2(n[0], n[1])) % 360.0
    return f"{x:.1f},{y:.1f},{z:.1f},{dip:.1f},{direction:.1f},{polarity}"


def main(folder):
    chance = random.Random(7)
    holes = [(chance.uniform(30, WIDTH - 30), chance.uniform(30, LENGTH - 30)) for _ in range(HOLES)]
    for name, level in BEDS.items():
        rows = [f"{x:.3f},{y:.3f},{z:.3f}" for x, y in holes for z in contacts(x, y, level)]
        write(folder / f"{name}.csv", "x,y,z", rows)
    rows = []
    for _ in range(DIPS):
        x, y = chance.uniform(0, WIDTH), chance.uniform(0, LENGTH)
        rows.append(dip_row(x, y, chance.uniform(BASE, unconformity(x, y))))
    write(folder / "dips.csv", "x,y,z,dip,dip_direction,polarity", rows)
    for name, height, spacing in (("unconformity", unconformity, 100.0), ("ground", ground, 50.0)):
        rows = []
        for i in range(round(WIDTH / spacing) + 1):
            for j in range(round(LENGTH / spacing) + 1):
                x, y = i * spacing, j * spacing
                rows.append(f"{x:.1f},{y:.1f},{height(x, y):.2f}")
        write(folder / f"{name}.csv", "x,y,z", rows)


def write(file, header, rows):
    file.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
