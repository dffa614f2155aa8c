# SPDX-License-Identifier: GPL-3.0-or-later
"""Model.validate finds what is wrong with a model and passes what is right; so does the outside check."""

import dataclasses
import json
import random

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.batch import command, sources
from realmodel.core import Cancelled, Project, Rock, Surface, UsageError, build
from realmodel.core.cells.cell_complex import ARRAYS
from realmodel.core.exporters.report import model_report
from realmodel.core.surfaces.surface_input import SurfaceArrays
from realmodel.core.validation.validation import ValidationReport
from stacks import places
from stacks.generate import FAMILIES, random_stack
from stacks.rock_masses import random_rock_masses
from validated import as_model, outside_failures


def crossing_project():
    """Three surfaces that cross each other and end at walls, on a flat base."""

    def surface(name, height, size=1.0, n=5):
        return Surface(name, *grid_surface(n, height, size))

    return Project(
        "crossing",
        [
            Rock(
                "rock",
                [
                    surface("level", lambda x, y: 0 * x),
                    surface("tilted", lambda x, y: x - 0.4, n=4),
                    surface("small", lambda x, y: 2 + 0 * x, size=0.7, n=3),
                ],
                base_elevation=-1.0,
            )
        ],
    )


@pytest.fixture(scope="module", params=["columns", "blocks"])
def model(request):
    return build(crossing_project(), cells=request.param)


def damaged(model, **given):
    """A copy of a model with some arrays, or other fields, replaced."""
    of_cells = {name: given.pop(name) for name in ARRAYS if name in given}
    names = ("vertices", "triangles", "vertex_offsets", "triangle_offsets")
    of_surfaces = {
        f"surface_{name}": given.pop(f"surface_{name}", getattr(model.surface_arrays, name)) for name in names
    }
    return dataclasses.replace(
        model,
        complex=dataclasses.replace(model.complex, **of_cells),
        surface_arrays=SurfaceArrays.of_arrays(of_surfaces),
        **given,
    )


def failed(report):
    return [test.name for test in report.tests if not test.passed]


def test_a_built_model_passes(model):
    report = model.validate()
    assert isinstance(report, ValidationReport)
    assert report.passed and failed(report) == [] and report.failure() is None
    assert {test.number for test in report.tests} == {0, 1, 2, 3, 4, 5}
    counts = {test.name: test.examined for test in report.tests}
    assert counts["closed"] == counts["volumes"] == len(model.cell_block)
    assert counts["faces"] == counts["loops"] == len(model.face_surface)
    assert counts["vertices"] == len(model.vertices)
    assert counts["outside"] == (model.face_cells[:, 1] < 0).sum()
    assert counts["block volumes"] == len(model.blocks)


def wrong_block(m):
    block = m.cell_block.copy()
    block[0] = 1 if block[0] == 0 else 0
    return {"cell_block": block}


def wrong_surface(m):
    """The level surface is named where the tilted one lies."""
    return {"face_surface": np.where(m.face_surface == 1, 0, m.face_surface).astype(np.int32)}


def other_heights(m):
    """The model is that of surfaces a hair lower."""
    vertices = m.surface_vertices.copy()
    vertices[:, 2] += 1e-11
    return {"surface_vertices": vertices}


def other_rules(m):
    rock = m.project.rocks[0]
    surfaces = [dataclasses.replace(s, rule="conformable") for s in rock.surfaces]
    return {"project": dataclasses.replace(m.project, rocks=[dataclasses.replace(rock, surfaces=surfaces)])}


def open_cell(m):
    keep = np.arange(len(m.face_surface)) != 3
    size = np.diff(m.face_offsets)
    return {
        "face_vertices": m.face_vertices[np.repeat(keep, size)],
        "face_offsets": np.concatenate([[0], np.cumsum(size[keep])]),
        "face_cells": m.face_cells[keep],
        "face_surface": m.face_surface[keep],
    }


def turned_face(m):
    corners = m.face_vertices.copy()
    a, b = m.face_offsets[4:6]
    corners[a:b] = corners[a:b][::-1]
    return {"face_vertices": corners}


def missing_side(m):
    cells = m.face_cells.copy()
    cells[np.flatnonzero(cells[:, 1] >= 0)[0], 1] = -1
    return {"face_cells": cells}


def wrong_cell(m):
    cells = m.face_cells.copy()
    cells[0, 0] = next(c for c in range(len(m.cell_block)) if c not in cells[0])
    return {"face_cells": cells}


def unused_vertex(m):
    return {"vertices": np.concatenate([m.vertices, [[9.0, 9.0, 9.0]]])}


def inside_out(m):
    corners = m.face_vertices.copy()
    for a, b in zip(m.face_offsets[:-1], m.face_offsets[1:], strict=True):
        corners[a:b] = corners[a:b][::-1]
    return {"face_vertices": corners}


def equal_vertices(m):
    vertices = m.vertices.copy()
    vertices[1] = vertices[0]
    return {"vertices": vertices}


def repeated_vertex(m):
    corners = m.face_vertices.copy()
    corners[m.face_offsets[2]] = corners[m.face_offsets[2] + 1]
    return {"face_vertices": corners}


def vertex_out_of_range(m):
    corners = m.face_vertices.copy()
    corners[5] = len(m.vertices)
    return {"face_vertices": corners}


def wrong_volume(m):
    b = dataclasses.replace(m.blocks[1], volume=m.blocks[1].volume * (1 + 1e-6))
    return {"blocks": [m.blocks[0], b, *m.blocks[2:]]}


def not_finite(m):
    vertices = m.vertices.copy()
    vertices[0, 2] = np.nan
    return {"vertices": vertices}


DAMAGES = {
    wrong_block: "places",
    wrong_surface: "surfaces",
    other_heights: "places",
    other_rules: "places",
    open_cell: "closed",
    turned_face: "closed",
    missing_side: "closed",
    wrong_cell: "closed",
    unused_vertex: "vertices",
    equal_vertices: "vertices",
    inside_out: "volumes",
    repeated_vertex: "loops",
    vertex_out_of_range: "arrays",
    wrong_volume: "block volumes",
    not_finite: "arrays",
}


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda f: f.__name__)
def test_damage_is_found_and_named(model, damage):
    report = damaged(model, **damage(model)).validate()
    assert not report.passed
    test = next(test for test in report.tests if test.name == DAMAGES[damage])
    assert test.failed and test.offenders
    assert test.offenders[0].text in str(report)
    assert report.failure() and "\n" not in report.failure()


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
@pytest.mark.parametrize(
    "damage",
    [d for d in DAMAGES if d not in (wrong_volume, other_heights)],
    ids=lambda f: f.__name__,
)
def test_the_outside_check_refuses_the_same(model, damage):
    assert outside_failures(damaged(model, **damage(model)))


@pytest.mark.parametrize(
    "name, array",
    [
        ("vertices", lambda a: a.astype(np.float32)),
        ("face_offsets", lambda a: a.astype(np.int32)),
        ("face_cells", lambda a: a.ravel()),
        ("cell_block", lambda a: a[:, None]),
    ],
)
def test_arrays_of_other_types_are_named(model, name, array):
    report = damaged(model, **{name: array(getattr(model, name))}).validate()
    assert failed(report) == ["arrays"]
    assert name in report.tests[0].offenders[0].text


def test_the_report_reads_well(model):
    text = str(damaged(model, **unused_vertex(model)).validate())
    assert text.startswith("Validation of crossing: FAILED\n")
    assert f"vertex {len(model.vertices)} belongs to no face near (9, 9, 9)" in text
    assert max(len(line) for line in text.splitlines()) <= 100
    passed = str(model.validate())
    assert passed.startswith("Validation of crossing: passed\n") and "FAILED" not in passed


def test_it_is_part_of_the_json_report(model):
    report = model_report(damaged(model, **unused_vertex(model)))
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert report["validation"]["passed"] is False
    tests = {test["name"]: test for test in report["validation"]["tests"]}
    assert tests["vertices"]["offenders"][0]["vertex"] == len(model.vertices)
    assert tests["vertices"]["offenders"][0]["place"] == [9.0, 9.0, 9.0]
    assert tests["closed"]["passed"] and tests["closed"]["offenders"] == []
    assert model_report(model)["validation"]["passed"] is True


def test_the_same_findings_for_any_number_of_threads(model):
    spoilt = damaged(model, **turned_face(model))
    expected = spoilt.validate(2000, threads=1).tests
    for threads in (2, 5):
        for one, other in zip(expected, spoilt.validate(2000, threads=threads).tests, strict=True):
            assert dataclasses.replace(one, seconds=0) == dataclasses.replace(other, seconds=0)


def test_random_stacks_pass():
    """Every family of degenerate stacks, with features as thin as rounding."""
    rng = random.Random(6)
    for family in [*FAMILIES, "rock masses"] * 6:
        case = random_rock_masses(rng) if family == "rock masses" else random_stack(rng, family)
        for cells in ("columns", "blocks"):
            report = as_model(case, cells).validate(places=500, threads=1)
            assert report.passed, (family, cells, report.failure())


def test_a_model_knows_its_region_without_its_input(write):
    """Put together from arrays, a model has a project but no rock_inputs; heights may be interpolated."""
    points = np.array([[0, 0, 1], [4, 0, 2], [4, 4, 1], [0, 4, 3], [2, 2, 2]], float)
    rock = Rock(
        "rock",
        [
            Surface("bottom", points=points - [0, 0, 3]),
            Surface("top", *grid_surface(5, lambda x, y: 2 + x, 6.0)),
        ],
        region=[[0, 0], [4, 0], [4, 4], [0, 4]],
        holes=[[[1, 1], [2, 1], [2, 2], [1, 2]]],
        edge_length=0.5,
    )
    model = build(Project("holes", [rock]))
    report = dataclasses.replace(model, rock_inputs=[]).validate(places=3000)
    assert report.passed, report.failure()
    smaller = dataclasses.replace(model.project.rocks[0], region=[[0, 0], [3, 0], [3, 4], [0, 4]])
    project = dataclasses.replace(model.project, rocks=[smaller])
    wrong = dataclasses.replace(model, rock_inputs=[], project=project)
    assert "places" in failed(wrong.validate(places=3000))


def test_surfaces_that_cannot_be_read_are_named(model):
    triangles = model.surface_triangles.copy()
    triangles[3, 1] = 10_000
    report = damaged(model, surface_triangles=triangles).validate()
    assert failed(report) == ["arrays"] and "surface_triangles" in report.failure()


def test_stages_pass(model):
    for m in range(3):
        assert model.stage(m).validate(places=400).passed


def test_places_and_seed(model):
    none = model.validate(places=0)
    assert {test.number for test in none.tests} == {0, 1, 2, 3, 4}
    spoilt = damaged(model, **wrong_surface(model))
    one, same, other = (spoilt.validate(places=800, seed=s).tests for s in (1, 1, 2))
    texts = [[o.text for test in tests for o in test.offenders] for tests in (one, same, other)]
    assert texts[0] == texts[1] != texts[2]
    for options in ({"places": -1}, {"places": 1.5}, {"seed": -1}, {"places": True}):
        with pytest.raises(UsageError):
            model.validate(**options)


def test_it_can_be_cancelled(model):
    with pytest.raises(Cancelled):
        model.validate(places=3_000_000, cancel=lambda: True)


@pytest.fixture
def main(monkeypatch):
    """The command line; it leaves the signals of the tests' own process alone."""
    monkeypatch.setattr(command.signal, "signal", lambda *_: None)
    return command.main


def spoil_builds(monkeypatch):
    whole = sources.build

    def spoilt(*arguments, **options):
        model = whole(*arguments, **options)
        return damaged(model, **unused_vertex(model))

    monkeypatch.setattr(sources, "build", spoilt)


def test_check_model_prints_the_proof(main, layers, tmp_path, capsys):
    assert main([str(layers([0, 1])), "--check-model", "--export", str(tmp_path / "m.npz")]) == 0
    out = capsys.readouterr().out
    assert "Validation of layers: passed" in out and "% of the time of intersecting" in out
    assert (tmp_path / "m.npz").exists()


def test_check_model_keeps_a_wrong_model_from_being_written(main, monkeypatch, layers, tmp_path, capsys):
    spoil_builds(monkeypatch)
    status = main([str(layers([0, 1])), "--check-model", "--export", str(tmp_path / "m.npz")])
    captured = capsys.readouterr()
    assert status == 1
    assert captured.err.count("\n") == 1 and "belongs to no face" in captured.err
    assert "Validation of layers: FAILED" in captured.out
    assert not (tmp_path / "m.npz").exists()


def test_the_report_of_a_wrong_model_says_so(main, monkeypatch, layers, tmp_path, capsys):
    spoil_builds(monkeypatch)
    assert main([str(layers([0, 1])), "--report", str(tmp_path / "r.json")]) == 0
    assert "the model fails its validation" in capsys.readouterr().out
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["validation"]["passed"] is False
    assert any(warning["kind"] == "validation" for warning in report["warnings"])
