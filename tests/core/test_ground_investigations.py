# SPDX-License-Identifier: GPL-3.0-or-later
"""From an AGS file to a model and IFC, for random sites."""

import numpy as np
import pytest
from ground_investigations import ags3, ags4, random_site
from realmodel.core import build, propose_project
from realmodel.core.exporters.shapes.manifold import separated


@pytest.mark.parametrize(("seed", "write_ags"), [(2, ags4), (3, ags3)])
def test_a_site_becomes_closed_strata(tmp_path, seed, write_ags):
    """The clay under London has the code LC, which is no lost core here."""
    site = random_site(seed, lenses=seed == 3)
    (tmp_path / "site.ags").write_text(write_ags(site), encoding="utf-8")
    project = propose_project(boreholes=tmp_path / "site.ags")
    assert project.proposal.order[0] == "LC"
    assert any("'LC' is taken for a unit" in text for text in project.proposal.warnings)
    model = build(project)
    assert model.observed().share == 1.0
    ifcopenshell = pytest.importorskip("ifcopenshell", reason="not installed: scripts/test.sh installs it")
    model.save(tmp_path / "m.ifc")
    face_sets = ifcopenshell.open(tmp_path / "m.ifc").by_type("IfcTriangulatedFaceSet")
    closed = [np.array(item.CoordIndex) for item in face_sets if item.Closed]
    assert len(closed) == sum(block.components for block in model.blocks)
    for triangles in closed:
        assert_manifold(triangles)


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
