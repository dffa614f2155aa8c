# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the mapped valley: ground.asc, map.geojson, and a table of dips for each bed.

    python3 blend_samples/mapped_valley/generate.py [FOLDER]

Everything is made up. Heights are formulas of the plan position in meters; the map has a line wherever the
ground cuts a bed or the base of the basalt, and the dips are the slopes of the formulas there. Only `math` is
used and numbers are written in fixed decimals, so every machine writes the same files.
"""

import json
import math
import sys
from pathlib import Path

LENGTH, WIDTH = 3000.0, 2000.0
CELL = 50.0  # of the terrain model
STEP = 25.0  # between corners of lines
BASE = -100.0
THICKNESS = (-75.0, 0.0, 70.0)  # of the tops of sandstone, shale and limestone against the middle one
TOPS = ("sandstone", "shale", "limestone")
UNITS = ("Ss", "Sh", "Ls", "Ml", "Bas")  # as the map calls the beds, from west to east, and the basalt
DIPS = (7, 7, 6)  # measured at each top


def ground(x, y):
    """A valley from west to east between two ridges."""
    return 420.0 - 130.0 * math.exp(-(((y - 1000.0) / 450.0) ** 2)) + 8.0 * math.sin(x / 300.0)


def fold(y):
    """Open folds that plunge as the beds dip."""
    return 20.0 * math.sin(y / 330.0)


def top(bed, x, y):
    """The top of a bed: all are parallel, folded, and dip east."""
    return 380.0 + THICKNESS[bed] - 0.2 * (x - 1500.0) + fold(y)


def basalt_base(x, y):
    """The plain that erosion had made of the beds when lava flowed over them, tilted since."""
    return 372.0 + 0.006 * x - 0.004 * y


def root(function, low, high):
    """Where a function that falls is 0."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) > 0 else (low, middle)
    return 0.5 * (low + high)


def outcrop(bed, y):
    """x of the line where the ground cuts the top of a bed."""
    return root(lambda x: top(bed, x, y) - ground(x, y), -1000.0, LENGTH + 1000.0)


def rim(side, x):
    """y of the edge of the basalt above one side of the valley: -1 south, 1 north."""

    def below(out):
        y = 1000.0 + side * out
        return basalt_base(x, y) - ground(x, y)

    return 1000.0 + side * root(below, 0.0, 1000.0)


def corner(bed, side):
    """Where the line of the top of a bed ends at the basalt."""
    x = root(lambda x: top(bed, x, rim(side, x)) - ground(x, rim(side, x)), 0.0, LENGTH)
    return x, rim(side, x)


def bed_line(bed):
    """The line between two beds, from the southern rim to the northern one."""
    south, north = corner(bed, -1), corner(bed, 1)
    count = math.ceil((north[1] - south[1]) / STEP)
    ys = [south[1] + (north[1] - south[1]) * n / count for n in range(1, count)]
    return [south, *((outcrop(bed, y), y) for y in ys), north]


def rim_line(side, low, high):
    """The part of a rim between two places."""
    count = math.ceil((high[0] - low[0]) / STEP)
    xs = [low[0] + (high[0] - low[0]) * n / count for n in range(1, count)]
    return [low, *((x, rim(side, x)) for x in xs), high]


def ring(corners):
    rounded = [[round(x, 3), round(y, 3)] for x, y in corners]
    return [*rounded, rounded[0]]


def areas():
    """(unit, polygons): the beds in the valley, and the basalt on both ridges. Neighbors have the corners of
    their common line alike."""
    lines = [
        [(0.0, rim(-1, 0.0)), (0.0, rim(1, 0.0))],
        *(bed_line(bed) for bed in range(len(TOPS))),
        [(LENGTH, rim(-1, LENGTH)), (LENGTH, rim(1, LENGTH))],
    ]
    rims: list = [[], []]
    found = []
    for number, unit in enumerate(UNITS[:-1]):
        west, east = lines[number], lines[number + 1]
        south, north = rim_line(-1, west[0], east[0]), rim_line(1, west[-1], east[-1])
        found.append((unit, [[ring([*south, *east[1:-1], *north[::-1], *west[-2:0:-1]])]]))
        rims[0] += south[1 if number else 0 :]
        rims[1] += north[1 if number else 0 :]
    south = [(LENGTH, 0.0), (0.0, 0.0), *rims[0]]
    north = [*rims[1], (LENGTH, WIDTH), (0.0, WIDTH)]
    found.append((UNITS[-1], [[ring(south[::-1])], [ring(north)]]))
    return found


def geology():
    """The map as GeoJSON."""
    rows = [
        json.dumps(
            {
                "type": "Feature",
                "properties": {"FORMATION": unit},
                "geometry": {"type": "MultiPolygon", "coordinates": polygons},
            }
        )
        for unit, polygons in areas()
    ]
    return '{"type": "FeatureCollection", "features": [\n' + ",\n".join(rows) + "\n]}\n"


def terrain():
    """The ground as a raster that reaches a little beyond the region."""
    columns, rows = int(LENGTH / CELL) + 3, int(WIDTH / CELL) + 3
    head = (
        f"ncols {columns}\nnrows {rows}\nxllcenter {-CELL:.0f}\nyllcenter {-CELL:.0f}\ncellsize {CELL:.0f}\n"
    )
    lines = []
    for r in range(rows):
        y = (rows - 2 - r) * CELL
        lines.append(" ".join(f"{ground((c - 1) * CELL, y):.2f}" for c in range(columns)))
    return head + "\n".join(lines) + "\n"


def dips(bed):
    """A table of dips where the top of a bed crops out."""
    lines = ["x,y,dip,dip_direction"]
    count = DIPS[bed]
    (_, low), (_, high) = corner(bed, -1), corner(bed, 1)
    for n in range(count):
        y = low + (high - low) * (n + 0.5) / count
        x = outcrop(bed, y)
        east, north = -0.2, 20.0 / 330.0 * math.cos(y / 330.0)
        dip = math.degrees(math.atan(math.hypot(east, north)))
        direction = math.degrees(math.atan2(-east, -north)) % 360.0
        lines.append(f"{x:.1f},{y:.1f},{dip:.1f},{direction:.1f}")
    return "\n".join(lines) + "\n"


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    texts = {"map.geojson": geology(), "ground.asc": terrain()}
    texts |= {f"dips_{name}.csv": dips(bed) for bed, name in enumerate(TOPS)}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
