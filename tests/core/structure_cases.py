# SPDX-License-Identifier: GPL-3.0-or-later
"""Small faults, surfaces and rock masses for the tests of structures."""

from dataclasses import replace

import numpy as np
import pytest
from realmodel.core.rock_input import mesh_rock, read_rocks
from realmodel.core.structures.closed_form import ClosedForm, nearest_side
from realmodel.core.structures.reading import read_structures
from realmodel.core.structures.setup import add_structures
from realmodel.core.structures.sheets import make_sheets
from realmodel.core.work import native_module, run


def fault_sides(points, vertices, triangles, threads=0, control=None):
    """_native.fault_sides in NumPy."""
    side = nearest_side(np.asarray(points), vertices, triangles)
    return np.where(side == 0, 1, side).astype(np.int8)


@pytest.fixture
def sides(monkeypatch):
    """Sides of faults by NumPy."""
    monkeypatch.setattr(native_module(), "fault_sides", fault_sides, raising=False)


def plane_fault(x=5.0, lean=0.0, y=(-5.0, 15.0), z=(-20.0, 20.0), turn=0.0):
    """A plane along y that passes (x, 5, 0) and leans: x grows by `lean` for each unit down; turned about the
    vertical through (x, 5) by `turn` degrees."""
    (y0, y1), (z0, z1) = y, z
    corners = np.array(
        [[-lean * height, at, height] for height, at in ((z0, y0), (z0, y1), (z1, y1), (z1, y0))]
    )
    corners[:, 1] -= 5.0
    cos, sin = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    corners[:, :2] = corners[:, :2] @ np.array([[cos, sin], [-sin, cos]])
    return corners + np.array([x, 5.0, 0.0]), np.array([[0, 1, 2], [0, 2, 3]], np.int32)


SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])


def prepared(project, threads=1):
    """The rock masses (RockInput) of a project with their sheets."""

    def task(work):
        inputs = read_rocks(work, replace(project, faults=[], bodies=[]))
        for entry in inputs:
            mesh_rock(work, entry)
        faults, bodies, _ = read_structures(work, project, threads)
        add_structures(work, project, faults, bodies, inputs, threads)
        for entry in inputs:
            make_sheets(work, entry, 0.0, 1.0, threads)
        return inputs

    return run(task)


def closed_form_of(entry):
    """The closed form of a RockInput that `prepared` returned; blocks are numbered as the surfaces."""
    return ClosedForm(
        [surface.rule for surface in entry.rock.surfaces],
        entry.structure.faults,
        entry.structure.compartments,
        entry.structure.sheets,
        list(range(len(entry.rock.surfaces))),
        entry.rock.base_elevation,
    )
