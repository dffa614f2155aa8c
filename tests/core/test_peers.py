# SPDX-License-Identifier: GPL-3.0-or-later
"""Kriging as PyKrige and GSTools say it (tests/data/kriging/peers.json, by scripts/peer_references.py), and
points of real horizons left out, beside what others make of them."""

import json

import numpy as np
import pytest
from conftest import ROOT
from realmodel.core import interpolate
from scipy.interpolate import CloughTocher2DInterpolator, RBFInterpolator
from stacks import places, real_data

PEERS = json.loads((ROOT / "tests" / "data" / "kriging" / "peers.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("at_utm", [False, True])
@pytest.mark.parametrize("case", PEERS["cases"], ids=lambda c: f"{c['peer']}-{c['variogram']['model']}")
def test_as_pykrige_and_gstools(case, at_utm):
    points, nodes = np.array(PEERS["points"]), np.array(PEERS["nodes"])
    if at_utm:
        points[:, :2] += PEERS["origin"]
        nodes += PEERS["origin"]
    sill = case["variogram"]["sill"]
    method = "kriging" if case["drift"] == "constant" else "universal_kriging"
    for neighbours in (0, len(points)):
        result = interpolate(
            points,
            nodes,
            method,
            neighbours=neighbours,
            variogram=case["variogram"],
            anisotropy=case["anisotropy"],
        )
        # Places at UTM coordinates are rounded to 1e-9 m, of ranges of some hundred.
        assert result.z == pytest.approx(np.array(case["z"]), abs=1e-7 * sill)
        assert result.variance == pytest.approx(np.array(case["variance"]), abs=1e-7 * sill)


def splits(points, most, count):
    """(others, left out) several times: 500 points left out at random, of the rest as many as `most`."""
    for seed in range(count):
        order = np.random.default_rng(seed).permutation(len(points))
        yield points[order[500 : 500 + most]], points[order[:500]]


def rmse(z, left_out):
    return np.sqrt(np.nanmean((z - left_out[:, 2]) ** 2))


@pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize("name", ["claudius", "drogon"])
def test_real_horizons_are_estimated_as_well_as_by_any_peer(name):
    """Over the same splits: the mean error of kriging and of `auto` with everything at its default is no
    larger than that of Matern 3/2 with as many neighbours, as pyinterp has it, of thin plates and of
    Clough-Tocher, and errors lie within two deviations as often as they should."""
    if name == "claudius":
        points = next(p for k, p in real_data.claudius_points().items() if "250" in str(k))
    else:
        points = next(iter(real_data.drogon().values()))[0]
    points = points[np.sort(np.unique(points[:, :2], axis=0, return_index=True)[1])]
    errors_of: dict[str, list[float]] = {}
    honest = []
    for others, left_out in splits(points, 20_000, 3):
        nodes = left_out[:, :2]
        for method in ("kriging",) if honest else ("kriging", "auto"):
            result = interpolate(others, nodes, method)
            errors_of.setdefault(method, []).append(rmse(result.z, left_out))
            within = np.abs(result.z - left_out[:, 2]) <= 2 * np.sqrt(result.variance)
            honest.append(within.mean())
        middle = others.mean(axis=0)
        spline = RBFInterpolator(
            (others - middle)[:, :2] / 50, others[:, 2], neighbors=16, kernel="thin_plate_spline"
        )
        errors_of.setdefault("thin plate", []).append(rmse(spline((nodes - middle[:2]) / 50), left_out))
        smooth = CloughTocher2DInterpolator((others - middle)[:, :2], others[:, 2])
        errors_of.setdefault("Clough-Tocher", []).append(rmse(smooth(nodes - middle[:2]), left_out))
        for neighbours in (16, 32):
            matern = {"model": "matern32", "range": 2000.0, "sill": 1.0}
            z = interpolate(others, nodes, neighbours=neighbours, variogram=matern).z
            errors_of.setdefault(f"Matern 3/2, {neighbours}", []).append(rmse(z, left_out))
    means = {peer: np.mean(errors) for peer, errors in errors_of.items()}
    best = min(mean for peer, mean in means.items() if peer not in ("kriging", "auto"))
    # Between Matern 3/2 and itself, fitted, nothing but chance decides: a thousandth.
    assert means["kriging"] <= 1.001 * best, means
    assert errors_of["auto"][0] <= 1.02 * errors_of["kriging"][0], (
        errors_of
    )  # it may take another method that is as good
    assert min(honest) >= 0.80
    assert 0.80 <= np.mean(honest) <= 0.97
