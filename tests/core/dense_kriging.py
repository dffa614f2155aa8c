# SPDX-License-Identifier: GPL-3.0-or-later
"""Kriging as textbooks write it, with all points in one full matrix: what the tests compare with."""

import numpy as np

SHAPES = {
    "spherical": lambda t: np.where(t < 1, 1.5 * t - 0.5 * t**3, 1.0),
    "exponential": lambda t: 1 - np.exp(-3 * t),
    "gaussian": lambda t: 1 - np.exp(-3 * t**2),
    "cubic": lambda t: np.where(t < 1, 7 * t**2 - 8.75 * t**3 + 3.5 * t**5 - 0.75 * t**7, 1.0),
    "matern32": lambda t: 1 - (1 + 4.743864518390579 * t) * np.exp(-4.743864518390579 * t),
    "matern52": lambda t: (
        1 - (1 + 5.918649346310188 * t + 5.918649346310188**2 * t**2 / 3) * np.exp(-5.918649346310188 * t)
    ),
}


def distances(a, b, ratio=1.0, azimuth=0.0):
    """Distances in plan, those across the long axis (azimuth clockwise from north) stretched by the ratio."""
    d = a[:, None, :2] - b[None, :, :2]
    angle = np.radians(azimuth)
    along = d[..., 0] * np.sin(angle) + d[..., 1] * np.cos(angle)
    across = d[..., 0] * np.cos(angle) - d[..., 1] * np.sin(angle)
    return np.hypot(along, ratio * across)


def semivariance(a, b, variogram, anisotropy=None):
    """gamma between places, of {model, range, sill, nugget} or {nugget, structures}."""
    anisotropy = anisotropy or {}
    structures = variogram.get("structures")
    if structures is None:
        part = {**variogram, "sill": variogram["sill"] - variogram.get("nugget", 0.0)}
        structures = [part]
    gamma = np.zeros((len(a), len(b)))
    for part in structures:
        if part["model"] == "wave":
            gamma += part["sill"] * _wave(a, b, part["range"], **(part.get("anisotropy") or anisotropy))
            continue
        h = distances(a, b, **(part.get("anisotropy") or anisotropy))
        gamma += part["sill"] * SHAPES[part["model"]](h / part["range"])
    return np.where(distances(a, b) > 0, variogram.get("nugget", 0.0) + gamma, 0.0)


def _wave(a, b, range, ratio=1.0, azimuth=0.0):
    d = a[:, None, :2] - b[None, :, :2]
    angle = np.radians(azimuth)
    turns = ratio * (d[..., 0] * np.cos(angle) - d[..., 1] * np.sin(angle)) / range
    return 1 - np.cos(2 * np.pi * turns) * np.exp(-3 * (distances(a, b) / range) ** 2)


def drift_terms(places, drift):
    x, y = places[:, 0], places[:, 1]
    terms = [np.ones(len(places))]
    if drift != "constant":
        terms += [x, y]
    if drift == "quadratic":
        terms += [x * x, x * y, y * y]
    return np.column_stack(terms)


def dense_kriging(points, nodes, variogram, drift="constant", anisotropy=None):
    """z (N,), variance (N,). Coordinates count from the middle of the points, in their extent."""
    middle, extent = points[:, :2].mean(axis=0), np.ptp(points[:, :2], axis=0).max()
    f = drift_terms((points[:, :2] - middle) / extent, drift)
    n, terms = f.shape
    system = np.zeros((n + terms, n + terms))
    system[:n, :n] = semivariance(points, points, variogram, anisotropy)
    system[:n, n:], system[n:, :n] = f, f.T
    right = np.vstack(
        [
            semivariance(points, nodes, variogram, anisotropy),
            drift_terms((nodes[:, :2] - middle) / extent, drift).T,
        ]
    )
    weights = np.linalg.solve(system, right)
    return weights[:n].T @ points[:, 2], (weights * right).sum(axis=0)
