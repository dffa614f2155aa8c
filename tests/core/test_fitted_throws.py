# SPDX-License-Identifier: GPL-3.0-or-later
"""Throws that the contacts on both sides of faults show together."""

import numpy as np
import pytest
from realmodel.core import Fault, Project, Rock, Surface, build
from realmodel.core.exporters.report import model_report
from realmodel.core.results.displacements import displacements
from realmodel.core.structures.sheets.fitted_throws import _eliminate
from structure_cases import plane_fault

SQUARE = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]])


def fault(name, x=500.0, along="y", **more):
    """A vertical fault along an axis."""
    vertices, triangles = plane_fault(0.0, 0.0, y=(-500.0, 1500.0), z=(-2000.0, 2000.0))
    vertices = vertices + np.array([x, 0.0, 0.0])
    if along == "x":
        vertices = vertices[:, [1, 0, 2]]
    return Fault(name, vertices, triangles, **more)


def project(heights, faults, method=None, edge_length=60.0):
    """Surfaces through points, oldest first."""
    surfaces = [Surface(f"S{n}", points=points, method=method) for n, points in enumerate(heights)]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=edge_length, base_elevation=-2000.0)
    return Project("p", [rock], faults=faults)


def contacts(seed, count, height, noise=0.0):
    random = np.random.default_rng(seed)
    plan = random.uniform(0.0, 1000.0, (count, 2))
    return np.column_stack([plan, height(*plan.T) + noise * random.standard_normal(count)])


def throws(model):
    """Of each fault and surface the size of the throw."""
    return {(each.fault, each.surface): abs(each.mean_throw) for each in displacements(model)}


def texts(model):
    return [warning.text for warning in model.warnings]


def random_case(seed):
    """A project, its throw, its noise, and the throws by least squares of a plane and a step."""
    random = np.random.default_rng(seed)
    size, noise, count = random.uniform(0, 80), [0.0, 2.0][seed % 2], int(random.integers(6, 26))
    turn, phase, length = random.uniform(0, 2 * np.pi, 3)
    slope = np.tan(np.radians(random.uniform(0, 6)))

    def shape(x, y):
        along = (x - 500) * np.cos(turn) + (y - 500) * np.sin(turn)
        if seed % 4 < 2:
            return slope * along
        return 15 * np.sin(2 * np.pi * along / (500 + 160 * length) + phase)

    def height(x, y):
        return shape(x, y) - size * (x > 500)

    given = [
        contacts(100 * seed + n, count, height, noise) + np.array([0, 0, base])
        for n, base in enumerate((150.0, 220.0, 290.0))
    ]
    plain = []
    for points in given:
        columns = np.column_stack([np.ones(count), points[:, :2] - 500, points[:, 0] > 500])
        plain.append(abs(np.linalg.lstsq(columns, points[:, 2], rcond=None)[0][3]))
    return project(given, [fault("F")]), size, noise, plain


def test_throws_of_random_projects():
    wrong, plainly_wrong, errors = 0, 0, []
    for seed in range(16):
        case, size, noise, plain = random_case(seed)
        allowed = max(0.05 * size, 3.0, 2 * noise)
        model = build(case)
        off = np.abs(np.array([*throws(model).values()]) - size)
        wrong += (off > allowed).sum()
        plainly_wrong += (np.abs(np.array(plain) - size) > allowed).sum()
        errors += off.tolist()
    assert len(errors) == 48
    assert (wrong, plainly_wrong) == (1, 16)
    assert np.median(errors) < 1.0


@pytest.mark.parametrize("method", ["kriging", "universal_kriging", "spline", "natural_neighbour"])
@pytest.mark.parametrize("count", [10, 40])
def test_a_surface_that_no_fault_displaces_gets_no_throw(method, count):
    model = build(project([contacts(1, count, lambda x, y: 200 + 0.09 * x)], [fault("F")], method))
    assert throws(model) == {("F", "S0"): pytest.approx(0.0, abs=1e-9)}
    (entry,) = model_report(model)["faults"][0]["surfaces"]
    assert not entry["throw_found"]
    assert any(text.startswith("no throw of fault 'F' is found, from") for text in texts(model))


def test_crossing_faults_are_fitted_together():
    def height(x, y):
        return 300 + 0.05 * x + 10 * np.sin(x / 150 + y / 200) - 175 * (x > 500) - 40 * (y > 500)

    points = contacts(1, 30, height)
    model = build(project([points], [fault("F"), fault("G", along="x")]))
    assert throws(model) == {
        ("F", "S0"): pytest.approx(175, rel=0.05),
        ("G", "S0"): pytest.approx(40, rel=0.05),
    }


def test_a_compartment_without_contacts_is_reached_by_the_throws_of_its_faults():
    def height(x, y):
        return 300 + 0.05 * x - 175 * (x > 500) - 40 * (y > 500)

    points = contacts(1, 40, height)
    points = points[(points[:, 0] < 500) | (points[:, 1] < 500)]
    model = build(project([points], [fault("F"), fault("G", along="x")]))
    assert throws(model) == {
        ("F", "S0"): pytest.approx(175, rel=0.01),
        ("G", "S0"): pytest.approx(40, rel=0.01),
    }
    assert any("by the throws that these show, " in text for text in texts(model))


def test_turned_blocks_have_their_own_points():
    def height(x, y):
        return 200 + np.where(x > 500, -40 + 0.1 * (x - 500), 0.02 * y) + 3 * np.sin(y / 100)

    given = [contacts(n, 25, height) + np.array([0, 0, 90 * n]) for n in range(3)]
    model = build(project(given, [fault("F")]))
    assert all(entry["throw_deviation"] is None for entry in model_report(model)["faults"][0]["surfaces"])


def test_a_fault_that_grew():
    def height(x, y):
        return 0.05 * y + 8 * np.sin(x / 150 + y / 200)

    given = [contacts(n, 25, height) + np.array([0, 0, 90 * n]) for n in range(3)]
    for number, points in enumerate(given):
        points[:, 2] -= (90 - 30 * number) * (points[:, 0] > 500)
    found = throws(build(project(given, [fault("F")])))
    assert found == {("F", f"S{n}"): pytest.approx(90 - 30 * n, abs=1.0) for n in range(3)}


def test_contacts_are_honored_on_each_side():
    points = contacts(3, 12, lambda x, y: 200 + 15 * np.sin(x / 90) - 30 * (x > 500), noise=2.0)
    model = build(project([points], [fault("F")]))
    assert [each for each in model.misfits() if abs(each.residual) > 1e-9] == []


def test_elimination():
    random = np.random.default_rng(0)
    root = random.standard_normal((3, 8, 8))
    whole = root @ root.transpose(0, 2, 1)
    left = whole.copy()
    value, power = _eliminate(left, 5)
    inner = np.linalg.solve(whole[:, :5, :5], whole[:, :5, 5:])
    np.testing.assert_allclose(left[:, 5:, 5:], whole[:, 5:, 5:] - whole[:, 5:, :5] @ inner, rtol=1e-8)
    np.testing.assert_allclose(np.ldexp(value, power), np.linalg.det(whole[:, :5, :5]), rtol=1e-9)


def test_the_same_bytes_for_any_number_of_threads():
    case = random_case(2)[0]
    one, two = (build(case, threads=threads) for threads in (1, 2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
