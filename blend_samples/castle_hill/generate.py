# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the Castle Hill sample: region.geojson, *.csv and ground.off.

    python3 blend_samples/castle_hill/generate.py [FOLDER]

Everything is made up: no measurement of the real hill went into it. The formulas below (README.md
explains them) give heights in meters at a plan position (x, y) in meters from the south-west
corner, which is put at UTM zone 32N, 377400 E, 5397900 N, so that the sample also shows that
large coordinates lose nothing. Only `math` and `random.Random` are used and heights are written in
centimeters, so every machine writes the same files.
"""

import json
import math
import random
import sys
from pathlib import Path

EAST, NORTH = 377400, 5397900  # UTM 32N of the local origin
WIDTH, DEPTH = 1200.0, 800.0  # extent of the region in plan, meters

# fmt: off
# Concave: a bay in the south, where the old road enters, bares the inside of the castle hill.
OUTLINE = [
    (0, 90), (60, 20), (150, 0), (500, 0), (545, 60), (560, 185), (612, 258), (690, 262),
    (742, 190), (765, 70), (820, 0), (1120, 0), (1200, 70), (1200, 610), (1150, 740), (1040, 800),
    (300, 800), (130, 770), (30, 690), (0, 560),
]
# The quarry on the eastern plateau was dug so deep that the model leaves it out: a hole.
QUARRY = [(1010, 548), (1062, 530), (1108, 554), (1120, 600), (1086, 640), (1030, 632), (998, 592)]
# fmt: on

# Levels of the tops of the layers where the structure is 0 (below the castle), meters
LEVEL = {
    "permian": 342.0,
    "annweiler": 374.0,
    "vosgien": 460.0,
    "conglomerate": 510.0,
    "violet": 518.0,
    "intermediate": 550.0,
    "voltzia": 564.0,
    "muschelkalk": 582.0,
}
THROW = 134.0  # of the flexure in the east, meters


def step(t):
    """Smooth step from 0 to 1 around t = 0."""
    return 0.5 * (1.0 + math.tanh(t))


def bell(t):
    return math.exp(-t * t)


def structure(x, y):
    """How far the strata lie above their level: dip, a gentle fold, and the flexure in the east."""
    dip = 0.055 * (x - 590.0)
    fold = -14.0 * math.sin(2.0 * math.pi * (0.30 * x + 0.95 * y) / 820.0)
    flexure = -THROW * step((x - 875.0 - 0.22 * (y - 400.0)) / 42.0)
    return dip + fold + flexure


def basement(x, y):
    """Old land surface on the granite: hills and two basins under the Permian."""
    relief = 18.0 * math.sin(2.0 * math.pi * (x + 0.3 * y - 60.0) / 560.0)
    relief += 8.0 * math.cos(2.0 * math.pi * (y - 0.35 * x) / 430.0)
    return 331.0 + structure(x, y) + relief


def channels(x, y):
    """Depth of the rivers that cut into the conglomerate before the Couches intermediaires."""
    west = abs(x - 108.0 - 34.0 * math.sin(y / 130.0))
    east = abs(y - 520.0 - 0.25 * (x - 900.0) - 30.0 * math.sin(x / 90.0))
    return 58.0 * max(bell(west / 34.0), bell(east / 44.0) * step((x - 800.0) / 40.0))


def top(layer):
    """Height function of the top of a layer of the Permian or Triassic."""

    def height(x, y):
        z = LEVEL[layer] + structure(x, y)
        if layer == "violet":
            z -= channels(x, y)
        elif layer == "permian":
            z += 3.0 * math.sin(x / 150.0) * math.cos(y / 120.0)
        elif layer == "vosgien":
            z += 2.5 * math.sin((x + y) / 95.0)
        return z

    return height


def main_valley(x, y):
    """Distance from the axis of the main valley (the Zorn's), meters."""
    return abs(x - 330.0 - 52.0 * math.sin((y + 60.0) / 170.0))


def side_valley(x, y):
    """Distance from the axis of the side valley that follows the flexure, meters."""
    return abs(x - 838.0 - 0.20 * (y - 400.0) - 24.0 * math.sin(y / 120.0))


def slope(distance, half_width, floor, steepness):
    """Height of a valley's side at a distance from its axis: flat floor, then ever steeper."""
    d = max(0.0, distance - half_width)
    return floor + steepness * d * d / (d + 38.0)


def smaller(a, b, radius):
    """Smooth minimum."""
    h = max(0.0, radius - abs(a - b)) / radius
    return min(a, b) - 0.25 * radius * h * h


def crags(x, y):
    """The three rocks of the castle, on a ridge from south to north."""
    z = 0.0
    for cx, cy, radius, height in ((604, 335, 24, 22), (584, 408, 30, 25), (566, 486, 21, 18)):
        r = math.hypot((x - cx) * 1.35, y - cy) / radius
        z = max(z, height * step((1.0 - r) * 5.0))
    return z


def ground(x, y):
    """Today's land surface."""
    west = 508.0 + 5.0 * math.sin(x / 70.0) * math.cos(y / 110.0)
    castle = 484.0 - 0.0011 * (y - 400.0) ** 2 * step((abs(y - 400.0) - 120.0) / 60.0)
    east = 481.0 + 4.0 * math.sin((x + 1.4 * y) / 95.0)
    between = step((x - 350.0) / 50.0)
    beyond = step((x - 850.0) / 40.0)
    z = west + (castle - west) * between + (east - castle) * beyond
    z = smaller(z, slope(main_valley(x, y), 34.0, 292.0 + 0.02 * y, 1.40), 40.0)
    z = smaller(z, slope(side_valley(x, y), 20.0, 308.0 + 0.03 * y, 1.35), 36.0)
    # Hard beds stand out as cliffs: the conglomerate, and a bench in the Gres vosgien.
    for level, height, width in ((464.0, 14.0, 5.0), (412.0, 6.0, 5.0)):
        e = z - level - structure(x, y)
        z += height * math.tanh(e / width) * bell(e / 42.0)
    gully = abs(y - 210.0 - 0.35 * (x - 1000.0) - 14.0 * math.sin(x / 40.0))
    z -= 24.0 * bell(gully / 20.0) * step((x - 925.0) / 30.0) * step((1190.0 - x) / 40.0)
    return z + crags(x, y)


def old_valleys(x, y):
    """Land surface of the last ice age: loess on the plateaus, valleys deeper than today's."""
    fill = 52.0 * bell(main_valley(x, y) / 58.0) + 42.0 * bell(side_valley(x, y) / 42.0)
    return ground(x, y) + 24.0 - fill


def stations(spacing, seed, margin=30.0):
    """Scattered plan positions: a staggered grid, each shaken by up to 0.35 of its spacing."""
    shake = random.Random(seed)
    points, row, y = [], 0, -margin
    while y <= DEPTH + margin:
        x = -margin + (0.5 * spacing if row % 2 else 0.0)
        while x <= WIDTH + margin:
            away = [0.7 * spacing * (shake.random() - 0.5) for _ in range(2)]
            points.append((x + away[0], y + away[1]))
            x += spacing
        row, y = row + 1, y + spacing * 0.866
    return points


def write_points(path, positions, height):
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write("x,y,z\n")
        for x, y in positions:
            x, y = round(x, 1), round(y, 1)
            file.write(f"{EAST + x:.1f},{NORTH + y:.1f},{height(x, y):.2f}\n")


def write_off(path, spacing, height):
    """A ready triangulated surface: a grid that reaches beyond the region, diagonals alternating."""
    columns, rows = int(WIDTH / spacing) + 3, int(DEPTH / spacing) + 3
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(f"OFF\n{columns * rows} {2 * (columns - 1) * (rows - 1)} 0\n")
        for j in range(rows):
            for i in range(columns):
                x, y = (i - 1) * spacing, (j - 1) * spacing
                file.write(f"{EAST + x:.1f} {NORTH + y:.1f} {height(x, y):.2f}\n")
        for j in range(rows - 1):
            for i in range(columns - 1):
                a = j * columns + i
                b, c, d = a + 1, a + columns + 1, a + columns
                if (i + j) % 2:
                    file.write(f"3 {a} {b} {d}\n3 {b} {c} {d}\n")
                else:
                    file.write(f"3 {a} {b} {c}\n3 {a} {c} {d}\n")


def write_region(path):
    def ring(corners):
        return [[EAST + x, NORTH + y] for x, y in [*corners, corners[0]]]

    feature = {
        "type": "Feature",
        "properties": {"name": "Castle Hill"},
        "geometry": {"type": "Polygon", "coordinates": [ring(OUTLINE), ring(QUARRY[::-1])]},
    }
    with open(path, "w", encoding="ascii", newline="\n") as file:
        json.dump({"type": "FeatureCollection", "features": [feature]}, file, indent=1)
        file.write("\n")


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    write_region(folder / "region.geojson")
    logged = stations(46.0, seed=1)  # the strata were logged at the same stations
    write_points(folder / "basement.csv", stations(30.0, seed=2), basement)
    for layer in LEVEL:
        positions = stations(24.0, seed=3) if layer == "violet" else logged
        write_points(folder / f"{layer}.csv", positions, top(layer))
    write_points(folder / "old_valleys.csv", stations(20.0, seed=4), old_valleys)
    write_off(folder / "ground.off", 11.0, ground)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
