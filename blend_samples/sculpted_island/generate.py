# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the sculpted island: the terrain as an artist brings it, a mesh (ground.off),
points of the fold that all strata follow (fold.csv), and the round outline (region.geojson).

    python3 blend_samples/sculpted_island/generate.py [FOLDER]

Everything is made up. Only `math` is used and numbers are written in fixed decimals, so every machine writes
the same files.
"""

import json
import math
import sys
from pathlib import Path

RADIUS = 60.0  # of the island, in plan
RINGS = 44
TERRACE = 4.5  # height of the steps that were sculpted


def smoothstep(low, high, value):
    t = min(1.0, max(0.0, (value - low) / (high - low)))
    return t * t * (3.0 - 2.0 * t)


def terrace(z):
    """Steps: flat treads, steep faces."""
    step = math.floor(z / TERRACE)
    return TERRACE * (step + smoothstep(0.15, 1.0, z / TERRACE - step))


def ground(x, y):
    """Three peaks around a lake, and arms that turn around them down to the shore."""
    r, angle = math.hypot(x, y), math.atan2(y, x)
    swirl = angle - 0.045 * r
    peaks = 21.0 * math.exp(-(((x + 17.0) / 15.0) ** 2) - ((y - 12.0) / 17.0) ** 2)
    peaks += 15.0 * math.exp(-(((x - 22.0) / 13.0) ** 2) - ((y - 17.0) / 12.0) ** 2)
    peaks += 11.0 * math.exp(-(((x - 3.0) / 12.0) ** 2) - ((y + 31.0) / 11.0) ** 2)
    lake = -9.0 * math.exp(-(((x - 4.0) / 13.0) ** 2) - ((y + 6.0) / 11.0) ** 2)
    arms = 3.0 * math.sin(3.0 * swirl) * smoothstep(8.0, 30.0, r)
    rim = -5.0 * smoothstep(40.0, 60.0, r)
    z = 14.0 + peaks + lake + arms + rim + 0.8 * math.sin(0.35 * x) * math.cos(0.31 * y)
    return 0.5 * z + 0.5 * terrace(z)


def fold(x, y):
    """The strata: a fold that turns around the middle and leans out."""
    turn = 0.011 * math.hypot(x, y)
    u = x * math.cos(turn) - y * math.sin(turn)
    v = x * math.sin(turn) + y * math.cos(turn)
    return -20.0 + 8.0 * math.sin(u / 12.5) + 3.0 * math.sin(v / 17.0 + 0.6)


def disc(height):
    """Rings of vertices around the middle, reaching a little beyond the island; triangles between them."""
    vertices, triangles, before = [(0.0, 0.0, height(0.0, 0.0))], [], [0]
    for ring in range(1, RINGS + 2):
        r, count = RADIUS * ring / RINGS, 6 * ring
        numbers = list(range(len(vertices), len(vertices) + count))
        for k in range(count):
            angle = 2.0 * math.pi * k / count
            x, y = r * math.cos(angle), r * math.sin(angle)
            vertices.append((x, y, height(x, y)))
        inner = 0
        for k in range(count):
            outer = (k + 1) % count
            triangles.append((before[inner % len(before)], numbers[k], numbers[outer]))
            if len(before) > 1 and (inner + 1) * count <= (k + 1) * len(before):
                after = before[(inner + 1) % len(before)]
                triangles.append((before[inner], numbers[outer], after))
                inner += 1
        before = numbers
    return vertices, triangles


def off(vertices, triangles):
    lines = ["OFF", f"{len(vertices)} {len(triangles)} 0"]
    lines += ["{:.1f} {:.1f} {:.2f}".format(*vertex) for vertex in vertices]
    return "\n".join([*lines, *("3 " + " ".join(map(str, triangle)) for triangle in triangles)]) + "\n"


def points():
    """The fold, on a grid of points over the island."""
    along = range(-66, 67, 6)
    rows = [f"{x},{y},{fold(x, y):.2f}" for y in along for x in along if math.hypot(x, y) < 69]
    return "\n".join(["x,y,z", *rows]) + "\n"


def region():
    turns = [2.0 * math.pi * k / 120 for k in range(121)]
    ring = [[round(RADIUS * math.cos(a), 2), round(RADIUS * math.sin(a), 2)] for a in turns]
    return json.dumps({"type": "Polygon", "coordinates": [ring]}) + "\n"


def write(folder):
    files = {"ground.off": off(*disc(ground)), "fold.csv": points(), "region.geojson": region()}
    for name, text in files.items():
        (folder / name).write_bytes(text.encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
