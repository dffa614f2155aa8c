# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the truth lies between percentiles of realizations: scripts/calibrate_ensembles.py again."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import calibrate_ensembles
import numpy as np

TRUTHS = 100  # pairs of random surfaces for each method and number of places
WORKERS = 2
METHODS = ("kriging", "universal_kriging")
PLACES = (12, 25)


def _heights(number: int, name: str, points: np.ndarray) -> dict:
    calibrated = calibrate_ensembles.calibrated(points, number)
    row = {"surface": name, "half": calibrated.half, "most": calibrated.most}
    print(row, flush=True)
    return row


def heights() -> dict:
    """The shares of heights of real surfaces that lie between percentiles."""
    surfaces = list(calibrate_ensembles.surfaces())
    with ProcessPoolExecutor(WORKERS) as pool:
        rows = list(pool.map(_heights, range(len(surfaces)), *zip(*surfaces, strict=True)))
    return {"surfaces": rows, "realizations": calibrate_ensembles.REALIZATIONS}


def _volumes(method: str, places: int) -> dict:
    ranks = np.array([calibrate_ensembles.rank_of_a_volume(seed, places, method) for seed in range(TRUTHS)])
    most = float(((ranks >= 0.1) & (ranks <= 0.9)).mean())
    row = {"method": method, "places": places, "most": most}
    print(row, flush=True)
    return row


def volumes() -> dict:
    """The share of volumes between two random surfaces that lie between P10 and P90."""
    cases = [(method, places) for method in METHODS for places in PLACES]
    with ProcessPoolExecutor(WORKERS) as pool:
        rows = list(pool.map(_volumes, *zip(*cases, strict=True)))
    return {"volumes": rows, "truths": TRUTHS}
