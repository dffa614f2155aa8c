# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as files of objects (OMF, geoh5), as the libraries of the formats read them, and back as input."""

import sys
import warnings

import numpy as np
import pytest
from object_models import assert_closed, assert_shared, crossing_model, logged_model, volume
from realmodel.core import Project, Rock, Surface, UsageError, build
from realmodel.core.exporters import MODEL
from realmodel.core.results.samples import regular_cells

WHY = "not installed: scripts/test.sh installs it"
BLOCKS = ["base block", "Grès à Voltzia", "Clay", "Clay (2)", "Cover"]
SIZE = 0.125


@pytest.fixture
def model(write):
    return crossing_model(write)


def read_omf(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of 2019: NumPy 2 and Python 3.12 say what it uses that will go
        omf = pytest.importorskip("omf", reason=f"omf is {WHY}")
        with path.open("rb") as file:
            project = omf.OMFReader(file).get_project()
            assert project.validate()
            return project


def arrays(geometry):
    return np.asarray(geometry.vertices.array).view(np.ndarray), np.asarray(geometry.triangles.array)


def omf_names(data, legend="name"):
    """What each place of mapped data is."""
    values = next(each.values.array for each in data.legends if each.name == legend)
    return ["" if number < 0 else values[number] for number in np.asarray(data.array.array).tolist()]


def test_omf_has_closed_blocks_that_share_their_triangles(model, tmp_path):
    model.save(tmp_path / "m.omf")
    project = read_omf(tmp_path / "m.omf")
    assert (project.name, project.units) == ("crossing", "m")
    assert "EPSG:25832" in project.description
    elements = {element.name: element for element in project.elements}
    shapes = []
    for name, block in zip(BLOCKS, model.blocks, strict=True):
        vertices, triangles = arrays(elements[name].geometry)
        assert_closed(triangles)
        assert volume(vertices, triangles) == pytest.approx(block.volume, rel=1e-9)
        shapes.append((vertices, triangles))
        data = {each.name: each for each in elements[name].data}
        legends = {each.name: each.values.array for each in data["property"].legends}
        assert legends["id"].tolist() == [block.property]
        assert set(omf_names(data["neighbor"])) <= {"", *BLOCKS} - {name}
    assert_shared(shapes, model)
    sandstone = {each.name: each.values.array for each in elements[BLOCKS[1]].data[2].legends}
    assert sandstone["name"] == ["Sandstone"]
    assert sandstone["age"] == ["Buntsandstein"]
    assert sandstone["density"].tolist() == [2.5]
    assert tuple(elements[BLOCKS[1]].color) == (0xC8, 0x64, 0x32)
    cover = {each.name: each for each in elements["Cover"].data}
    assert {"cover", "wall"} <= set(omf_names(cover["surface"]))


def test_omf_has_surfaces_and_boreholes(model, tmp_path):
    model.save(tmp_path / "m.omf")
    elements = {element.name: element for element in read_omf(tmp_path / "m.omf").elements}
    for number, name in enumerate(["S0", "S1", "S2", "S3", "cover"]):
        vertices, triangles = arrays(elements[name].geometry)
        wanted = model.surface(number)
        assert np.array_equal(vertices, wanted[0])
        assert np.array_equal(triangles, wanted[1])
    lines = elements["boreholes"]
    assert lines.subtype == "borehole"
    by = {(each.location, each.name): omf_names(each) for each in lines.data}
    assert by["segments", "hole"] == ["B1"] * 3 + ["B2"] * 2
    assert by["segments", "block"] == ["Cover", "Clay (2)", "Clay", "Clay (2)", "Clay"]
    assert by["vertices", "surface"] == ["", "S3", "S2", "S0", "", "S2", "S1"]
    places = np.asarray(lines.geometry.vertices.array)
    assert places[:4, 2].tolist() == [9.0, 1.5, 1.0, 0.0]
    assert np.linalg.norm(places[5] - places[4]) == pytest.approx(8.25)


def runs(blocks, depths):
    """(block, from, to) of the pieces of a hole, those of one block that follow one another as one."""
    found = []
    for block, begin, end in zip(blocks, depths[:-1], depths[1:], strict=True):
        if found and found[-1][0] == block:
            found[-1] = (block, found[-1][1], end)
        else:
            found.append((block, begin, end))
    return [(block, round(begin, 6), round(end, 6)) for block, begin, end in found]


LOGGED = {
    "L1": [("", 0, 2), ("soil", 2, 10), ("", 10, 14), ("clay", 14, 25), ("rock", 25, 40)],
    "L2": [("soil", 0, 12), ("clay", 12, 16), ("", 16, 18), ("clay", 18, 22), ("rock", 22, 30)],
    "L3": [("soil", 0, 8), ("clay", 8, 28), ("rock", 28, 45)],
}


def test_omf_has_holes_as_they_were_logged(write, tmp_path):
    """To their ends; lost core is of no block, also within one."""
    logged_model(write).save(tmp_path / "m.omf")
    elements = {element.name: element for element in read_omf(tmp_path / "m.omf").elements}
    lines = elements["boreholes"]
    by = {(each.location, each.name): np.array(omf_names(each)) for each in lines.data}
    places = np.asarray(lines.geometry.vertices.array)
    for hole, wanted in LOGGED.items():
        blocks = by["segments", "block"][by["segments", "hole"] == hole].tolist()
        own = places[by["vertices", "hole"] == hole]
        steps = np.linalg.norm(np.diff(own, axis=0), axis=1)
        assert runs(blocks, [0.0, *np.cumsum(steps).tolist()]) == wanted
    named = {
        (hole, surface, round(30.0 - place[2], 6))
        for hole, surface, place in zip(
            by["vertices", "hole"], by["vertices", "surface"], places.tolist(), strict=True
        )
        if surface and hole != "L3"
    }
    # between lost core and a block there is no contact; a pick is one
    assert named == {("L1", "C", 12), ("L1", "R", 25), ("L2", "C", 12), ("L2", "R", 22)}


def test_omf_has_cells_where_their_size_is_given(model, tmp_path):
    model.save(tmp_path / "m.omf", cell_size=SIZE)
    elements = {element.name: element for element in read_omf(tmp_path / "m.omf").elements}
    geometry, cells = elements["cells"].geometry, regular_cells(model, SIZE)
    counts = [len(tensor) for tensor in (geometry.tensor_u, geometry.tensor_v, geometry.tensor_w)]
    assert counts == list(cells.counts)
    assert np.array_equal(geometry.origin, cells.origin)
    data = {each.name: np.asarray(each.array.array).reshape(counts) for each in elements["cells"].data}
    for number, name in enumerate(BLOCKS):
        assert np.array_equal(data[f"share {name}"], cells.shares[number].transpose(2, 1, 0))
    filled = data["block"] >= 0
    assert np.array_equal(filled, cells.shares.sum(axis=0).transpose(2, 1, 0) > 0)


def read_geoh5(path):
    geoh5py = pytest.importorskip("geoh5py", reason=f"geoh5py is {WHY}")
    return geoh5py.Workspace(path, mode="r")


def geoh5_names(item, name):
    data = item.get_data(name)[0]
    names = {key: value.decode() for key, value in data.value_map.map.tolist()}
    return [names[number] for number in data.values.tolist()]


def test_geoh5_has_closed_blocks_that_share_their_triangles(model, tmp_path):
    model.save(tmp_path / "m.geoh5")
    with read_geoh5(tmp_path / "m.geoh5") as workspace:
        shapes = []
        for name, block in zip(BLOCKS, model.blocks, strict=True):
            (item,) = workspace.get_entity(name)
            assert item.parent.name == "Blocks"
            vertices, triangles = np.array(item.vertices), np.array(item.cells)
            assert_closed(triangles)
            assert volume(vertices, triangles) == pytest.approx(block.volume, rel=1e-9)
            shapes.append((vertices, triangles))
            assert item.metadata["RealModel"]["property"] == block.property
            assert item.metadata["RealModel"]["volume"] == block.volume
            assert name not in geoh5_names(item, "neighbor")
            assert item.coordinate_reference_system["Code"] == "EPSG:25832"
        assert_shared(shapes, model)
        (sandstone,) = workspace.get_entity(BLOCKS[1])
        assert sandstone.metadata["RealModel"]["age"] == "Buntsandstein"
        assert set(geoh5_names(sandstone, "property")) == {"Sandstone"}
        assert sandstone.visual_parameters.colour == [0xC8, 0x64, 0x32]
        for number, name in enumerate(["S0", "S1", "S2", "S3", "cover"]):
            (item,) = workspace.get_entity(name)
            assert item.parent.name == "Interfaces"
            assert np.array_equal(np.array(item.vertices), model.surface(number)[0])


def test_geoh5_has_drillholes(model, tmp_path):
    model.save(tmp_path / "m.geoh5")
    with read_geoh5(tmp_path / "m.geoh5") as workspace:
        (upright,), (inclined,) = workspace.get_entity("B1"), workspace.get_entity("B2")
        assert upright.collar.tolist() == (400_000.75, 5_300_001.0, 9.0)
        assert upright.from_.values.tolist() == [0.0, 7.5, 8.0]
        assert upright.to_.values.tolist() == [7.5, 8.0, 9.0]
        assert geoh5_names(upright, "block") == ["Cover", "Clay (2)", "Clay"]
        assert geoh5_names(upright, "surface")[1:] == ["S3", "S2", "S0"]
        assert np.allclose(inclined.surveys[:, 1:], [90.0, -80.0], atol=1e-4)
        # by the directions that the file says, in its short numbers
        assert np.allclose(inclined.desurvey([8.25, 8.5]), inclined.vertices[1:], atol=1e-4)


def test_geoh5_has_holes_as_they_were_logged(write, tmp_path):
    logged_model(write).save(tmp_path / "m.geoh5")
    with read_geoh5(tmp_path / "m.geoh5") as workspace:
        for hole, wanted in LOGGED.items():
            (item,) = workspace.get_entity(hole)
            blocks = [name.replace("Unknown", "") for name in geoh5_names(item, "block")]
            depths = [item.from_.values[0], *item.to_.values.tolist()]
            found = runs(blocks, depths)
            assert [each[0] for each in found] == [each[0] for each in wanted]
            assert np.allclose([each[1:] for each in found], [each[1:] for each in wanted], atol=1e-4)
            assert item.end_of_hole == pytest.approx(wanted[-1][2])


def test_geoh5_has_cells_where_their_size_is_given(model, tmp_path):
    model.save(tmp_path / "m.geoh5", cell_size=SIZE)
    cells = regular_cells(model, SIZE)
    with read_geoh5(tmp_path / "m.geoh5") as workspace:
        (item,) = workspace.get_entity("cells")
        assert item.shape == cells.counts
        places = ((item.centroids - cells.origin) / cells.size).astype(int)
        x, y, z = places.T
        assert np.allclose(item.get_data("share Cover")[0].values, cells.shares[4, z, y, x], atol=1e-7)


@pytest.mark.parametrize(
    ("module", "ending", "extra"),
    [("omf", ".omf", "omf"), ("geoh5py", ".geoh5", "geoh5"), ("ifcopenshell", ".ifc", "ifc")],
)
def test_a_missing_library_is_named_before_anything_is_made(tmp_path, monkeypatch, module, ending, extra):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(UsageError, match=rf'needs {module}.*pip install "realmodel\[{extra}\]"'):
        MODEL.format(f"m{ending}")
    level = [Surface(f"S{z}", *square(z)) for z in (0.0, 1.0)]
    small = build(Project("x", [Rock("r", level)]))
    with pytest.raises(UsageError, match=f"needs {module}"):
        small.save(tmp_path / f"m{ending}")
    assert list(tmp_path.iterdir()) == []


def square(z):
    plan = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    return np.column_stack([plan, np.full(4, z)]), np.array([[0, 1, 2], [0, 2, 3]])


def test_names_in_a_file_are_distinct(tmp_path):
    """A block that is called as its surface is."""
    level = [Surface("S", *square(0.0)), Surface("T", *square(1.0), block="S")]
    small = build(Project("x", [Rock("r", level)]))
    small.save(tmp_path / "m.omf")
    assert [each.name for each in read_omf(tmp_path / "m.omf").elements] == ["S", "S (2)", "T"]
    small.save(tmp_path / "M.GEOH5")
    (tmp_path / "M.GEOH5").rename(tmp_path / "m.geoh5")
    with read_geoh5(tmp_path / "m.geoh5") as workspace:
        assert sorted(each.name for each in workspace.objects) == ["S", "S (2)", "T"]
