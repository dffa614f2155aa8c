# SPDX-License-Identifier: GPL-3.0-or-later
"""From an AGS file to a model and IFC, for random sites."""

import importlib

import numpy as np
import pytest
from ground_investigations import Site, ags3, ags4, random_site
from realmodel.batch.command import main
from realmodel.core import InputRefused, build, load_project, propose_project
from realmodel.core.exporters.shapes.manifold import separated


@pytest.mark.parametrize(("seed", "write_ags"), [(2, ags4), (3, ags3)])
def test_a_site_becomes_closed_strata(tmp_path, seed, write_ags):
    """The clay under London has the code LC, which is no lost core here."""
    site = random_site(seed, lenses=seed == 3)
    (tmp_path / "site.ags").write_text(write_ags(site), encoding="utf-8")
    project = propose_project(boreholes=tmp_path / "site.ags")
    assert project.proposal.order[0] == "LC"
    assert any("'LC' is treated as a unit" in text for text in project.proposal.warnings)
    model = build(project)
    assert model.observed().share == 1.0
    ifcopenshell = pytest.importorskip("ifcopenshell", reason="not installed: scripts/test.sh installs it")
    model.save(tmp_path / "m.ifc")
    face_sets = ifcopenshell.open(tmp_path / "m.ifc").by_type("IfcTriangulatedFaceSet")
    closed = [np.array(item.CoordIndex) for item in face_sets if item.Closed]
    assert len(closed) == sum(block.components for block in model.blocks)
    for triangles in closed:
        assert_manifold(triangles)


def first_holes(count):
    return lambda site: Site(dict(list(site.places.items())[:count]), site.logs)


def moved(site):
    """To a grid whose numbers have seven digits."""
    return Site({hole: (x, y + 5e6, z) for hole, (x, y, z) in site.places.items()}, site.logs)


def in_a_line(site):
    places = {hole: (5e5 + 20 * n, 2e5, z) for n, (hole, (_, _, z)) in enumerate(site.places.items())}
    return Site(places, site.logs)


def twice(site):
    """All holes go through their units again."""
    ends = {hole: log[-1][1] for hole, log in site.logs.items()}
    again = {
        hole: [(a + ends[hole], b + ends[hole], c) for a, b, c in log] for hole, log in site.logs.items()
    }
    return Site(site.places, {hole: [*log, *again[hole]] for hole, log in site.logs.items()})


def with_gaps(site):
    """Rows that say nothing, and a hole beside another that ends in the first unit."""
    logs = {
        hole: [(a, b, code if n != 1 else "") for n, (a, b, code) in enumerate(log)]
        for hole, log in site.logs.items()
    }
    hole, (x, y, z) = next(iter(site.places.items()))
    return Site({**site.places, "TP1": (x + 0.3, y, z)}, {**logs, "TP1": [(0.0, 0.2, logs[hole][0][2])]})


def drilled_again(site):
    """A hole beside another, at the place that the file says of both, whose layers lie otherwise."""
    hole, place = next(iter(site.places.items()))
    log = [(a + 0.7 * (a > 0), b + 0.7, code) for a, b, code in site.logs[hole]]
    return Site({**site.places, f"{hole}R": place}, {**site.logs, f"{hole}R": log})


# the validation leaves the file of its rules open
@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(
    ("seed", "change", "units"),
    [
        *((8, first_holes(1), "m"), (9, first_holes(2), "ft"), (10, in_a_line, "m")),
        *((11, twice, "m"), (12, with_gaps, "m"), (13, moved, "us-ft"), (9, drilled_again, "m")),
    ],
    ids=["one hole", "two holes in feet", "a line", "repeated", "gaps", "far away in feet", "drilled again"],
)
def test_any_site_becomes_valid_ifc_by_one_command(tmp_path, seed, change, units):
    """Closed strata, each borehole with its layers, small numbers inside, where the grid is known."""
    ifcopenshell = pytest.importorskip("ifcopenshell", reason="not installed: scripts/test.sh installs it")
    validate = importlib.import_module("ifcopenshell.validate")
    site = change(random_site(seed))
    (tmp_path / "site.ags").write_text(ags4(site), encoding="utf-8")
    out = tmp_path / "site"
    outputs = ["--export", f"{out}/m.ifc", "--export", f"{out}/m.html", "--report", f"{out}/m.json"]
    given = [str(tmp_path / "site.ags"), "--out", str(out), "--units", units, "--quiet"]
    assert main(["new", *given, *outputs]) == 0
    assert (out / "m.html").stat().st_size and (out / "m.json").stat().st_size
    file = ifcopenshell.open(out / "m.ifc")
    logger = validate.json_logger()
    validate.validate(file, logger, express_rules=len(site.places) == 1)
    assert logger.statements == []
    for item in file.by_type("IfcTriangulatedFaceSet"):
        if item.Closed:
            assert_manifold(np.array(item.CoordIndex))
    assert {hole.Name for hole in file.by_type("IfcBorehole")} == set(site.places)
    codes = {name: [code for _, _, code in site.logs[name] if code] for name in site.places}
    for hole in file.by_type("IfcBorehole"):
        layers = [part.Name for part in hole.IsDecomposedBy[0].RelatedObjects]
        assert [name for name in layers if name != "unknown"] == codes[hole.Name]
    largest = max(np.abs(np.array(item.CoordList)).max() for item in file.by_type("IfcCartesianPointList3D"))
    assert largest < 5000
    assert [system.Name for system in file.by_type("IfcProjectedCRS")] == ["EPSG:27700"] * (units == "m")


SMALL = first_holes(3)(random_site(2))
NO_GRID = "not known: no file names it; name it by --crs EPSG:CODE, or the key 'crs'"


@pytest.mark.parametrize(
    ("grid", "units", "crs", "reason"),
    [
        ("OSGB", "m", "EPSG:27700", "as site.ags says"),
        ("osgb 36", "m", "EPSG:27700", "as site.ags says"),
        ("ITM", "m", "EPSG:2157", "as site.ags says"),
        ("EPSG:25832", "m", "EPSG:25832", "as site.ags says"),
        ("", "m", None, NO_GRID),
        ("Moon", "m", None, "not known: files say 'Moon'; name it by --crs EPSG:CODE, or the key 'crs'"),
        ("OSGB", "ft", None, "none: site.ags says EPSG:27700, whose unit is not the model's"),
    ],
)
def test_the_grid_of_the_file_is_the_projects_system(tmp_path, capsys, grid, units, crs, reason):
    (tmp_path / "site.ags").write_text(ags4(SMALL, grid))
    out = tmp_path / "site"
    assert main(["new", str(tmp_path / "site.ags"), "--out", str(out), "--units", units]) == 0
    assert f"coordinate system: {crs + ', ' if crs else ''}{reason}\n" in capsys.readouterr().out
    assert load_project(out / "project.toml").crs == crs
    assert f"# The coordinate system: {reason[:60]}" in (out / "project.toml").read_text()


def test_other_files_name_it_as_well_and_the_option_comes_first(tmp_path):
    (tmp_path / "site.ags").write_text(ags3(SMALL))
    assert propose_project(boreholes=tmp_path / "site.ags").crs == "EPSG:27700"
    assert propose_project(boreholes=tmp_path / "site.ags", crs="EPSG:2157").crs == "EPSG:2157"
    text = ags4(SMALL).replace("LOCA_NATE", "LOCA_NEW_X").replace("LOCA_LOCX", "LOCA_NATE")
    text = (
        text.replace("LOCA_NEW_X", "LOCA_LOCX")
        .replace("LOCA_NATN", "NEW_Y")
        .replace("LOCA_LOCY", "LOCA_NATN")
    )
    (tmp_path / "local.ags").write_text(text.replace("NEW_Y", "LOCA_LOCY"))
    local = propose_project(boreholes=tmp_path / "local.ags")
    assert (local.crs, local.proposal.reasons["crs"]) == (None, NO_GRID)  # the places are those of the site


def test_the_column_of_units_is_chosen_once(tmp_path):
    """The legend says the same of several units: what was chosen, with a warning, the project says."""
    (tmp_path / "site.ags").write_text(ags4(SMALL))
    project = propose_project(boreholes=tmp_path / "site.ags")
    assert sum("GEOL_LEG" in text for text in project.proposal.warnings) == 1
    built = build(load_project(project.save(tmp_path / "site")))
    assert not any("GEOL_LEG" in warning.text for warning in built.warnings)
    given = [str(tmp_path / "site.ags"), "--out", str(tmp_path / "legend"), "--block", "GEOL_LEG", "--quiet"]
    assert main(["new", *given]) == 0
    legends = load_project(tmp_path / "legend/project.toml")
    assert {surface.block for surface in legends.rocks[0].surfaces} <= {"202", "203", "204"}


def test_a_file_without_codes_is_told_which_column_to_name(tmp_path):
    text = ags4(SMALL).replace('"GEOL_LEG","GEOL_GEOL"', '"GEOL_A","GEOL_B"')
    (tmp_path / "site.ags").write_text(text.replace("GEOL_A", "GEOL_GEOL", 1).replace(',"202",', ',"",'))
    for code in ("203", "204"):
        text = (tmp_path / "site.ags").read_text().replace(f',"{code}",', ',"",')
        (tmp_path / "site.ags").write_text(text)
    with pytest.raises(InputRefused, match=r"no unit is known.*--block"):
        propose_project(boreholes=tmp_path / "site.ags")


def assert_manifold(triangles):
    """Each edge is used once each way."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert np.array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))


TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


@pytest.mark.parametrize(("shared", "count"), [([0, 1], 8), ([0], 8), ([], 8)])
def test_what_touches_itself_is_separated(shared, count):
    """Two tetrahedra with an edge, a vertex or nothing in common."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    turned = corners * [1, -1, -1]  # about the x axis, on which the first two vertices are
    vertices = np.concatenate([corners, turned + np.array([0 if shared else 9, 0, 0])])
    other = np.array([number if number in shared else number + 4 for number in range(4)])
    triangles = np.concatenate([TETRAHEDRON, other[TETRAHEDRON]])
    used, made = separated(vertices, triangles)
    assert len(used) == count
    assert_manifold(made)
    assert np.array_equal(used[made], triangles)
    assert not set(made[:4].ravel()) & set(made[4:].ravel())
