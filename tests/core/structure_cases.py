# SPDX-License-Identifier: GPL-3.0-or-later
"""Small faults, surfaces and rock masses for the tests of structures."""

from collections import Counter

import numpy as np
import pytest
from realmodel.core.base.mapped_arrays import unchanged
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import native_module, run
from realmodel.core.structures.setup import make_structures, mesh_inputs, read_inputs
from realmodel.core.surfaces import wrong_sides
from realmodel.core.validation.closed_form import ClosedForm


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
    return with_structures(project, threads, joins=True)[0]


def with_structures(project, threads=1, keep=unchanged, joins=False):
    """The rock masses (RockInput) of a project with their sheets, and its structures."""

    def task(work):
        inputs, with_arrays = read_inputs(work, project)
        mesh_inputs(work, inputs, keep)
        structures = make_structures(work, with_arrays, inputs, None, joins, keep)
        return inputs, structures

    return run(task, threads=threads)


def heights_at(plan, vertices, triangles):
    """(N,) heights of a surface at plan points (N, 2)."""
    return run(lambda work: wrong_sides.heights_at(work, Sheet(vertices, triangles), plan))


def cells_at(model, points):
    """(N,) the cell of a model that each point lies in, -1 for none."""
    return native_module().cells_at(model.native(), points)


def blocks_at(closed, points):
    """ClosedForm.blocks_at."""
    return run(lambda work: closed.blocks_at(work, points))


def compartments_of(entry, points):
    """ClosedForm.compartments_of, of a RockInput that `prepared` returned."""
    return run(lambda work: closed_form_of(entry).compartments_of(work, np.asarray(points, float)))


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


def box_body(low, high):
    """A closed box."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    triangles = [
        *([0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]),
        *([2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]),
    ]
    return np.asarray(low) + corners * (np.asarray(high, float) - low), np.array(triangles, np.int32)


def ball(center, radius, n=9):
    """A closed surface of some hundred triangles in the shape of a ball."""
    up, around = np.linspace(-np.pi / 2, np.pi / 2, n + 1)[1:-1], 2 * np.arange(2 * n) * np.pi / (2 * n) + 0.1
    rings = [[np.cos(a) * np.cos(t), np.cos(a) * np.sin(t), np.sin(a)] for a in up for t in around]
    vertices = np.array([[0, 0, -1.0], *rings, [0, 0, 1.0]])
    k, turn, last = np.arange(2 * n), np.roll(np.arange(2 * n), -1), len(vertices) - 1
    triangles = [np.column_stack([0 * k, 1 + turn, 1 + k])]
    for row in range(n - 2):
        low, high = 1 + row * 2 * n, 1 + (row + 1) * 2 * n
        triangles += [np.column_stack([low + k, low + turn, high + k])]
        triangles += [np.column_stack([low + turn, high + turn, high + k])]
    triangles.append(np.column_stack([last - 2 * n + k, last - 2 * n + turn, last + 0 * k]))
    return np.asarray(center) + radius * vertices, np.concatenate(triangles).astype(np.int32)


def assert_areas_of_faces(model):
    """The areas of each juxtaposition diagram are those of the model's faces on the fault, summed by
    themselves, without sides."""
    size = np.ptp(model.vertices, axis=0).max()
    for number, surface in enumerate(np.flatnonzero(model.surface_kind == 1)):
        sums = Counter()
        for face in np.flatnonzero(model.face_surface == surface).tolist():
            corners = model.vertices[model.face_vertices[slice(*model.face_offsets[face : face + 2])]]
            cells = model.face_cells[face].tolist()
            pair = frozenset(
                model.blocks[model.cell_block[cell]].name if cell >= 0 else None for cell in cells
            )
            spokes = corners[1:] - corners[0]
            sums[pair] += np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0)) / 2
        if not sums:
            continue
        areas = Counter()
        for pair, area in model.juxtaposition(number).areas.items():
            areas[frozenset(pair)] += area
        assert areas == pytest.approx(sums, rel=1e-11, abs=1e-12 * size**2)
