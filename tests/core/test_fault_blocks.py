# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample with faults: its script writes it, its model is closed and displaced as it was made; and sticks
of a real reservoir, where these are there."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Fault, PointFile, Project, Rock, Surface, build, load_project
from realmodel.core.structures.displacement import displacements
from realmodel.core.structures.reading import read_structures
from realmodel.core.work import run

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "blend_samples" / "fault_blocks"
REAL = ROOT.parent / "shared" / "data" / "drogon_faults"


def test_its_files_are_those_of_its_script(tmp_path):
    subprocess.run([sys.executable, SAMPLE / "generate.py", tmp_path], check=True, timeout=60)
    written = sorted(path.name for path in tmp_path.iterdir())
    assert len(written) == 7
    for name in written:
        assert (tmp_path / name).read_bytes() == (SAMPLE / name).read_bytes(), name


def test_its_model_is_displaced_as_it_was_made():
    model = build(load_project(SAMPLE / "project.toml"))
    assert model.validate(3000).passed
    assert len(model.compartment_names) == 4
    tunnel = 1600 * 8 / 2 * 12**2 * np.sin(np.pi / 4)
    whole = 2000 * 1600 * (1400 - 930)
    assert sum(block.volume for block in model.blocks) == pytest.approx(whole - tunnel, rel=1e-6)
    throws = {(each.fault, each.surface): each.throw for each in displacements(model)}
    assert len(throws) == 9
    for (fault, _), throw in throws.items():
        if fault == "branch":
            assert throw.mean() == pytest.approx(35, abs=1) and np.ptp(throw) < 3
        elif fault == "main fault":
            assert throw.min() > 55 and throw.max() < 112
        else:
            assert throw.min() < 8 and 26 < throw.max() < 30


@pytest.mark.skipif(not REAL.is_dir(), reason="the real data are not there")
def test_sticks_of_a_real_reservoir():
    """Surfaces through six faults of irregular sticks: their points as they are, one side and another."""
    faults = [Fault(f"F{k}", points=PointFile(REAL / f"F{k}.pol", z_axis="down")) for k in range(1, 7)]
    horizon = Surface("top", points=PointFile(REAL / "TopVolantis.poi", z_axis="down"))
    region = np.array([[457000.0, 5927000], [467000, 5927000], [467000, 5939000], [457000, 5939000]])
    project = Project("real", [Rock("r", [horizon], region=region, edge_length=200.0)], faults=faults)
    read, _, told = run(lambda work: read_structures(work, project))
    assert told == []
    for fault in read:
        lines = (REAL / f"{fault.name}.pol").read_text().split("\n")
        points = {
            tuple(map(float, line.split()[:3])) for line in lines if line and not line.startswith("999.")
        }
        assert {(x, y, -z) for x, y, z in fault.vertices.tolist()} == points
        assert len(fault.triangles) >= len(points) - 2
