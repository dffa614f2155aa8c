# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with series whose surfaces are level sets: their blocks are those of the closed form."""

import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT
from folded_rocks import SQUARE, contacts, dome, folded_project, given_field, plunging, recumbent, sheet
from realmodel.core import (
    Body,
    Fault,
    InputRefused,
    Model,
    Project,
    Rock,
    Series,
    SpaceDips,
    Surface,
    UsageError,
    build,
)
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import native_module
from realmodel.core.exporters.surface_files import write_fields
from realmodel.core.fields import are_on
from realmodel.core.project.project_writer import save_project

LEVELS = {recumbent: (1.5, 2.5, 4.0), dome: (3.0, 4.5, 6.0), plunging: (2.5, 4.0, 6.0)}


def points_in_rock(count=4000, seed=3):
    return np.random.default_rng(seed).uniform((0, 0, 0), (10, 10, 9), (count, 3))


@pytest.mark.parametrize(
    ("f", "cells"), [(recumbent, "columns"), (recumbent, "blocks"), (dome, "blocks"), (plunging, "columns")]
)
def test_a_fold_below_the_ground(monkeypatch, f, cells):
    given_field(monkeypatch, f, LEVELS[f])
    model = build(folded_project(f, LEVELS[f]), cells=cells)
    report = model.validate()
    assert report.passed, report.failure()


def test_contacts_lie_on_their_surface(monkeypatch):
    """The field alone misses them by its bend in a cell."""
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    model = build(folded_project())
    for number, surface in enumerate(model.project.rocks[0].surfaces[:3]):
        vertices = {tuple(vertex) for vertex in model.surface(number)[0].tolist()}
        assert vertices.issuperset(map(tuple, surface.points.tolist()))


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_sheets_above_an_unconformity(monkeypatch, cells):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    younger = [
        sheet("base of B", lambda x, y: 5.0 + 0.3 * y),
        sheet("B1", lambda x, y: 7.0 - 0.2 * x, rule="conformable"),
    ]
    model = build(folded_project(younger=younger), cells=cells)
    assert model.validate().passed, model.validate().failure()
    # where the folds part nothing there is no face
    folds = np.isin(model.face_surface, [0, 1, 2])
    sides = model.complex.face_blocks[folds]
    assert len(sides)
    assert (sides[:, 0] != sides[:, 1]).all()
    assert not np.isin(sides, [4, 5]).all(axis=1).any()


@pytest.mark.parametrize("rule", ["erosional", "conformable", "base", "discontinuous"])
@pytest.mark.parametrize("basement", ["erosional", "base"])
def test_a_fold_on_older_sheets(monkeypatch, rule, basement):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    project = folded_project()
    surfaces = project.rocks[0].surfaces
    for surface in surfaces[:3]:
        surface.rule = rule
    surfaces.insert(0, sheet("basement", lambda x, y: 2.0 + 0.2 * x, rule=basement))
    model = build(project)
    assert model.validate().passed, model.validate().failure()


def box(low, high):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return np.array(low) + corners * (np.array(high) - low), np.array(triangles, np.int32)


@pytest.mark.parametrize(("after", "void"), [("f", False), ("fii", False), (None, True), ("fi", True)])
def test_bodies_in_a_fold(monkeypatch, after, void):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    body = Body("body", *box([2.3, 2.2, 1.7], [6.1, 7.3, 6.9]), after=after, void=void)
    model = build(folded_project(bodies=[body]))
    assert model.validate().passed, model.validate().failure()


def plane(low, high):
    """A vertical fault through points (x, y) in plan, beyond everything."""
    a, b = np.array(low, float), np.array(high, float)
    vertices = np.array([[*a, -5.0], [*b, -5.0], [*b, 20.0], [*a, 20.0]])
    return vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def leaning():
    """A fault that leans."""
    vertices = np.array([[1.0, -3, -5], [1, 13, -5], [9, 13, 15], [9, -3, 15]])
    return vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32)


@pytest.mark.parametrize(
    ("shape", "cells"),
    [(plane((5.3, -2), (4.1, 12)), "columns"), (leaning(), "columns"), (leaning(), "blocks")],
)
def test_a_fold_on_both_sides_of_a_fault(monkeypatch, shape, cells):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    model = build(folded_project(faults=[Fault("F", *shape, youngest="fii")]), cells=cells)
    assert model.validate().passed, model.validate().failure()
    assert len(model.rock_inputs[0].fields[0].distinct()) == 2
    assert len(model.compartment_names) >= 2


def test_two_series(monkeypatch):
    def chosen(data):
        return recumbent if data.names[0] == "f" else dome

    given_field(monkeypatch, chosen, [1.5, 2.5, 4.0])
    project = folded_project()
    rock = project.rocks[0]
    upper = [Surface(f"d{k}", points=contacts(dome, 1.5, 4, k), series="upper") for k in range(3)]
    rock.surfaces[3:3] = upper
    rock.series.append(Series("upper", resolution=1.3))
    model = build(project)
    assert model.validate().passed, model.validate().failure()


def test_stages_and_files(monkeypatch, tmp_path):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    model = build(folded_project())
    model.save(tmp_path / "m.npz")
    loaded = Model.load(tmp_path / "m.npz")
    assert loaded.validate().passed
    for m in range(4):
        stage = loaded.stage(m)
        assert stage.validate().passed, stage.validate().failure()
        np.testing.assert_array_equal(stage.vertices, build(folded_project(), stage=m).vertices)


def test_a_stage_before_a_body_came(monkeypatch):
    """Rock that the level above all cuts off, and a structure that is not there yet."""
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    body = Body("body", *box([2.3, 2.2, 1.7], [6.1, 7.3, 6.9]))
    stage = build(folded_project(bodies=[body])).stage(0)
    assert (stage.face_surface == -3).any()
    assert stage.validate().passed, stage.validate().failure()


def test_the_same_for_any_number_of_threads(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    one, three = (build(folded_project(), threads=threads) for threads in (1, 3))
    np.testing.assert_array_equal(one.vertices, three.vertices)
    np.testing.assert_array_equal(one.face_vertices, three.face_vertices)


def from_data(f, levels, contacts_of_each=40, dips=40):
    """A project with contacts of a closed form and dips of its bedding."""
    project = folded_project(f, levels)
    rock = project.rocks[0]
    for number, level in enumerate(levels):
        rock.surfaces[number].points = contacts(f, level, contacts_of_each, 11 + number)
    places = np.random.default_rng(5).uniform(0.5, 9.5, (dips, 3))
    moves = 1e-5 * np.eye(3)
    normals = np.column_stack([f(places + move) - f(places - move) for move in moves])
    rock.series[0].dips = SpaceDips(places, normals)
    rock.series[0].resolution = 0.6
    return project


def test_a_recumbent_fold_from_contacts_and_dips_in_batch(tmp_path):
    levels = LEVELS[recumbent]
    save_project(from_data(recumbent, levels), tmp_path / "fold.toml")
    model_file, field_file = tmp_path / "fold.npz", tmp_path / "field.vtu"
    command = [sys.executable, str(ROOT / "build_model.py"), str(tmp_path / "fold.toml"), "--quiet"]
    command += ["--check-model", "--export", str(model_file), "--export-field", str(field_file)]
    subprocess.run(command, check=True, timeout=300)
    model = Model.load(model_file)
    points = points_in_rock()
    cells = native_module().cells_at(model.native(), points)
    rock = cells >= 0
    said = model.cell_block[cells[rock]]
    true = np.searchsorted(levels, recumbent(points[rock]))
    assert (said == true).mean() > 0.96
    field = model.field("folded")
    assert np.abs(field.at(np.concatenate([s.points for s in model.project.rocks[0].surfaces[:3]]))).any()
    command[2:] = [str(model_file), "--quiet", "--export-field", str(tmp_path / "again.vtu")]
    subprocess.run(command, check=True, timeout=300)
    text = field_file.read_bytes()
    assert (tmp_path / "again.vtu").read_bytes() == text
    assert f'NumberOfPoints="{field.lattice.nodes}"'.encode() in text
    assert f'NumberOfCells="{6 * np.prod(np.subtract(field.lattice.counts, 1))}"'.encode() in text
    for number, surface in enumerate(model.project.rocks[0].surfaces[:3]):
        on = are_on(surface.points, Sheet(*model.surface(number)))
        assert on.mean() > 0.95


def test_a_model_without_a_field_says_so(tmp_path):
    sheets = [sheet("low", lambda x, y: 1.0), sheet("high", lambda x, y: 2.0)]
    model = build(Project("plain", [Rock("r", sheets, region=SQUARE)]))
    with pytest.raises(UsageError, match="the model has none"):
        model.field("folded")
    with pytest.raises(UsageError, match="the model has no field"), open(tmp_path / "f.vtu", "wb") as file:
        write_fields([entry.fields for entry in model.rock_inputs], file)


def test_data_far_from_the_region_are_told(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    project = folded_project()
    told = [each.text for each in build(project, cells="blocks").warnings]
    assert not any("beyond the region" in text for text in told)
    surface = project.rocks[0].surfaces[0]
    surface.points = np.vstack([surface.points, [5.0, 70.0, 3.0]])
    told = [each.text for each in build(project, cells="blocks").warnings]
    assert any(
        "series 'folded': data lie up to 60 beyond the region, as at (5, 70, 3)" in text for text in told
    )


def test_a_base_that_is_too_high_is_named(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    younger = [sheet("base of B", lambda x, y: 5.0 + 0.3 * y)]
    project = folded_project(younger=younger)
    project.rocks[0].base_elevation = 30.0
    with pytest.raises(
        InputRefused, match=r"^rock '.*': base_elevation 30 is not .*; choose one below 4.85$"
    ):
        build(project)


def test_a_base_cuts_a_surface_above_a_fold(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    project = folded_project(younger=[sheet("base of B", lambda x, y: 5.0 + 0.3 * y)])
    project.rocks[0].base_elevation = 6.0
    model = build(project)
    assert model.validate().passed
    assert model.vertices[:, 2].min() == 6.0
    (said,) = [each for each in model.warnings if each.kind == "below_base"]
    assert (said.surface, said.text.partition(" % ")[0]) == (
        "base of B",
        "it reaches below base_elevation 6 on 35",
    )


def test_what_cannot_be_made_of_fields_is_refused(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    project = folded_project()
    project.faults = [Fault("F", *plane((5.3, -2), (4.1, 12)), youngest="f")]
    with pytest.raises(InputRefused, match="displaces some of its surfaces, but not all"):
        build(project)
    project.faults = []
    project.rocks[0].series[0].resolution = 1e-3
    with pytest.raises(InputRefused, match=r"its lattice would have .* nodes"):
        build(project)


def test_rock_that_nothing_ends_is_cut_off_with_a_warning(monkeypatch):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    model = build(folded_project(), stage=2)
    assert any(warning.kind == "cut_off" for warning in model.warnings)
    assert (model.face_surface == -3).any()


@pytest.mark.parametrize("has_folds", [(True, False), (True, True)])
def test_two_rock_masses_side_by_side(monkeypatch, has_folds):
    given_field(monkeypatch, recumbent, LEVELS[recumbent])
    project = folded_project()
    east = folded_project().rocks[0]
    east.name = "east"
    east.region = [[x + 10.0, y] for x, y in SQUARE]
    east.surfaces[-1].vertices = east.surfaces[-1].vertices + np.array([9.0, 0.0, 0.4])
    if has_folds[1]:
        for number, surface in enumerate(east.surfaces[:3]):
            surface.points = contacts(recumbent, 1.5, 2, number) + np.array([5.0, 0.0, 0.0])
    else:
        east.series, east.surfaces = [], east.surfaces[-1:]
    project.rocks.append(east)
    model = build(project)
    assert model.validate().passed, model.validate().failure()
    shared = model.complex.face_blocks[model.face_surface == -1]
    rock_of = np.array([block.rock for block in model.blocks])
    both = (shared >= 0).all(axis=1)
    assert (rock_of[shared[both][:, 0]] != rock_of[shared[both][:, 1]]).any()


def test_an_automatic_resolution_gives_some_ten_thousand_nodes(monkeypatch):
    given_field(monkeypatch, dome, LEVELS[dome])
    project = folded_project(dome, LEVELS[dome])
    project.rocks[0].series[0].resolution = "auto"
    model = build(project)
    assert 40_000 < model.field("folded").lattice.nodes < 80_000
