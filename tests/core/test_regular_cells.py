# SPDX-License-Identifier: GPL-3.0-or-later
"""Block models, and grids of elevation and thickness, against the exact volumes and as others read them."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import (
    Body,
    Cancelled,
    Model,
    PointFile,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
)
from realmodel.core.base.packages import vendored
from realmodel.core.exporters import MODEL
from realmodel.core.readers import read_point_file
from realmodel.core.results.samples import plan_grids, regular_cells
from sample_scripts import built_sample

WHY = "is not installed: scripts/test.sh installs it"


@pytest.fixture(scope="module")
def model():
    return built_sample("two_layers")


def box(low, high):
    x, y, z = zip(low, high, strict=True)
    corners = np.array([(a, b, c) for c in z for b in y for a in x], float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def test_shares_are_exact_where_they_are_known():
    """A wedge from height 0 to 1 over a square of 2 by 2, on a layer of 1, with a box of ore in the layer."""
    plane = [
        grid_surface(2, lambda x, y: -1 + 0 * x),
        grid_surface(2, lambda x, y: 0 * x),
        grid_surface(2, lambda x, y: x),
    ]
    surfaces = [
        Surface(f"S{k}", vertices * [2, 2, 1], triangles) for k, (vertices, triangles) in enumerate(plane)
    ]
    ore = Body("ore", *box((0.25, 0.25, -0.75), (0.75, 1.25, -0.25)))
    model = build(Project("x", [Rock("r", surfaces)], bodies=[ore]))
    cells = regular_cells(model, 1.0)
    assert (cells.origin.tolist(), cells.counts) == ([0, 0, -1], (2, 2, 2))
    assert [block.name for block in model.blocks] == ["S1 block", "S2 block", "ore"]
    layer, wedge, lens = cells.shares
    assert lens[0] == pytest.approx(np.array([[0.1875, 0], [0.0625, 0]]))
    assert layer[0] == pytest.approx(1 - lens[0])
    assert wedge[1] == pytest.approx(np.array([[0.25, 0.75], [0.25, 0.75]]))
    assert not layer[1].any()
    assert not wedge[0].any()


@pytest.mark.parametrize("size", [7.0, (9.0, 2.5), (5.0, 11.0, 1.7)])
def test_volumes_add_up_to_those_of_the_blocks(model, size):
    cells = regular_cells(model, size)
    assert cells.volumes.sum(axis=(1, 2, 3)) == pytest.approx(
        [block.volume for block in model.blocks], rel=1e-10
    )
    assert cells.shares.sum(axis=0).max() <= 1 + 1e-9
    grids = plan_grids(model, size)
    sums = grids.thickness.sum(axis=(1, 2)) * grids.size[0] * grids.size[1]
    assert sums == pytest.approx([block.volume for block in model.blocks], rel=0.15)  # sampled at centers


def test_a_cell_lies_where_it_says(model):
    """What lies in a half of the model is the same share of its cells."""
    cells = regular_cells(model, (10.0, 10.0, 4.0))
    cut = model.cut_by_plane((0.0, 0.0, 12.0), (0.0, 0.0, 1.0))
    level = round((12.0 - cells.origin[2]) / 4.0)
    below = cells.volumes[:, :level].sum(axis=(1, 2, 3))
    assert below == pytest.approx([block.volume for block in cut.below.blocks], rel=1e-9)


def test_vti_and_csv(model, tmp_path):
    vtk = pytest.importorskip("vtk", reason=f"VTK {WHY}")
    from vtk.util.numpy_support import vtk_to_numpy

    model.save(tmp_path / "m.vti", cell_size=(10.0, 10.0, 2.0))
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(str(tmp_path / "m.vti"))
    reader.Update()
    image = reader.GetOutput()
    cells = regular_cells(model, (10.0, 10.0, 2.0))
    assert image.GetNumberOfCells() == np.prod(cells.counts)
    assert image.GetSpacing() == (10.0, 10.0, 2.0)
    data = image.GetCellData()
    shares = np.stack([vtk_to_numpy(data.GetArray(f"share {block.name}")) for block in model.blocks])
    assert shares.sum(axis=1) * 200.0 == pytest.approx([block.volume for block in model.blocks], rel=1e-10)
    block = vtk_to_numpy(data.GetArray("block"))
    assert np.array_equal(block >= 0, shares.sum(axis=0) > 0)
    model.save(tmp_path / "m.csv", cell_size=(10.0, 10.0, 2.0))
    with (tmp_path / "m.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == (block >= 0).sum()
    assert {row["block"] for row in rows} == {"Clay", "Sand"}
    assert sum(float(row["share Sand"]) for row in rows) * 200 == pytest.approx(
        model.blocks[1].volume, rel=1e-7
    )
    bounds = np.zeros(6)
    image.GetCellBounds(int(np.flatnonzero(block >= 0)[0]), bounds)
    first = [float(rows[0][axis]) for axis in "xyz"]
    assert first == pytest.approx((bounds[::2] + bounds[1::2]) / 2)


def test_geotiff_has_a_band_for_each_grid(model, tmp_path):
    tifffile = vendored("tifffile", "tifffile", "this test")
    model.save(tmp_path / "g.tif", cell_size=4.0)
    grids = plan_grids(model, 4.0)
    with tifffile.TiffFile(tmp_path / "g.tif") as tiff:
        page = tiff.pages[0]
        bands = page.asarray()
        assert bands.shape == (9, *grids.top.shape)
        assert np.array_equal(bands[0], grids.top, equal_nan=True)
        assert np.array_equal(bands[2], grids.thickness[0])
        assert np.array_equal(bands[6], grids.true_thickness[1])
        assert np.array_equal(bands[7:], [values for _, values in grids.deviation], equal_nan=True)
        assert page.tags[33550].value[:2] == (4.0, 4.0)
        assert page.tags[33922].value[3:5] == grids.north_west
        assert "top of Clay" in page.tags[42112].value


def test_geotiff_names_the_projects_system(model, tmp_path):
    """As GDAL and others have them: GeoTIFF 1.1, keys in ascending order."""
    tifffile = vendored("tifffile", "tifffile", "this test")
    for crs, keys in (("EPSG:25832", {1024: 1, 1025: 1, 3072: 25832}), ("ESRI:102013", {1025: 1})):
        other = Model.of(model)
        other.project = replace(model.project, crs=crs)
        other.save(tmp_path / "g.tif", cell_size=4.0)
        with tifffile.TiffFile(tmp_path / "g.tif") as tiff:
            head, *found = np.array(tiff.pages[0].tags[34735].value).reshape(-1, 4).tolist()
            assert head == [1, 1, 0, len(found)]
            assert {key: value for key, _, _, value in found} == keys
            assert [key for key, *_ in found] == sorted(keys)


def test_ascii_grids_are_files_side_by_side(model, tmp_path):
    model.save(tmp_path / "g.asc", cell_size=4.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *(
            "g.asc",
            "g_standard_deviation_of_ground.asc",
            "g_standard_deviation_of_top_of_clay.asc",
            "g_thickness_of_Clay.asc",
            "g_thickness_of_Sand.asc",
            "g_top_of_Clay.asc",
            "g_top_of_Sand.asc",
            "g_true_thickness_of_Clay.asc",
            "g_true_thickness_of_Sand.asc",
        )
    ]
    points, _ = read_point_file(PointFile(tmp_path / "g.asc"))
    grids = plan_grids(model, 4.0)
    assert len(points) == np.isfinite(grids.top).sum() == grids.top.size
    top = np.loadtxt(tmp_path / "g.asc", skiprows=6)
    assert np.array_equal(top, grids.top)
    number = len(model.surface_names) - 1  # the youngest surface is the ground here
    vertices, triangles = model.surface(number)
    from realmodel.core.base.work import native_module

    z = native_module().surface_heights(vertices, triangles, points[:, :2])
    assert points[:, 2] == pytest.approx(z, abs=1e-9)


def test_a_center_on_an_edge_counts_once():
    flat = [Surface(f"S{k}", *grid_surface(4, lambda x, y, k=k: k + 0 * x)) for k in range(2)]
    model = build(Project("x", [Rock("r", flat)]))
    for size in (0.25, 0.5, 1 / 3, 0.125):  # centers on vertices and diagonals of the triangles
        assert plan_grids(model, size).thickness == pytest.approx(1.0, rel=1e-12)


def test_true_thickness_is_perpendicular_to_the_base():
    """Of tilted beds everywhere, also beside the border, where the foot lies beyond it."""

    def plane(z):
        return grid_surface(6, lambda x, y: z + 0.75 * x)

    model = build(Project("x", [Rock("r", [Surface(f"S{k}", *plane(k)) for k in range(3)])]))
    grids = plan_grids(model, 0.2)
    assert grids.thickness == pytest.approx(1.0, rel=1e-12)
    assert grids.true_thickness == pytest.approx(0.8, rel=1e-9)


def test_true_thickness_is_nowhere_more_than_the_vertical_one(model):
    grids = plan_grids(model, 3.0)
    assert (grids.true_thickness <= grids.thickness).all()
    assert np.array_equal(grids.true_thickness > 0, grids.thickness > 0)


def test_what_cannot_be_is_refused(model, tmp_path):
    for size in (0.0, -1.0, (1.0, 2.0, 3.0, 4.0), float("nan")):
        with pytest.raises(UsageError, match="a cell size is one, two or three numbers above 0"):
            regular_cells(model, size)
    with pytest.raises(UsageError, match="take larger ones"):
        model.save(tmp_path / "m.vti", cell_size=0.001)
    with pytest.raises(UsageError, match="take larger ones"):
        model.save(tmp_path / "m.tif", cell_size=0.0001)
    assert list(tmp_path.iterdir()) == []


def test_a_table_stops_while_it_is_written(model, tmp_path):
    """Its rows are most of the time: who cancels must not wait for all of them."""
    shares = []

    def step(share):
        shares.append(share)
        if share > 0.5:
            raise Cancelled("cancelled")

    with pytest.raises(Cancelled):
        MODEL.save(model, tmp_path / "m.csv", step, cell_size=1.0)
    assert 0.5 < shares[-1] < 1.0 and shares == sorted(shares)
    assert not list(tmp_path.iterdir())
