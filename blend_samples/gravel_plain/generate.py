# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the gravel plain: *.geojson, ground.asc and *.csv.

    python3 blend_samples/gravel_plain/generate.py [FOLDER]

Everything is made up. Heights are formulas of the plan position in meters from the south-west
corner, which is put at UTM zone 32N, 412000 E, 5336000 N. Only `math` and `random.Random` are used
and numbers are written in fixed decimals, so every machine writes the same files.
"""

import json
import math
import random
import sys
from pathlib import Path

EAST, NORTH = 412000, 5336000
WIDTH, DEPTH = 900, 600
CELL = 20
FOOT = 0.3048

OUTLINE = [(0, 40), (180, 0), (620, 10), (900, 90), (880, 420), (760, 600), (240, 580), (30, 430)]
LAKE = [(520, 330), (600, 300), (690, 340), (700, 410), (620, 450), (540, 420)]  # of a gravel pit: left out
HOLES = 22


def ground(x, y):
    """A terrace with an edge, and the shallow valley of a brook."""
    edge = 7.0 / (1.0 + math.exp((y - 0.25 * x - 160.0) / 25.0))
    brook = 5.0 * math.exp(-(((x - 250.0 - 0.4 * y) / 60.0) ** 2))
    return 452.0 + 0.004 * x - edge - brook


def clay(x, y):
    """The top of a clay that fills the channel in the bedrock."""
    return 436.0 + 0.006 * x + 1.5 * math.sin(y / 140.0)


def bedrock(x, y):
    """A hill in the west, and a buried channel from south-west to north-east."""
    channel = 24.0 * math.exp(-(((y - 120.0 - 0.45 * x) / 110.0) ** 2))
    return 442.0 + 6.0 * math.exp(-(((x - 120.0) / 150.0) ** 2 + ((y - 430.0) / 150.0) ** 2)) - channel


def ring(corners):
    """Closed, in UTM."""
    return [[EAST + x, NORTH + y] for x, y in [*corners, corners[0]]]


def inside(x, y, corners):
    crossings = 0
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            crossings += 1
    return crossings % 2 == 1


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def geojson(features):
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=1) + "\n"


def region():
    polygon = {"type": "Polygon", "coordinates": [ring(OUTLINE), ring(LAKE)]}
    return geojson([feature(polygon, name="gravel plain")])


def raster():
    """Heights at the centers of cells, the northernmost row first; it reaches a cell beyond the region."""
    columns, rows = WIDTH // CELL + 2, DEPTH // CELL + 2
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {EAST - CELL}", f"yllcorner {NORTH - CELL}"]
    lines += [f"cellsize {CELL}", "NODATA_value -9999"]
    for row in reversed(range(rows)):
        y = (row - 0.5) * CELL
        lines.append(" ".join(f"{ground((column - 0.5) * CELL, y):.2f}" for column in range(columns)))
    return "\n".join(lines) + "\n"


def contours():
    """Places at which the bedrock has round heights, in feet, strung along lines."""
    features = []
    for feet in range(1380, 1480, 10):
        height = feet * FOOT
        for low, high in ((0.0, 300.0), (300.0, 620.0)):
            line = []
            for x in range(0, WIDTH + 1, 60):
                crossing = where(lambda y, x=x, z=height: bedrock(x, y) - z, low, high)
                if crossing is not None and inside(x, crossing, OUTLINE):
                    line.append([EAST + x, round(NORTH + crossing, 1)])
            if len(line) > 1:
                features.append(feature({"type": "LineString", "coordinates": line}, ELEV_FT=feet))
    return geojson(features)


def where(function, low, high):
    """A zero of a function between two places, by halving; None where there is no change of sign."""
    if (function(low) > 0) == (function(high) > 0):
        return None
    for _ in range(40):
        middle = 0.5 * (low + high)
        if (function(low) > 0) == (function(middle) > 0):
            low = middle
        else:
            high = middle
    return low


def boreholes():
    """Collars and picks. Some holes end in the clay: they have no depth of the bedrock."""
    draw = random.Random(22)
    collars, picks = ["Hole,Easting,Northing,RL"], ["Hole,Horizon,Depth"]
    number = 0
    while number < HOLES:
        x, y = draw.uniform(0, WIDTH), draw.uniform(0, DEPTH)
        if not inside(x, y, OUTLINE) or inside(x, y, LAKE):
            continue
        number += 1
        name, top = f"GP{number:02d}", ground(x, y)
        collars.append(f"{name},{EAST + x:.1f},{NORTH + y:.1f},{top:.2f}")
        rock = bedrock(x, y)
        if clay(x, y) > rock:
            picks.append(f"{name},clay,{top - clay(x, y):.2f}")
        depth = "" if top - rock > 30 else f"{top - rock:.2f}"
        picks.append(f"{name},bedrock,{depth}")
    return "\n".join(collars) + "\n", "\n".join(picks) + "\n"


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    collars, picks = boreholes()
    files = {
        "region.geojson": region(),
        "ground.asc": raster(),
        "bedrock.geojson": contours(),
        "collars.csv": collars,
        "picks.csv": picks,
    }
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
