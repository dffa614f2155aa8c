# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the input files of the uncertain valley: ground.off, collars.csv, and picks.csv.

    python3 blend_samples/uncertain_valley/generate.py [FOLDER]

Everything is made up. Heights are formulas of the plan position in meters; boreholes see them only where they
are. Only `math` and `random.Random` are used and numbers are written in fixed decimals, so every machine
writes the same files.
"""

import math
import random
import sys
from pathlib import Path

LENGTH, WIDTH = 3000.0, 2000.0
CELL = 50.0  # of the terrain model
BASE = 280.0
HOLES = 28
APART = 230.0  # nobody drills nearer to another hole


def side(x, y):
    """Distance from the axis of the valley, which bends."""
    return y - 1000.0 - 220.0 * math.sin(x / 700.0)


def ground(x, y):
    """A valley floor that falls eastward, between two slopes."""
    out = (side(x, y) / 950.0) ** 2
    return (
        412.0 - 0.003 * x + 16.0 * out * out / (0.3 + out) + 1.5 * math.sin(x / 260.0) * math.cos(y / 210.0)
    )


def bedrock(x, y):
    """A channel of changing depth that a glacier has cut, filled since."""
    deep = 62.0 + 12.0 * math.sin(x / 410.0)
    wide = 430.0 + 90.0 * math.cos(x / 530.0)
    rough = 5.0 * math.sin(x / 190.0 + 0.7) * math.cos(y / 170.0)
    return ground(x, y) - 7.0 + rough - deep * math.exp(-((side(x, y) / wide) ** 2))


def gravel(x, y):
    """Where the gravel in the channel ends."""
    return 367.0 - 0.003 * x + 4.0 * math.sin(x / 310.0) + 3.0 * math.cos(y / 280.0)


def clay(x, y):
    """Where the lake clay on it ends; it has settled as the gravel lies."""
    return 388.0 - 0.003 * x + 0.6 * (gravel(x, y) - 367.0 + 0.003 * x) + 2.0 * math.sin((x + y) / 450.0)


def boreholes():
    """Collars and picks; a hole has a pick of a top where there is something of the layer below it."""
    draw = random.Random(19)
    collars, picks, places = ["hole,x,y,z"], ["hole,surface,depth"], []
    while len(places) < HOLES:
        x, y = round(draw.uniform(40, LENGTH - 40), 1), round(draw.uniform(40, WIDTH - 40), 1)
        if any(math.hypot(x - a, y - b) < APART for a, b in places):
            continue
        places.append((x, y))
        name, top, below = f"V{len(places):02d}", ground(x, y), -math.inf
        collars.append(f"{name},{x:.1f},{y:.1f},{top:.2f}")
        for surface, height in (("bedrock", bedrock), ("gravel", gravel), ("clay", clay)):
            z = height(x, y)
            if below < z < top:
                picks.append(f"{name},{surface},{top - z:.2f}")
                below = z
    return "\n".join(collars) + "\n", "\n".join(picks) + "\n"


def terrain():
    """The ground as triangles; it reaches a little beyond the region."""
    columns, rows = int(LENGTH / CELL) + 2, int(WIDTH / CELL) + 2
    corners = [(c * CELL - 31.0, r * CELL - 17.0) for r in range(rows) for c in range(columns)]
    faces = []
    for r in range(rows - 1):
        for c in range(columns - 1):
            k = r * columns + c
            faces += [(k, k + 1, k + columns + 1), (k, k + columns + 1, k + columns)]
    lines = ["OFF", f"{len(corners)} {len(faces)} 0"]
    lines += [f"{x:.0f} {y:.0f} {ground(x, y):.2f}" for x, y in corners]
    lines += ["3 {} {} {}".format(*face) for face in faces]
    return "\n".join(lines) + "\n"


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    collars, picks = boreholes()
    for name, text in {"ground.off": terrain(), "collars.csv": collars, "picks.csv": picks}.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
