# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that die out in a series: its field differs on their two sides, and is one function around their
tips."""

import numpy as np
import pytest
from folded_rocks import SQUARE, dome, folded_project, given_field, plunging, recumbent, sheet
from realmodel.core import Fault, InputRefused, Project, Rock, Series, SpaceDips, Surface, build
from realmodel.core.base.work import run
from realmodel.core.validation.closed_form import closed_forms

LEVELS = {recumbent: (1.5, 2.5, 4.0), dome: (3.0, 4.5, 6.0), plunging: (2.5, 4.0, 6.0)}


def leaning(along, low=-1.0, high=11.0, x=5.3, lean=0.2):
    """A fault that leans over x, between two places along y and two heights."""
    (y0, y1), n = along, 4
    y, z = (each.ravel() for each in np.meshgrid(np.linspace(y0, y1, n), np.linspace(low, high, n)))
    number = np.arange(n * n).reshape(n, n)
    a, b, c, d = (
        each.ravel() for each in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x + lean * (z - 5.0) + 0.1 * y, y, z]), triangles.astype(np.int32)


def fault(name="F", along=(-2.0, 6.2), **more):
    shape = {key: more.pop(key) for key in ("low", "high", "x", "lean") if key in more}
    return Fault(name, *leaning(along, **shape), youngest="fii", dies_out=True, **more)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("f", [recumbent, dome])
def test_a_fold_that_a_fault_displaces_up_to_its_tip(monkeypatch, f, cells):
    given_field(monkeypatch, f, LEVELS[f])
    model = build(folded_project(f, LEVELS[f], faults=[fault()]), cells=cells)
    assert model.validate().passed, model.validate().failure()
    (own,) = model.rock_inputs[0].fields
    assert len(own.distinct()) == 2
    # the two sides are one block, but for what the fault parts
    number = model.surface_names.index("F")
    faces = np.flatnonzero(model.face_surface == number)
    _, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    assert 4.0 < model.vertices[corners, 1].max() < 6.3


def test_beyond_its_tip_both_fields_are_one(monkeypatch):
    given_field(monkeypatch, plunging, LEVELS[plunging])
    model = build(folded_project(plunging, LEVELS[plunging], faults=[fault()]))
    one, other = model.rock_inputs[0].fields[0].distinct()
    y = np.linspace(0, 10, 400)
    z = np.linspace(0.2, 7, 400)
    places = np.column_stack([5.3 + 0.2 * (z - 5.0) + 0.1 * y, y, z])
    differs = one.at(places) - other.at(places)
    assert (differs[y > 6.3] == 0).all()
    assert (np.abs(differs[y < 4.0]) > 0.2).all()


def test_a_border_inside_the_rock_is_a_tip_all_around(monkeypatch):
    given_field(monkeypatch, dome, LEVELS[dome])
    inside = fault(along=(2.0, 7.0), low=1.0, high=6.0)
    model = build(folded_project(dome, LEVELS[dome], faults=[inside]))
    assert model.validate().passed, model.validate().failure()
    assert len(model.rock_inputs[0].fields[0].distinct()) == 2


def test_one_whose_border_lies_in_younger_rock(monkeypatch):
    """There it is no tip: up to the unconformity the fold is thrown."""
    given_field(monkeypatch, dome, LEVELS[dome])
    younger = [sheet("base of B", lambda x, y: 5.0 + 0.2 * x)]
    buried = fault(high=7.4)
    model = build(folded_project(dome, LEVELS[dome], younger=younger, faults=[buried]))
    assert model.validate().passed, model.validate().failure()
    one, other = model.rock_inputs[0].fields[0].distinct()
    z = np.linspace(0.2, 6.0, 50)
    places = np.column_stack([5.3 + 0.2 * (z - 5.0) + 0.2, np.full(50, 2.0), z])
    assert (np.abs(one.at(places) - other.at(places)) > 0.4).all()


def test_one_that_ends_at_a_fault_through_the_rock(monkeypatch):
    given_field(monkeypatch, dome, LEVELS[dome])
    y, z = (each.ravel() for each in np.meshgrid([-2.0, 12.0], [-1.0, 11.0]))
    triangles = np.array([[0, 1, 3], [0, 3, 2]], np.int32)
    through = Fault("through", np.column_stack([y, np.full(4, 1.7), z]), triangles, youngest="fii")
    branch = fault(along=(-0.4, 6.2), ends_at=["through"])
    project = folded_project(dome, LEVELS[dome], faults=[through, branch])
    model = build(project)
    assert model.validate().passed, model.validate().failure()
    assert len(model.rock_inputs[0].fields[0].distinct()) == 3


def test_two_of_them_side_by_side_part_three_fields(monkeypatch):
    given_field(monkeypatch, dome, LEVELS[dome])
    faults = [fault(), fault("G", (3.0, 12.0), x=3.0, lean=-0.1)]
    model = build(folded_project(dome, LEVELS[dome], faults=faults))
    assert model.validate().passed, model.validate().failure()
    assert len(model.rock_inputs[0].fields[0].distinct()) == 3


@pytest.mark.parametrize("f", [dome, recumbent])
@pytest.mark.parametrize(("low", "high", "at"), [(-1.0, 3.2, 3.0), (1.5, 4.3, 3.0), (-1.0, 3.2, 5.6)])
def test_a_branch_that_dies_out_at_one_that_does(monkeypatch, f, low, high, at):
    """Its tip lies at x = `low`, or outside; in the last cases it ends near the tip of the other."""
    given_field(monkeypatch, f, LEVELS[f])
    x, z = (each.ravel() for each in np.meshgrid([low, 2.0 + high], [-1.0, 11.0]))
    triangles = np.array([[0, 1, 3], [0, 3, 2]], np.int32)
    plan = np.column_stack([x, np.full(4, at), z])
    branch = Fault("B", plan, triangles, youngest="fii", ends_at=["F"], dies_out=True)
    model = build(folded_project(f, LEVELS[f], faults=[branch, fault()]))
    assert model.validate().passed, model.validate().failure()
    own = model.rock_inputs[0].fields[0]
    assert len(own.distinct()) == 3
    # beyond the tip of the other one all three are one
    places = np.column_stack([5.3 + 0.2 * (np.linspace(0.3, 7, 50) - 5.0) + 0.8, np.full(50, 8.0)])
    places = np.column_stack([places, np.linspace(0.3, 7, 50)])
    one, *others = (each.at(places) for each in own.distinct())
    assert all((one == other).all() for other in others)


def test_one_at_which_a_fault_ends_that_goes_on_is_refused(monkeypatch):
    given_field(monkeypatch, dome, LEVELS[dome])
    x, z = (each.ravel() for each in np.meshgrid([-1.0, 5.6], [-1.0, 11.0]))
    triangles = np.array([[0, 1, 3], [0, 3, 2]], np.int32)
    branch = Fault("B", np.column_stack([x, np.full(4, 3.0), z]), triangles, youngest="fii", ends_at=["F"])
    with pytest.raises(
        InputRefused, match=r"fault 'F'.*dies out in a series.*'B', which does not, ends at it"
    ):
        build(folded_project(dome, LEVELS[dome], faults=[fault(), branch]))


def slip(points):
    """How far beds are thrown along z by a fault over x = 5 whose tip is at y = 6."""
    x, y, _ = points.T
    return np.sign(x - 5.0) * 0.7 * np.clip((6.0 - y) / 5.0, 0, 1) * np.exp(-np.abs(x - 5.0) / 4.0)


def test_a_thrown_fold_from_contacts_and_dips():
    """Nearer to the truth than without the fault, and the same bytes for any number of threads."""
    rng = np.random.default_rng(4)

    def f(points):
        return dome(points + slip(points)[:, None] * [0.0, 0.0, 1.0])

    surfaces = []
    levels = LEVELS[dome]
    for number, level in enumerate(levels):
        plan = rng.uniform(0.3, 9.7, (25, 2))
        low, high = np.full(25, -6.0), np.full(25, 14.0)
        for _ in range(60):
            middle = 0.5 * (low + high)
            above = f(np.column_stack([plan, middle])) > level
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        points = np.column_stack([plan, low])
        surfaces.append(Surface(f"f{'i' * number}", points=points[points[:, 2] > 0.1], series="folded"))
    places = rng.uniform(0.5, 8.0, (20, 3))
    slopes = np.stack([f(places + 1e-5 * e) - f(places - 1e-5 * e) for e in np.eye(3)], axis=1)
    dips = SpaceDips(places, slopes / np.linalg.norm(slopes, axis=1)[:, None])
    ground = sheet("ground", lambda x, y: 8.0 + 0 * x)
    series = [Series("folded", resolution=0.8, dips=dips)]
    upright = Fault("F", *leaning((-2.0, 6.0), x=5.0, lean=0.0), youngest="fii", dies_out=True)
    upright.vertices[:, 0] = 5.0
    rock = Rock("r", [*surfaces, ground], region=SQUARE, base_elevation=0.0, series=series)
    near = rng.uniform((4.0, 0.0, 0.0), (6.0, 5.0, 8.0), (4000, 3))

    def built(faults, threads):
        model = build(Project("thrown", [rock], faults=faults), threads=threads)
        found = run(lambda work: closed_forms(model)[0].blocks_at(work, near))
        return model, (found == np.searchsorted(levels, f(near))).mean()

    _, without = built([], 1)
    model, share = built([upright], 1)
    assert share > 0.95
    assert share > without + 0.03
    other, _ = built([upright], 2)
    np.testing.assert_array_equal(other.vertices, model.vertices)
    np.testing.assert_array_equal(other.face_surface, model.face_surface)


def moved(points, way, beyond):
    """Where rock was before faults moved what lies beyond them."""
    return points - np.where(beyond[:, None], way, 0.0)


def few_data(f, levels, seed):
    """Contacts of twelve vertical holes in the levels of a function, and 30 dips."""
    rng = np.random.default_rng(seed)
    z = np.linspace(0.0, 8.0, 2001)
    found = [[] for _ in levels]
    for x, y in rng.uniform(0.3, 9.7, (12, 2)):
        values = f(np.column_stack([0 * z + x, 0 * z + y, z]))
        for points, level in zip(found, levels, strict=True):
            at = np.flatnonzero((values[1:] > level) != (values[:-1] > level))
            share = (level - values[at]) / (values[at + 1] - values[at])
            points += [(x, y, height) for height in z[at] + share * (z[1] - z[0])]
    places = rng.uniform(0.3, 7.7, (30, 3))
    slopes = np.stack([f(places + 1e-5 * e) - f(places - 1e-5 * e) for e in np.eye(3)], axis=1)
    return found, SpaceDips(places, slopes / np.linalg.norm(slopes, axis=1)[:, None])


def test_few_data_on_both_sides_of_a_fault_tell_what_it_has_moved():
    """Two faults, one ending at the other, in a recumbent fold: no compartment has data for a field of its
    own. By itself each has 0.80 of random places in the right block."""
    levels = LEVELS[recumbent]

    def f(points):
        west = points[:, 0] < 5.0
        before = moved(points, [0.0, 0.6, -0.9], west)
        return recumbent(moved(before, [0.5, 0.0, 0.6], ~west & (points[:, 1] > 5.0)))

    found, dips = few_data(f, levels, 3)
    surfaces = [
        Surface(f"f{'i' * n}", points=np.array(points), series="folded") for n, points in enumerate(found)
    ]
    series = [Series("folded", resolution=0.6, dips=dips)]
    ground = sheet("ground", lambda x, y: 8.0 + 0 * x)
    rock = Rock("r", [*surfaces, ground], region=SQUARE, base_elevation=0.0, series=series)
    two = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    main = np.array([[5.0, -2, -5], [5.0, 12, -5], [5.0, 12, 20], [5.0, -2, 20]])
    branch = np.array([[4.0, 5.0, -5], [12.0, 5.0, -5], [12.0, 5.0, 20], [4.0, 5.0, 20]])
    faults = [Fault("F", main, two, youngest="fii"), Fault("B", branch, two, youngest="fii", ends_at=["F"])]
    models = [build(Project("moved", [rock], faults=faults), threads=threads) for threads in (1, 2)]
    assert not [warning for warning in models[0].warnings if "compartment" in warning.text]
    assert models[0].validate().passed, models[0].validate().failure()
    places = np.random.default_rng(1).uniform((0, 0, 0), (10, 10, 8), (5000, 3))
    blocks = run(lambda work: closed_forms(models[0])[0].blocks_at(work, places))
    assert (blocks == np.searchsorted(levels, f(places))).mean() > 0.97
    np.testing.assert_array_equal(models[1].vertices, models[0].vertices)
