# SPDX-License-Identifier: GPL-3.0-or-later
"""Files from and for programs that nobody here wrote, for formats that no other test tries so."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core.readers import read_mesh, read_shapes
from realmodel.core.results.samples import plan_grids
from realmodel.core.settings.data_files import MapLayer
from sample_scripts import built_sample

WHY = "not installed: scripts/test.sh installs it"


@pytest.fixture(scope="module")
def model():
    return built_sample("two_layers")


def of_ogs(program, *arguments):
    path = Path(sys.executable).with_name(program)
    if not path.is_file():
        pytest.skip(f"OpenGeoSys is {WHY}")
    done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def points_and_triangles(path):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    read = meshio.read(path)
    return read.points, read.cells_dict["triangle"]


def volume(points, triangles):
    a, b, c = (points[triangles] - points.mean(axis=0)).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_open_geo_sys_reads_tsurf(model, tmp_path):
    model.save(tmp_path / "m.ts")
    (tmp_path / "out").mkdir()
    of_ogs("GocadTSurfaceReader", "-s", "-i", tmp_path / "m.ts", "-o", tmp_path / "out")
    found = {path.stem: path for path in (tmp_path / "out").iterdir()}
    assert set(found) == {"Clay", "Sand"}
    for block in model.blocks:
        read = volume(*points_and_triangles(found[block.name]))
        assert read == pytest.approx(block.volume, rel=1e-7)


def test_open_geo_sys_reads_ascii_grids(model, tmp_path):
    model.save(tmp_path / "g.asc", cell_size=4.0)
    of_ogs(
        *("Raster2Mesh", "-e", "quad", "-p", "scalar", "-n", "z", "-i", tmp_path / "g.asc"),
        *("-o", tmp_path / "g.vtu"),
    )
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    read = meshio.read(tmp_path / "g.vtu")
    grids = plan_grids(model, 4.0)
    centers = read.points[read.cells[0].data].mean(axis=1)[:, :2]
    heights = dict(zip(map(tuple, centers), read.cell_data["z"][0], strict=True))
    rows, columns = grids.top.shape
    west, north = grids.north_west
    assert len(heights) == rows * columns
    for row in range(rows):
        for column in range(columns):
            place = (west + 4.0 * (column + 0.5), north - 4.0 * (row + 0.5))
            assert heights[place] == pytest.approx(grids.top[row, column], rel=1e-12)


@pytest.mark.parametrize(
    ("library", "ending"),
    [
        *(("meshio", ending) for ending in (".off", ".obj", ".ply", ".stl", ".vtu", ".msh")),
        *(("trimesh", ending) for ending in (".off", ".obj", ".ply", ".stl")),
    ],
)
def test_surfaces_of_other_libraries(library, ending, tmp_path):
    module = pytest.importorskip(library, reason=f"{library} is {WHY}")
    points, triangles = grid_surface(5, lambda x, y: np.sin(3 * x) * y)
    path = tmp_path / f"s{ending}"
    if library == "meshio":
        kind = {"file_format": "gmsh"} if ending == ".msh" else {}  # or it takes it for ANSYS Fluent's
        module.write(path, module.Mesh(points, {"triangle": triangles}), **kind)
    else:
        module.Trimesh(points, triangles, process=False).export(path)
    read = read_mesh(path)
    expected, found = (
        np.sort(places[corners].mean(axis=1), axis=0)
        for places, corners in ((points, triangles), (read.vertices, read.triangles))
    )
    assert len(read.triangles) == len(triangles)
    assert len(read.vertices) == len(points)  # also of formats that repeat them
    assert found == pytest.approx(expected, abs=1e-6)  # some have numbers of 32 bits


@pytest.mark.parametrize("ending", [".gpkg", ".geojson"])
def test_maps_of_gdal(ending, tmp_path):
    pyogrio = pytest.importorskip("pyogrio", reason=f"pyogrio is {WHY}")
    shapely = pytest.importorskip("shapely", reason=f"shapely is {WHY}")
    square = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(1, 1), (1, 2), (2, 2), (2, 1)]])
    several = shapely.MultiPolygon([square, shapely.box(20, 0, 21, 1)])
    shapes = shapely.to_wkb(np.array([shapely.MultiPolygon([square]), several]))
    names = np.array(["one", "two"], object)
    path = tmp_path / f"m{ending}"
    pyogrio.raw.write(
        path, shapes, [names], ["name"], geometry_type="MultiPolygon", crs="EPSG:25832", layer="m"
    )
    found = read_shapes(MapLayer(path, where={"name": "two"})).polygons
    assert [len(polygon.rings) for polygon in found] == [2, 1]
    assert len(read_shapes(MapLayer(path)).polygons) == 3
    areas = [shapely.Polygon(p.rings[0], p.rings[1:]).area for p in found]
    assert areas == pytest.approx([80.0, 1.0])
