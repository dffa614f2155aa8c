# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample Haut-Barr: its script writes it, and its model has the parts of the thesis's, chapter 5."""

from collections import Counter

import numpy as np
import pytest
from realmodel.core import build, load_project
from sample_scripts import SAMPLES, written_again

ROCKS = ["Septentrional Rock", "Median Rock", "Markenfels", "base"]


@pytest.fixture(scope="module")
def project():
    return load_project(SAMPLES / "haut_barr" / "project.toml")


@pytest.fixture(scope="module")
def model(project):
    return build(project)


@pytest.mark.parametrize(("name", "count"), [("haut_barr", 41), ("castle_hill", 12)])
def test_its_files_are_those_of_its_script(name, count, tmp_path):
    assert len(written_again(name, tmp_path)) == count


def test_counts_of_the_thesis(model):
    rocks = model.project.rocks
    assert [rock.name for rock in rocks] == ROCKS
    assert [len(rock.surfaces) for rock in rocks] == [10, 9, 10, 10]
    layers = Counter(block.rock for block in model.blocks if block.volume > 0)
    assert [layers[number] for number in range(4)] == [9, 8, 9, 10]
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    assert high - low == pytest.approx([255, 70, 40], abs=3)
    assert 455 < high[2] < 462


def test_fins_share_their_walls_with_the_base(model):
    """Each fin stands on and in the base: their vertices along the wall are the same."""
    rock = np.array([block.rock for block in model.blocks])
    sides = np.sort(np.append(rock, -1)[model.face_blocks], axis=1)
    for fin in range(3):
        shared = (sides == (fin, 3)).all(axis=1)
        assert shared.sum() > 500
        assert set(model.face_surface[shared]) == {-1}


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_its_model_is_proved(project, model, cells):
    made = model if cells == "columns" else build(project, cells=cells)
    report = made.validate(4000)
    assert report.passed, report.failure()
    assert [b.volume for b in made.blocks] == pytest.approx([b.volume for b in model.blocks], rel=1e-9)


def test_every_stage_has_more_layers(model):
    counts = [sum(block.volume > 0 for block in model.stage(number).blocks) for number in (0, 1, 4, 9)]
    assert counts == [1, 5, 17, 36]
