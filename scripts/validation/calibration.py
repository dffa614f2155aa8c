# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the truth lies between percentiles of realizations: the tables of docs/ensembles.md again."""

from __future__ import annotations

import time

import calibrate_ensembles
import numpy as np

TRUTHS = 100  # pairs of random surfaces for each method and number of places
METHODS = ("kriging", "universal_kriging")
PLACES = (12, 25)


def calibration() -> dict:
    began = time.process_time()
    surfaces = []
    for number, (name, points) in enumerate(calibrate_ensembles.surfaces()):
        found = calibrate_ensembles.calibrated(points, number)
        surfaces.append({"surface": name, "half": found.half, "most": found.most})
        print(surfaces[-1], flush=True)
    volumes = []
    for method in METHODS:
        for places in PLACES:
            ranks = np.array(
                [calibrate_ensembles.rank_of_a_volume(seed, places, method) for seed in range(TRUTHS)]
            )
            most = float(((ranks >= 0.1) & (ranks <= 0.9)).mean())
            volumes.append({"method": method, "places": places, "most": most})
            print(volumes[-1], flush=True)
    return {
        "surfaces": surfaces,
        "volumes": volumes,
        "truths": TRUTHS,
        "realizations": calibrate_ensembles.REALIZATIONS,
        "seconds": round(time.process_time() - began, 1),
    }
