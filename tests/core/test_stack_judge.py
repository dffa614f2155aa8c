# SPDX-License-Identifier: GPL-3.0-or-later
"""The judge finds what is wrong: models spoilt on purpose, each in one way, none passes."""

import numpy as np
import pytest
from realmodel._native import build_stack
from stacks import judge, places
from stacks.case import Stack, as_surface

pytestmark = pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)


def crossing_stack():
    """A level lattice, a plane that crosses it, a square of partial extent above: walls and wedges."""
    plan = [(x, y) for y in range(4) for x in range(4)]
    lattice = [t for a in (0, 1, 2, 4, 5, 6, 8, 9, 10) for t in ((a, a + 1, a + 5), (a, a + 5, a + 4))]
    level = as_surface([(x, y, 0) for x, y in plan], lattice)
    tilted = as_surface([(x, y, x - 1.25) for x, y in plan], lattice)
    part = as_surface([(0.5, 0.5, 3), (2.5, 0.5, 3), (2.5, 2.5, 3), (0.5, 2.5, 3)], [(0, 1, 2), (0, 2, 3)])
    return Stack([level, tilted, part])


def spoil_vertex(result):
    result["vertices"][np.argmax(result["vertices"][:, 2]), 2] += 1e-3


def spoil_plan(result):
    result["vertices"][np.argmax(result["vertices"][:, 0]), 0] += 1e-3


def spoil_block(result):
    result["cell_block"][0] = 3 - result["cell_block"][0]


def spoil_orientation(result):
    a, b = result["face_offsets"][0], result["face_offsets"][1]
    result["face_vertices"][a:b] = result["face_vertices"][a:b][::-1].copy()


def spoil_side(result):
    inner = np.flatnonzero(result["face_cells"][:, 1] >= 0)[0]
    result["face_cells"][inner, 1] = -1


def spoil_surface(result):
    # two surfaces in general position: the level one is named where the tilted one lies
    result["face_surface"][result["face_surface"] == 1] = 0


def spoil_volume(result):
    result["volumes"][1] *= 1 + 1e-6


def spoil_inside_out(result):
    """All faces turned over: still closed, every volume negative."""
    for a, b in zip(result["face_offsets"][:-1], result["face_offsets"][1:], strict=True):
        result["face_vertices"][a:b] = result["face_vertices"][a:b][::-1].copy()


SPOILERS = [value for name, value in sorted(globals().items()) if name.startswith("spoil_")]


def failures_with(monkeypatch, spoil):
    class Spoilt:
        @staticmethod
        def build_stack(*arguments, **options):
            result = build_stack(*arguments, **options)
            result = {k: v.copy() if isinstance(v, np.ndarray) else v for k, v in result.items()}
            spoil(result)
            return result

    monkeypatch.setattr(places, "native", lambda: Spoilt)
    return judge.failures_of(crossing_stack(), kinds=("columns",))


def test_the_model_itself_passes():
    assert judge.failures_of(crossing_stack()) == []


@pytest.mark.parametrize("spoil", SPOILERS, ids=lambda f: f.__name__)
def test_a_spoilt_model_does_not(monkeypatch, spoil):
    assert failures_with(monkeypatch, spoil)
