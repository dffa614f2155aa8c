# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the rift basin: picks of eight horizons (*.csv) and the sticks of four faults
(*.pol).

    python3 blend_samples/rift_basin/generate.py [FOLDER]

Everything is made up. Lengths are in meters, z is an elevation. Only `math` and `random.Random` are used and
numbers are written in fixed decimals, so every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 8000.0, 4000.0
SPACING = 200.0
MARGIN = 25.0  # nobody picks nearer to a fault
DISPLACED = {  # oldest first: their mean elevations before the rift opened
    "basement": -900.0,
    "red_beds": -640.0,
    "evaporite": -520.0,
    "limestone": -260.0,
    "shale": -60.0,
}
COVER = {"mudstone": -330.0, "chalk": -190.0}  # younger than the faults


def western_fault(y, z):
    """x of the fault that bounds the basin in the west: it dips east and flattens with depth."""
    return 1500.0 + 160.0 * math.sin(y / 1300.0) - 0.35 * z + 0.00012 * z * z


def middle_fault(y, z):
    """x of a fault that dips east."""
    return 3500.0 + 140.0 * math.sin(1.0 + y / 900.0) - 0.55 * z


def antithetic_fault(y, z):
    """x of a fault that dips west and ends at the middle fault."""
    return 5700.0 + 120.0 * math.sin(y / 1100.0) + 0.5 * z


def eastern_fault(y, z):
    """x of the fault that bounds the basin in the east: it dips west."""
    return 7000.0 + 100.0 * math.cos(y / 1200.0) + 0.5 * z


def blocks():
    """Each block from west to east: how much lower a place of it lies, and between which faults it is."""
    yield lambda x: 40.0, None, western_fault
    yield lambda x: 900.0 - 0.16 * (x - 1600.0), western_fault, middle_fault
    yield lambda x: 1120.0 - 0.11 * (x - 3500.0), middle_fault, antithetic_fault
    yield lambda x: 620.0 + 0.06 * (x - 5700.0), antithetic_fault, eastern_fault
    yield lambda x: 120.0, eastern_fault, None


def undisturbed(x, y, mean):
    return mean + 25.0 * math.sin(x / 900.0 + y / 1500.0) + 15.0 * math.cos(y / 700.0)


def unconformity(x, y):
    """What erosion left of the blocks."""
    return -470.0 + 45.0 * math.sin(x / 1100.0) * math.cos(y / 1300.0)


def picks(mean, seed):
    """(x, y, z) of a horizon, block by block."""
    chance = random.Random(seed)
    for lower, west, east in blocks():
        for row in range(int(LENGTH / SPACING) + 1):
            for column in range(int(WIDTH / SPACING) + 1):
                x = SPACING * column + chance.uniform(-60.0, 60.0)
                y = SPACING * row + chance.uniform(-60.0, 60.0)
                z = undisturbed(x, y, mean) - lower(x)
                is_east = west is None or x > west(y, z) + MARGIN
                if is_east and (east is None or x < east(y, z) - MARGIN):
                    yield x, y, z


def grid(height, seed):
    """(x, y, z) of a horizon that no fault displaces."""
    chance = random.Random(seed)
    for row in range(int(LENGTH / 400.0) + 1):
        for column in range(int(WIDTH / 400.0) + 1):
            x = 400.0 * column + chance.uniform(-80.0, 80.0)
            y = 400.0 * row + chance.uniform(-80.0, 80.0)
            yield x, y, height(x, y)


def ground(x, y):
    """Hills over the shoulders of the rift, and the valley of a river in its middle."""
    return (
        30.0 + 70.0 * ((x - 4200.0) / 4200.0) ** 2 - 60.0 * math.exp(-(((x - 4300.0 - 0.2 * y) / 500.0) ** 2))
    )


def sticks():
    """The sticks of each fault, from top to bottom; they go beyond the rock, the antithetic fault beyond the
    middle one."""
    heights = [300.0 - 250.0 * step for step in range(16)]
    rows = [-400.0 + 300.0 * step for step in range(17)]
    for name, x_of in (
        ("western", western_fault),
        ("middle", middle_fault),
        ("antithetic", antithetic_fault),
        ("eastern", eastern_fault),
    ):
        yield name, [[(x_of(y, z), y, z) for z in heights] for y in rows]


def write(folder):
    def put(name, points):
        rows = [f"{x:.2f},{y:.2f},{z:.2f}" for x, y, z in points]
        (folder / f"{name}.csv").write_bytes(("\n".join(["x,y,z", *rows]) + "\n").encode())

    for number, (name, mean) in enumerate(DISPLACED.items()):
        put(name, picks(mean, number))
    put("unconformity", grid(unconformity, 10))
    for number, (name, mean) in enumerate(COVER.items(), 11):
        put(name, grid(lambda x, y, mean=mean: undisturbed(x, y, mean), number))
    put("ground", grid(ground, 20))
    for name, lines in sticks():
        text = "".join(
            "".join(f"{x:.2f} {y:.2f} {z:.2f}\n" for x, y, z in line) + "999.00 999.00 999.00\n"
            for line in lines
        )
        (folder / f"{name}.pol").write_bytes(text.encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
