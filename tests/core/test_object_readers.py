# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces, points and boreholes of OMF and geoh5 files as input: our files, and those of the libraries."""

import sys
import warnings
from itertools import islice

import numpy as np
import pytest
from conftest import grid_surface
from damages import damaged_bytes
from object_models import crossing_model
from realmodel.core import (
    Boreholes,
    InputRefused,
    MeshFile,
    PointFile,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import UnitNames, objects_in, read_mesh, read_picks, read_point_file
from realmodel.core.readers.contents import column_names, column_values, layer_names

WHY = "not installed: scripts/test.sh installs it"
ENDINGS = (".omf", ".geoh5")


def omf_module():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is of 2019
        return pytest.importorskip("omf", reason=f"omf is {WHY}")


def geoh5_modules():
    geoh5py = pytest.importorskip("geoh5py", reason=f"geoh5py is {WHY}")
    from geoh5py import groups, objects

    return geoh5py, groups, objects


@pytest.fixture
def model(write):
    return crossing_model(write)


def write_omf(path, elements, origin=(0.0, 0.0, 0.0)):
    omf = omf_module()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        omf.OMFWriter(omf.Project(name="x", elements=elements(omf), origin=list(origin)), str(path))
    return path


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_is_written_is_read(model, tmp_path, ending):
    model.save(path := tmp_path / f"m{ending}")
    names = layer_names(path)
    assert {"Clay", "Clay (2)", "S0", "S3", "cover"} <= set(names)
    for number, name in enumerate(["S0", "S1", "S2", "S3"]):
        mesh = read_mesh(MeshFile(path, layer=name))
        vertices, triangles = model.surface(number)
        assert np.array_equal(mesh.vertices, vertices)
        assert np.array_equal(mesh.triangles, triangles)
        points, said = read_point_file(PointFile(path, layer=name.lower()))
        assert np.array_equal(points, vertices)
        assert said == []


@pytest.mark.parametrize("ending", ENDINGS)
def test_boreholes_come_back(model, tmp_path, ending):
    model.save(path := tmp_path / f"m{ending}")
    picks = read_picks(Boreholes(path))
    wanted = model.project.rocks[0].hole_picks
    assert set(picks.holes) == {"B1", "B2"}
    for hole, (collar, places) in wanted.items():
        found_collar, found = picks.holes[hole]
        if ending == ".geoh5":
            assert np.array_equal(found_collar, collar)
        assert [name for name, _ in found] == [name for name, _ in places]
        assert np.array_equal([place for _, place in found], [place for _, place in places])
    assert picks.points["S2"].shape == (2, 3)
    assert picks.warnings == []


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_project_is_built_from_the_objects_of_a_file(model, tmp_path, ending):
    model.save(file := tmp_path / f"m{ending}")
    surfaces = "".join(
        f'[[rock.surface]]\nname = "S{k}"\nmesh = "{file.name}"\nlayer = "S{k}"\n' for k in range(4)
    )
    text = f'format = 1\nname = "x"\n[[rock]]\nname = "r"\nbase_elevation = -2.0\n{surfaces}'
    (tmp_path / "p.toml").write_text(text)
    again = build(load_project(tmp_path / "p.toml"))
    other = build(Project("x", [Rock("r", model.project.rocks[0].surfaces[:4], base_elevation=-2.0)]))
    assert [block.volume for block in again.blocks] == [block.volume for block in other.blocks]
    written = save_project(again.project, tmp_path / "again.toml")
    assert len(written) == 5


def test_a_body_and_a_fault_may_be_objects(tmp_path):
    """A closed block of another model as a body."""
    level = [Surface(f"S{k}", *grid_surface(2, lambda x, y, k=k: 1.0 * k + 0 * x)) for k in range(2)]
    build(Project("small", [Rock("r", level)])).save(tmp_path / "m.omf")
    around = [
        Surface(f"L{k}", *grid_surface(2, lambda x, y, k=k: 3.0 * k - 1.0 + 0 * x, 3.0)) for k in range(2)
    ]
    from realmodel.core import Body

    rock = Rock("r", [Surface(s.name, s.vertices - [1, 1, 0], s.triangles) for s in around])
    body = Body("b", mesh=MeshFile(tmp_path / "m.omf", layer="S1 block"))
    built = build(Project("x", [rock], bodies=[body]))
    assert [block.volume for block in built.blocks] == pytest.approx([26.0, 1.0])


def test_points_of_omf_have_data_a_grid_and_an_origin(tmp_path):
    def elements(omf):
        legend = omf.Legend(name="name", values=omf.StringArray(array=["sand", "clay"]))
        data = [
            omf.MappedData(
                name="unit",
                location="vertices",
                indices=omf.ScalarArray(np.array([0, 1, -1])),
                legends=[legend],
            ),
            omf.ScalarData(
                name="depth", location="vertices", array=omf.ScalarArray(np.array([1.5, 2.5, np.nan]))
            ),
        ]
        vertices = omf.Vector3Array(np.array([[0.0, 0, 7], [1, 0, 8], [2, 0, 9]]))
        points = omf.PointSetElement(name="p", geometry=omf.PointSetGeometry(vertices=vertices), data=data)
        grid = omf.SurfaceGridGeometry(
            tensor_u=np.array([1.0, 2.0]),
            tensor_v=np.array([4.0]),
            offset_w=omf.ScalarArray(np.arange(6.0)),
            origin=[0.0, 0.0, 1.0],
        )
        return [points, omf.SurfaceElement(name="g", geometry=grid)]

    path = write_omf(tmp_path / "a.omf", elements, (100.0, 0.0, 0.0))
    assert [(each.name, each.kind) for each in objects_in(path)] == [("p", "points"), ("g", "surface")]
    points, _ = read_point_file(PointFile(path, layer="p", where={"unit": ["clay", ""]}))
    assert points.tolist() == [[101, 0, 8], [102, 0, 9]]
    points, said = read_point_file(PointFile(path, layer="p", height="depth", nodata=2.5, z_axis="down"))
    assert points.tolist() == [[100, 0, -1.5]]
    assert said == [f"{path}: left out: 2 points without a value"]
    assert column_names(path, "p") == ["unit", "depth"]
    assert column_values(path, "unit", "p") == ["sand", "clay"]
    mesh = read_mesh(path)  # the only surface
    assert mesh.vertices.tolist() == [
        [100, 0, 1],
        [101, 0, 2],
        [103, 0, 3],
        [100, 4, 4],
        [101, 4, 5],
        [103, 4, 6],
    ]
    plan = mesh.vertices[mesh.triangles][:, :, :2]
    (ax, ay), (bx, by) = (plan[:, 1] - plan[:, 0]).T, (plan[:, 2] - plan[:, 0]).T
    assert sorted((ax * by - ay * bx) / 2) == [2, 2, 4, 4]


def test_intervals_of_a_group_of_drillholes_are_picks_at_their_tops(tmp_path):
    """As most files have boreholes: concatenated, with a table of intervals."""
    geoh5py, groups, objects = geoh5_modules()
    path = tmp_path / "d.geoh5"
    with geoh5py.Workspace.create(path) as workspace:
        group = groups.DrillholeGroup.create(workspace, name="holes")
        for name, x in (("A", 0.0), ("B", 10.0)):
            surveys = np.array([[0.0, 90.0, -45.0]])
            hole = objects.Drillhole.create(
                workspace, name=name, parent=group, collar=[x, 0.0, 100.0], surveys=surveys
            )
            hole.add_data(
                {
                    "Lithology": {
                        "values": np.array(["soil", "clay", "clay", ""]),
                        "from-to": np.array([[0.0, 2], [2, 5], [5, 7], [7, 9]]),
                        "type": "text",
                    }
                }
            )
    with pytest.raises(InputRefused, match=r"'A': it has no data 'Rock'; it has Lithology"):
        read_picks(Boreholes(path, columns={"surface": "Rock"}))
    picks = read_picks(Boreholes(path, units={"xy": "ft"}))
    assert set(picks.points) == {"soil", "clay"}
    along = 2 * np.sqrt(0.5)
    wanted = [[along * 0.3048, 0, 100 - along], [(10 + along) * 0.3048, 0, 100 - along]]
    assert np.allclose(picks.points["clay"], wanted, atol=1e-5)
    assert picks.holes["B"][0].tolist() == [3.048, 0, 100]

    units = UnitNames(["clay", "soil"], ["clay", "soil"])
    logged = read_picks(Boreholes(intervals=path), units=units, plan_step=10.0)
    (seen,) = logged.observations
    assert seen.holes.tolist() == ["A"] * 4 + ["B"] * 4
    assert seen.blocks.tolist() == ["soil", "soil", "clay", "clay"] * 2
    assert seen.depths.tolist() == [0, 2, 2, 7] * 2
    assert np.allclose(seen.places[3], [7 * np.sqrt(0.5), 0, 100 - 7 * np.sqrt(0.5)], atol=1e-5)
    assert logged.left_out == []
    unknown = read_picks(Boreholes(intervals=path), units=UnitNames(["clay"], ["clay"]), plan_step=10.0)
    assert [(each.kind, each.hole) for each in unknown.left_out] == [("unknown_block", hole) for hole in "AB"]


def group_of_drillholes(path, tables):
    """A geoh5 file of inclined holes; tables: the ends of the intervals of each hole, and their units."""
    geoh5py, groups, objects = geoh5_modules()
    with geoh5py.Workspace.create(path) as workspace:
        group = groups.DrillholeGroup.create(workspace, name="holes")
        for number, (name, (ends, units)) in enumerate(tables.items()):
            hole = objects.Drillhole.create(
                workspace,
                name=name,
                parent=group,
                collar=[10.0 * number, 0.0, 100.0],
                surveys=np.array([[0.0, 90.0, -45.0]]),
            )
            values = {"values": np.array(units), "from-to": np.array(ends, float), "type": "text"}
            hole.add_data({"Lithology": values})
    return path


def test_intervals_of_objects_are_repaired_as_those_of_tables(tmp_path):
    ends = [[2, 5], [5.00390625, 8], [7.5, 9]]  # begins below the collar, with a gap and an overlap
    path = group_of_drillholes(
        tmp_path / "d.geoh5", {name: (ends, ["soil", "clay", "rock"]) for name in ("A", "B")}
    )
    names = ["rock", "clay", "soil"]
    picks = read_picks(Boreholes(intervals=path), units=UnitNames(names, names), plan_step=100.0)
    assert [(problem.kind, problem.hole) for problem in picks.problems] == [
        ("gap", "A"),
        ("overlap", "A"),
        ("gap", "B"),
        ("overlap", "B"),
    ]
    assert picks.problems[0].text.startswith(
        "row 2, hole 'A' at 5.00195312, 'clay': gap of 0.00390625 beside row 1,"
    )
    (seen,) = picks.observations
    ours = seen.holes == "A"
    assert seen.depths[ours].tolist() == [2, 5.001953125, 5.001953125, 7.5, 8, 9]
    along = seen.depths[ours] * np.sqrt(0.5)
    wanted = np.column_stack([along, 0 * along, 100 - along])
    assert np.allclose(seen.places[ours], wanted, atol=1e-5)

    kept = read_picks(
        Boreholes(intervals=path, unrepaired=["d.geoh5:1"], left_out=["d.geoh5:3"]),
        units=UnitNames(names, names),
    )
    assert [problem.kind for problem in kept.problems if problem.hole == "A"] == [
        "unrepaired",
        "switched_off",
    ]


def test_picks_and_intervals_of_two_files_of_objects(tmp_path):
    logged = group_of_drillholes(tmp_path / "i.geoh5", {"A": ([[0, 4], [4, 9]], ["soil", "clay"])})
    met = group_of_drillholes(tmp_path / "p.geoh5", {"A": ([[1, 3], [3, 5]], ["top", "base"])})
    names = ["clay", "soil", "base", "top"]
    picks = read_picks(Boreholes(met, intervals=logged), units=UnitNames(names, names))
    assert set(picks.points) == {"top", "base"}
    assert np.allclose(picks.points["base"][0, 2], 100 - 3 * np.sqrt(0.5), atol=1e-5)
    assert [name for name, _ in picks.holes["A"][1]] == ["soil", "top", "base", "clay"]


@pytest.mark.parametrize("ending", ENDINGS)
def test_logged_intervals_of_objects_are_those_of_a_table(write, tmp_path, ending):
    """A model from intervals in a table; its file; and a model from that."""
    plan = [[0, 0], [100, 0], [100, 100], [0, 100]]
    collars = write("c.csv", "hole,x,y,z\nA,20,20,30\nB,80,30,30\nC,50,80,30\n")
    rows = ["A,0,10,soil", "A,10,25,clay", "A,25,30,rock", "B,0,12,soil", "B,12,22,clay", "B,22,30,rock"]
    rows += ["C,0,8,soil", "C,8,28,clay", "C,28,30,rock"]
    logged = write("i.csv", "hole,from,to,block\n" + "\n".join(rows) + "\n")

    def model(boreholes):
        names = (("R", "rock"), ("C", "clay"), ("S", "soil"))
        surfaces = [Surface(name, method="plane", block=block) for name, block in names]
        rock = Rock("r", surfaces, plan, edge_length=25.0, base_elevation=-10.0, boreholes=boreholes)
        return build(Project("x", [rock]))

    first = model(Boreholes(intervals=logged, collars=collars))
    first.save(file := tmp_path / f"m{ending}")
    again = model(Boreholes(intervals=file))
    assert len(again.blocks) == 3
    assert set(again.project.rocks[0].hole_picks) == {"A", "B", "C"}
    for tops, wanted in zip(again.rock_inputs[0].data, first.rock_inputs[0].data, strict=True):
        assert np.allclose(np.sort(tops.points, axis=0), np.sort(wanted.points, axis=0), atol=1e-6)


def test_points_that_name_their_hole_are_picks(model, tmp_path):
    model.save(path := tmp_path / "m.omf")
    picks = read_picks(Boreholes(path, layer="picks"))
    assert [name for name, _ in picks.holes["B1"][1]] == ["S3", "S2", "S0"]
    assert picks.holes["B1"][0] is None


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_is_wrong_is_said_with_what_there_is(model, tmp_path, ending):
    model.save(path := tmp_path / f"m{ending}")
    with pytest.raises(InputRefused, match=r'it has 10 surfaces; say which: layer = "..."; it has .*S0'):
        read_mesh(path)
    with pytest.raises(InputRefused, match="it has no object 'S9'; it has "):
        read_mesh(MeshFile(path, layer="S9"))
    with pytest.raises(InputRefused, match="is of the kind borehole, and surfaces are needed"):
        read_mesh(MeshFile(path, layer="boreholes" if ending == ".omf" else "B1"))
    with pytest.raises(InputRefused, match="has objects, so 'columns' has no effect"):
        read_point_file(PointFile(path, layer="S0", columns=[1, 2, 3]))
    with pytest.raises(InputRefused, match="has objects, so 'survey' has no effect"):
        read_picks(Boreholes(path, survey=path))
    with pytest.raises(InputRefused, match="object 'S0': it has no attribute 'bed'"):
        read_point_file(PointFile(path, layer="S0", where={"bed": 1}))
    mesh = tmp_path / "m.off"
    mesh.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(InputRefused, match="not a file of objects, so it has no 'S0'"):
        read_mesh(MeshFile(mesh, layer="S0"))
    with pytest.raises(InputRefused, match="it has objects, and the other file is a table"):
        read_picks(Boreholes(path, intervals=mesh))
    with pytest.raises(InputRefused, match="a table, so it has no object 'S0'"):
        read_picks(Boreholes(mesh, layer="S0"))


@pytest.mark.parametrize(("ending", "module"), zip(ENDINGS, ("omf", "geoh5py"), strict=True))
def test_a_missing_library_is_named(model, tmp_path, monkeypatch, ending, module):
    model.save(path := tmp_path / f"m{ending}")
    monkeypatch.setitem(sys.modules, module, None)
    for read in (read_mesh, lambda file: read_point_file(PointFile(file)), layer_names):
        with pytest.raises(UsageError, match=rf"needs {module}.*install it"):
            read(path)


def small_file(folder, ending):
    """A surface of two triangles and a set of points with data."""
    level = [Surface(f"S{k}", *grid_surface(1, lambda x, y, k=k: 1.0 * k + 0 * x)) for k in range(2)]
    build(Project("x", [Rock("r", level)])).save(path := folder / f"m{ending}")
    return path


@pytest.mark.parametrize("ending", ENDINGS)
def test_damaged_files_are_read_or_refused(tmp_path, ending):
    path = small_file(tmp_path, ending)
    outcomes = {"read": 0, "refused": 0}
    for raw in islice(damaged_bytes(path.read_bytes()), 100):
        path.write_bytes(raw)
        try:
            mesh = read_mesh(MeshFile(path, layer="S1"))
            assert np.isfinite(mesh.vertices).all()
            outcomes["read"] += 1
        except InputRefused as error:
            assert len(str(error).splitlines()) == 1
            outcomes["refused"] += 1
    assert outcomes["read"] >= 1, outcomes
    assert outcomes["refused"] >= 20, outcomes


@pytest.mark.parametrize("ending", ENDINGS)
def test_feet_of_a_file_of_objects_are_obeyed(write, tmp_path, ending):
    model = crossing_model(write)
    model.project.units = "ft"
    model.save(path := tmp_path / f"m{ending}")
    vertices, _ = model.surface(0)
    mesh = read_mesh(MeshFile(path, layer="S0"))
    for units, factor in (("ft", 1.0), ("m", 0.3048)):
        places, warnings = mesh.in_model(MeshFile(path), units)
        assert np.allclose(places, vertices * factor, rtol=1e-12)
        assert len(warnings) == (units == "m") and all("set units" in text for text in warnings)
