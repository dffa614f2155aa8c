# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected parts, against a plain search from node to node."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core.components import connected_parts


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


@pytest.mark.parametrize("order", ["along", "shuffled", "star"])
def test_a_million_nodes(order):
    count = 1_000_000
    nodes = np.arange(count)
    edges = np.stack([nodes[:-1], nodes[1:]], axis=1)
    if order == "shuffled":
        edges = np.random.default_rng(1).permutation(count)[edges]
    if order == "star":
        edges[:, 1], edges[:, 0] = count - 1, nodes[:-1]
    began = time.perf_counter()
    assert not connected_parts(count, edges).any()
    assert time.perf_counter() - began < 10.0
