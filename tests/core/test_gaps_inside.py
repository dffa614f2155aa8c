# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaps at the base of a rock mass and at the tips of faults: closed as those at walls."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project, Rock, Surface, build

SQUARE = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]])
QUAD = np.array([[0, 1, 2], [0, 2, 3]])


def wall(begin, end, low, **more):
    (x, y), (u, v) = begin, end
    corners = np.array([[x, y, low], [u, v, low], [u, v, 700.0], [x, y, 700.0]])
    return Fault(more.pop("name"), corners, QUAD, **more)


def built(*faults):
    plan = np.random.default_rng(0).uniform(0, 1000, (60, 2))
    z = 200 - 30.0 * ((plan[:, 0] > 500) & (plan[:, 1] < 605))
    surface = Surface("S", points=np.column_stack([plan, z]))
    rock = Rock("r", [surface], region=SQUARE, edge_length=50, base_elevation=0.0)
    return build(Project("p", [rock], faults=list(faults)))


def test_a_gap_at_the_base():
    model = built(wall((500, -100), (500, 1100), 11.0, name="F"))
    assert any("its border ends up to 11 before the base" in each.text for each in model.warnings)
    with pytest.raises(InputRefused, match="ends inside the rock"):
        built(wall((500, -100), (500, 1100), 14.0, name="F"))


def test_a_gap_at_the_tip_of_a_fault():
    other = wall((500, -100), (500, 600), -100.0, name="B", dies_out=True)
    model = built(other, wall((495, 605), (1100, 605), -100.0, name="A", ends_at=["B"]))
    assert any("fault 'B': its border ends 5 before fault 'A'" in each.text for each in model.warnings)
    with pytest.raises(InputRefused, match="does not meet it"):
        built(other, wall((495, 620), (1100, 620), -100.0, name="A", ends_at=["B"]))
