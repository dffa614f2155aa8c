# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected parts of blocks, against a plain search from cell to cell."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel import _native


def connected_parts(count, edges):
    """Cells of one block that share faces."""
    return _native.cell_components(edges, np.zeros(count, np.int32))


def by_search(count, edges):
    neighbours = [[] for _ in range(count)]
    for a, b in edges:
        neighbours[a].append(b)
        neighbours[b].append(a)
    part = [-1] * count
    for start in range(count):
        waiting = [start] if part[start] < 0 else []
        while waiting:
            node = waiting.pop()
            if part[node] < 0:
                part[node] = start
                waiting += neighbours[node]
    return part


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    st.integers(1, 30).flatmap(
        lambda n: st.tuples(
            st.just(n), st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=40)
        )
    )
)
def test_as_a_search_finds_them(graph):
    count, edges = graph
    found = connected_parts(count, np.array(edges, np.int32).reshape(-1, 2))
    assert found.tolist() == by_search(count, edges)


def test_faces_between_blocks_and_to_the_outside_join_nothing():
    faces = np.array([[0, 1], [1, 2], [2, -1], [3, 2]], np.int32)
    assert _native.cell_components(faces, np.array([0, 0, 1, 1], np.int32)).tolist() == [0, 0, 2, 2]


@pytest.mark.parametrize("bad", [4, -2])
def test_a_face_of_a_cell_that_is_not_there_is_refused(bad):
    with pytest.raises(_native.InputError, match="face 1") as refused:
        connected_parts(4, np.array([[0, 1], [2, bad]], np.int32))
    assert (refused.value.kind, refused.value.items) == ("bad_index", [1])


def test_cancelled():
    control = _native.Execution()
    control.cancel()
    with pytest.raises(_native.Cancelled):
        _native.cell_components(np.array([[0, 1]], np.int32), np.zeros(2, np.int32), execution=control)


def test_sides_of_cells_are_in_the_order_of_the_faces():
    faces = np.array([[0, 1], [1, -1], [2, 0], [0, -1]], np.int32)
    offsets, sides = _native.cell_sides(faces, 4)
    found = [[(int(side) >> 1, int(side) & 1) for side in sides[a:b]] for a, b in pairwise(offsets)]
    assert found == [[(0, 0), (2, 1), (3, 0)], [(0, 1), (1, 0)], [(2, 0)], []]
    with pytest.raises(_native.InputError, match="face 2"):
        _native.cell_sides(faces, 2)


@pytest.mark.parametrize("order", ["along", "shuffled", "star"])
def test_a_million_nodes(order):
    count = 1_000_000
    nodes = np.arange(count)
    edges = np.stack([nodes[:-1], nodes[1:]], axis=1)
    if order == "shuffled":
        edges = np.random.default_rng(1).permutation(count)[edges]
    if order == "star":
        edges[:, 1], edges[:, 0] = count - 1, nodes[:-1]
    assert not connected_parts(count, edges).any()
