# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that are continued beyond their borders: by `extend`, and where they all but reach."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project
from realmodel.core.structures.continued import border_of, continued, extended
from realmodel.core.structures.reading import read_structures
from realmodel.core.structures.triangles import border_loops, meet, open_edges
from realmodel.core.work import run


def grid(x, y, height=lambda x, y: 0 * x, left_out=()):
    """A mesh of squares over lines in plan, without those at some places (column, row)."""
    corners = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    vertices = np.column_stack([corners, height(*corners.T)])
    triangles = []
    for i in range(len(x) - 1):
        for j in range(len(y) - 1):
            a = i * len(y) + j
            if (i, j) not in left_out:
                triangles += [(a, a + len(y), a + len(y) + 1), (a, a + len(y) + 1, a + 1)]
    return vertices.astype(float), np.array(triangles, np.int32)


def area(vertices, triangles):
    """By triangle, seen from above."""
    a, b, c = vertices[triangles, :2].transpose(1, 0, 2)
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def test_a_mesh_is_continued_in_its_plane():
    vertices, triangles = grid(np.arange(5.0), np.arange(4.0), lambda x, y: 0.5 * x)
    wide, more = extended(vertices, triangles, 2.0)
    assert np.array_equal(wide[: len(vertices)], vertices) and np.array_equal(more[: len(triangles)], triangles)
    assert wide[:, 2] == pytest.approx(0.5 * wide[:, 0])
    level = 2.0 / np.hypot(1, 0.5)
    assert [*wide.min(axis=0)[:2], *wide.max(axis=0)[:2]] == pytest.approx([-level, -2, 4 + level, 5])
    assert (area(wide, more) > 0).all()
    assert area(wide, more).sum() == pytest.approx((4 + 2 * level) * 7)
    assert len(border_loops(more)) == 1


def test_a_hole_stays():
    vertices, triangles = grid(np.arange(6.0), np.arange(6.0), left_out=[(2, 2), (2, 3)])
    wide, more = extended(vertices, triangles, 1.5)
    assert area(wide, more).sum() == pytest.approx(8 * 8 - 2) and (area(wide, more) > 0).all()


@pytest.mark.parametrize("by", [0.3, 1.0, 4.0])
def test_a_ragged_border_with_a_bay_does_not_overlap_itself(by):
    """Steps along one side, and a bay wider than twice the extension, or much narrower."""
    steps = [(i, j) for i in range(12) for j in range(12) if i + j > 15 or (j < 4 and i in (3, 4, 5))]
    vertices, triangles = grid(np.arange(13.0), np.arange(13.0), left_out=steps)
    wide, more = extended(vertices, triangles, by)
    assert (area(wide, more) > 0).all()
    assert np.array_equal(more[: len(triangles)], triangles)
    ends = wide[np.unique(open_edges(wide, more))]
    assert len(ends) and ends[:, :2].min() == pytest.approx(-by) and ends[:, 1].max() == pytest.approx(12 + by)


def test_a_fault_that_dies_out_is_continued_up_and_down_its_dip():
    vertices, triangles = grid(np.arange(9.0), np.arange(4.0), lambda x, y: 2.0 * y)
    wide, more = extended(vertices, triangles, 1.0, sideways=False)
    assert wide[:, 0].min() == 0 and wide[:, 0].max() == 8
    assert wide[:, 1].max() == pytest.approx(3 + 1 / np.sqrt(5))
    assert wide[:, 1].min() == pytest.approx(-1 / np.sqrt(5))


def test_only_some_edges_are_continued():
    vertices, triangles = grid(np.arange(4.0), np.arange(4.0))
    border = border_of(vertices, triangles)
    east = border.some(border.away[:, 0] > 0.9)
    wide, more = continued(vertices, triangles, east, 0.25)
    assert wide[:, 0].max() == 3.25 and wide[:, :2].min() == 0 and wide[:, 1].max() == 3
    assert area(wide, more).sum() == pytest.approx(9 + 3 * 0.25)


def test_a_border_that_returns_beside_itself_is_refused():
    turn = np.linspace(0.0, 1.9 * np.pi, 40)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    vertices = np.concatenate([np.column_stack([r * ring, 0 * turn]) for r in (0.05, 1.0)])
    k = np.arange(39)
    triangles = np.concatenate(
        [np.column_stack([k, k + 40, k + 41]), np.column_stack([k, k + 41, k + 1])]
    ).astype(np.int32)
    with pytest.raises(InputRefused, match="its border turns back on itself near"):
        extended(vertices, triangles, 5.0)


def test_a_mesh_with_extend_is_read_extended():
    vertices, triangles = grid(np.arange(5.0), np.arange(4.0))
    project = Project("p", [], faults=[Fault("F", vertices, triangles, extend=1.0)])
    (fault,), _, _ = run(lambda work: read_structures(work, project))
    assert fault.vertices[:, :2].min() == -1 and fault.extend == 0
    assert not meet(vertices[triangles], fault.vertices[fault.triangles[len(triangles) :]] + [0, 0, 1]).any()
