# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample with every kind of input file: its script writes it, and its model is what it was made of."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import build, load_project

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "gravel_plain"


@pytest.fixture(scope="module")
def made():
    """The module that made the sample."""
    spec = importlib.util.spec_from_file_location("gravel_plain", SAMPLE / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_its_files_are_those_of_its_script(tmp_path):
    subprocess.run([sys.executable, SAMPLE / "generate.py", tmp_path], check=True, timeout=60)
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["bedrock.geojson", "collars.csv", "ground.asc", "picks.csv", "region.geojson"]
    for name in written:
        assert (tmp_path / name).read_bytes() == (SAMPLE / name).read_bytes(), name


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
    told = [str(warning) for warning in model.warnings]
    assert any("2 picks have no depth" in text for text in told)
    assert not any("range" in text for text in told)
