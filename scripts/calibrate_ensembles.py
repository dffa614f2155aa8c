#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/ensembles.md: how often left-out points of real surfaces lie between percentiles of drawn
heights.

    PYTHONPATH=addon python scripts/calibrate_ensembles.py

Needs the built module and ../shared/data.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from realmodel.core.base.work import Work
from realmodel.core.heights import Task
from realmodel.core.heights.realizations.draws import Draw
from realmodel.core.heights.realizations.turning_bands import FieldArea, Noise
from realmodel.core.settings.methods import checked_options

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "core"))

from stacks import real_data  # noqa: E402

DATA, LEFT_OUT, REALIZATIONS = 150, 1000, 200


@dataclass(frozen=True)
class Calibration:
    """Shares of left-out points between P25 and P75, and between P10 and P90; the root mean square of errors,
    and of the standard deviations of drawn heights."""

    half: float
    most: float
    error: float
    deviation: float


def calibrated(points, seed, realizations=REALIZATIONS):
    """Of points (P, 3) some are data, and heights are drawn at others."""
    chosen = np.random.default_rng(seed).permutation(len(points))
    data = np.ascontiguousarray(points[chosen[:DATA]])
    others = points[chosen[DATA : DATA + LEFT_OUT]]
    nodes = np.ascontiguousarray(others[:, :2])
    area, known = FieldArea(points[:, :2].min(axis=0), points[:, :2].max(axis=0)), {}
    settings, work = checked_options("kriging", {}), Work()
    drawn = np.array(
        [
            Draw(area, Noise((seed, number)), known)
            .heights("kriging", Task(work, data, nodes, settings, 0))
            .z
            for number in range(realizations)
        ]
    )
    p10, p25, p75, p90 = np.percentile(drawn, [10, 25, 75, 90], axis=0)
    z = others[:, 2]
    return Calibration(
        float(((p25 < z) & (z < p75)).mean()),
        float(((p10 < z) & (z < p90)).mean()),
        float(np.sqrt(((drawn.mean(axis=0) - z) ** 2).mean())),
        float(np.sqrt(drawn.var(axis=0).mean())),
    )


def surfaces():
    """(name, points (P, 3)) of the real surfaces."""
    for name, points in real_data.claudius_points().items():
        yield f"claudius, {name.replace('_', ' ')}", points
    for name, (vertices, _) in real_data.drogon().items():
        yield f"drogon, {name[3:]}", vertices


def main():
    print("| surface | within P25-P75 | within P10-P90 | error | deviation |\n|---|---|---|---|---|")
    for number, (name, points) in enumerate(surfaces()):
        found = calibrated(points, number)
        print(
            f"| {name} | {100 * found.half:.0f} % | {100 * found.most:.0f} % | {found.error:.2f} m "
            f"| {found.deviation:.2f} m |"
        )


if __name__ == "__main__":
    main()
