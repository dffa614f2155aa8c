# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields through their contacts: the nodes follow, and contacts are corners of tetrahedra."""

import numpy as np
import pytest
from conftest import ROOT
from folded_rocks import contacts, recumbent
from realmodel.core import Lattice, ScalarField, build, load_project
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import run
from realmodel.core.fields import HeldData, SharedCorners, are_on, fields_with_contacts, level_solids

LATTICE = Lattice((-0.3, -0.4, -0.2), (0.9, 0.8, 0.85), (13, 14, 13))
LEVELS = np.array([1.5, 3.0])
CLAUDIUS = ROOT.parent / "shared" / "data" / "folds" / "claudius" / "project.toml"


def with_contacts(field, places, surfaces, held=None):
    """One field through all contacts."""
    shared = SharedCorners(np.arange(field.lattice.nodes)[None], np.ones((1, len(places)), bool))
    return run(lambda work: fields_with_contacts(work, [field], places, surfaces, shared, held))[0]


@pytest.fixture
def through():
    """A field with thirty contacts of each of two surfaces, and these."""
    field = ScalarField(LATTICE, recumbent(LATTICE.positions()), LEVELS)
    places = np.concatenate([contacts(recumbent, level, 30, seed=4) for level in LEVELS])
    return field, places, np.repeat([0, 1], 30)


def test_the_field_has_its_levels_at_contacts(through):
    field, places, surfaces = through
    missed = np.abs(field.at(places) - LEVELS[surfaces])
    own = with_contacts(field, places, surfaces)
    assert missed.max() > 0.05
    np.testing.assert_allclose(own.at(places), LEVELS[surfaces], rtol=1e-12)
    # the nodes alone nearly do, too, and have moved no more than they had to
    alone = ScalarField(LATTICE, own.values, LEVELS)
    assert np.abs(alone.at(places) - LEVELS[surfaces]).max() < 1e-3 * missed.max()
    assert np.abs(own.values - field.values).max() < 4 * missed.max()


def test_critical_points_go_and_contacts_stay(through):
    """A bubble in a field that rises, between contacts."""
    field, places, surfaces = through
    positions = LATTICE.positions()
    bubble = 1.5 * np.exp(-((positions - [5.0, 5.2, 5.4]) ** 2).sum(axis=1))
    field = ScalarField(LATTICE, 0.5 * positions[:, 2] + bubble, np.array([1.5, 3.6]))
    places = np.concatenate(
        [np.column_stack([places[:30, :2], np.full(30, 2 * level)]) for level in field.levels]
    )
    places = places[((places - [5.0, 5.2, 5.4]) ** 2).sum(axis=1) > 9]
    surfaces = np.searchsorted(2 * field.levels, places[:, 2])
    none = np.empty((0, 3))
    held = with_contacts(
        field, places, surfaces, HeldData([[5.1, 5.2, 6.2]], [[0.0, 0.0, -1.0]], none, none[:, 0], none[:, 0])
    )
    assert len(held.critical_points)
    own = with_contacts(field, places, surfaces, HeldData(none, none, none, none[:, 0], none[:, 0]))
    assert not len(own.critical_points)
    np.testing.assert_array_equal(own.at(places), own.levels[surfaces])
    assert np.abs(own.values - with_contacts(field, places, surfaces).values).max() < 0.5


def test_contacts_are_vertices_of_closed_level_sets(through):
    field, places, surfaces = through
    own = with_contacts(field, places, surfaces)
    solids = run(lambda work: level_solids(work, own))
    for surface, (solid, level_set) in enumerate((each.boundary, each.level_set) for each in solids):
        assert are_on(places[surfaces == surface], level_set).all()
        assert 0 < len(level_set.triangles) < len(solid.triangles)
        edges = solid.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        assert {tuple(edge) for edge in edges.tolist()} == {tuple(edge) for edge in edges[:, ::-1].tolist()}
        a, b, c = np.moveaxis(solid.vertices[solid.triangles], 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0


def test_a_part_of_a_field_has_the_same_triangles_to_the_bit(through):
    _, places, surfaces = through
    lattice = Lattice((-0.375, -0.5, -0.25), (0.875, 0.875, 0.875), (13, 13, 13))  # sums are exact
    own = with_contacts(ScalarField(lattice, recumbent(lattice.positions()), LEVELS), places, surfaces)
    box = np.array([[2.0, 3.1, -np.inf], [6.2, 4.7, np.inf]])
    part = own.within(box)
    assert part.lattice.counts[2] == own.lattice.counts[2] and part.lattice.nodes < own.lattice.nodes / 2

    def in_box(field):
        found = []
        for solid in run(lambda work: level_solids(work, field)):
            corners = solid.level_set.corners
            there = ((corners >= box[0]) & (corners <= box[1])).all(axis=(1, 2))
            found.append(corners[there].tolist())
        return found

    assert in_box(part) == in_box(own)
    assert min(map(len, in_box(part))) > 20


def test_contacts_denser_than_nodes_are_vertices_and_bend_it_no_more_than_they_miss_it():
    """Forty contacts in one cell of a surface that they miss by a tenth of it, here and there."""
    lattice = Lattice((-0.375, -0.5, -0.25), (1.0, 1.0, 1.0), (12, 12, 12))
    field = ScalarField(lattice, lattice.positions() @ [0.2, 0.1, 1.0], np.array([4.9]))
    random = np.random.default_rng(1)
    plan = random.uniform([4.625, 5.5], [5.625, 6.5], (40, 2))
    z = 4.9 - plan @ [0.2, 0.1] + 0.1 * np.sin(9 * plan[:, 0]) * np.cos(11 * plan[:, 1])
    places, surfaces = np.column_stack([plan, z]), np.zeros(40, int)
    own = with_contacts(field, places, surfaces)
    assert len(own.points) > 40
    np.testing.assert_array_equal(own.at(places), np.full(40, 4.9))
    level_set = run(lambda work: level_solids(work, own))[0].level_set
    assert are_on(places, level_set).all()
    assert np.abs(own.values - field.values).max() < 0.2
    assert np.abs(level_set.vertices @ [0.2, 0.1, 1.0] - 4.9).max() < 0.2


def test_a_vertex_is_on_a_sheet_where_it_is_exactly_there():
    sheet = Sheet(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]], np.int32))
    near = np.array([[1.0, 0, 0], [0.5, 0, 0], [0, 1, 1e-16], [-0.0, 0, 0]])
    assert are_on(near, sheet).tolist() == [True, False, False, True]


@pytest.mark.skipif(not CLAUDIUS.exists(), reason="shared/data/folds is not here")
def test_a_field_of_rough_horizons_has_no_critical_points():
    """Of a tenth of the contacts it had 26."""
    model = build(load_project(CLAUDIUS))
    assert not [each for each in model.warnings if each.kind in ("critical_points", "contacts")]
