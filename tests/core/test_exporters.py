# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as files: the same bytes each time, and other software reads the same model from them."""

import json
import time
import zipfile
from itertools import pairwise

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Fault, InputRefused, OutputFailed, Project, Rock, Surface, UsageError, build
from realmodel.core.exporters import MODEL
from realmodel.core.exporters.model_arrays import model_arrays
from realmodel.core.exporters.report import SCHEMA, model_report
from stacks import places
from structure_cases import plane_fault


def crossing_surfaces(n=8, count=4):
    def height(k):
        return lambda x, y: 0.3 * k + 0.4 * np.sin(5 * x + k) * np.cos(4 * y - k)

    return [Surface(f"S{k}", *grid_surface(n + k, height(k)), property=k) for k in range(count)]


@pytest.fixture(scope="module")
def model():
    return build(Project("crossing", [Rock("rock", crossing_surfaces(), base_elevation=-2.0)]))


def test_npz_holds_every_array(model, tmp_path):
    model.save(tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz", allow_pickle=False) as read:
        for name, array in model_arrays(model).items():
            assert read[name].dtype == array.dtype
            assert np.array_equal(read[name], array, equal_nan=array.dtype.kind == "f"), name
        others = set(read.files) - set(model_arrays(model))
        assert {"record"} <= others and all(name.startswith("record") for name in others)
        assert str(read["cell_kind"]) == "columns"
        assert read["block_names"].tolist() == ["base block", "S1 block", "S2 block", "S3 block"]
        assert read["block_surface"].tolist() == [0, 1, 2, 3]
        assert read["block_property"].tolist() == [0, 1, 2, 3]
        assert read["block_volume"].sum() == pytest.approx(model.volume)


def contents(path):
    """The bytes of a file, or of the files of a folder, whatever it is called."""
    if path.is_file():
        return path.read_bytes()
    files = (file for file in sorted(path.rglob("*")) if file.is_file())
    return {str(file.relative_to(path)): file.read_bytes() for file in files}


ENDINGS = [known.ending for known in MODEL.formats()]


@pytest.mark.parametrize("ending", sorted(ENDINGS))
def test_the_same_model_gives_the_same_bytes(model, tmp_path, ending):
    first, second = tmp_path / "a" / f"m{ending}", tmp_path / "b" / f"m{ending}"
    first.parent.mkdir()
    second.parent.mkdir()
    model.save(first)
    again = build(model.project, threads=1)
    if ending == ".npz":
        time.sleep(2.1)  # the clock of zip files counts two seconds
    again.save(second)
    assert contents(first) == contents(second)


def test_npz_knows_no_clock(model, tmp_path):
    model.save(tmp_path / "m.npz")
    with zipfile.ZipFile(tmp_path / "m.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_a_model_without_cells_can_be_written(tmp_path):
    empty = build(Project("one", [Rock("rock", crossing_surfaces(count=1))]))
    assert (len(empty.cell_block), empty.volume) == (0, 0.0)
    for ending in ENDINGS:
        if ending != ".grdecl":
            empty.save(tmp_path / f"m{ending}")
    with pytest.raises(InputRefused, match="the model has no cells"):
        empty.save(tmp_path / "m.grdecl")
    with np.load(tmp_path / "m.npz", allow_pickle=False) as read:
        assert len(read["vertices"]) == len(read["block_names"]) == 0
    assert model_report(empty)["counts"]["cells"] == 0


def test_unknown_endings_are_refused_with_those_known(model, tmp_path):
    with pytest.raises(UsageError, match=r"'\.xyz' are not supported; use one of \.npz, \.vtu, "):
        model.save(tmp_path / "m.xyz")
    with pytest.raises(UsageError, match="no extension"):
        MODEL.format("model")
    assert MODEL.format("M.NPZ") is MODEL.format("m.npz")
    with pytest.raises(OutputFailed, match="no folder"):
        model.save(tmp_path / "none" / "m.npz")
    assert list(tmp_path.iterdir()) == []


def test_progress_is_the_share_written(model, tmp_path):
    for ending in ENDINGS:
        shares = []
        MODEL.save(model, tmp_path / f"m{ending}", shares.append)
        assert shares == sorted(shares)
        assert shares[-1] == pytest.approx(1.0)


def read_by_vtk(path):
    vtk = pytest.importorskip("vtk", reason="VTK is not installed: scripts/test.sh installs it")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def test_vtu_has_exact_volumes(model, tmp_path):
    model.save(tmp_path / "m.vtu")
    volume = read_by_vtk(tmp_path / "m.vtu").GetCellData().GetArray("volume")
    assert [volume.GetValue(k) for k in range(len(model.cell_block))] == model.cell_volumes.tolist()


def polyhedron_volume(cell):
    """By the divergence theorem over the faces as VTK has them: they must turn outward.

    VTK's own vtkCellSizeFilter divides a polyhedron into tetrahedra without regard to its faces, and is
    off by percents on tall convex cells.
    """
    points = {
        cell.GetPointId(i): np.array(cell.GetPoints().GetPoint(i)) for i in range(cell.GetNumberOfPoints())
    }
    origin = points[cell.GetPointId(0)]
    volume = 0.0
    for number in range(cell.GetNumberOfFaces()):
        face = cell.GetFace(number)
        corners = [points[face.GetPointId(i)] - origin for i in range(face.GetNumberOfPoints())]
        for b, c in pairwise(corners[1:]):
            volume += np.dot(corners[0], np.cross(b, c)) / 6.0
    return volume


def test_vtk_reads_the_compartments(tmp_path):
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 0.5 * k + 0 * x)) for k in range(2)]
    fault = Fault("F1", *plane_fault(x=0.4))
    model = build(Project("x", [Rock("rock", levels)], faults=[fault]))
    assert len(model.compartment_names) == 2
    model.save(tmp_path / "m.vtu")
    grid = read_by_vtk(tmp_path / "m.vtu")
    from vtk.util.numpy_support import vtk_to_numpy

    compartment = vtk_to_numpy(grid.GetCellData().GetArray("compartment"))
    assert np.array_equal(compartment, model.cell_compartment)
    volumes = np.array([polyhedron_volume(grid.GetCell(i)) for i in range(grid.GetNumberOfCells())])
    west, east = sorted(np.bincount(compartment, volumes))
    assert (west, east) == pytest.approx((0.2, 0.3))


@pytest.mark.parametrize(("cells", "kind"), [("columns", "Int32"), ("blocks", "Int32"), ("columns", "Int64")])
def test_vtk_reads_the_same_model(tmp_path, cells, kind, monkeypatch):
    monkeypatch.setattr("realmodel.core.exporters.solvers.vtu._CELLS_AT_ONCE", 37)  # several pieces
    if kind == "Int64":
        monkeypatch.setattr("realmodel.core.exporters.solvers.vtu._LARGEST_INT32", 1000)
    model = build(Project("x", [Rock("rock", crossing_surfaces(), base_elevation=-2.0)]), cells=cells)
    model.save(tmp_path / "m.vtu")
    assert f'<DataArray type="{kind}" Name="faces"'.encode() in (tmp_path / "m.vtu").read_bytes()
    grid = read_by_vtk(tmp_path / "m.vtu")
    from vtk.util.numpy_support import vtk_to_numpy

    assert grid.GetNumberOfCells() == len(model.cell_block) > 0
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), model.vertices)
    block = vtk_to_numpy(grid.GetCellData().GetArray("block"))
    assert np.array_equal(block, model.cell_block)
    properties = np.array([block.property for block in model.blocks])
    assert np.array_equal(vtk_to_numpy(grid.GetCellData().GetArray("property")), properties[model.cell_block])
    assert {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())} == {42}
    volumes = np.array([polyhedron_volume(grid.GetCell(i)) for i in range(grid.GetNumberOfCells())])
    assert (volumes > 0).all()
    by_block = np.bincount(block, weights=volumes, minlength=len(model.blocks))
    assert by_block == pytest.approx([block.volume for block in model.blocks], rel=1e-9)
    sizes = {grid.GetCell(i).GetNumberOfPoints() for i in range(grid.GetNumberOfCells())}
    assert min(sizes) >= 4


def test_vtk_validates_convex_cells(tmp_path):
    """Cells of level layers are prisms, for which VTK's own volume is right as well."""
    vtk = pytest.importorskip("vtk", reason="VTK is not installed: scripts/test.sh installs it")
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 0.5 * k + 0 * x)) for k in range(3)]
    model = build(Project("x", [Rock("rock", levels)]))
    model.save(tmp_path / "m.vtu")
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(read_by_vtk(tmp_path / "m.vtu"))
    sizes.Update()
    from vtk.util.numpy_support import vtk_to_numpy

    volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
    assert volumes.sum() == pytest.approx(1.0, rel=1e-12)
    validator = vtk.vtkCellValidator()
    validator.SetInputData(read_by_vtk(tmp_path / "m.vtu"))
    validator.Update()
    assert not vtk_to_numpy(validator.GetOutput().GetCellData().GetArray("ValidityState")).any()


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
def test_the_outside_checker_reads_the_npz(model, tmp_path):
    model.save(tmp_path / "m.npz")
    checked = places.checker().Complex(tmp_path / "m.npz")
    rocks = [([0, 1, 2, 3], ["erosional"] * 4, -2.0, [0, 1, 2, 3], [])]
    assert places.checker().check_all(checked, rocks) == []


def test_report(model):
    report = model_report(model, stage=3)
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert report["schema"] == SCHEMA
    assert report["project"]["stage"] == 3
    assert report["counts"]["cells"] == len(model.cell_block)
    assert [block["name"] for block in report["blocks"]] == [block.name for block in model.blocks]
    assert sum(block["volume"] for block in report["blocks"]) == pytest.approx(report["volume"])
    assert sum(block["share"] for block in report["blocks"]) == pytest.approx(1.0)
    assert sum(block["cells"] for block in report["blocks"]) == report["counts"]["cells"]
    assert [surface["name"] for surface in report["surfaces"]] == model.surface_names
    assert report["versions"]["realmodel"]
    assert report["timings"]["intersect"] > 0
    assert report["peak_memory"] > 1e6
