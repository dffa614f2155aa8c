# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the canyon: the project file with forty beds, picks of the lowest bed
(datum.csv), and the terrain (ground.asc).

    python3 blend_samples/canyon/generate.py [FOLDER]

Everything is made up. The walls follow the beds: each bed has a slope of its own, steep where it is hard, and
the terrain is the profile of all of them over the distance from the streams. Only `math` and `random.Random`
are used and numbers are written in fixed decimals, so every machine writes the same files.
"""

import itertools
import math
import random
import sys
from pathlib import Path

LENGTH, WIDTH = 1504.0, 1000.0
BASE = -90.0
WATER = 5.0  # elevation of the river
CELL = 8.0  # of the terrain model, meters

# Groups of beds, oldest first: name, thickness in meters, number of beds, the properties that take turns,
# and meters to go back for each meter that the wall rises (two: hard and soft beds take turns).
GROUPS = (
    ("Brown sandstone", 52.0, 5, (2, 3), (0.18, 0.35)),
    ("Green shale", 58.0, 6, (4, 5), (1.5, 1.9)),
    ("Red limestone", 104.0, 6, (6, 7), (0.06, 0.16)),
    ("Red beds", 84.0, 10, (8, 9), (0.15, 1.35)),
    ("Red shale", 34.0, 3, (9, 8), (1.7, 1.3)),
    ("White sandstone", 58.0, 4, (10, 11), (0.08, 0.14)),
    ("Gray marl", 30.0, 3, (5, 12), (1.6, 1.2)),
    ("Rim limestone", 50.0, 3, (12, 13), (0.1, 0.3)),
)


def beds():
    """(name, property, thickness, meters back for each meter up) of each bed, oldest first."""
    chance = random.Random(40)
    for name, thickness, count, properties, runs in GROUPS:
        shares = [chance.uniform(0.6, 1.4) for _ in range(count)]
        for number, share in enumerate(shares):
            turn = number % 2
            yield f"{name} {number + 1}", properties[turn], thickness * share / sum(shares), runs[turn]


def profile():
    """(distance from the stream, height) where the slope of the wall changes."""
    found, back, height = [(0.0, -14.0), (16.0, 0.0)], 16.0, 0.0
    for _, _, thickness, run in beds():
        back, height = back + thickness * run, height + thickness
        found.append((back, height))
    return [*found, (back + 2000.0, height + 30.0)]


def datum(x, y):
    """The elevation of the base of the lowest bed, and how far all beds are bent."""
    return 9.0 * math.sin(x / 330.0 + 0.4) + 0.012 * (x - LENGTH / 2) - 0.02 * (y - WIDTH / 2)


class Noise:
    """Smooth random heights between -1 and 1, with detail down to a size."""

    def __init__(self, seed, size, octaves):
        self.size, self.octaves = size, octaves
        chance = random.Random(seed)
        self.lattice = [[chance.uniform(-1.0, 1.0) for _ in range(64)] for _ in range(64)]

    def at(self, x, y):
        total, strength, size = 0.0, 0.5, self.size
        for octave in range(self.octaves):
            total += strength * self._smooth(x / size + 13 * octave, y / size + 7 * octave)
            strength, size = 0.5 * strength, 0.5 * size
        return total

    def _smooth(self, x, y):
        i, j = math.floor(x), math.floor(y)
        u, v = x - i, y - j
        u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
        row, above = self.lattice[j % 64], self.lattice[(j + 1) % 64]
        low = row[i % 64] * (1 - u) + row[(i + 1) % 64] * u
        high = above[i % 64] * (1 - u) + above[(i + 1) % 64] * u
        return low * (1 - v) + high * v


def river(x):
    return 480.0 + 165.0 * math.sin(x / 205.0 - 0.7) + 45.0 * math.sin(x / 77.0)


# Side streams: where they leave the river, their direction in degrees, how long they are, and how much they
# climb for each meter (in meters of the distance from a stream).
SIDES = ((330.0, 112.0, 330.0, 0.34), (560.0, -70.0, 300.0, 0.42), (800.0, 80.0, 360.0, 0.3))
SIDES += ((1050.0, -105.0, 380.0, 0.33), (1290.0, 60.0, 300.0, 0.45), (150.0, -60.0, 260.0, 0.5))


def streams():
    """((x, y), (x, y), added distance at both ends) of each straight piece."""
    step = 12.0
    x = -120.0
    while x < LENGTH + 120.0:
        yield (x, river(x)), (x + step, river(x + step)), (0.0, 0.0)
        x += step
    for start, direction, length, climb in SIDES:
        at, angle, gone = (start, river(start)), math.radians(direction), 0.0
        while gone < length:
            bend = angle + 0.7 * math.sin(gone / 55.0 + start)
            following = at[0] + 20.0 * math.cos(bend), at[1] + 20.0 * math.sin(bend)
            yield at, following, (climb * gone, climb * (gone + 20.0))
            at, gone = following, gone + 20.0


def distance(x, y, pieces):
    """From the nearest stream, side streams being farther the higher they are."""
    nearest = math.inf
    for (ax, ay), (bx, by), (near, far) in pieces:
        if abs(ax - x) > nearest + 40.0 or abs(ay - y) > nearest + 40.0:
            continue
        dx, dy = bx - ax, by - ay
        share = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
        away = math.hypot(x - ax - share * dx, y - ay - share * dy)
        nearest = min(nearest, away + near + share * (far - near))
    return nearest


def height_at(back, steps):
    for (a, low), (b, high) in itertools.pairwise(steps):
        if back <= b:
            return low + (high - low) * (max(back, a) - a) / (b - a)
    return steps[-1][1]


def terrain():
    """The lines of an ESRI ASCII grid with its nodes on the border of the region."""
    columns, rows = round(LENGTH / CELL) + 1, round(WIDTH / CELL) + 1
    yield from (f"ncols {columns}", f"nrows {rows}", f"xllcenter {0.0:.1f}", f"yllcenter {0.0:.1f}")
    yield from (f"cellsize {CELL:.1f}", "nodata_value -9999")
    pieces, steps = list(streams()), profile()
    spurs, gullies, rough = Noise(1, 150.0, 3), Noise(2, 46.0, 2), Noise(3, 90.0, 4)
    for row in range(rows):
        y = CELL * (rows - 1 - row)
        line = []
        for column in range(columns):
            x = CELL * column
            back = distance(x, y, pieces)
            grown = min(1.0, back / 60.0)  # the river has no spurs
            back += grown * (62.0 * spurs.at(x, y) - 34.0 * (abs(gullies.at(x, y)) - 0.12))
            height = height_at(back, steps) + datum(x, y) * min(1.0, max(0.0, back / 40.0))
            line.append(f"{height + 5.0 * grown * rough.at(x, y):.1f}")
        yield " ".join(line)


def picks():
    chance = random.Random(7)
    yield "x,y,z"
    for row in range(7):
        for column in range(10):
            x = LENGTH * (column + chance.uniform(0.05, 0.95)) / 10
            y = WIDTH * (row + chance.uniform(0.05, 0.95)) / 7
            yield f"{x:.1f},{y:.1f},{datum(x, y):.2f}"


HEAD = f"""# SPDX-License-Identifier: GPL-3.0-or-later
# Forty beds, a canyon, and the river in it. Lengths are in meters. Written by generate.py.
format = 1
name = "Canyon"
library = "library.toml"

[[rock]]
name = "plateau"
region = [[0, 0], [{LENGTH:.0f}, 0], [{LENGTH:.0f}, {WIDTH:.0f}], [0, {WIDTH:.0f}]]
edge_length = {CELL + 1:.0f}
base_elevation = {BASE:.0f}

[[rock.surface]]
name = "datum"
points = "datum.csv"
method = "spline"
property = 1
block = "Schist"
"""
BED = """
[[rock.surface]]
name = "top of {name}"
method = "parallel"
to = "datum"
thickness = {top:.2f}
property = {property}
block = "{name}"
"""
TAIL = f"""
[[rock.surface]]
name = "ground"
points = "ground.asc"
method = "grid"
property = 13
block = "Cover"

[[rock.surface]]
name = "water"
method = "constant"
value = {WATER:.0f}
rule = "conformable"
property = 14
block = "River"
"""


def project():
    parts, top = [HEAD], 0.0
    for name, kind, thickness, _ in beds():
        top += thickness
        parts.append(BED.format(name=name, top=top, property=kind))
    return "".join([*parts, TAIL])


def write(folder):
    files = {"project.toml": project(), "ground.asc": "\n".join(terrain()) + "\n"}
    files["datum.csv"] = "\n".join(picks()) + "\n"
    for name, text in files.items():
        (folder / name).write_bytes(text.encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
