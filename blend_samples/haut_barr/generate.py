# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the Haut-Barr sample: the project file, outlines and points.

    python3 blend_samples/haut_barr/generate.py [FOLDER]

The outcrop is that of chapter 5 of G. Mei's thesis (Freiburg 2014): three fins of sandstone on a base, 255 m
long, 70 m wide and 40 m high. Only its size and the counts of rock masses, surfaces and layers are the
thesis's; nothing was measured, and all shapes come from the formulas below (README.md explains them). Heights
are in meters, plan positions (x, y) in meters from the south-west corner, which is put at UTM zone 32N,
377600 E, 5398100 N. Only `math` and `random.Random` are used and coordinates are written in centimeters, so
every machine writes the same files.
"""

import json
import math
import random
import sys
from pathlib import Path

EAST, NORTH = 377600, 5398100  # UTM 32N of the local origin
LENGTH, WIDTH = 255.0, 70.0  # extent of the base in plan, meters
BASE = 420.0  # elevation of the flat base of the model, meters


class Fin:
    """A fin of rock: an oval in plan with a wavy, notched outline."""

    def __init__(self, name, center, half_length, half_width, turn, summit, joints, seed):
        self.name, self.center = name, center
        self.half_length, self.half_width = half_length, half_width
        self.turn = math.radians(turn)
        self.summit = summit  # elevation of its highest part, meters
        self.joints = joints  # clefts across it: (along, lean, depth), meters along its axis
        shake = random.Random(seed)
        self.waves = [
            (order, shake.uniform(0, 2 * math.pi), 0.09 / order**0.6) for order in (2, 3, 5, 7, 11, 16)
        ]

    def radius(self, angle):
        """Of the outline as a share of the oval's, by the angle in the oval."""
        bare = 1.0 + sum(size * math.sin(order * angle + phase) for order, phase, size in self.waves)
        notches = 0.0
        for along, lean, _ in self.joints:
            for side in (-1.0, 1.0):
                at = math.atan2(
                    side * math.sqrt(max(0.0, 1.0 - (along / self.half_length) ** 2)),
                    along / self.half_length,
                )
                away = (angle - at - 0.002 * lean + math.pi) % (2.0 * math.pi) - math.pi
                notches = max(notches, 0.10 * bell(away / 0.055))
        return bare - notches

    def local(self, x, y):
        """Along and across the fin, meters."""
        dx, dy = x - self.center[0], y - self.center[1]
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        return dx * cos + dy * sin, dy * cos - dx * sin

    def share(self, x, y):
        """0 in the middle, 1 on the outline."""
        along, across = self.local(x, y)
        u, v = along / self.half_length, across / self.half_width
        return math.hypot(u, v) / self.radius(math.atan2(v, u))

    def outline(self, spacing):
        corners, angle = [], 0.0
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        while angle < 2.0 * math.pi - 1e-3:
            r = self.radius(angle)
            along, across = r * self.half_length * math.cos(angle), r * self.half_width * math.sin(angle)
            corners.append(
                (self.center[0] + along * cos - across * sin, self.center[1] + along * sin + across * cos)
            )
            tangent = math.hypot(self.half_length * math.sin(angle), self.half_width * math.cos(angle))
            angle += spacing / max(tangent, self.half_width)
        return corners

    def top(self, x, y):
        """Its bare rock: a rounded summit with ledges of hard beds, and clefts along the joints."""
        along, across = self.local(x, y)
        r = min(self.share(x, y), 1.2)
        u = along / self.half_length
        z = self.summit - 1.2 * r**2 - 5.0 * r**14
        z -= (
            5.0 * step((u - 0.45) * 7.0)
            + 3.0 * step((-u - 0.6) * 8.0)
            + 1.2 * math.sin(2.6 * u + self.turn * 9.0)
        )
        for level, height, width in (
            (456.0, 1.3, 0.5),
            (452.0, 1.8, 0.6),
            (448.5, 1.2, 0.5),
            (444.0, 1.4, 0.6),
        ):
            e = z - level - structure(x, y)
            z += height * math.tanh(e / width) * bell(e / 3.0)
        z += 0.30 * math.sin(x / 1.9 + 0.6 * math.sin(y / 2.3)) + 0.25 * math.sin(y / 1.6 + x / 4.1)
        for at, lean, depth in self.joints:
            away = along - at - 0.03 * lean * across - 0.5 * math.sin(across / 2.7)
            z -= depth * bell(away / 1.3) ** 0.7 * (0.5 + 0.5 * r)
        return max(z, 429.0 + 0.5 * math.sin(x / 3.0))


def step(t):
    """Smooth step from 0 to 1 around t = 0."""
    return 0.5 * (1.0 + math.tanh(t))


def bell(t):
    return math.exp(-t * t)


FINS = [
    Fin(
        "Septentrional Rock",
        (50.0, 38.0),
        37.0,
        11.0,
        8.0,
        457.5,
        [(-15.0, 8.0, 9.0), (8.0, -6.0, 17.0), (19.0, 4.0, 6.0)],
        1,
    ),
    Fin("Median Rock", (130.0, 32.0), 34.0, 12.5, -7.0, 459.5, [(-9.0, -7.0, 8.0), (14.0, 6.0, 14.0)], 2),
    Fin("Markenfels", (207.0, 38.0), 31.0, 9.5, 12.0, 455.5, [(-10.0, 5.0, 12.0), (9.0, -9.0, 16.0)], 3),
]


def structure(x, y):
    """How far the beds lie above their level: a gentle dip to the east and a wave."""
    return 0.006 * (127.5 - x) + 0.008 * (y - 35.0) + 0.3 * math.sin(x / 37.0 + y / 29.0)


def bed(level, relief=0.15, wave=13.0):
    """The top of a bed, slightly uneven."""
    return lambda x, y: (
        level + structure(x, y) + relief * math.sin(x / wave + 0.7 * y / wave) * math.cos(y / wave)
    )


def foresets(low, slope, bend, start, turn=0.0):
    """Slip face of a migrating bar: rises with x (falls, where `slope` is negative), concave at its toe."""

    def height(x, y):
        d = (x - start + turn * (y - 35.0)) * (1.0 if slope > 0 else -1.0)
        rise = abs(slope) * 0.5 * (d + math.hypot(d, bend))
        return low + structure(x, y) + rise

    return height


def channel(level, depth, axis, width):
    """The top of a bed into which a river cut."""
    plain = bed(level)
    return lambda x, y: plain(x, y) - depth * bell((x - axis - 9.0 * math.sin(y / 15.0)) / width)


def rim(x, y):
    """0 in the middle of the base, 1 on its outline."""
    u, v = (x - LENGTH / 2) / (LENGTH / 2), (y - WIDTH / 2) / (WIDTH / 2)
    return (abs(u) ** 3 + abs(v) ** 3) ** (1.0 / 3.0) / rim_radius(math.atan2(v, u))


def rim_radius(angle):
    return 0.99 + 0.02 * math.sin(3 * angle + 1.0) + 0.01 * math.sin(8 * angle)


def base_outline(spacing):
    corners, angle = [], 0.0
    while angle < 2.0 * math.pi - 1e-3:
        cos, sin = math.cos(angle), math.sin(angle)
        r = rim_radius(angle) / (abs(cos) ** 3 + abs(sin) ** 3) ** (1.0 / 3.0)
        corners.append((LENGTH / 2 * (1 + r * cos), WIDTH / 2 * (1 + r * sin)))
        angle += spacing / math.hypot(LENGTH / 2 * sin, WIDTH / 2 * cos)
    return corners


def bench(x, y):
    """The rock of the base: highest along the fins, falling off to its outline."""
    z = 427.4 - 5.4 * min(rim(x, y), 1.2) ** 4 + 0.4 * math.sin(x / 9.0) * math.sin(y / 7.0)
    e = z - 425.2 - structure(x, y)
    return z + 0.5 * math.tanh(e / 0.3) * bell(e / 1.5)


def debris(x, y):
    """Blocks and sand at the foot of the fins."""
    away = min(8.0 * (fin.share(x, y) - 1.0) * fin.half_width / 8.0 for fin in FINS)
    return bench(x, y) + 2.6 * bell(max(away, 0.0) / 3.2) - 0.35


def soil(x, y):
    return (
        max(bench(x, y), debris(x, y))
        + 0.45 * step((math.sin(x / 17.0) + math.cos(y / 11.0) - 0.2) * 3.0)
        - 0.12
    )


def pockets(fin):
    """Soil and grass in the hollows of a fin's summit."""

    def height(x, y):
        uneven = 0.5 * math.sin(x / 3.7 + 1.0) * math.sin(y / 2.9) + 0.3 * math.sin(x / 8.0)
        level = fin.summit - 2.6 + uneven - 12.0 * min(fin.share(x, y), 1.2) ** 4
        return min(level, fin.top(x, y) + 0.8)

    return height


# The surfaces of each rock mass, oldest first: (name, height, rule, spacing of the points, property, block)
def base_surfaces():
    return [
        ("set 1", bed(421.9), "erosional", 12, 1, "Set 1"),
        ("bar 1", foresets(421.6, 0.035, 30.0, 90.0, 0.4), "conformable", 9, 2, "Bar 1"),
        ("set 2", bed(423.2), "erosional", 12, 1, "Set 2"),
        ("bar 2", foresets(422.9, -0.030, 25.0, 150.0, -0.3), "conformable", 9, 2, "Bar 2"),
        ("set 3", channel(424.9, 1.6, 168.0, 14.0), "erosional", 7, 1, "Set 3"),
        ("channel", bed(424.5), "conformable", 12, 3, "Channel gravel"),
        ("set 4", bed(426.2), "conformable", 12, 1, "Set 4"),
        ("bench", bench, "erosional", 3.5, 4, "Bench"),
        ("debris", debris, "conformable", 2.5, 6, "Debris"),
        ("soil", soil, "conformable", 3.5, 7, "Soil"),
    ]


def fin_surfaces(fin):
    x = fin.center[0]
    beds = {
        "foot": ("foot", None, "erosional", 0, 0, None),
        "set 1": ("set 1", bed(423.2), "erosional", 9, 1, "Set 1"),
        "bar 1": ("bar 1", foresets(423.0, 0.16, 12.0, x - 12.0, 0.3), "conformable", 5, 2, "Bar 1"),
        "set 2": ("set 2", bed(429.0), "erosional", 9, 1, "Set 2"),
        "set 3": ("set 3", channel(436.0, 3.0, x + 6.0, 8.0), "erosional", 4, 1, "Set 3"),
        "bar 2": ("bar 2", foresets(435.4, -0.22, 10.0, x + 10.0, -0.4), "conformable", 5, 2, "Bar 2"),
        "set 4": ("set 4", bed(444.0), "erosional", 9, 1, "Set 4"),
        "pebbles": ("pebbles", bed(446.2, 0.3, 6.0), "conformable", 5, 3, "Pebble bed"),
        "conglomerate": ("conglomerate", bed(452.0), "conformable", 9, 4, "Lower conglomerate"),
        "summit": ("summit", fin.top, "erosional", 1.5, 5, "Upper conglomerate"),
        "soil": ("soil", pockets(fin), "conformable", 2.0, 7, "Soil"),
    }
    chosen = {
        "Septentrional Rock": "foot,set 1,bar 1,set 2,set 3,bar 2,set 4,conglomerate,summit,soil",
        "Median Rock": "foot,set 1,set 2,set 3,set 4,pebbles,conglomerate,summit,soil",
        "Markenfels": "foot,set 1,bar 1,set 2,set 3,bar 2,pebbles,conglomerate,summit,soil",
    }[fin.name]
    return [beds[name] for name in chosen.split(",")]


def stations(inside, box, spacing, seed):
    """Scattered plan positions: a staggered grid, each shaken by up to 0.35 of its spacing; those inside."""
    shake = random.Random(seed)
    points, row, y = [], 0, box[1]
    while y <= box[3]:
        x = box[0] + (0.5 * spacing if row % 2 else 0.0)
        while x <= box[2]:
            dx, dy = (0.7 * spacing * (shake.random() - 0.5) for _ in range(2))
            if inside(x + dx, y + dy, spacing):
                points.append((round(x + dx, 2), round(y + dy, 2)))
            x += spacing
        row, y = row + 1, y + spacing * 0.866
    return points


def file_name(*words):
    return "_".join("_".join(words).lower().split())


def write_points(path, positions, height):
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write("x,y,z\n")
        for x, y in positions:
            file.write(f"{EAST + x:.2f},{NORTH + y:.2f},{height(x, y):.2f}\n")


def write_region(path, outline, holes=()):
    def ring(corners):
        return [[round(EAST + x, 2), round(NORTH + y, 2)] for x, y in [*corners, corners[0]]]

    geometry = {"type": "Polygon", "coordinates": [ring(outline), *(ring(hole[::-1]) for hole in holes)]}
    feature = {"type": "Feature", "properties": {"name": path.stem}, "geometry": geometry}
    with open(path, "w", encoding="ascii", newline="\n") as file:
        json.dump({"type": "FeatureCollection", "features": [feature]}, file)
        file.write("\n")


def write_rock(folder, lines, name, edge_length, surfaces, inside, box, base=None):
    key = file_name(name)
    lines += ["", "[[rock]]", f'name = "{name}"', f'region = "{key}.geojson"', f"edge_length = {edge_length}"]
    if base is not None:
        lines.append(f"base_elevation = {base}")
    for seed, (surface, height, rule, spacing, number, block) in enumerate(surfaces):
        lines += ["", "[[rock.surface]]", f'name = "{surface}"']
        if height is None:
            lines += ['method = "constant"', f"value = {BASE}"]
        else:
            file = f"{key}_{file_name(surface)}.csv"
            write_points(folder / file, stations(inside, box, spacing, seed), height)
            lines += [f'points = "{file}"']
            lines += ['method = "natural_neighbour"', 'extrapolate = "nearest"'] if spacing < 4 else VARIOGRAM
            lines.append("tie = false")  # the survey has finer clefts than the mesh: ties make spikes
        if rule != "erosional":
            lines.append(f'rule = "{rule}"')
        if block is not None:
            lines += [f"property = {number}", f'block = "{block}"']


VARIOGRAM = ['method = "kriging"', 'variogram = {model = "matern52", range = 120, sill = 20}']
HEADER = """# SPDX-License-Identifier: GPL-3.0-or-later
# The outcrop at Haut-Barr as in chapter 5 of G. Mei's thesis: three fins of sandstone on a base.
# Written by generate.py.
format = 1
name = "Haut-Barr"
library = "library.toml"
"""


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    lines = HEADER.splitlines()
    holes = [fin.outline(1.5) for fin in FINS]
    write_region(folder / "base.geojson", base_outline(3.0), holes)
    for fin, outline in zip(FINS, holes, strict=True):
        write_region(folder / f"{file_name(fin.name)}.geojson", outline)
        along = fin.half_length * 1.3
        box = fin.center[0] - along, fin.center[1] - along, fin.center[0] + along, fin.center[1] + along
        near = lambda x, y, spacing, fin=fin: (fin.share(x, y) - 1.0) * fin.half_width < spacing  # noqa: E731
        write_rock(folder, lines, fin.name, 1.15, fin_surfaces(fin), near, box)

    def on_base(x, y, spacing):
        if (rim(x, y) - 1.0) * WIDTH / 2 > spacing:
            return False
        return all((fin.share(x, y) - 1.0) * fin.half_width > -spacing for fin in FINS)

    write_rock(
        folder, lines, "base", 2.4, base_surfaces(), on_base, (-9.0, -9.0, LENGTH + 9.0, WIDTH + 9.0), BASE
    )
    (folder / "project.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
