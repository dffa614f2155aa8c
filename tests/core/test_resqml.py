# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as RESQML 2.0.1, as resqpy reads them."""

import json
import re
import zipfile

import numpy as np
import pytest
from object_models import assert_closed, assert_shared, crossing_model, logged_model, volume
from realmodel.core import Body, Fault, OutputFailed, Project, Rock, Surface, build
from realmodel.core.exporters.objects import resqml
from structure_cases import ball, plane_fault
from test_batch import names, out, refused, run  # noqa: F401 - out is a fixture
from test_corner_point import MODELS

resqpy_model = pytest.importorskip("resqpy.model", reason="not installed: scripts/test.sh installs it")
import resqpy.crs  # noqa: E402
import resqpy.grid  # noqa: E402
import resqpy.organize  # noqa: E402
import resqpy.property  # noqa: E402
import resqpy.surface  # noqa: E402
import resqpy.well  # noqa: E402

BLOCKS = ["base block", "Grès à Voltzia", "Clay", "Clay (2)", "Cover"]
TRIANGLES = "TriangulatedSetRepresentation"
PLAN = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])


class Read:
    """A file as resqpy reads it."""

    def __init__(self, path):
        self.file = resqpy_model.Model(str(path), quiet=True)
        self.crs = resqpy.crs.Crs(self.file, uuid=self.file.uuid(obj_type="LocalDepth3dCrs"))
        self.origin = np.array([self.crs.x_offset, self.crs.y_offset, self.crs.z_offset])

    def all(self, kind, make):
        return [make(self.file, uuid=uuid) for uuid in self.file.uuids(obj_type=kind)]

    def shapes(self):
        """Of each set of triangles by its name: the set, vertices in coordinates of the map, triangles."""
        sets = self.all(TRIANGLES, resqpy.surface.Surface)
        return {made.title: (made, *self._arrays(made)) for made in sets}

    def _arrays(self, made):
        triangles, points = made.triangles_and_points()
        return points + self.origin, triangles

    def represents(self, made):
        """The kinds of the interpretation and of the feature that a set of triangles represents."""
        made = self.file.referenced_node(_child(made.root, "RepresentedInterpretation"))
        feature = self.file.referenced_node(_child(made, "InterpretedFeature"))
        return [node.tag.rpartition("}")[2] for node in (made, feature)]

    def names(self, support):
        """Of the numbers that a representation has, by their title, what each is."""
        known = {}
        for uuid in self.file.uuids(obj_type="CategoricalProperty", related_uuid=support.uuid):
            made = resqpy.property.Property(self.file, uuid=uuid)
            names = made.string_lookup().as_dict()
            known[made.title] = [names.get(number, "") for number in made.array_ref().ravel().tolist()]
        return known

    def grid(self):
        return resqpy.grid.Grid(self.file, uuid=self.file.uuid(obj_type="IjkGridRepresentation"))


def _child(node, word):
    return next(child for child in node if child.tag.rpartition("}")[2] == word)


@pytest.fixture
def model(write):
    return crossing_model(write)


def test_blocks_are_closed_and_share_their_triangles(model, tmp_path):
    model.save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    shapes = read.shapes()
    for name, block in zip(BLOCKS, model.blocks, strict=True):
        made, vertices, triangles = shapes[name]
        assert_closed(triangles)
        assert volume(vertices, triangles) == pytest.approx(block.volume, rel=1e-9)
        assert float(made.extra_metadata["volume"]) == block.volume
        assert int(made.extra_metadata["property"]) == block.property
        assert read.represents(made) == ["StratigraphicUnitInterpretation", "StratigraphicUnitFeature"]
        names = read.names(made)
        assert set(names["neighbor"]) <= {"", *BLOCKS} - {name}
        assert len(names["surface"]) == len(triangles)
    assert {"cover", "wall"} <= set(read.names(shapes["Cover"][0])["surface"])
    assert_shared([shapes[name][1:] for name in BLOCKS], model)
    about = shapes[BLOCKS[1]][0].extra_metadata
    assert (about["name"], about["age"], about["density"]) == ("Sandstone", "Buntsandstein", "2.5")


def test_coordinates_count_from_a_place_of_the_projects_system(model, tmp_path):
    model.save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    assert (read.crs.epsg_code, read.crs.z_inc_down) == ("25832", False)
    assert read.origin.tolist() == [400_000.0, 5_300_000.0, 0.0]
    assert all(abs(vertices - read.origin).max() < 10.0 for _, vertices, _ in read.shapes().values())
    with zipfile.ZipFile(tmp_path / "m.epc") as archive:
        system = next(name for name in archive.namelist() if name.startswith("obj_LocalDepth3dCrs"))
        text = archive.read(system).decode()
    # heights are of no system, and the schema has the code among the common elements
    assert re.findall(r"<(\w+):EpsgCode", text) == ["eml"]
    assert "VerticalUnknownCrs" in text


@pytest.mark.parametrize(("unit", "word"), [("m", "m"), ("ft", "ft"), ("us-ft", "ft[US]"), ("mi", "mi")])
def test_surfaces_are_those_of_random_models(unit, word, tmp_path):
    random = np.random.default_rng(len(word))
    for number in range(3):
        place = np.round(random.uniform(-1e6, 5e6, 2), 2)
        heights = np.cumsum(random.uniform(0.5, 3.0, (4, 4)), axis=0)
        surfaces = [
            Surface(f"S{k}", np.column_stack([PLAN + place, z]), [[0, 1, 2], [0, 2, 3]])
            for k, z in enumerate(heights)
        ]
        model = build(Project("random", [Rock("r", surfaces)], units=unit))
        path = tmp_path / f"{number}.epc"
        model.save(path)
        read = Read(path)
        assert (read.crs.xy_units, read.crs.z_units, read.crs.epsg_code) == (word, word, None)
        shapes = read.shapes()
        for k, z in enumerate(heights):
            made, vertices, triangles = shapes[f"S{k}"]
            assert np.allclose(vertices, np.column_stack([PLAN + place, z]), rtol=0, atol=1e-8)
            assert triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
            assert read.represents(made) == ["HorizonInterpretation", "GeneticBoundaryFeature"]
        for block in model.blocks:
            assert volume(*shapes[block.name][1:]) == pytest.approx(block.volume, rel=1e-9)


def structured(void=False):
    """A fault, a ball and four layers."""
    surfaces = [
        Surface(f"S{k}", np.column_stack([PLAN, np.full(4, 4.0 * k)]), [[0, 1, 2], [0, 2, 3]])
        for k in range(3)
    ]
    body = Body("ball", *ball((5.2, 5.1, 4.0), 2.0), void=void)
    fault = Fault("F", *plane_fault(x=5.0, lean=0.3))
    return build(Project("s", [Rock("r", surfaces)], faults=[fault], bodies=[body]))


def test_faults_and_bodies_are_what_they_are(tmp_path):
    model = structured()
    model.save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    kinds = {name: read.represents(made) for name, (made, *_) in read.shapes().items()}
    assert kinds["F"] == ["FaultInterpretation", "TectonicBoundaryFeature"]
    shapes = read.shapes()
    body = next(block for block in model.blocks if model.surface_kind[block.surface] == 2)
    named = {name: shapes[name] for name in shapes if name.startswith("ball")}
    assert {tuple(kinds[name]) for name in named} == {
        ("GeobodyInterpretation", "GeobodyFeature"),
        ("GeobodyBoundaryInterpretation", "GeneticBoundaryFeature"),
    }
    block = next(name for name in named if kinds[name][0] == "GeobodyInterpretation")
    assert volume(*shapes[block][1:]) == pytest.approx(body.volume, rel=1e-9)
    assert {"S0", "S1", "ball"} <= set(read.names(shapes["S1 block"][0])["surface"])


def test_deviations_of_kriging_are_at_the_nodes(write, tmp_path):
    rows = np.random.default_rng(5).uniform(1.0, 9.0, (9, 3)).tolist()
    points = write("p.csv", "x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in rows))
    top = Surface("top", points=points, method="kriging")
    base = Surface("base", method="constant", options={"value": 0.0})
    model = build(Project("k", [Rock("r", [base, top], region=PLAN.tolist(), edge_length=4.0)]))
    model.save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    made = read.shapes()["top"][0]
    values = {}
    for uuid in read.file.uuids(obj_type="ContinuousProperty", related_uuid=made.uuid):
        value = resqpy.property.Property(read.file, uuid=uuid)
        assert (value.indexable_element(), value.uom()) == ("nodes", "m")
        values[value.title] = value.array_ref()
    variance = model.surface_attributes(model.surface_names.index("top"))["variance"]
    assert values["standard deviation"] ** 2 == pytest.approx(variance)


def holes(read):
    """Of each hole by its name: places, the block between them, and marker, depth and interpretation."""
    known = {}
    for path in read.all("WellboreTrajectoryRepresentation", resqpy.well.Trajectory):
        frames = [
            frame
            for frame in read.all("WellboreFrameRepresentation", resqpy.well.WellboreFrame)
            if frame.trajectory.uuid == path.uuid
        ]
        blocks = [(frame.node_mds.tolist(), read.names(frame)["block"]) for frame in frames]
        markers = [
            (marker.title, round(depth, 9), read.file.title(uuid=marker.interpretation_uuid))
            for frame in read.all("WellboreMarkerFrameRepresentation", resqpy.well.WellboreMarkerFrame)
            if frame.trajectory.uuid == path.uuid
            for marker, depth in zip(frame.marker_list, frame.node_mds.tolist(), strict=True)
        ]
        known[path.title] = (path, blocks, markers)
    return known


def test_boreholes_are_trajectories_with_intervals_and_markers(model, tmp_path):
    model.save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    known = holes(read)
    path, [(depths, blocks)], markers = known["B1"]
    places = path.control_points + read.origin
    assert places.tolist() == [[400_000.75, 5_300_001.0, z] for z in (9.0, 1.5, 1.0, 0.0)]
    assert (depths, blocks) == ([0.0, 7.5, 8.0, 9.0], ["Cover", "Clay (2)", "Clay"])
    assert markers == [("S3", 7.5, "S3"), ("S2", 8.0, "S2"), ("S0", 9.0, "S0")]
    assert path.md_uom == "m"
    assert tuple(path.md_datum.location + read.origin) == tuple(places[0])
    assert known["B2"][2] == [("S2", 8.25, "S2"), ("S1", 8.5, "S1")]


def test_lost_core_is_of_no_block(write, tmp_path):
    logged_model(write).save(tmp_path / "m.epc")
    _, [(depths, blocks)], markers = holes(Read(tmp_path / "m.epc"))["L1"]
    assert depths == pytest.approx([0, 2, 10, 12, 14, 25, 40])
    assert blocks == ["", "soil", "", "", "clay", "rock"]
    assert [(name, depth) for name, depth, _ in markers] == [("C", 12), ("R", 25)]


def test_a_pick_alone_is_a_point_of_its_horizon(tmp_path):
    surfaces = [
        Surface(f"S{k}", np.column_stack([PLAN, np.full(4, 4.0 * k)]), [[0, 1, 2], [0, 2, 3]])
        for k in range(2)
    ]
    picks = {"P": (None, [("S1", np.array([2.0, 3.0, 4.0]))])}
    build(Project("p", [Rock("r", surfaces, hole_picks=picks)])).save(tmp_path / "m.epc")
    read = Read(tmp_path / "m.epc")
    [made] = read.all("PointSetRepresentation", resqpy.surface.PointSet)
    assert (made.full_array_ref() + read.origin).tolist() == [[2.0, 3.0, 4.0]]
    assert made.extra_metadata == {"hole": "P", "surface": "S1"}
    assert read.represents(made) == ["HorizonInterpretation", "GeneticBoundaryFeature"]


@pytest.mark.parametrize("azimuth", [0.0, 30.0])
@pytest.mark.parametrize("name", [*MODELS, "structured", "void"])
def test_the_grid_is_the_corner_point_grid(name, azimuth, tmp_path):
    model = MODELS[name]() if name in MODELS else structured(name == "void")
    size = 10.0 if name in MODELS else 0.7
    wanted = model.corner_point_grid(size, layers=2, azimuth=azimuth)
    model.save(tmp_path / "m.epc", cell_size=size, grid_layers=2, grid_azimuth=azimuth)
    read = Read(tmp_path / "m.epc")
    grid = read.grid()
    nx, ny, nz = wanted.shape
    corners = grid.corner_points() + read.origin
    assert corners.shape == (nz, ny, nx, 2, 2, 2, 3)
    depths = wanted.zcorn.reshape(nz, 2, ny, 2, nx, 2).transpose(0, 2, 4, 1, 3, 5)
    assert np.array_equal(-corners[..., 2], depths)
    for j, i in np.ndindex(2, 2):
        pillars = wanted.coord[j : j + ny, i : i + nx, :2]
        assert np.allclose(corners[:, :, :, 0, j, i, :2], pillars, rtol=0, atol=1e-9)
    is_active = wanted.actnum > 0
    assert np.array_equal(grid.extract_inactive_mask(), ~is_active)
    assert np.array_equal(
        np.array(read.names(grid)["block"]).reshape(nz, ny, nx),
        np.where(is_active, np.array(["", *wanted.names])[wanted.fipnum], ""),
    )
    i, j, k = (corners[-1, 0, 0][at] - corners[-1, 0, 0, 0, 0, 0] for at in ((0, 0, 1), (0, 1, 0), (1, 0, 0)))
    assert (np.dot(np.cross(i, j), k) > 0) == bool(grid.grid_is_right_handed)


def test_there_is_no_grid_without_a_size_of_cells(model, tmp_path):
    model.save(tmp_path / "m.epc", grid_layers=2)
    assert Read(tmp_path / "m.epc").file.uuids(obj_type="IjkGridRepresentation") == []


def test_the_same_model_gives_the_same_bytes_and_another_one_other_identifiers(write, tmp_path):
    for name in "abc":
        (tmp_path / name).mkdir()
    for name in "ab":
        crossing_model(write).save(tmp_path / name / "m.epc", cell_size=0.2)
    for ending in (".epc", ".h5"):
        first, second = ((tmp_path / name / f"m{ending}").read_bytes() for name in "ab")
        assert first == second
    structured().save(tmp_path / "c" / "m.epc")
    identifiers = [set(map(str, Read(tmp_path / name / "m.epc").file.uuids())) for name in ("a", "c")]
    assert identifiers[0].isdisjoint(identifiers[1])
    with zipfile.ZipFile(tmp_path / "a" / "m.epc") as archive:
        texts = [archive.read(name).decode() for name in archive.namelist()]
    found = {date for text in texts for date in re.findall(r"[>](\d{4}-\d\d-\d\dT[^<]*)<", text)}
    assert found == {"1970-01-01T00:00:00Z"}


def test_both_files_appear_or_none(model, tmp_path, monkeypatch):
    (tmp_path / "folder.h5").mkdir()
    with pytest.raises(OutputFailed, match=r"folder\.h5"):
        model.save(tmp_path / "folder.epc")

    def full(*_):
        raise OSError("no space")

    with monkeypatch.context() as patched:
        patched.setattr(resqml, "_pack", full)
        with pytest.raises(OutputFailed, match="no space"):
            model.save(tmp_path / "m.epc")
    assert [path.name for path in tmp_path.iterdir() if path.suffix != ".csv"] == ["folder.h5"]
    model.save(tmp_path / "m.v2.EPC")
    names = {path.name for path in tmp_path.iterdir() if path.name.startswith("m.")}
    assert names == {"m.v2.EPC", "m.v2.h5"}
    with zipfile.ZipFile(tmp_path / "m.v2.EPC") as archive:
        relations = b"".join(archive.read(name) for name in archive.namelist() if name.endswith(".rels"))
    assert b'"m.v2.h5"' in relations


def test_the_batch_has_the_grid_where_the_size_of_cells_is_given(layers, out):  # noqa: F811
    project = layers([0, 1, 3])
    asked = ("--export", out / "m.epc", "--grid-layers", 2, "--report", out / "r.json")
    assert "with --cell-size" in refused(run(project, *asked), 2)
    assert run(project, *asked, "--cell-size", 0.25).returncode == 0
    assert names(out) == ["m.epc", "m.h5", "r.json"]
    nk, nj, ni = Read(out / "m.epc").grid().extent_kji
    assert json.loads((out / "r.json").read_text())["corner_point_grid"]["shape"] == [ni, nj, nk]
