# SPDX-License-Identifier: GPL-3.0-or-later
"""Percentiles of drawn heights at left-out points, of made and of real surfaces."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT
from realmodel.core.base.work import Work
from realmodel.core.heights import Task
from realmodel.core.heights.realizations.draws import LikelyVariograms
from realmodel.core.heights.realizations.turning_bands import Noise
from realmodel.core.settings.methods import checked_options
from realmodel.core.settings.variogram import Structure, Variogram
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


def test_few_points_have_many_variograms():
    """Also where the likeliest has several structures: realizations took it for exact, and were too alike."""
    random = np.random.default_rng(0)
    points = np.column_stack([random.uniform(0, 1000, (12, 2)), np.zeros(12)])
    points[:, 2] = 15 * np.sin(points[:, 0] / 90) + 0.05 * points[:, 1]
    task = Task(Work(), points, points[:, :2], checked_options("kriging", {}), 0)
    parts = (Structure("spherical", 200.0, 40.0), Structure("gaussian", 800.0, 60.0))
    fitted = Variogram("nested", 800.0, 100.0, structures=parts)
    found = LikelyVariograms.of(task, task.settings, fitted)
    assert found is not None
    drawn = [found.draw(Noise((0, number))) for number in range(40)]
    assert len({each.range for each in drawn}) > 5
    assert not any(each.structures for each in drawn)
    waves = replace(fitted, structures=(*parts, Structure("wave", 300.0, 10.0)))
    assert LikelyVariograms.of(task, task.settings, waves) is None


@pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize("name", ["horizon_330", "04_basevolantis"])
def test_real_surfaces(name):
    points = real_data.claudius_points()[name] if name.startswith("horizon") else real_data.drogon()[name][0]
    found = calibrated(points, 0, realizations=60)
    assert 0.55 < found.most < 0.97
    assert 0.6 < found.deviation / found.error < 1.7
