# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of interpolation, ours and the peers', each to be run in a process of its own (process.alone).

Points are those of real horizons where ../shared/data is there, else made ones of as many.
"""

from __future__ import annotations

import csv
import time
from functools import cache

import numpy as np

from .heights_programs import gmt_surface, gstat
from .process import ROOT, Skipped

_DATA = ROOT.parent / "shared" / "data"
# Points known, and points left out: of 500 of a rough surface chance alone makes half a percent, so there are
# ten times as many where the data have them.
SETS = {
    "claudius": (4768, 500),
    "drogon": (20_000, 5000),
    "drogon 02": (20_000, 5000),
    "hamersley": (20_000, 5000),
}
TIMED = ("claudius", "drogon")
_SPHERICAL = {"model": "spherical", "range": 2000.0, "sill": 5000.0, "nugget": 0.0}
_MATERN_RANGE = 2000.0


@cache
def horizon(name: str) -> np.ndarray:
    """(P, 3) points, no two at one place."""
    if name == "claudius" and (_DATA / "claudius").is_dir():
        with (_DATA / "claudius" / "claudius.csv").open(encoding="utf-8") as file:
            rows = [r for r in csv.DictReader(file) if r["val"] and float(r["val"]) == 250 and not r["nx"]]
        points = np.array([[float(r[k]) for k in "XYZ"] for r in rows])
    elif name == "drogon" and (_DATA / "drogon").is_dir():
        points = np.loadtxt(_DATA / "drogon" / "drogon_01_topvolantis.xyz")[:, :3]
    elif name == "drogon 02" and (_DATA / "drogon").is_dir():
        points = np.loadtxt(_DATA / "drogon" / "drogon_02_toptherys.xyz")[:, :3]
    elif name == "hamersley" and (_DATA / "hamersley").is_dir():
        from realmodel.core import PointFile
        from realmodel.core.readers import read_point_file

        points, _ = read_point_file(PointFile(_DATA / "hamersley" / "dtm_rp.tif"))
    elif name not in TIMED:
        raise Skipped("../shared/data is not there")
    else:
        own = np.random.default_rng(7)
        plan = own.random((2 * SETS[name][0], 2)) * 6000
        waves = [own.normal(0, 60 / k, 2) for k in range(1, 9)]
        z = sum(
            a * np.sin(k * plan[:, 0] / 900) * np.cos(k * plan[:, 1] / 1100 + b)
            for k, (a, b) in enumerate(waves, 1)
        )
        points = np.column_stack([plan, z + own.normal(0, 0.3, len(plan))])
    return points[np.sort(np.unique(points[:, :2], axis=0, return_index=True)[1])]


def split(name: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """The points that are known, and those that are left out."""
    points = horizon(name)
    known, left_out = SETS[name]
    order = np.random.default_rng(seed).permutation(len(points))
    return points[order[left_out : left_out + known]], points[order[:left_out]]


def grid(points: np.ndarray, count: int) -> np.ndarray:
    """About so many nodes of a grid over the points' extent, row by row."""
    side = int(np.sqrt(count))
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    x, y = np.meshgrid(*(np.linspace(a, b, side) for a, b in zip(low, high, strict=True)))
    return np.column_stack([x.ravel(), y.ravel()])


def _ours(points, nodes, threads, **options):
    from realmodel.core import interpolate

    result = interpolate(points, nodes, threads=threads, **options)
    return result.z, result.variance


def _matern32(neighbours: int) -> dict:
    variogram = {"model": "matern32", "range": _MATERN_RANGE, "sill": 5000.0}
    return {"variogram": variogram, "neighbours": neighbours}


def _pykrige(points, nodes, _threads):
    try:
        from pykrige.ok import OrdinaryKriging
    except ImportError as error:
        raise Skipped(f"PyKrige is not there: {error}") from error
    middle = points.mean(axis=0)
    x, y, z = (points - middle).T
    kriging = OrdinaryKriging(
        x, y, z, "spherical", {"psill": 5000.0, "range": 2000.0, "nugget": 0.0}, exact_values=True
    )
    found = kriging.execute("points", *(nodes - middle[:2]).T, backend="C", n_closest_points=16)
    return np.asarray(found[0]) + middle[2], np.asarray(found[1])


def _scipy_thin_plate(neighbours):
    def run(points, nodes, _threads):
        try:
            from scipy.interpolate import RBFInterpolator
        except ImportError as error:
            raise Skipped(f"SciPy is not there: {error}") from error
        middle = points.mean(axis=0)
        spacing = np.sqrt(np.prod(np.ptp(points[:, :2], axis=0)) / len(points))
        known = (points - middle)[:, :2] / spacing
        spline = RBFInterpolator(known, points[:, 2], neighbors=neighbours, kernel="thin_plate_spline")
        return spline((nodes - middle[:2]) / spacing), None

    return run


def _scipy_clough_tocher(points, nodes, _threads):
    try:
        from scipy.interpolate import CloughTocher2DInterpolator
    except ImportError as error:
        raise Skipped(f"SciPy is not there: {error}") from error
    middle = points.mean(axis=0)
    found = CloughTocher2DInterpolator((points - middle)[:, :2], points[:, 2])
    return found(nodes - middle[:2]), None


def _gstat(model: str, extent: float, kappa: float, neighbours: int, drift: str = "constant"):
    return lambda points, nodes, _: gstat(points, nodes, model, extent, kappa, neighbours, drift)


# Each gives heights, variances or None, and programs of their own the seconds they took.
METHODS = {
    "kriging": _ours,
    "auto": lambda p, n, t: _ours(p, n, t, method="auto"),
    "kriging, spherical, 16": lambda p, n, t: _ours(p, n, t, variogram=_SPHERICAL, neighbours=16),
    "kriging, Matern 3/2, 16": lambda p, n, t: _ours(p, n, t, **_matern32(16)),
    "kriging, Matern 3/2, 32": lambda p, n, t: _ours(p, n, t, **_matern32(32)),
    "universal kriging, spherical, 16": lambda p, n, t: _ours(
        p, n, t, method="universal_kriging", variogram=_SPHERICAL, neighbours=16
    ),
    "PyKrige, spherical, 16": _pykrige,
    "gstat, spherical, 16": _gstat("Sph", _SPHERICAL["range"], 0.5, 16),
    "gstat, universal, spherical, 16": _gstat("Sph", _SPHERICAL["range"], 0.5, 16, "linear"),
    "gstat, Matern 3/2, 32": _gstat("Mat", _MATERN_RANGE / 4.7439, 1.5, 32),
    "GMT, surface": lambda p, n, _: gmt_surface(p, n),
    "SciPy, thin plate, 16": _scipy_thin_plate(16),
    "SciPy, thin plate, 32": _scipy_thin_plate(32),
    "SciPy, Clough-Tocher": _scipy_clough_tocher,
}


def speed(name: str, method: str, count: int, threads: int) -> dict:
    """Seconds for about so many nodes, and how many there were."""
    points, _ = split(name, 0)
    nodes = grid(points, count)
    began = time.perf_counter()
    z, _, *own = METHODS[method](points, nodes, threads)
    seconds = own[0] if own else time.perf_counter() - began
    return {"seconds": seconds, "nodes": len(nodes), "known": int(np.isfinite(z).sum())}


def accuracy(name: str, method: str, splits: int, threads: int) -> dict:
    """Root mean square errors at the points left out, and shares of them within two deviations."""
    errors, shares = [], []
    for seed in range(splits):
        points, left_out = split(name, seed)
        z, variance, *_ = METHODS[method](points, np.ascontiguousarray(left_out[:, :2]), threads)
        off = z - left_out[:, 2]
        errors.append(float(np.sqrt(np.nanmean(off**2))))
        if variance is not None:
            shares.append(float((np.abs(off) <= 2 * np.sqrt(variance)).mean()))
    return {"rmse": errors, "within": shares}


def dsi(count: int, threads: int) -> dict:
    """Seconds of discrete smooth interpolation on a mesh of about so many nodes, its making not counted."""
    from realmodel.core import interpolate, mesh_region

    points, _ = split("drogon", 0)
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    outline = [low, (high[0], low[1]), high, (low[0], high[1])]
    edge = np.sqrt(np.prod(high - low) / count / np.sqrt(0.75))
    vertices, triangles = mesh_region(np.array(outline), edge_length=float(edge))
    began = time.perf_counter()
    interpolate(points, vertices, "dsi", triangles, threads=threads)
    return {"seconds": time.perf_counter() - began, "nodes": len(vertices)}
