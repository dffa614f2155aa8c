#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of Claudius in docs/dev/fields.md: what Loop3D's ImplicitBenchmark measures, on its lattice of
38 x 55 x 30 nodes: the mean and the standard deviation of the signed distances from reference points of a
horizon to its level set, with all horizons given (its "Validation"), and how many critical points the field
has.

    scripts/compare_fields.py [--write docs/dev/fields.md]

Its reference points are not public; here they are the points of the data that the solution has not seen, by
their column Cutoff, and all of a horizon that is left out, from the mean of f on them. Needs the built module
(scripts/build.sh) and ../shared/data/folds/claudius_all.
"""

import argparse
import re
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "addon"))

from realmodel.core.base.algebra import norm  # noqa: E402
from realmodel.core.base.work import run  # noqa: E402
from realmodel.core.fields import (  # noqa: E402
    HeldData,
    Lattice,
    LevelSetData,
    SharedCorners,
    fields_with_contacts,
    rises,
    solve_field,
)

DATA = ROOT.parent / "shared" / "data" / "folds" / "claudius_all"
HORIZONS = "DCBA"  # the oldest first
LOW, HIGH = np.array([548800.0, 7816600.0, -11010.0]), np.array([552500.0, 7822000.0, -8400.0])
COUNTS = np.array([38, 55, 30])
CASES = ((0.1, ""), (0.9, ""), (0.1, "B"), (1.0, "B"))  # share of the points given; horizon left out
HEADER = (
    "| points given | contacts | order | D | C | B | A | critical points |",
    "|---|---|---|---|---|---|---|---|",
)
TABLE = re.compile(re.escape("\n".join(HEADER)) + r"\n(?:\|.*\n)*")


def inside(points):
    """Those of some rows that lie in the box."""
    return points[np.all((points[:, :3] >= LOW) & (points[:, :3] <= HIGH), axis=1)]


def table(name):
    return inside(np.loadtxt(DATA / f"{name}.csv", delimiter=";", skiprows=1))


def solved(horizons, share, left_out):
    """The field, its level sets through its contacts, and the horizons that it has."""
    given = [name for name in HORIZONS if name != left_out]
    contacts = [horizons[name][horizons[name][:, 4] < share, :3] for name in given]
    dips = table("Dips")
    normals = -dips[:, 3:6] / norm(dips[:, 3:6])[:, None]  # toward younger rock
    surfaces = np.repeat(np.arange(len(given), dtype=np.int32), [len(each) for each in contacts])
    data = LevelSetData(given, np.concatenate(contacts), surfaces, dips[:, :3], normals)
    lattice = Lattice(tuple(LOW), tuple((HIGH - LOW) / (COUNTS - 1)), tuple(COUNTS.tolist()))
    field = run(lambda work: solve_field(lattice, data, work))
    alone = SharedCorners(np.arange(lattice.nodes)[None], np.ones((1, len(data.contacts)), bool))
    held = HeldData(data.dips, data.normals, data.bounds, np.empty(0), np.empty(0))
    through = run(
        lambda work: fields_with_contacts(work, [field], data.contacts, data.contact_surfaces, alone, held)
    )
    return field, through[0], given


def distances(field, points, level):
    """(P,) about how far points are from a level set; of None from that of their mean."""
    rise, far = rises(field, points)
    excess = field.at(points)
    return (excess - (excess.mean() if level is None else level)) / norm(rise / far)


def row(horizons, share, left_out):
    field, through, given = solved(horizons, share, left_out)
    columns = []
    for name in HORIZONS:
        points = horizons[name]
        unseen = points[points[:, 4] >= share] if name in given else points
        if not len(unseen):
            columns.append("")
            continue
        level = through.levels[given.index(name)] if name in given else None
        far = distances(through, unseen[:, :3], level)
        columns.append(f"{far.mean():.1f} ± {far.std():.1f}")
    what = f"{share:.0%}" + (f", without {left_out}" if left_out else "")
    count = sum((horizons[name][:, 4] < share).sum() for name in given)
    critical = len(through.critical_points)
    return f"| {what} | {count:,} | {field.order} | {' | '.join(columns)} | {critical} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    horizons = {name: np.vstack([table(f"{name}Points"), table(f"{name}Section")]) for name in HORIZONS}
    lines = [*HEADER]
    for share, left_out in CASES:
        lines.append(row(horizons, share, left_out))
        print(lines[-1], flush=True)
    if given.write is not None:
        page = given.write.read_text(encoding="utf-8")
        given.write.write_text(TABLE.sub("\n".join(lines) + "\n", page), encoding="utf-8")


if __name__ == "__main__":
    main()
