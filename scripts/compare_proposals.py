#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How good projects are that follow from intervals of boreholes alone (realmodel new): of histories in closed
form (scripts/field_data/histories.py) and random ones the share of neighboring units in the right order, and
the share of random points in the right block, beside that of a project with the true order and rules.

    scripts/compare_proposals.py [--random N] [--seeds N] [--write docs/dev/field_data.md]

Needs the built module (scripts/build.sh).
"""

import argparse
import re
import sys
import tempfile
import warnings
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "scripts")]

from field_data.histories import BASE, HISTORIES, LENGTH, History, random_history  # noqa: E402
from field_data.measured import EDGE, Measured, measure, project, random_points, right_share  # noqa: E402
from realmodel.core import InputRefused, Project, build, propose_project  # noqa: E402

HEADER = (
    "| histories | neighbors in order | right block, order given | right block, proposed | largest loss |",
    "|---|---|---|---|---|",
)
TABLE = re.compile(re.escape("\n".join(HEADER)) + r"\n(?:\|.*\n)*")
SQUARE = [[0, 0], [LENGTH, 0], [LENGTH, LENGTH], [0, LENGTH]]


@dataclass
class Compared:
    """Of a history: the neighboring units, how many of them are in the right order, and the shares of random
    points in the right block with the order given, and proposed."""

    pairs: int
    right: int
    given: float
    proposed: float


def proposed(history: History, data: Measured, seed: int) -> tuple[Project, dict[int, str]]:
    """The project from the logs alone, and the names of its units by block, from which no order follows."""
    numbers = np.random.default_rng(seed).permutation(len(history.layers))
    names = {block: f"unit {number}" for block, number in enumerate(numbers.tolist())}
    logs = data.logs
    with tempfile.TemporaryDirectory() as folder:
        collars, intervals = Path(folder, "collars.csv"), Path(folder, "intervals.csv")
        rows, places = ["hole,from,to,block"], {}
        for at in range(0, len(logs), 2):
            hole, block = logs.holes[at], int(logs.blocks[at][1:])
            places.setdefault(hole, (*logs.places[at, :2], logs.places[at, 2] + logs.depths[at]))
            rows.append(f"{hole},{float(logs.depths[at])!r},{float(logs.depths[at + 1])!r},{names[block]}")
        intervals.write_text("\n".join(rows))
        lines = [",".join(map(repr, map(float, place))) for place in places.values()]
        collars.write_text(
            "\n".join(["hole,x,y,z", *(f"{hole},{line}" for hole, line in zip(places, lines, strict=True))])
        )
        made = propose_project(
            boreholes={"collars": collars, "intervals": intervals}, region=np.array(SQUARE, float)
        )
        made.rocks[0].edge_length, made.rocks[0].base_elevation = EDGE, BASE - 1000
        return build(made), names


def order_given(history: History, data: Measured) -> Project:
    """The project with the true surfaces and rules, and the same data."""
    given = project(history, data, "all")
    rock = given.rocks[0]
    rock.observations = data.logs
    for surface in rock.surfaces:
        surface.dips = None
    seen = {int(block[1:]) for block in data.logs.blocks.tolist()}
    rock.surfaces = [
        surface
        for number, surface in enumerate(rock.surfaces)
        if number in seen or number == len(history.layers) - 1
    ]
    collars = {
        hole: (*place[:2], place[2] + depth)
        for hole, place, depth in zip(
            data.logs.holes.tolist(), data.logs.places, data.logs.depths, strict=True
        )
    }
    rock.surfaces[-1].points, rock.surfaces[-1].method = np.array(list(collars.values())), None
    return given


def compare(history: History, seed: int) -> Compared:
    data = measure(history, seed)
    points, blocks = random_points(history)
    model, names = proposed(history, data, seed)
    order = model.project.proposal.order
    seen = [block for block in range(len(history.layers)) if names[block] in order]
    right = sum(order.index(names[a]) < order.index(names[b]) for a, b in pairwise(seen))
    return Compared(
        len(seen) - 1,
        right,
        right_share(build(order_given(history, data)), points, blocks),
        right_share(model, points, blocks, names),
    )


def row(name: str, compared: list[Compared]) -> str:
    pairs, right = sum(c.pairs for c in compared), sum(c.right for c in compared)
    given, proposed_share = (np.array([getattr(c, key) for c in compared]) for key in ("given", "proposed"))
    loss = (given - proposed_share).max()
    return f"| {name} | {right} of {pairs} | {given.mean():.3f} | {proposed_share.mean():.3f} | {loss:.3f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--random", type=int, default=100, help="random histories")
    parser.add_argument("--first", type=int, default=0, help="the seed of the first of them")
    parser.add_argument("--seeds", type=int, default=3, help="draws of holes of each of the eight")
    parser.add_argument("--write", type=Path)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    for history in HISTORIES:
        if options.seeds:
            rows.append(row(history.name, [compare(history, seed) for seed in range(options.seeds)]))
            print(rows[-1], flush=True)
    compared = []
    for seed in range(options.first, options.first + options.random):
        history = random_history(seed)
        try:
            compared.append(compare(history, seed))
        except InputRefused as refusal:
            print(f"random {seed}: {refusal}")
            continue
        last = compared[-1]
        what = f"{last.right} of {last.pairs}, {last.given:.3f}, {last.proposed:.3f}"
        print(f"random {seed} ({history.name}): {what}", flush=True)
    if compared:
        rows.append(row(f"{len(compared)} random", compared))
        print(rows[-1])
    if options.write is not None:
        page = options.write.read_text(encoding="utf-8")
        table = "\n".join([*HEADER, *rows]) + "\n"
        options.write.write_text(TABLE.sub(lambda _: table, page), encoding="utf-8")


if __name__ == "__main__":
    main()
