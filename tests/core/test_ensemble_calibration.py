# SPDX-License-Identifier: GPL-3.0-or-later
"""Percentiles of drawn heights at left-out points, of made and of real surfaces."""

import sys

import numpy as np
import pytest
from conftest import ROOT
from stacks import places, real_data

sys.path.insert(0, str(ROOT / "scripts"))

from calibrate_ensembles import calibrated


def test_a_field_of_the_variogram_is_within_its_percentiles():
    """A smooth made surface."""
    places = np.random.default_rng(2).uniform(0, 1000, (900, 2))
    waves = np.random.default_rng(3).uniform(-1, 1, (12, 4)) * [0.02, 0.02, 3.0, 4.0]
    z = sum(d * np.sin(a * places[:, 0] + b * places[:, 1] + c) for a, b, c, d in waves.tolist())
    found = calibrated(np.column_stack([places, z]), 1, realizations=60)
    assert 0.65 < found.most < 0.97
    assert found.half < found.most
    assert 0.6 < found.deviation / found.error < 1.6


@pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize("name", ["horizon_330", "04_basevolantis"])
def test_real_surfaces(name):
    points = real_data.claudius_points()[name] if name.startswith("horizon") else real_data.drogon()[name][0]
    found = calibrated(points, 0, realizations=60)
    assert 0.55 < found.most < 0.97
    assert 0.6 < found.deviation / found.error < 1.7
