# SPDX-License-Identifier: GPL-3.0-or-later
"""What a notebook shows of a model, and its tables, meshes and maps for pandas, PyVista and xarray."""

import base64
import io
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import (
    Body,
    Fault,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    build_surfaces,
    load_project,
)
from realmodel.core.model import notebook_view
from sample_models import three_layers
from sample_scripts import built_sample
from structure_cases import ball, plane_fault

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


@pytest.fixture(scope="module")
def model():
    return build(three_layers())


@pytest.fixture(scope="module")
def faulted():
    plan = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], float)
    surfaces = [
        Surface(f"S{k}", vertices=np.column_stack([plan, np.full(4, z)]), triangles=[[0, 1, 2], [0, 2, 3]])
        for k, z in enumerate((1.0, 2.0))
    ]
    vertices, triangles = plane_fault(5.0, 0.4)
    fault = Fault("F", vertices=vertices, triangles=triangles)
    body = Body("salt", *ball((2.0, 5.0, 1.0), 0.7))
    return build(
        Project(
            "faulted", [Rock("rock", surfaces=surfaces, base_elevation=0.0)], faults=[fault], bodies=[body]
        )
    )


class Cells(HTMLParser):
    """The texts of the cells of a table, row by row."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.within = [], False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.within = True

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.within = False

    def handle_data(self, data):
        if self.within:
            self.rows[-1][-1] += data


def test_a_model_is_three_lines(model):
    assert repr(model).splitlines() == [
        "Model 'three layers': 3 blocks, 48 m³",
        "  12 cells (columns), 46 faces, 27 vertices, 3 surfaces",
        "  x 0 to 4, y 0 to 4, z 0 to 5 m; 0 warnings",
    ]


def test_half_of_a_faulted_model_is_three_lines(faulted):
    half = faulted.cut_by_plane((0, 5, 0), (0, 1, 0)).above
    lines = repr(half).splitlines()
    assert len(lines) == 3
    assert lines[0].startswith("Model 'faulted' (half of a cut): ")
    assert lines[1].endswith(" 2 surfaces, 1 fault, 1 body")


def test_a_model_without_cells_is_shown(model):
    apart = model.cut_by_plane((0, 0, 9), (0, 0, 1)).above
    assert repr(apart).splitlines()[2] == "  no cells m; 0 warnings"
    assert "<img" not in apart._repr_html_()
    assert "<iframe" not in apart._repr_html_()
    assert apart.to_pyvista().n_cells == 0


def test_a_notebook_shows_the_blocks_and_a_picture(model, monkeypatch):
    assert "<iframe" in model._repr_html_()  # test_page.py opens it
    monkeypatch.setattr(notebook_view, "_LARGEST_PAGE", 0)
    html = model._repr_html_()
    assert Cells(html).rows[1:] == [
        ["", "soil", "hill", "8", "16.7 %", "1", "2"],
        ["", "sand", "hill", "10", "20.8 %", "1", "4"],
        ["", "clay", "hill", "30", "62.5 %", "1", "6"],
    ]
    picture = base64.b64decode(re.search(r"data:image/png;base64,([^\"]+)", html).group(1))
    assert picture.startswith(b"\x89PNG")
    colors = re.findall(r"background:(#\w{6})", html)
    assert len(set(colors)) == 3
    pixels = pixels_of(picture)
    for color in colors:  # each block is in the picture, in its own color
        rgb = np.array([int(color[k : k + 2], 16) for k in (1, 3, 5)])
        assert (pixels == rgb).all(axis=2).sum() > 100


def pixels_of(png):
    image = pytest.importorskip("PIL.Image")
    return np.asarray(image.open(io.BytesIO(png)).convert("RGB"))


def test_names_are_escaped():
    project = three_layers()
    project.rocks[0].surfaces[0].block = "<b>clay</b> & silt"
    html = build(project)._repr_html_()
    assert "<b>" not in html
    assert Cells(html).rows[3][1] == "<b>clay</b> & silt"


def test_the_picture_of_a_large_model_is_small():
    html = built_sample("haut_barr", cells="blocks")._repr_html_()
    assert len(html) < 100_000


def test_a_section_is_shown_as_its_drawing(model, tmp_path):
    section = model.section((2, 2, 2), (0, -1, 0))
    section.save(tmp_path / "s.svg")
    assert section._repr_svg_() == (tmp_path / "s.svg").read_text(encoding="utf-8")
    assert model.section((2, 9, 2), (0, -1, 0))._repr_svg_() is None
    assert model.cut_by_block(model, "sand").section._repr_svg_() is None


def test_results_are_shown_in_short(faulted):
    section = faulted.section((5, 5, 1), (0, -1, 0))
    assert repr(section) == f"Section of 'faulted': {len(section)} polygons of 3 blocks, 20 m²"
    assert repr(faulted.fence([[1, 1], [9, 9]])).startswith("Fence of 'faulted': ")
    mesh = faulted.simulation_mesh(2.0, 0.2, elements="tetrahedra")
    assert repr(mesh).startswith(f"SimulationMesh(points=<float64 ({len(mesh.points)}, 3)>, elements=")
    assert repr(mesh.points) not in repr(mesh)
    cut = faulted.cut_by_plane((5, 5, 1), (0, 1, 0))
    for found in (mesh, cut, faulted.cleaned_cells(0.01), faulted.eroded(), faulted.block_boundary(0)):
        assert len(repr(found)) < 1500
        assert "\n" not in repr(found)
    nothing = replace(mesh, warnings=list(range(9)))
    assert "warnings=<list of 9>" in repr(nothing)


# -- tables


def test_the_table_of_blocks(model):
    table = model.block_table()
    assert table.index.name == "block"
    assert table["name"].tolist() == ["clay", "sand", "soil"]
    assert table["volume"].tolist() == [block.volume for block in model.blocks]
    assert table["share"].sum() == pytest.approx(1)
    assert table["cells"].tolist() == [6, 4, 2]
    assert table["surface"].tolist() == ["top of clay", "top of sand", "ground"]
    assert table["rock"].unique().tolist() == ["hill"]


def test_the_table_of_blocks_has_the_names_of_the_library():
    model = built_sample("two_layers")
    table = model.block_table()
    library = model.project.library
    assert table["property_name"].tolist() == [library.get(block.property).name for block in model.blocks]


def test_the_table_of_a_borehole(model):
    table = model.borehole_table(3.5, 1.0)
    assert table["name"].tolist() == ["soil", "sand", "clay"]
    assert table["block"].tolist() == [each.block for each in model.borehole(3.5, 1.0)]
    assert table["top"].tolist() == [4.5, 3.0, 2.0]
    assert table["length"].sum() == 4.5
    nothing = model.borehole_table(9, 9)
    assert len(nothing) == 0
    assert list(nothing) == list(table)


def test_lists_of_the_report_are_tables(faulted):
    report = faulted.report()
    assert report.table("blocks")["volume"].tolist() == [block.volume for block in faulted.blocks]
    compartments = report.table("compartments")
    assert compartments["blocks.volume"].sum() == pytest.approx(faulted.volume)
    assert set(compartments["blocks.block"]) == {block.name for block in faulted.blocks}
    faults = report.table("faults")
    assert len(faults) == len(report["faults"][0]["surfaces"])
    assert {"name", "surfaces.surface", "surfaces.throw.mean"} <= set(faults)
    with pytest.raises(UsageError, match="no list 'volume'; there are blocks, surfaces"):
        report.table("volume")


def test_the_table_of_a_section(model):
    table = model.section((2, 2, 2), (0, -1, 0)).block_table()
    assert table["area"].tolist() == pytest.approx([7.5, 2.5, 2.0])
    above = model.section((2, 2, 4.5), (0, 0, 1)).block_table()
    assert above["name"].tolist() == ["soil"]
    assert above.index.tolist() == [2]


# -- meshes


def closed(mesh):
    return mesh.n_open_edges == 0


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_model_is_a_watertight_grid(cells):
    model = build(three_layers(), cells=cells)
    grid = model.to_pyvista()
    assert grid.n_cells == len(model.cell_block)
    assert (grid.celltypes == 42).all()
    assert (grid["block"] == model.cell_block).all()
    assert grid["volume"].sum() == pytest.approx(48)
    assert list(grid.field_data["block_names"]) == ["clay", "sand", "soil"]
    outside = grid.extract_surface(algorithm=None)
    assert closed(outside)
    assert outside.volume == pytest.approx(48)
    for number, block in enumerate(model.blocks):
        own = grid.extract_cells(grid["block"] == number).extract_surface(algorithm=None)
        assert closed(own)
        assert own.volume == pytest.approx(block.volume)
        boundary = model.block_boundary(number).to_pyvista()
        assert closed(boundary)
        assert boundary.volume == pytest.approx(block.volume)


def test_cells_are_as_large_for_pyvista(model):
    """Columns are convex here: the faces of each turn outward, and none is missing."""
    sizes = model.to_pyvista().compute_cell_sizes()
    assert sizes["Volume"] == pytest.approx(model.cell_volumes)


def test_a_faulted_model_is_a_watertight_grid(faulted):
    grid = faulted.to_pyvista()
    outside = grid.extract_surface(algorithm=None)
    assert closed(outside)
    assert outside.volume == pytest.approx(faulted.volume)
    assert set(grid["compartment"]) == set(range(len(faulted.compartment_names)))
    assert (grid["property"] == [faulted.blocks[k].property for k in faulted.cell_block]).all()
    colors = {tuple(color) for color in grid["color"]}
    assert len(colors) == len(faulted.blocks)


def test_a_mesh_of_pyvista_is_a_copy(model):
    vertices, blocks = model.vertices.copy(), model.cell_block.copy()
    grid = model.to_pyvista()
    grid.points += 100
    grid["block"][:] = 7
    surfaces = model.surfaces_to_pyvista()
    surfaces["ground"].points += 100
    assert (model.vertices == vertices).all()
    assert (model.cell_block == blocks).all()
    assert model.surface(2)[0][:, 2].max() == 5


def test_a_grid_is_the_file_for_paraview(faulted, tmp_path):
    import pyvista

    faulted.save(tmp_path / "m.vtu")
    file, grid = pyvista.read(tmp_path / "m.vtu"), faulted.to_pyvista()
    assert (file.points == grid.points).all()
    for name in ("block", "property", "compartment"):
        assert (file[name] == grid[name]).all()
    assert (file.polyhedron_face_connectivity == grid.polyhedron_face_connectivity).all()
    assert (file.polyhedron_face_offsets == grid.polyhedron_face_offsets).all()


def test_sections_and_fences_are_meshes(model):
    section = model.section((2, 2, 2), (0, -1, 0))
    mesh = section.to_pyvista()
    assert mesh.compute_cell_sizes()["Area"] == pytest.approx(section.polygon_areas)
    assert (mesh["block"] == section.block).all()
    assert (mesh["cells"] == section.cells).all()
    assert mesh["color"].dtype == np.uint8
    fence = model.fence([[0, 1], [3, 1], [3, 4]])
    mesh = fence.to_pyvista()
    assert mesh.area == pytest.approx(fence.area)
    assert set(mesh["panel"]) == {0, 1}
    assert model.section((2, 9, 2), (0, -1, 0)).to_pyvista().n_cells == 0


def test_surfaces_are_meshes(faulted):
    found = faulted.surfaces_to_pyvista()
    assert list(found.keys()) == ["S0", "S1", "F", "salt"]
    for number, mesh in enumerate(found):
        vertices, triangles = faulted.surface(number)
        assert (mesh.points == vertices).all()
        assert (mesh.regular_faces == triangles).all()
        assert (mesh["height"] == vertices[:, 2]).all()
    assert closed(found["salt"])
    assert np.isnan(found["S0"]["variance"]).all()


def test_surfaces_of_a_project_are_meshes():
    found = build_surfaces(load_project(SAMPLES / "two_layers" / "project.toml")).to_pyvista()
    assert found.n_blocks == 2
    assert np.isfinite(found[0]["distance"]).all()


@pytest.mark.parametrize("elements", ["prisms", "tetrahedra"])
def test_a_mesh_for_simulation_is_a_watertight_grid(model, elements):
    mesh = model.simulation_mesh(1.0, 0.1, 2, elements)
    grid = mesh.to_pyvista()
    assert grid.n_cells == mesh.cells
    sizes = grid.compute_cell_sizes()["Volume"]
    assert (sizes > 0).all()
    assert np.bincount(grid["block"], sizes, 3) == pytest.approx(mesh.volumes)
    assert closed(grid.extract_surface(algorithm=None))
    assert grid["layer"].max() == mesh.plan.layers - 1
    assert grid["column"].max() == len(mesh.plan.triangles) - 1


def test_a_mesh_of_a_model_without_columns_is_a_watertight_grid(faulted):
    grid = faulted.simulation_mesh(2.0, 0.2, elements="tetrahedra").to_pyvista()
    assert set(grid.celltypes) == {10}
    assert closed(grid.extract_surface(algorithm=None))
    assert set(grid["compartment"]) == set(range(len(faulted.compartment_names)))


def test_cleaned_cells_are_a_watertight_grid(faulted):
    cells = faulted.cleaned_cells(0.01)
    grid = cells.to_pyvista()
    assert grid.n_cells == cells.cells
    assert closed(grid.extract_surface(algorithm=None))


# -- maps


def test_maps_have_coordinates_and_units(model):
    pytest.importorskip("xarray", reason="xarray is not installed")
    maps = model.to_xarray(cell_size=0.5)
    assert maps.sizes == {"y": 8, "x": 8, "block": 3}
    assert maps.x.values.tolist() == [0.25 + 0.5 * k for k in range(8)]
    assert maps.y.values.tolist() == [3.75 - 0.5 * k for k in range(8)]
    assert all(maps[name].attrs["units"] == "m" for name in ("x", "y", "elevation", "top", "thickness"))
    assert maps.block_name.values.tolist() == ["clay", "sand", "soil"]
    assert maps.elevation.values == pytest.approx(np.tile(1 + maps.x.values, (8, 1)))
    soil = maps.isel(block=2)
    assert soil.thickness.values == pytest.approx(np.tile(np.maximum(maps.x.values - 2, 0), (8, 1)))
    assert np.isnan(soil.top.values[:, :4]).all()
    assert maps.thickness.sum("block").values == pytest.approx(maps.elevation.values)


def test_maps_name_the_unit_of_the_project():
    pytest.importorskip("xarray", reason="xarray is not installed")
    project = three_layers()
    project.units = "ft"
    assert build(project).to_xarray().thickness.attrs["units"] == "ft"


# -- progress and missing packages


def test_progress_is_a_bar_where_it_is_asked_for(capsys):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    build(three_layers(), progress=True)
    bar = capsys.readouterr().err.split("\r")
    assert re.fullmatch(r".+: 100%\|█+\| 00:0\d\n", bar[-1])


CALLS = {
    "pandas": [
        lambda model: model.block_table(),
        lambda model: model.borehole_table(1, 1),
        lambda model: model.report().table("blocks"),
        lambda model: model.section((2, 2, 2), (1, 0, 0)).block_table(),
    ],
    "pyvista": [
        lambda model: model.to_pyvista(),
        lambda model: model.section((2, 2, 2), (1, 0, 0)).to_pyvista(),
        lambda model: model.surfaces_to_pyvista(),
        lambda model: model.simulation_mesh(1.0, 0.1).to_pyvista(),
        lambda model: model.block_boundary(0).to_pyvista(),
    ],
    "xarray": [lambda model: model.to_xarray()],
    "tqdm": [lambda model: model.stage(1, progress=True)],
}


@pytest.mark.parametrize(
    ("package", "call"), [(package, call) for package, calls in CALLS.items() for call in calls]
)
def test_a_missing_package_is_named_with_its_extra(model, monkeypatch, package, call):
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, f"{package}.auto", None)
    with pytest.raises(UsageError, match=rf'needs {package}.*pip install "realmodel\[notebook\]"'):
        call(model)


def test_nothing_of_the_extras_is_imported_before_it_is_needed():
    code = (
        "import sys; from realmodel.core import build; import realmodel.core.plots; "
        "print(sorted({'pandas', 'pyvista', 'vtk', 'xarray', 'tqdm'} & set(sys.modules)))"
    )
    environment = {"PYTHONPATH": str(SAMPLES.parent / "addon")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert run.stdout == "[]\n", run.stderr
