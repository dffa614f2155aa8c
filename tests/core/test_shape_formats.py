# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a model in the formats of shapes, as readers that nobody here wrote read them."""

from dataclasses import replace

import numpy as np
import pytest
from object_models import assert_closed, crossing_surfaces, volume
from realmodel.core import Library, MeshFile, Project, Property, Rock, build, build_surfaces
from realmodel.core.exporters.shapes.shape_parts import model_parts
from realmodel.core.readers import read_mesh
from realmodel.core.readers.contents import layer_names

WHY = "not installed: scripts/test.sh installs it"
NAMES = ["base block", "Grès à Voltzia", "Clay", "Clay (2)"]


def read_all(path):
    """The mesh of each object of a file, or the only one."""
    return [read_mesh(MeshFile(path, layer=name)) for name in layer_names(path) or [None]]


def rocks(shift):
    return [Rock("rock", crossing_surfaces(shift), base_elevation=-2.0)]


@pytest.fixture(scope="module")
def model():
    library = Library([Property(1, "Sandstone", color="#c86432"), Property(2, "Clay", color="#204060")])
    return build(Project("crossing", rocks((400_000.0, 5_300_000.0, 0.0)), library))


@pytest.fixture(scope="module")
def folder(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("shapes")
    for ending in (".obj", ".ply", ".stl", ".glb", ".dxf", ".ts"):
        model.save(path / f"m{ending}")
    return path


def test_obj_has_a_group_for_each_block(model, folder):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    text = (folder / "m.obj").read_text()
    groups = [line.split()[1] for line in text.splitlines() if line.startswith("g ")]
    assert groups == ["base_block", "Grès_à_Voltzia", "Clay", "Clay__2_"]
    assert [line for line in text.splitlines() if line.startswith("usemtl")] == [
        f"usemtl property_{k}" for k in (0, 1, 2, 0)
    ]
    assert "newmtl property_1\nKd 0.784314 0.392157 0.196078" in (folder / "m.mtl").read_text()
    read = meshio.read(folder / "m.obj")
    assert np.array_equal(read.points, np.concatenate([part.vertices for part in model_parts(model)]))
    assert set(map(tuple, read.points)) <= set(map(tuple, model.vertices))
    triangles = np.concatenate([cells.data for cells in read.cells])
    assert {cells.type for cells in read.cells} == {"triangle"}
    assert_closed(triangles)
    whole = sum(block.volume for block in model.blocks)
    assert volume(read.points, triangles) == pytest.approx(whole, rel=1e-9)
    objects = [line.split()[1] for line in text.splitlines() if line.startswith("o ")]
    assert objects == groups  # Blender makes an object of each "o"


def test_stl_in_a_file_for_each_block(model, tmp_path):
    model.save(tmp_path / "a {block}.stl")
    names = {"a base_block.stl", "a Gres_a_Voltzia.stl", "a Clay.stl", "a Clay_2.stl"}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert (tmp_path / "a Clay.stl").read_text().count("endsolid") == 1


def test_ply_knows_blocks_properties_and_colors(model, folder):
    vtk = pytest.importorskip("vtk", reason=f"VTK is {WHY}")
    trimesh = pytest.importorskip("trimesh", reason=f"trimesh is {WHY}")
    mesh = trimesh.load(folder / "m.ply", process=False)
    faces = mesh.metadata["_ply_raw"]["face"]["data"]
    for number, block in enumerate(model.blocks):
        own = mesh.faces[faces["block"] == number]
        assert_closed(own)
        assert volume(mesh.vertices, own) == pytest.approx(block.volume, rel=1e-7)
        assert set(faces["property"][faces["block"] == number]) == {block.property}
    assert (faces["red"][faces["block"] == 1] == 0xC8).all()
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(folder / "m.ply"))
    reader.Update()
    assert reader.GetOutput().GetNumberOfCells() == len(mesh.faces)


def test_stl_has_a_solid_for_each_block(model, folder):
    trimesh = pytest.importorskip("trimesh", reason=f"trimesh is {WHY}")
    solids = trimesh.load(folder / "m.stl", process=False).geometry
    assert list(solids) == NAMES
    for name, block in zip(NAMES, model.blocks, strict=True):
        corners = np.asarray(solids[name].vertices)[solids[name].faces].reshape(-1, 3)
        vertices, index = np.unique(corners, axis=0, return_inverse=True)
        assert_closed(index.reshape(-1, 3))
        assert volume(vertices, index.reshape(-1, 3)) == pytest.approx(block.volume, rel=1e-7)


def test_glb_has_a_node_for_each_block_and_a_material_for_each_property(model, folder):
    trimesh = pytest.importorskip("trimesh", reason=f"trimesh is {WHY}")
    scene = trimesh.load(folder / "m.glb")
    assert set(scene.geometry) == set(NAMES)
    for name, block in zip(NAMES, model.blocks, strict=True):
        mesh = scene.geometry[name]
        assert mesh.visual.material.name == ("property 0", "Sandstone", "Clay")[block.property]
        assert volume(mesh.vertices, mesh.faces) == pytest.approx(block.volume, rel=1e-5)
    transform, _ = scene.graph["Clay"]
    low, high = scene.geometry["Clay"].bounds + transform[:3, 3]
    assert -high[2] == pytest.approx(5_300_000.0)
    assert low[0] == pytest.approx(400_000.0)
    assert high[1] == pytest.approx(model.block_boundary(2).vertices[:, 2].max(), abs=1e-5)


def test_dxf_has_a_layer_for_each_block(model, folder):
    ezdxf = pytest.importorskip("ezdxf", reason=f"ezdxf is {WHY}")
    document = ezdxf.readfile(folder / "m.dxf")
    assert not document.audit().has_errors
    layers = ["BASE_BLOCK", "GRES_A_VOLTZIA", "CLAY", "CLAY__2_"]
    for layer, block in zip(layers, model.blocks, strict=True):
        assert layer in document.layers
        faces = list(document.modelspace().query(f'3DFACE[layer=="{layer}"]'))
        corners = np.array([[tuple(p) for p in face.wcs_vertices()[:3]] for face in faces])
        vertices, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        assert_closed(index.reshape(-1, 3))
        assert volume(vertices, index.reshape(-1, 3)) == pytest.approx(block.volume, rel=1e-7)
    assert document.layers.get("GRES_A_VOLTZIA").color != document.layers.get("CLAY").color


def test_tsurf_has_an_object_for_each_block(model, folder):
    text = (folder / "m.ts").read_text()
    names = [line.removeprefix("name:") for line in text.splitlines() if line.startswith("name:")]
    assert names == NAMES
    assert text.count("GOCAD TSurf 1\n") == text.count("\nEND\n") == 4
    assert 'AXIS_UNIT "m" "m" "m"' in text
    read = read_all(folder / "m.ts")
    for mesh in read:
        assert_closed(mesh.triangles)
    total = sum(volume(mesh.vertices, mesh.triangles) for mesh in read)
    assert total == pytest.approx(model.volume, rel=1e-7)


def test_every_triangle_of_a_block_has_an_area(model):
    from realmodel.core.exporters.shapes.shape_parts import model_parts

    for part in model_parts(model):
        a, b, c = part.vertices[part.triangles].transpose(1, 0, 2)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        # faces with corners in one line are divided without triangles on it, up to rounding
        assert (area > 0).mean() > 0.999
        assert_closed(part.triangles)


@pytest.mark.parametrize("ending", [".obj", ".ply", ".stl", ".ts"])
def test_surfaces_and_sections_are_written_as_shapes(model, tmp_path, ending):
    surfaces = build_surfaces(model.project)
    surfaces.save(tmp_path / f"s{ending}")
    read = read_all(tmp_path / f"s{ending}")
    assert sum(len(mesh.triangles) for mesh in read) == sum(len(surfaces.surface(k)[1]) for k in range(4))
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    section = model.section((low + high) / 2, (1.0, 0.3, 0.1))
    section.save(tmp_path / f"c{ending}")
    corners = [mesh.vertices[mesh.triangles] for mesh in read_all(tmp_path / f"c{ending}")]
    a, b, c = (np.concatenate(corners) - low).transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(section.area, rel=1e-6)


def test_vtk_reads_surfaces(model, tmp_path):
    pyvista = pytest.importorskip("pyvista", reason=f"PyVista is {WHY}")
    surfaces = build_surfaces(model.project)
    surfaces.save(tmp_path / "s.vtu")
    read = pyvista.read(tmp_path / "s.vtu")
    for number in range(len(surfaces.surface_names)):
        vertices, triangles = surfaces.surface(number)
        own = read.extract_cells(np.flatnonzero(read.cell_data["surface"] == number))
        assert own.n_cells == len(triangles)
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        assert own.area == pytest.approx(area)
        used = vertices[np.unique(triangles)]
        assert own.bounds[::2] == pytest.approx(used.min(axis=0))
        assert own.bounds[1::2] == pytest.approx(used.max(axis=0))


def test_tsurf_says_the_unit(model, tmp_path):
    project = replace(model.project, units="ft")
    surfaces = build_surfaces(project)
    surfaces.save(tmp_path / "s.ts")
    built = build(project)
    built.save_surfaces(tmp_path / "b.ts")
    assert (tmp_path / "b.ts").read_bytes() == (tmp_path / "s.ts").read_bytes()
    built.save(tmp_path / "m.ts")
    built.section(built.vertices.mean(axis=0), (1.0, 0.0, 0.0)).save(tmp_path / "c.ts")
    for name in ("s", "m", "c"):
        assert {mesh.unit for mesh in read_all(tmp_path / f"{name}.ts")} == {"ft"}


def test_surfaces_have_groups_in_obj(model, tmp_path):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    surfaces = build_surfaces(model.project)
    surfaces.save(tmp_path / "s.obj")
    text = (tmp_path / "s.obj").read_text()
    assert [line for line in text.splitlines() if line.startswith("g ")] == ["g S0", "g S1", "g S2", "g S3"]
    assert "mtl" not in text
    read = meshio.read(tmp_path / "s.obj")
    shapes = [surfaces.surface(k) for k in range(4)]
    assert np.array_equal(read.points, np.concatenate([vertices for vertices, _ in shapes]))
    assert sum(map(len, read.cells)) == sum(len(triangles) for _, triangles in shapes)


def test_surfaces_and_sections_in_glb_and_dxf(model, tmp_path):
    trimesh = pytest.importorskip("trimesh", reason=f"trimesh is {WHY}")
    ezdxf = pytest.importorskip("ezdxf", reason=f"ezdxf is {WHY}")
    build_surfaces(model.project).save(tmp_path / "s.dxf")
    document = ezdxf.readfile(tmp_path / "s.dxf")
    assert {"S0", "S1", "S2", "S3"} <= {layer.dxf.name for layer in document.layers}
    middle = (model.vertices.min(axis=0) + model.vertices.max(axis=0)) / 2
    model.section(middle, (1.0, 0.0, 0.0)).save(tmp_path / "c.glb")
    assert set(trimesh.load(tmp_path / "c.glb").geometry) <= set(NAMES)
