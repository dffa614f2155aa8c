# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the truth lies between percentiles of realizations: scripts/calibrate_ensembles.py again."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import calibrate_ensembles
import numpy as np

WORKERS = 8  # as many as surfaces


def _heights(number: int, name: str, points: np.ndarray) -> dict:
    calibrated = calibrate_ensembles.calibrated(points, number)
    row = {"surface": name, "half": calibrated.half, "most": calibrated.most}
    print(row, flush=True)
    return row


def calibration() -> dict:
    """The shares of heights of real surfaces that lie between percentiles."""
    surfaces = list(calibrate_ensembles.surfaces())
    with ProcessPoolExecutor(WORKERS) as pool:
        rows = list(pool.map(_heights, range(len(surfaces)), *zip(*surfaces, strict=True)))
    return {"surfaces": rows, "realizations": calibrate_ensembles.REALIZATIONS}
