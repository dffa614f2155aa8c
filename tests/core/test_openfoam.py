# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM cases of the exact cells, as OpenFOAM and VTK read them."""

import os
import re
import shutil
import subprocess

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import OutputFailed, Project, Rock, Surface, build
from realmodel.core.simulation import PolyhedralMesh
from realmodel.core.simulation.patches import boundary_patches, solver_names

NO_OPENFOAM = "OpenFOAM is not installed: scripts/test.sh installs it"


def project(base=-2.0):
    def height(k):
        return lambda x, y: 0.3 * k + 0.4 * np.sin(5 * x + k) * np.cos(4 * y - k)

    names = [None, "Grès à Voltzia", "2nd clay", "Clay"]
    surfaces = [Surface(f"S {k}", *grid_surface(5 + k, height(k)), block=names[k]) for k in range(4)]
    return Project("crossing", [Rock("rock", surfaces, base_elevation=base)])


@pytest.fixture(scope="module")
def model():
    return build(project())


def read_by_vtk(case):
    vtk = pytest.importorskip("vtk", reason="VTK is not installed: scripts/test.sh installs it")
    reader = vtk.vtkOpenFOAMReader()
    reader.SetFileName(str(case / f"{case.stem}.foam"))
    reader.ReadZonesOn()
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.UpdateTimeStep(0.0)
    reader.Update()
    return reader


def test_vtk_reads_cells_zones_and_patches(model, tmp_path):
    from vtk.util.numpy_support import vtk_to_numpy

    model.save(tmp_path / "m.foam")
    reader = read_by_vtk(tmp_path / "m.foam")
    names = {reader.GetPatchArrayName(k) for k in range(reader.GetNumberOfPatchArrays())}
    assert {"internalMesh", "patch/base", "patch/sides"} <= names
    grid = reader.GetOutput().GetBlock(0)
    assert grid.GetNumberOfCells() == len(model.cell_block)
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), model.vertices.astype(np.float32))
    text = (tmp_path / "m.foam/constant/polyMesh/cellZones").read_bytes().decode("latin-1")
    zones = re.findall(r"(\w+)\n{\ntype cellZone;\ncellLabels List<label> (\d+)", text)
    expected = ["base_block", "Gres_a_Voltzia", "n2nd_clay", "Clay"]
    assert zones == [(name, str(block.cells)) for name, block in zip(expected, model.blocks, strict=True)]


@pytest.mark.skipif(shutil.which("checkMesh") is None, reason=NO_OPENFOAM)
def test_checkmesh_finds_one_region_of_good_topology(model, tmp_path):
    model.save(tmp_path / "m.foam")
    found = subprocess.run(
        ["checkMesh", "-allTopology", "-allGeometry", "-case", tmp_path / "m.foam"],
        env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ},  # Debian's place
        capture_output=True,
        text=True,
        timeout=120,
    ).stdout
    assert re.search(rf"^ +cells: +{len(model.cell_block)}$", found, re.MULTILINE)
    assert "FATAL" not in found
    for good in (
        "Boundary definition OK.",
        "Cell to face addressing OK.",
        "Point usage OK.",
        "Upper triangular ordering OK.",
        "Face vertices OK.",
        "Number of regions: 1 (OK).",
    ):
        assert good in found, found
    total = float(re.search(r"Total volume = (\S+?)\.  Cell", found)[1])
    assert total == pytest.approx(model.volume, rel=1e-5)
    for zone, block in zip(("base_block", "Gres_a_Voltzia", "n2nd_clay", "Clay"), model.blocks, strict=True):
        cells, volume = re.search(rf"^ +{zone} +(\d+) +\d+ +(\S+)", found, re.MULTILINE).groups()
        assert int(cells) == block.cells
        assert float(volume) == pytest.approx(block.volume, rel=1e-9)


def test_patches_are_named_by_where_they_lie_and_by_their_surface():
    surface = np.array([3, 2, 3, 0, -1, -2, 4, 4, -3])
    rise = np.array([1.0, 1, 2, -1, 0, -1, 1, -1, 0])
    names = ["S0", "S1", "S2", "S 3", "Fault"]
    patches, number = boundary_patches(surface, rise, names, np.array([0, 0, 0, 0, 1]))
    assert [patches[k].name for k in number] == [
        "top_S_3",
        "top_S2",
        "top_S_3",
        "base_S0",
        "sides",
        "base_flat",
        "Fault",
        "Fault",
        "cut",
    ]
    assert [patches[k].group for k in number] == [
        *("top", "top", "top", "base", "sides", "base", "Fault", "Fault", "cut")
    ]
    patches, number = boundary_patches(surface[[0, 5, 4]], rise[[0, 5, 4]], names, np.zeros(5, int))
    assert [patches[k].name for k in number] == ["top", "base", "sides"]


def test_names_for_solvers_are_plain_and_different():
    assert solver_names(["Clay", "clay", "2nd", "Grès (à)", "", "粘土"]) == [
        *("Clay", "clay_2", "n2nd", "Gres_a", "unnamed", "unnamed_2")
    ]
    assert [len(name) for name in solver_names(["x" * 40, "x" * 40], longest=32)] == [32, 32]


def test_a_second_export_renews_the_mesh_and_nothing_else(model, tmp_path):
    case = tmp_path / "m.foam"
    model.save(case)
    (case / "system/controlDict").write_text("mine")
    (case / "0").mkdir()
    (case / "0/T").write_text("result")
    (case / "constant/polyMesh/sets").mkdir()
    (case / "system/fvSchemes").unlink()
    model.save(case)
    assert (case / "system/controlDict").read_text() == "mine"
    assert (case / "0/T").read_text() == "result"
    assert (case / "system/fvSchemes").is_file()
    assert not (case / "constant/polyMesh/sets").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.foam"]


def test_a_folder_of_something_else_is_refused(model, tmp_path):
    (tmp_path / "m.foam").mkdir()
    (tmp_path / "m.foam/letter.txt").write_text("dear")
    with pytest.raises(OutputFailed, match="other content"):
        model.save(tmp_path / "m.foam")
    assert (tmp_path / "m.foam/letter.txt").read_text() == "dear"
    (tmp_path / "n.foam").write_text("a file")
    with pytest.raises(OutputFailed, match="this is a file"):
        model.save(tmp_path / "n.foam")


def test_a_model_that_cannot_be_written_leaves_the_old_case(model, tmp_path, monkeypatch):
    case = tmp_path / "m.foam"
    model.save(case)
    before = (case / "constant/polyMesh/points").read_bytes()
    monkeypatch.setattr("realmodel.core.exporters.solvers.openfoam._write_zones", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        build(project(-3.0)).save(case)
    assert (case / "constant/polyMesh/points").read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.foam"]


def test_a_polyhedral_mesh_shares_the_arrays_of_its_model(model):
    mesh = PolyhedralMesh.of_model(model)
    assert np.shares_memory(mesh.face_vertices, model.face_vertices)
    assert mesh.cells == len(model.cell_block)
