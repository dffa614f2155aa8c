# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample of an ensemble: its script writes it, and what is true lies where the ensemble says."""

import numpy as np
import pytest
from realmodel.core import load_project
from realmodel.core.ensembles import ensemble
from sample_scripts import SAMPLES, generator, written_again

PROJECT = SAMPLES / "uncertain_valley" / "project.toml"


@pytest.fixture(scope="module")
def made():
    """The module that made the sample."""
    return generator("uncertain_valley")


@pytest.fixture(scope="module")
def found():
    return ensemble(load_project(PROJECT), 60, seed=1)


def test_its_files_are_those_of_its_script(tmp_path):
    assert written_again("uncertain_valley", tmp_path) == ["collars.csv", "ground.off", "picks.csv"]


def test_the_true_volumes_are_within_the_percentiles(made, found):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(10, 3000, 20.0), np.arange(10, 2000, 20.0)))
    ground, bedrock, gravel, clay = (
        np.vectorize(height)(x, y) for height in (made.ground, made.bedrock, made.gravel, made.clay)
    )
    bedrock = np.minimum(bedrock, ground)
    gravel = np.clip(gravel, bedrock, ground)
    clay = np.clip(clay, gravel, ground)
    low, high = found.percentiles((5, 95))
    layers = (bedrock - made.BASE, gravel - bedrock, clay - gravel, ground - clay)
    assert found.block_names == ["Bedrock", "Gravel", "Lake clay", "Till"]
    for number, thickness in enumerate(layers):
        true = 400.0 * thickness.sum()
        assert low[number] < true < high[number], found.block_names[number]
        assert high[number] - low[number] < 0.9 * true


def test_heights_are_as_far_off_as_their_deviations_say(made, found):
    for number, height in enumerate((made.bedrock, made.gravel, made.clay)):
        nodes = found.model.surface(number)[0]
        off = np.vectorize(height)(nodes[:, 0], nodes[:, 1]) - found.model.interpolations[number].z
        deviation = found.surface_deviation[number]
        assert 0.4 < np.sqrt((off**2).mean() / (deviation**2).mean()) < 1.3
        assert 0.7 < (np.abs(off) < 1.2816 * deviation).mean() <= 1  # 0.8 were exact
    assert found.surface_deviation[3] is None


def test_the_clay_is_drawn_with_the_gravel(found):
    project = found.model.project
    assert [surface.correlation for surface in project.rocks[0].surfaces] == [None, None, 0.7, None]
