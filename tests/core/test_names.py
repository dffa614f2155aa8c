# SPDX-License-Identifier: GPL-3.0-or-later
"""Names beside numbers in the API, arguments by name, and errors that are also those of Python."""

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import (
    Dips,
    InputRefused,
    Library,
    OutputFailed,
    Project,
    Property,
    Rock,
    SpaceDips,
    Surface,
    Triangulation,
    UsageError,
    build,
    build_surfaces,
    mesh_region,
)


def _project():
    surfaces = []
    for number, (name, block) in enumerate((("ground", None), ("top", "sand"), ("moraine", "till"))):
        vertices, triangles = grid_surface(3, lambda x, y, z=float(number): 0 * x + z)
        surfaces.append(Surface(name, vertices=vertices, triangles=triangles, block=block))
    return Project("names", [Rock("rock", surfaces, base_elevation=-1)])


@pytest.fixture(scope="module")
def model():
    return build(_project())


def test_blocks_and_surfaces_by_name_are_those_by_number(model):
    for number, name in enumerate(block.name for block in model.blocks):
        assert model.blocks[name] is model.blocks[number]
    assert model.blocks[-1].name == "till"
    assert [block.name for block in model.blocks[1:]] == ["sand", "till"]
    for holder in (model, build_surfaces(_project())):
        for number, name in enumerate(holder.surface_names):
            assert holder.surfaces[name].vertices[0, 2] == float(number)
            assert holder.surface(name).triangles is holder.surface(number)[1]
            np.testing.assert_array_equal(holder.surface_attributes(name)["height"], float(number))
    assert model.stage("top").volume == model.stage(1).volume < model.volume


@pytest.mark.parametrize("key", ["chalk", 7, -4, True, 1.5, None])
def test_unknown_names_and_numbers_say_what_there_is(model, key):
    for call in (model.surface, model.block_boundary, model.surface_attributes):
        with pytest.raises(UsageError, match=r"there is no (surface|block).*numbered from 0"):
            call(key)


def test_a_name_of_several_blocks_asks_for_the_number():
    project = _project()
    project.rocks[0].surfaces[2].block = "sand"
    with pytest.raises(UsageError, match="there are 2 blocks named 'sand': give its number"):
        build(project).blocks["sand"]


def test_slice_and_clip_are_section_and_cut(model):
    middle = (0.5, 0.5, 0.5)
    for normal, axis in (("x", (1, 0, 0)), ("-y", (0, -1, 0)), ((1, 2, 3), (1, 2, 3))):
        section = model.section(middle, axis)
        np.testing.assert_array_equal(model.slice(normal, origin=middle).vertices, section.vertices)
        cut = model.cut_by_plane(middle, axis)
        assert model.clip(normal, middle).volume == cut.below.volume
        assert model.clip(normal, middle, invert=False).volume == cut.above.volume
    assert model.slice("z").area == model.slice("z", model.vertices.mean(axis=0) * 0 + middle).area
    with pytest.raises(UsageError, match="normal must be one of x, y, z, -x"):
        model.slice("w")


def test_arguments_by_position_still_work_and_warn(model):
    with pytest.warns(DeprecationWarning, match="section: pass threads by name"):
        old = model.section((0.5, 0.5, 0.5), (1, 0, 0), 2)
    assert old.area == model.section((0.5, 0.5, 0.5), (1, 0, 0), threads=2).area
    with pytest.raises(TypeError):
        model.section((0.5, 0.5, 0.5), (1, 0, 0), 2, threads=2)


def test_libraries_by_id_and_name():
    library = Library([Property(3, "Sand"), Property(7, "Clay")])
    assert library["Clay"] is library[7] is library.get(7)
    assert "Sand" in library and 7 in library and "Chalk" not in library
    with pytest.raises(UsageError, match="no property 'Chalk'; it has 3 'Sand', 7 'Clay'"):
        library["Chalk"]


def test_dips_from_angles():
    dips = Dips.from_angles([[0, 0, 5], [1, 0, 6]], [30, 45], 90, surfaces=["a", "b"])
    np.testing.assert_allclose(dips.gradients, [[-np.tan(np.pi / 6), 0], [-1, 0]], atol=1e-15)
    assert dips.z.tolist() == [5, 6] and dips.positions.shape == (2, 2) and dips.surfaces[1] == "b"
    with pytest.raises(InputRefused, match="dip 1 is 90 degrees"):
        Dips.from_angles([[0, 0], [1, 1]], [0, 90], 0)
    space = SpaceDips.from_angles([[0, 0, 0], [1, 1, 1]], [90, 30], [0, 90], [False, True])
    np.testing.assert_allclose(space.normals, [[0, 1, 0], [-0.5, 0, -np.sqrt(0.75)]], atol=1e-15)
    assert not len(Dips.from_angles(np.empty((0, 2)), 10, 20))


def test_errors_are_those_of_python_too(tmp_path, model):
    kinds = {
        InputRefused: ValueError,
        UsageError: (ValueError, TypeError),
        OutputFailed: OSError,
    }
    for error, built_in in kinds.items():
        assert all(issubclass(error, kind) for kind in np.atleast_1d(built_in))
    with pytest.raises(OSError, match="missing"):
        model.save(tmp_path / "missing" / "a.npz")
    with pytest.raises(ValueError, match="xyz"):
        model.save(tmp_path / "a.xyz")


def test_triangulations_are_tuples_and_meshes():
    pytest.importorskip("pyvista")
    mesh = mesh_region([[0, 0], [4, 0], [4, 4], [0, 4]], edge_length=2)
    vertices, triangles = mesh
    assert isinstance(mesh, Triangulation) and vertices is mesh.vertices
    assert mesh.to_pyvista().area == pytest.approx(16)
    assert mesh.to_pyvista().n_cells == len(triangles)
