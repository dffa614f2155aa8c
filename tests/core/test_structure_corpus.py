# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with faults and bodies that were once built wrongly, kept as small files in tests/data/structures/,
and some random ones (scripts/fuzz.sh --structures looks further)."""

import json

import numpy as np
import pytest
from faulted.case import CORPUS, BodyCase, load_case, save_case
from faulted.contract import FaultSides, is_inside, levels
from faulted.generate import random_case
from faulted.judge import failures_of, topology
from faulted.located import distances
from faulted.minimize import minimize
from faulted.shapes import box, together
from realmodel.core import build

FILES = sorted(CORPUS.glob("*.json"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_it_is_built_right(path):
    assert failures_of(load_case(path)) == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_file_is_small_and_survives_rewriting(path, tmp_path):
    assert path.stat().st_size < 20_000
    save_case(load_case(path), tmp_path / "again.json")
    given, again = (json.loads(file.read_text()) for file in (path, tmp_path / "again.json"))
    del given["why"]
    assert {key: again.get(key) for key in given} == given


@pytest.mark.parametrize("seed", range(100, 112))
def test_random_ones_are_built_right(seed):
    assert failures_of(random_case(seed)) == []


def assert_cut_right(case, point, normal):
    model = build(case.project(), cells=case.cells)
    cut, section = model.cut_by_plane(point, normal), model.section(point, normal)
    assert topology(cut.above) == topology(cut.below) == []
    parts = [[block.volume for block in half.blocks] for half in (cut.above, cut.below)]
    wanted = [block.volume for block in model.blocks]
    assert np.sum(parts, axis=0) == pytest.approx(wanted, abs=1e-9 * sum(wanted))
    assert cut.section.area == pytest.approx(section.area, rel=1e-9)


def test_a_block_that_touches_itself_has_no_flap_where_it_is_cut():
    """Its section passes one place by two nodes, so that a polygon of it runs to a corner and back."""
    case = load_case(CORPUS / "body_touches_wall.json")
    assert_cut_right(
        case,
        (2.1420722654611994, 2.3992919169943203, 0.26062240319661667),
        (-1.035160660959793, -0.38041307686270903, -1.2624809504826022),
    )


def test_a_case_is_the_same_for_a_seed():
    one, other = random_case(7), random_case(7)
    assert one.size() == other.size()
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(one.faults, other.faults, strict=True))


def test_the_judge_finds_what_is_wrong(monkeypatch):
    """A body that comes at another time, in the program alone."""
    case = load_case(CORPUS / "body_on_a_layer_that_came_later.json")
    case.bodies = [BodyCase("B", *box((1, 1, -5), (9, 9, 5)), after="S0")]
    assert failures_of(case) == []
    project = type(case).project

    def later(self):
        given = project(self)
        given.bodies[0].after = None
        return given

    monkeypatch.setattr(type(case), "project", later)
    assert any(failure.startswith("point") for failure in failures_of(case))


def test_the_judge_finds_a_cell_on_both_sides_of_a_branch(monkeypatch):
    """Of one that displaces the other rock mass, too, but in the program does not."""
    case = load_case(CORPUS / "branch_that_displaces_one_of_two_rock_masses.json")
    project = type(case).project(case)
    assert case.faults[1].youngest == "S1"
    case.faults[1].youngest = None
    monkeypatch.setattr(type(case), "project", lambda self: project)
    assert any(failure.startswith("straddles: cell 0 is below F1") for failure in failures_of(case))


def test_the_judge_asks_for_the_whole_volume_and_the_proof(monkeypatch):
    case = next(c for c in map(random_case, range(20)) if c.is_full and c.faults)
    assert failures_of(case, count=10) == []
    case.is_full = False
    project = type(case).project

    def deeper(self):
        given = project(self)
        for rock in given.rocks:
            rock.base_elevation -= 1.0
        return given

    monkeypatch.setattr(type(case), "project", deeper)
    assert not any(failure.startswith("whole") for failure in failures_of(case, count=10))
    case.is_full = True
    assert any(failure.startswith("whole") for failure in failures_of(case, count=10))
    monkeypatch.setattr("realmodel.core.validation.closed_form.closed_forms", lambda model: [])
    assert any(failure.startswith("validation: places") for failure in failures_of(case, count=10))


def test_sides_insides_and_levels():
    vertices, triangles = together(box((0, 0, 0), (4, 4, 4)), box((2, 2, 2), (6, 6, 6)))
    points = np.array([[1.0, 1, 1], [3, 3, 3], [5, 5, 5], [1, 5, 1]])
    inside, decided = is_inside(points, vertices[triangles])
    assert decided.all()
    assert inside.tolist() == [True, False, True, False]
    sheet = np.array([[0.0, 0, 1], [4, 0, 1], [0, 4, 1]]), np.array([[0, 2, 1]])
    places = np.array([[1.0, 1, 2], [1, 1, 0.5], [1, 1, 1], [3, 3, 0], [2, 2, 0]])
    assert levels(places, sheet).tolist() == [1, -1, 9, 0, 9]


def test_a_triangle_without_an_area_is_as_far_as_its_edges():
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 0], [0, 0, 0], [0, 0, 0]]])
    assert distances(np.array([[1.0, 3, 4], [5, 4, 0]]), corners).tolist() == [5.0, 5.0]
    assert distances(np.array([[5.0, 12, 0]]), corners[1:]).tolist() == [13.0]


def test_sides_of_a_fault_are_known_beyond_it():
    case = next(c for c in map(random_case, range(300)) if any(len(f.beyond) for f in c.faults))
    fault = next(f for f in case.faults if len(f.beyond))
    a, b, c = fault.vertices[fault.triangles[0]]
    side = FaultSides(fault, np.cross(b - a, c - a))
    middles = fault.vertices[fault.beyond].mean(axis=1)
    corners = fault.vertices[fault.beyond]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    step = 1e-6 * normal / np.sqrt(np.linalg.norm(normal, axis=1))[:, None]
    assert (side(middles + step) * side(middles - step) == -1).all()


def test_a_failing_case_is_made_small():
    case = random_case(5)
    small = minimize(case, lambda c: len(c.faults) > 0, steps=60)
    assert len(small.faults) == 1
    assert small.size() < case.size()
