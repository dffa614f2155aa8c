# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the fault blocks: picks of three horizons (*.csv), fault sticks (*.pol) and a
tunnel (tunnel.off).

    python3 blend_samples/fault_blocks/generate.py [FOLDER]

Everything is made up, in the manner of a seismic interpretation: z is a depth, positive downward; horizons
are picked block by block on both sides of the faults. Only `math` and `random.Random` are used and numbers
are written in fixed decimals, so every machine writes the same files.
"""

import math
import random
import sys
from pathlib import Path

WIDTH, LENGTH = 2000.0, 1600.0
SPACING = 50.0
MARGIN = 8.0  # nobody picks nearer to a fault
TIP = 900.0  # where the western fault dies out
HORIZONS = {"base_clay": 1150.0, "top_clay": 1085.0, "top_sand": 1030.0}  # oldest first: their mean depths


def main_fault(y, depth):
    """x of the main fault: it crosses everything, dips east, and flattens with depth."""
    below = depth - 1000.0
    return 1050.0 + 60.0 * math.sin(y / 500.0) + 0.45 * below + 0.0004 * below * below


def branch(x, depth):
    """y of a branch that ends at the main fault and dips north."""
    return 700.0 + 0.15 * (x - 1100.0) + 0.4 * (depth - 1000.0)


def western_fault(y, depth):
    """x of a fault in the west that dies out at y = TIP; it dips east."""
    return 430.0 + 0.05 * y + 0.35 * (depth - 1000.0)


def throw_of_western_fault(x, y, depth):
    """How far its sides have moved up and down: nothing at its end, and less away from it."""
    along = math.sqrt(max(0.0, 1.0 - (y / TIP) ** 2))
    return 14.0 * along * math.exp(-abs(x - western_fault(y, depth)) / 300.0)


def undisturbed(x, y, mean):
    return mean + 0.03 * x + 18.0 * math.sin(x / 420.0) * math.cos(y / 380.0)


def blocks():
    """Each block: how much lower it lies, and whether a point is in it, away from its faults."""

    def east(x, y, depth):
        return x - main_fault(y, depth)

    def north(x, y, depth):
        return y - branch(x, depth)

    def east_of_western(x, y, depth):
        return x - western_fault(y, depth)

    def beside_western(x, y, depth):
        return abs(east_of_western(x, y, depth)) > MARGIN or y > TIP + MARGIN

    yield (
        lambda *p: math.copysign(throw_of_western_fault(*p), east_of_western(*p)),
        lambda *p: east(*p) < -MARGIN and beside_western(*p),
    )
    yield lambda *p: 60.0, lambda *p: east(*p) > MARGIN and north(*p) < -MARGIN
    yield lambda *p: 95.0, lambda *p: east(*p) > MARGIN and north(*p) > MARGIN


def picks(mean, seed):
    """(x, y, depth) of a horizon, block by block."""
    chance = random.Random(seed)
    for lower, is_inside in blocks():
        for row in range(int(LENGTH / SPACING) + 1):
            for column in range(int(WIDTH / SPACING) + 1):
                x = SPACING * column + chance.uniform(-15.0, 15.0)
                y = SPACING * row + chance.uniform(-15.0, 15.0)
                depth = undisturbed(x, y, mean)
                depth += lower(x, y, depth)
                if is_inside(x, y, depth):
                    yield x, y, depth


def sticks():
    """The sticks of each fault, from top to bottom; they go beyond the rock where the fault does."""
    depths = [880.0 + 40.0 * step for step in range(14)]
    ends = depths[0], depths[-1]  # of straight sticks
    yield "main", [[(main_fault(y, d), y, d) for d in depths] for y in range(-200, 1801, 100)]
    # from a little beyond the main fault, which it ends at
    across = range(930, 2331, 140)
    yield "branch", [[(float(x), branch(x, d), d) for d in ends] for x in across]
    yield "western", [[(western_fault(y, d), y, d) for d in ends] for y in [*range(-200, 900, 100), TIP]]


def tunnel():
    """A tunnel with eight sides from south to north, 12 across, in the clay of the western block."""
    ring = [
        (12.0 * math.cos(k * math.pi / 4 + 0.3), 12.0 * math.sin(k * math.pi / 4 + 0.3)) for k in range(8)
    ]
    corners = [(700.0 + u, y, 1141.0 + v) for y in (-50.0, 1650.0) for u, v in ring]
    faces = [(k, (k + 1) % 8, 8 + (k + 1) % 8, 8 + k) for k in range(8)]
    return corners, [*faces, tuple(range(7, -1, -1)), tuple(range(8, 16))]


def write(folder):
    for number, (name, mean) in enumerate(HORIZONS.items()):
        rows = [f"{x:.2f},{y:.2f},{depth:.2f}" for x, y, depth in picks(mean, number)]
        (folder / f"{name}.csv").write_bytes(("\n".join(["x,y,z", *rows]) + "\n").encode())
    for name, lines in sticks():
        text = "".join(
            "".join(f"{x:.3f} {y:.3f} {d:.3f}\n" for x, y, d in line) + "999.000 999.000 999.000\n"
            for line in lines
        )
        (folder / f"{name}.pol").write_bytes(text.encode())
    corners, faces = tunnel()
    lines = ["OFF", f"{len(corners)} {len(faces)} 0", *("{:.3f} {:.3f} {:.3f}".format(*c) for c in corners)]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    (folder / "tunnel.off").write_bytes(("\n".join(lines) + "\n").encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
