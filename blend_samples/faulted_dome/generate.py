# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the faulted dome: contacts of four beds in sixteen boreholes (*.csv), sixty dips
(dips.csv), and a fault (fault.off).

    python3 blend_samples/faulted_dome/generate.py [FOLDER]

Everything is made up. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so
every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

SIZE = 1000.0
BASE, GROUND = -500.0, 0.0
BEDS = {"bed_1": -330.0, "bed_2": -240.0, "bed_3": -150.0, "bed_4": -60.0}  # oldest first: their levels
THROW = 70.0
HOLES = 16
DIPS = 60


def undisturbed(x, y, z):
    """It rises from older to younger rock. The flanks of the dome are steep, and overturned in the north."""
    up = z + 0.35 * (y - 480.0) * math.exp(-(((x - 520.0) / 300.0) ** 2))  # it leans
    away = math.hypot(x - 520.0, 1.2 * (y - 480.0))
    return up - 260.0 * math.exp(-((away / 260.0) ** 2)) - 0.02 * x


def is_above_fault(x, y, z):
    """The fault dips 60 degrees east."""
    return x - 0.1 * y - 420.0 + z / math.tan(math.radians(60.0)) > 0


def bedding(x, y, z):
    return undisturbed(x, y, z + (THROW if is_above_fault(x, y, z) else 0.0))


def normal(x, y, z):
    """Of the bedding, toward younger rock, of length 1."""
    step, z = 1e-3, z + (THROW if is_above_fault(x, y, z) else 0.0)
    slope = [
        undisturbed(x + dx, y + dy, z + dz) - undisturbed(x - dx, y - dy, z - dz)
        for dx, dy, dz in ((step, 0, 0), (0, step, 0), (0, 0, step))
    ]
    size = math.sqrt(sum(each * each for each in slope))
    return [each / size for each in slope]


def contacts(x, y, level):
    """The elevations at which a vertical hole meets a level below the ground, but for the fault."""
    found, step, z = [], 2.0, BASE
    while z + step < GROUND:
        low, high = z, z + step
        is_below = bedding(x, y, low) < level
        if is_above_fault(x, y, low) == is_above_fault(x, y, high) and is_below != (
            bedding(x, y, high) < level
        ):
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
    dip = math.degrees(math.acos(min(n[2], 1.0)))
    direction = math.degrees(math.atan2(n[0], n[1])) % 360.0
    return f"{x:.1f},{y:.1f},{z:.1f},{dip:.1f},{direction:.1f},{polarity}"


def main(folder):
    chance = random.Random(4)
    side = round(math.sqrt(HOLES))
    holes = [
        ((i + chance.uniform(0.2, 0.8)) * SIZE / side, (j + chance.uniform(0.2, 0.8)) * SIZE / side)
        for i in range(side)
        for j in range(side)
    ]
    for name, level in BEDS.items():
        rows = [f"{x:.3f},{y:.3f},{z:.3f}" for x, y in holes for z in contacts(x, y, level)]
        write(folder / f"{name}.csv", "x,y,z", rows)
    places = [
        (chance.uniform(0, SIZE), chance.uniform(0, SIZE), chance.uniform(BASE, GROUND)) for _ in range(DIPS)
    ]
    write(folder / "dips.csv", "x,y,z,dip,dip_direction,polarity", [dip_row(*place) for place in places])
    corners = []
    for z in (BASE - 200.0, GROUND + 200.0):
        for y in (-200.0, SIZE + 200.0):
            x = 420.0 + 0.1 * y - z / math.tan(math.radians(60.0))
            corners.append(f"{x:.4f} {y:.1f} {z:.1f}")
    write(folder / "fault.off", "OFF", ["4 2 0", *corners, "3 0 1 3", "3 0 3 2"])


def write(file, header, rows):
    file.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
