# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors for what reaches a model, and that nothing of it is left to a library of the processor's."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from realmodel.core.base.algebra import dot, norm, principal_axes

CORE = Path(__file__).resolve().parents[2] / "addon" / "realmodel" / "core"
# Pictures, volumes of cells in files of other programs, and validation, which are no part of a model.
OTHER = {
    "drawing",
    "exporters",
    "plots.py",
    "results/samples.py",
    "results/sections/section_drawing.py",
    "simulation",
}


def test_products_and_lengths():
    a, b = np.arange(12.0).reshape(4, 3), np.array([1.0, -2.0, 0.5])
    np.testing.assert_allclose(dot(a, b), a @ b)
    np.testing.assert_allclose(norm(a), np.linalg.norm(a, axis=1))
    assert norm(np.array([3.0, 4.0])) == 5.0


@given(st.integers(0, 10**6), st.integers(2, 40), st.sampled_from([2, 3]), st.integers(-12, 12))
def test_axes_are_those_of_the_singular_values(seed, count, dimensions, exponent):
    random = np.random.default_rng(seed)
    points = random.normal(size=(count, dimensions)) @ random.normal(size=(dimensions, dimensions))
    points = points * 10.0**exponent + random.normal(size=dimensions)
    spread, axes = principal_axes(points)
    moved = points - points.mean(axis=0)
    expected = np.zeros(dimensions)
    expected[: min(count, dimensions)] = np.linalg.svd(moved, compute_uv=False)
    np.testing.assert_allclose(spread, expected, rtol=1e-9, atol=1e-12 * expected[0])
    np.testing.assert_allclose(axes @ axes.T, np.eye(dimensions), atol=1e-12)
    np.testing.assert_allclose(norm((moved @ axes.T).T), spread, rtol=1e-6, atol=1e-12 * expected[0])
    assert (np.take_along_axis(axes, np.abs(axes).argmax(axis=1)[:, None], axis=1) > 0).all()


def test_points_in_one_line_spread_along_it_only():
    along = np.array([1.0, 2.0, -2.0]) / 3
    spread, axes = principal_axes(np.linspace(0, 90, 7)[:, None] * along + [4e6, 5e6, 100.0])
    np.testing.assert_allclose(axes[0], -along, atol=1e-9)
    assert spread[1] < 1e-9 * spread[0]


@pytest.mark.parametrize("points", [np.zeros((1, 3)), np.full((5, 3), 7.0)])
def test_points_at_one_place_spread_nowhere(points):
    spread, axes = principal_axes(points)
    assert not spread.any()
    np.testing.assert_array_equal(axes, np.eye(3))


@pytest.mark.parametrize("size", [1e-150, 1.0, 1e150])
def test_sizes_do_not_matter(size):
    points = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 2.0, 1e-9]])
    spread, axes = principal_axes(points * size)
    ours, _ = principal_axes(points)
    np.testing.assert_allclose(spread / size, ours, rtol=1e-12)
    np.testing.assert_allclose(norm(axes), 1.0)


def test_nothing_that_reaches_a_model_is_left_to_a_library_of_the_processors():
    found = []
    for path in sorted(CORE.rglob("*.py")):
        name = path.relative_to(CORE).as_posix()
        if name in OTHER or name.split("/")[0] in OTHER:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            matrices = isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult)
            products = called in ("np.matmul", "np.inner", "np.tensordot") or called.endswith(".dot")
            algebra = re.fullmatch(r"np\.linalg\.\w+", called)
            if called == "np.linalg.norm":
                algebra = not any(keyword.arg == "axis" for keyword in node.keywords)
            if matrices or products or algebra:
                found.append(f"{name}:{node.lineno}: {ast.unparse(node)}")
    assert not found, "take realmodel.core.base.algebra:\n" + "\n".join(found)
