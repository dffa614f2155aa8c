# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample with every kind of input file: its script writes it, and its model is what it was made of."""

import numpy as np
import pytest
from realmodel.core import build, load_project
from sample_scripts import SAMPLES, generator, written_again

SAMPLE = SAMPLES / "gravel_plain"


@pytest.fixture(scope="module")
def made():
    """The module that made the sample."""
    return generator("gravel_plain")


def test_its_files_are_those_of_its_script(tmp_path):
    written = written_again("gravel_plain", tmp_path)
    assert written == ["bedrock.geojson", "collars.csv", "ground.asc", "picks.csv", "region.geojson"]


def test_the_model_is_what_its_files_were_made_of(made):
    model = build(load_project(SAMPLE / "project.toml"))
    volumes = {block.name: block.volume for block in model.blocks}
    x, y = (a.ravel() for a in np.meshgrid(np.arange(2.5, 900, 5), np.arange(2.5, 600, 5)))
    inside = [
        made.inside(*p, made.OUTLINE) and not made.inside(*p, made.LAKE) for p in zip(x, y, strict=True)
    ]
    plan = [(float(a), float(b)) for a, b in zip(x[inside], y[inside], strict=True)]
    rock = np.array([made.bedrock(*p) for p in plan])
    clay = np.maximum(rock, [made.clay(*p) for p in plan])
    ground = np.array([made.ground(*p) for p in plan])
    for name, thickness, within in (
        ("Bedrock", rock - 400, 0.03),
        ("Clay", clay - rock, 0.2),  # 22 boreholes know no more of a channel
        ("Gravel", ground - clay, 0.12),
    ):
        assert volumes[name] == pytest.approx(25 * thickness.sum(), rel=within), name
    assert sum(volumes.values()) == pytest.approx(25 * (ground - 400).sum(), rel=0.002)
    warnings = [str(warning) for warning in model.warnings]
    assert any("2 picks without a depth" in text for text in warnings)
    assert not any("range" in text for text in warnings)
