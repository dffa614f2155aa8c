#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/ensembles.md on series of fields: how often a block is there that realizations of folds
of known truth have there with some probability.

    PYTHONPATH=addon python scripts/calibrate_fields.py

Needs the built module and ../shared/data.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from realmodel.core.base.work import run
from realmodel.core.fields import FieldDraws, Lattice
from realmodel.core.heights.realizations.turning_bands import Noise

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "core"))

import test_fields as folds  # noqa: E402

REALIZATIONS, PLACES = 100, 6000
BINS = (0.05, 0.2, 0.4, 0.6, 0.8, 0.95)


def shares(data, lattice, places, realizations=REALIZATIONS):
    """(N, B) float64: the share of the realizations in which each block is at each place (N, 3)."""
    known, counts = {}, np.zeros((len(places), len(data.names) + 1))
    for number in range(realizations):
        draws = FieldDraws(Noise((1, number)).normal, known, 0.0)
        field = run(lambda work, draws=draws: draws.field(lattice, data, work, 0))
        counts[np.arange(len(places)), np.searchsorted(field.levels, field.at(places))] += 1
    return counts / realizations


def cases():
    """(name, data, lattice, places (N, 3), the true block (N,) at each) of folds."""
    low, high = folds.LATTICE.corners
    places = np.random.default_rng(2).uniform(low, high, (PLACES, 3))
    for function in (folds.overturned, folds.cylinder, folds.dome):
        data = folds._data(function, holes=8, dips=20)
        truth = np.searchsorted(folds.LEVELS, function(places))
        yield f"{function.__name__}, closed form", data, folds.LATTICE, places, truth
    lattice = Lattice((0.0, 0.0, 0.0), (250.0, 250.0, 250.0), (33, 33, 23))
    for name in ("n_upright", "n_unconformity"):
        data, places, truth = folds.noddy(name)
        yield (
            f"{name}, Noddy, a third of the data",
            folds.some_of(data, 3),
            lattice,
            places[:PLACES],
            truth[:PLACES],
        )


def main():
    between = [f"{100 * a:.0f}-{100 * b:.0f} %" for a, b in pairwise(BINS)]
    print(f"| fold | most probable block is right | {' | '.join(between)} |")
    print("|---" * (2 + len(between)) + "|")
    for name, data, lattice, places, truth in cases():
        share = shares(data, lattice, places)
        is_true = truth[:, None] == np.arange(share.shape[1])
        row = [f"{100 * (share.argmax(axis=1) == truth).mean():.1f} %"]
        for low, high in pairwise(BINS):
            here = (share > low) & (share <= high)
            row.append(f"{100 * is_true[here].mean():.0f} % of {here.sum():,}")
        print(f"| {name} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
