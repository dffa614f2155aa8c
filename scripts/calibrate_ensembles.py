#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/ensembles.md: how often left-out points of real surfaces lie between percentiles of
drawn heights, and how often the volume between two random surfaces does.

    PYTHONPATH=addon python scripts/calibrate_ensembles.py             # needs ../shared/data
    PYTHONPATH=addon python scripts/calibrate_ensembles.py TRUTHS      # so many pairs of random surfaces

Needs the built module.
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


def _drawn(method, data, nodes, seed, realizations, area):
    """(realizations, N) heights at the nodes."""
    settings, work, known = checked_options(method, {}), Work(), {}
    return np.array(
        [
            Draw(area, Noise((seed, number)), known).heights(method, Task(work, data, nodes, settings, 0)).z
            for number in range(realizations)
        ]
    )


def calibrated(points, seed, realizations=REALIZATIONS):
    """Of points (P, 3) some are data, and heights are drawn at others."""
    chosen = np.random.default_rng(seed).permutation(len(points))
    data = np.ascontiguousarray(points[chosen[:DATA]])
    others = points[chosen[DATA : DATA + LEFT_OUT]]
    nodes = np.ascontiguousarray(others[:, :2])
    area = FieldArea(points[:, :2].min(axis=0), points[:, :2].max(axis=0))
    drawn = _drawn("kriging", data, nodes, seed, realizations, area)
    p10, p25, p75, p90 = np.percentile(drawn, [10, 25, 75, 90], axis=0)
    z = others[:, 2]
    return Calibration(
        float(((p25 < z) & (z < p75)).mean()),
        float(((p10 < z) & (z < p90)).mean()),
        float(np.sqrt(((drawn.mean(axis=0) - z) ** 2).mean())),
        float(np.sqrt(drawn.var(axis=0).mean())),
    )


def rank_of_a_volume(seed, places, method, realizations=40):
    """Which share of realizations has less volume between two random surfaces than there is: each a plane
    and a Gaussian field with a deviation of 15 m and a range of 200 to 500 m, known at so many places of
    1 km2."""
    chance = np.random.default_rng(seed)
    along = np.linspace(25.0, 975.0, 20)
    nodes = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    area, known = FieldArea(np.zeros(2), np.full(2, 1000.0)), chance.uniform(0.0, 1000.0, (places, 2))
    at = np.concatenate([known, nodes])
    distance = np.linalg.norm(at[:, None] - at[None], axis=2)
    between, drawn = 0.0, 0.0
    for number, sign in enumerate((-1.0, 1.0)):
        covariance = np.exp(-(((distance / chance.uniform(200.0, 500.0)) * 1.7) ** 2))
        covariance += 1e-9 * np.eye(len(at))
        field = 15.0 * np.linalg.cholesky(covariance) @ chance.standard_normal(len(at))
        z = field + at @ chance.uniform(-0.05, 0.05, 2) + 200.0 * number
        data = np.column_stack([known, z[:places]])
        between += sign * z[places:].mean()
        drawn += sign * _drawn(method, data, nodes, 2 * seed + number, realizations, area).mean(axis=1)
    return float((drawn < between).mean())


def of_truths(count):
    print("| method | places | below P10 | within P10-P90 | above P90 |\n|---|---|---|---|---|")
    for method in ("kriging", "universal_kriging"):
        for places in (12, 25):
            ranks = np.array([rank_of_a_volume(seed, places, method) for seed in range(count)])
            below, above = (ranks < 0.1).mean(), (ranks > 0.9).mean()
            shares = " | ".join(f"{100 * share:.0f} %" for share in (below, 1.0 - below - above, above))
            print(f"| {method} | {places} | {shares} |", flush=True)


def surfaces():
    """(name, points (P, 3)) of the real surfaces."""
    for name, points in real_data.claudius_points().items():
        yield f"claudius, {name.replace('_', ' ')}", points
    for name, (vertices, _) in real_data.drogon().items():
        yield f"drogon, {name[3:]}", vertices


def main():
    if len(sys.argv) > 1:
        of_truths(int(sys.argv[1]))
        return
    print("| surface | within P25-P75 | within P10-P90 | error | deviation |\n|---|---|---|---|---|")
    for number, (name, points) in enumerate(surfaces()):
        found = calibrated(points, number)
        print(
            f"| {name} | {100 * found.half:.0f} % | {100 * found.most:.0f} % | {found.error:.2f} m "
            f"| {found.deviation:.2f} m |"
        )


if __name__ == "__main__":
    main()
