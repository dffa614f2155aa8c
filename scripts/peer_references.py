#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes tests/data/kriging/peers.json: what PyKrige and GSTools say of small cases, for tests/core to
compare with. They are no part of the tests' environment because PyKrige has to be compiled.

    python -m venv build/peers && build/peers/bin/pip install PyKrige==1.7.3 gstools==1.7.0
    build/peers/bin/python scripts/peer_references.py
"""

import importlib.metadata
import json
from pathlib import Path

import gstools
import numpy as np
from pykrige.ok import OrdinaryKriging
from pykrige.uk import UniversalKriging

_FILE = Path(__file__).resolve().parents[1] / "tests" / "data" / "kriging" / "peers.json"
_ORIGIN = np.array([431250.25, 5398781.5])
_SILL, _NUGGET, _RANGE = 9.0, 0.5, 600.0
# Practical ranges: PyKrige's gaussian is 1 - exp(-(h / (4/7 range))^2), ours 1 - exp(-3 (h / range)^2).
_PYKRIGE_RANGE = {"spherical": 1.0, "exponential": 1.0, "gaussian": 7 / (4 * np.sqrt(3))}
# GSTools' Matern is that of sqrt(nu) h / length, ours that of 4.74 h / range or 5.92 h / range.
_MATERN = {"matern32": (1.5, 4.743864518390579), "matern52": (2.5, 5.918649346310188)}


def _case(model, peer, drift, anisotropy, nugget, z, variance):
    settings = {"model": model, "range": _RANGE, "sill": _SILL, "nugget": nugget}
    return {
        "peer": peer,
        "drift": drift,
        "variogram": settings,
        "anisotropy": anisotropy,
        "z": [float(v) for v in z],
        "variance": [float(v) for v in variance],
    }


def _pykrige(points, nodes, model, drift, nugget):
    parameters = {"psill": _SILL - nugget, "range": _RANGE * _PYKRIGE_RANGE[model], "nugget": nugget}
    kind = {"constant": OrdinaryKriging, "linear": UniversalKriging}[drift]
    more = {"drift_terms": ["regional_linear"]} if drift == "linear" else {}
    kriging = kind(*points.T, variogram_model=model, variogram_parameters=parameters, **more)
    z, variance = kriging.execute("points", *nodes.T)
    return _case(model, "PyKrige", drift, None, nugget, z, variance)


def _gstools(points, nodes, model, anisotropy):
    nu, scale = _MATERN[model]
    ratio, azimuth = (anisotropy["ratio"], anisotropy["azimuth"]) if anisotropy else (1.0, 0.0)
    covariance = gstools.Matern(
        dim=2,
        var=_SILL,
        len_scale=_RANGE * np.sqrt(nu) / scale,
        nu=nu,
        anis=1 / ratio,
        angles=np.radians(90 - azimuth),
        rescale=1.0,
    )
    x, y, values = points.T
    kriging = gstools.krige.Ordinary(covariance, (x, y), values, exact=True)
    z, variance = kriging((nodes[:, 0], nodes[:, 1]))
    return _case(model, "GSTools", "constant", anisotropy, 0.0, z, variance)


def main():
    own = np.random.default_rng(5)
    plan = own.random((40, 2)) * 1000
    height = 300 + 3 * np.sin(plan[:, 0] / 150) * np.cos(plan[:, 1] / 200) + 0.004 * plan[:, 0]
    points = np.column_stack([np.round(plan, 2), np.round(height, 3)])
    nodes = np.round(own.random((25, 2)) * 1100 - 50, 2)
    cases = [
        _pykrige(points, nodes, model, drift, nugget)
        for model in _PYKRIGE_RANGE
        for drift in ("constant", "linear")
        for nugget in (0.0 if model != "gaussian" else 0.1, _NUGGET)
    ]
    for model in _MATERN:
        for anisotropy in (None, {"ratio": 2.0, "azimuth": 30.0}):
            cases.append(_gstools(points, nodes, model, anisotropy))
    versions = {name: importlib.metadata.version(name) for name in ("PyKrige", "gstools", "numpy")}
    _FILE.parent.mkdir(parents=True, exist_ok=True)
    content = {
        "made_by": "scripts/peer_references.py",
        "versions": versions,
        "origin": _ORIGIN.tolist(),
        "points": points.tolist(),
        "nodes": nodes.tolist(),
        "cases": cases,
    }
    _FILE.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
