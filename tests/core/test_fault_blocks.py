# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample with faults: its script writes it, its model is closed and displaced as it was made; and faults
of a real reservoir and of California, where these are there."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, PointFile, Project, Rock, Surface, build, load_project
from realmodel.core.base.work import run
from realmodel.core.results.displacements import displacements
from realmodel.core.structures.shapes.reading import read_structures
from stacks import places, real_faults
from structure_cases import assert_areas_of_faces

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
    read, _, warnings = run(lambda work: read_structures(work, project))
    assert warnings == []
    for fault in read:
        lines = (REAL / f"{fault.name}.pol").read_text().split("\n")
        points = {
            tuple(map(float, line.split()[:3])) for line in lines if line and not line.startswith("999.")
        }
        assert {(x, y, -z) for x, y, z in fault.vertices.tolist()} == points
        assert len(fault.triangles) >= len(points) - 2


def checked(project_path, model, tmp_path):
    """Passes validation, and the outside checker where it is there; what lies across its faults adds up."""
    assert model.validate(1000).passed
    assert_areas_of_faces(model)
    check = places.CHECK / "check_model.py"
    if check.is_file():
        model.save(tmp_path / "model.npz")
        command = [sys.executable, check, project_path, tmp_path / "model.npz"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout


@pytest.mark.skipif(not REAL.is_dir(), reason="the real data are not there")
def test_a_real_reservoir_with_six_faults_that_die_out(tmp_path):
    """One closed model; picks that reach beyond the faults are left out, so the throw is the blocks'."""
    path = real_faults.drogon(tmp_path, edge_length=300, method="idw")
    model = build(load_project(path))
    checked(path, model, tmp_path)
    assert len(model.blocks) == 3 and model.compartment_names == ["drogon"]
    left_out = [w for w in model.warnings if "reach beyond a fault" in w.text]
    assert {w.surface for w in left_out} == set(real_faults.DROGON_HORIZONS)
    throws = {(each.fault, each.surface): each.throw for each in displacements(model)}
    assert len(throws) == 24
    for fault, least in (("F1", 15), ("F3", 15), ("F4", 8)):
        assert throws[fault, "TopVolantis"].mean() > least  # normal faults of some tens of meters
    for throw in throws.values():
        assert np.abs(throw).max() < 100


@pytest.mark.skipif(not REAL.is_dir(), reason="the real data are not there")
def test_a_fault_leaves_the_throw_of_one_beside_it():
    """F2 is two edges of the mesh apart, and on sides of both there is no rock: what such a sheet would be
    counts nowhere. F6 ends at F2, which parts no points around F4 though it would go on there."""
    points = PointFile(REAL / "BaseVolantis.poi", z_axis="down")
    horizon = Surface("base", points=points, method="idw", options={"extrapolate": "nearest"})
    region = np.array([[461537.0, 5926637], [467404, 5930024], [462016, 5939355], [456149, 5935968]])
    rock = Rock("r", [horizon], region=region, edge_length=400.0)
    faults = [
        Fault(name, points=PointFile(REAL / f"{name}.pol", z_axis="down"), dies_out=True, extend=100.0)
        for name in ("F4", "F2", "F6")
    ]
    throws = []
    for some in (faults[:1], faults[:2], faults, [*faults[:2], replace(faults[2], ends_at=("F2",))]):
        model = build(Project("real", [rock], faults=some))
        throws.append(next(each.throw.mean() for each in displacements(model) if each.fault == "F4"))
    assert throws[0] > 10
    assert throws[1] == pytest.approx(throws[0], rel=0.05)
    assert throws[2] == pytest.approx(throws[0], rel=0.15)
    assert throws[3] == pytest.approx(throws[2], rel=0.05)


@pytest.mark.skipif(not (REAL.parent / "california_faults").is_dir(), reason="the real data are not there")
def test_a_detachment_and_a_fault_of_overlapping_strands(tmp_path, monkeypatch):
    """A nearly level fault is built. Strands beside one another in one file are refused: what is beyond their
    border is not known."""
    names = ("ETRA-NFTS-DTMT-Deep_detachment-CFM5", "SAFS-SAFZ-1812-San_Andreas_fault_rupture-CFM5")
    monkeypatch.setattr(real_faults, "_CALIFORNIA", names[:1])
    path = real_faults.california(tmp_path)
    model = build(load_project(path))
    checked(path, model, tmp_path)
    assert (model.face_surface == 3).any()
    monkeypatch.setattr(real_faults, "_CALIFORNIA", names[1:])
    with pytest.raises(InputRefused, match=r"border crosses itself near .*make each part"):
        build(load_project(real_faults.california(tmp_path)))


@pytest.mark.skipif(not (REAL.parent / "california_faults").is_dir(), reason="the real data are not there")
def test_a_box_with_faults_of_california(tmp_path):
    path = real_faults.california(tmp_path, faults=8)
    model = build(load_project(path))
    checked(path, model, tmp_path)
    area, heights = 120e3**2, (5000, 5000, 4500)
    for block, height in zip(model.blocks, heights, strict=True):
        assert block.volume == pytest.approx(area * height, rel=1e-9) and block.components == 1
    slits = {int(n) for n in np.unique(model.face_surface) if n >= 3}
    assert len(slits) >= 6  # the others are blind, below or above the rock
