# SPDX-License-Identifier: GPL-3.0-or-later
"""Kriging with slopes as textbooks write it: every datum a row of weights on heights, all in one full
matrix."""

import numpy as np
from dense_kriging import drift_terms, semivariance


def dense_kriging_with_dips(points, dips, nodes, variogram, baseline, drift="constant", anisotropy=None):
    """z (N,), variance (N,). dips: (positions (D, 2), gradients (D, 2)); a slope is the difference of the
    heights at the ends of the baseline, of the surface without its nugget."""
    positions, gradients = dips
    half = baseline / 2 * np.eye(2)
    ends = [positions + sign * half[axis] for axis in (0, 1) for sign in (1, -1)]
    places = np.vstack([points[:, :2], *ends])
    p, d = len(points), len(positions)
    rows = np.zeros((p + 2 * d, len(places)))
    rows[:p, :p] = np.eye(p)
    for axis in (0, 1):
        for number in range(d):
            rows[p + axis * d + number, p + 2 * axis * d + number] = 1 / baseline
            rows[p + axis * d + number, p + (2 * axis + 1) * d + number] = -1 / baseline
    smooth = {**variogram, "nugget": 0.0}
    if "structures" in variogram:
        sill = sum(part["sill"] for part in variogram["structures"])
    else:
        sill = variogram["sill"] - variogram.get("nugget", 0.0)
        smooth["sill"] = sill
    covariance = sill - semivariance(places, places, smooth, anisotropy)
    c = rows @ covariance @ rows.T
    c[:p, :p] += variogram.get("nugget", 0.0) * np.eye(p)
    middle, extent = points[:, :2].mean(axis=0), np.ptp(places, axis=0).max()
    f = rows @ drift_terms((places - middle) / extent, drift)
    scale = 1 / np.sqrt(np.diag(c))
    c, f = c * scale[:, None] * scale, f * scale[:, None]
    right = (rows @ (sill - semivariance(places, nodes, smooth, anisotropy))) * scale[:, None]
    f0 = drift_terms((nodes - middle) / extent, drift).T
    n, terms = f.shape
    system = np.block([[c, f], [f.T, np.zeros((terms, terms))]])
    both = np.vstack([right, f0])
    weights = np.linalg.solve(system, both)
    values = np.concatenate([points[:, 2], gradients[:, 0], gradients[:, 1]]) * scale
    variance = sill + variogram.get("nugget", 0.0) - (weights * both).sum(axis=0)
    return weights[:n].T @ values, variance
