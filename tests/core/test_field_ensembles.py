# SPDX-License-Identifier: GPL-3.0-or-later
"""Realizations of series of fields: they honor the data, differ as these allow, and are sure where they may
be."""

import numpy as np
import pytest
from folded_rocks import OF_FOLD, dome, folded, recumbent
from realmodel.core import Observations, Surface, build
from realmodel.core.base.work import run
from realmodel.core.ensembles import Realizer, ensemble
from realmodel.core.fields import FieldDraws, are_on, solve_field
from realmodel.core.project.project import Fault
from test_fields import LATTICE, LEVELS, _data, _turned, overturned
from test_slits import leaning


def drawn(data, number, known, lattice=LATTICE):
    def normal(part, count):
        return np.random.default_rng((number, part)).standard_normal(count)

    return run(lambda work: FieldDraws(normal, known, 0.0).field(lattice, data, work, 0))


def rippled(points):
    """A fold with a second one of shorter waves across it, which few data do not show."""
    along, u, v = _turned(points)
    return v - 100.0 * np.sin(u / 110.0) - 25.0 * np.sin(along / 60.0 + u / 47.0)


def test_blocks_are_as_often_true_as_they_are_probable():
    """At random places in a fold of known truth, from few data."""
    data, known, draws = _data(rippled, holes=8, dips=20), {}, 40
    low, high = LATTICE.corners
    places = np.random.default_rng(2).uniform(low, high, (6000, 3))
    truth = np.searchsorted(LEVELS, rippled(places))
    counts = np.zeros((len(places), len(LEVELS) + 1))
    for number in range(draws):
        field = drawn(data, number, known)
        counts[np.arange(len(places)), np.searchsorted(field.levels, field.at(places))] += 1
    share = counts / draws
    is_true = truth[:, None] == np.arange(share.shape[1])
    for low, high in ((0.0, 0.02), (0.1, 0.4), (0.4, 0.7), (0.7, 0.95), (0.98, 1.0)):
        here = (share >= low) & (share <= high)
        assert is_true[here].mean() == pytest.approx(share[here].mean(), abs=0.12)
    assert share[np.arange(len(places)), truth].mean() > 0.75


def _solved(data):
    return run(lambda work: solve_field(LATTICE, data, work))


def test_a_drawn_field_honors_its_data():
    data = _data(overturned, holes=8, dips=20)
    field = drawn(data, 3, {})
    assert (np.diff(field.levels) > 0).all()
    assert field.misfit < 1e-3  # a millionth of the lattice
    away = np.abs(field.at(data.contacts) - field.levels[data.contact_surfaces])
    assert away.max() < 0.1 * np.ptp(field.levels)  # between nodes, which contacts are not yet
    step = 5.0 * data.normals
    assert (field.at(data.dips + step) > field.at(data.dips - step)).all()
    assert np.abs(field.values - drawn(data, 4, {}).values).max() > 1.0


def test_where_data_are_exact_there_is_no_doubt():
    """A plane: what is left of its data is nothing."""
    data = _data(lambda p: p[:, 2] + 0.2 * p[:, 0] - 300.0, holes=6, dips=8)
    base, field = _solved(data), drawn(data, 1, {})
    points = np.random.default_rng(1).uniform(*LATTICE.corners, (500, 3))
    there = field.at(points) - field.levels[0], base.at(points) - base.levels[0]
    np.testing.assert_allclose(*there, atol=1e-2)


def test_contacts_and_observations_hold_in_all_realizations():
    project = folded()
    places = np.random.default_rng(8).uniform((0.5, 0.5, 0.5), (9.5, 9.5, 6.5), (20, 3))
    blocks = np.searchsorted(OF_FOLD, recumbent(places))
    names = ["f", "fi", "fii", "ground"]
    project.rocks[0].observations = Observations(places, [names[block] for block in blocks])
    realizer = Realizer(build(project, cells="blocks"), 1)
    volumes = []
    for number in range(3):
        model = realizer.realization(number)
        assert model.validate().passed
        for each, data in enumerate(model.rock_inputs[0].data[:3]):
            assert are_on(data.points, model.rock_inputs[0].surface(each)).all()
        assert model.observed().share == 1.0
        volumes.append([block.volume for block in model.blocks])
    assert np.std(volumes, axis=0).min() > 1e-3


def test_the_same_for_any_number_of_threads_and_any_order():
    model = build(folded(), cells="blocks")
    one, other = Realizer(model, 4), Realizer(model, 4)
    other.prepare()
    first = one.realization(1, threads=1)
    other.realization(0)
    again = other.realization(1, threads=2)
    np.testing.assert_array_equal(first.vertices, again.vertices)
    np.testing.assert_array_equal(first.face_vertices, again.face_vertices)
    assert [block.volume for block in Realizer(model, 5).realization(1).blocks] != [
        block.volume for block in first.blocks
    ]


def test_sheets_over_a_fold_are_drawn_too():
    project = folded()
    points = np.random.default_rng(3).uniform((0.2, 0.2, 6.5), (9.8, 9.8, 9.0), (9, 3))
    project.rocks[0].surfaces[-1] = Surface("ground", points=points, method="kriging")
    project.rocks[0].edge_length = 1.5
    found = ensemble(project, 3, seed=2, places=[[5.0, 5.0, 3.0]])
    assert found.surface_deviation[:3] == [None] * 3
    assert found.surface_deviation[3].max() > 0.1
    assert found.probability.sum() == pytest.approx(1.0)
    assert found.volumes.std(axis=0).min() > 0
    hole = found.planned_hole((5.0, 5.0, 9.5), dip=90.0, length=9.0)
    assert any((each.deviation or 0) > 0 for each in hole.contacts)


@pytest.mark.parametrize("dies_out", [False, True])
def test_fields_on_both_sides_of_a_fault_are_drawn(dies_out):
    if dies_out:
        given = Fault("F", *leaning((-2.0, 6.2)), youngest="fii", dies_out=True)
    else:
        given = Fault("F", *leaning((-2.0, 12.0)), youngest="fii")
    model = build(folded(dome, (3.0, 4.5, 6.0), faults=[given]), cells="blocks")
    drawn = Realizer(model, 1).realization(0)
    assert drawn.validate().passed, drawn.validate().failure()
    one, other = drawn.rock_inputs[0].fields[0].distinct()
    base, _ = model.rock_inputs[0].fields[0].distinct()
    far = np.array([[5.0, 9.8, 1.0]])
    assert (one.at(far) == other.at(far)) == dies_out
    assert np.abs(one.values - base.values).max() > 1e-3
