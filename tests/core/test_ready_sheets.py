# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of ready meshes: divided along the faults by their triangles, and continued to the faults."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project, Rock, Surface
from realmodel.core.project.project_checks import check_project
from realmodel.core.structures.sheets.tips import on_fault
from realmodel.core.surfaces.rock_structure import FaultShape
from structure_cases import compartments_of, heights_at, plane_fault, prepared


def strip(x, height, n=10, y=(0.0, 10.0)):
    """A surface over columns of nodes at x (a list), n rows; height(x, y)."""
    x, rows = np.asarray(x, float), np.linspace(*y, n + 1)
    grid_x, grid_y = (each.ravel() for each in np.meshgrid(x, rows, indexing="ij"))
    first = (np.arange(len(x) - 1)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.column_stack([first, first + n + 1, first + n + 2])
    upper = np.column_stack([first, first + n + 2, first + 1])
    return np.column_stack([grid_x, grid_y, height(grid_x, grid_y)]), np.concatenate([lower, upper])


def together(*parts):
    begin = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    triangles = [triangles + first for (_, triangles), first in zip(parts, begin, strict=False)]
    return np.concatenate([vertices for vertices, _ in parts]), np.concatenate(triangles)


def made(mesh, *faults, **options):
    surface = Surface("S", *mesh, **options)
    (entry,) = prepared(Project("p", [Rock("r", [surface])], faults=list(faults)))
    return entry


def sheets_by_place(entry, *points):
    """The sheet of the only surface in the compartments of some points."""
    found = compartments_of(entry, points)
    return [entry.structure.sheets[number][0] for number in found]


def assert_single_valued(sheet, area):
    """Its triangles tile an area in plan."""
    vertices, triangles = sheet
    (ux, uy), (vx, vy) = ((vertices[triangles[:, k]] - vertices[triangles[:, 0]])[:, :2].T for k in (1, 2))
    assert (ux * vy - uy * vx).min() > 0 or (ux * vy - uy * vx).max() < 0
    assert np.abs(ux * vy - uy * vx).sum() / 2 == pytest.approx(area, rel=1e-9)


def grid_of(low, high, n=37):
    x, y = np.meshgrid(np.linspace(low, high, n), np.linspace(0.05, 9.93, n))
    return np.column_stack([x.ravel(), y.ravel()])


def beside_a_fault():
    """A mesh in two parts that end before the fault at x = 5."""
    return together(
        strip(np.arange(0, 4.1), lambda x, y: 0.1 * x), strip(np.arange(6, 10.1), lambda x, y: 0.1 * x - 1)
    )


def test_the_method_by_which_a_mesh_is_continued():
    fault = Fault("F", *plane_fault())
    heights = {}
    for method, options in ((None, {}), ("plane", {}), ("constant", {"value": 0.75})):
        entry = made(beside_a_fault(), fault, method=method, options=options)
        (west,) = sheets_by_place(entry, [1, 5, 0])
        heights[method, *options] = heights_at(np.array([[4.9, 5.0]]), *west)[0]
    assert heights[None,] == pytest.approx(0.4, abs=0.02)
    assert heights["plane",] == pytest.approx(0.49)
    assert heights["constant", "value"] == pytest.approx(0.4 + 0.45 * 0.35)  # 0.75 at x = 6


@pytest.mark.parametrize(
    ("method", "options", "says"),
    [
        (None, {"extrapolate": "none"}, "gives no elevations where the mesh is continued"),
        ("parallel", {"to": "S"}, "'to' names a surface; a mesh is continued from its own vertices"),
        ("dsi", {"above": "S"}, "'above' names a surface"),
        (None, {"neighbours": 4}, "'neighbours' belongs to kriging, not to natural_neighbour"),
    ],
)
def test_refused_continuations(method, options, says):
    surface = Surface("S", *beside_a_fault(), method=method, options=options)
    with pytest.raises(InputRefused, match=says):
        check_project(Project("p", [Rock("r", [surface])], faults=[Fault("F", *plane_fault())]))


def test_no_fault_near_leaves_the_mesh_as_it_is():
    mesh = strip(range(11), lambda x, y: 0.1 * x)
    entry = made(mesh, Fault("F", *plane_fault(x=14.0)))
    sheet = entry.structure.sheets[0][0]
    assert np.array_equal(sheet.vertices, mesh[0]) and np.array_equal(sheet.triangles, mesh[1])


@pytest.mark.parametrize("lean", [0.0, 0.8, -0.8])
def test_a_mesh_that_goes_through_the_fault(lean):
    """Each side has its own triangles and those that cross; beyond them it goes on from these."""
    mesh = strip(range(11), lambda x, y: np.where(x < 5.2, 0.0, 2.0) + 0.1 * y)
    shape = plane_fault(x=5.5, lean=lean)
    entry = made(mesh, Fault("F", *shape))
    left, right = sheets_by_place(entry, [-9, 5, 0], [19, 5, 0])
    for sheet in (left, right):
        assert np.array_equal(sheet.triangles, mesh[1])
        assert_single_valued(sheet, 100.0)
    plan = grid_of(0.0, 3.9)
    assert np.abs(heights_at(plan, *left) - 0.1 * plan[:, 1]).max() < 1e-9
    plan = grid_of(7.3, 10.0)
    assert np.abs(heights_at(plan, *right) - 2 - 0.1 * plan[:, 1]).max() < 1e-9


def test_parts_that_meet_at_a_vertical_fault():
    """Both have vertices on it; each continues the other's place with its own heights."""
    mesh = together(
        strip([0, 1, 2, 3, 4, 5], lambda x, y: 0.2 * x), strip([5, 6, 7, 8, 9, 10], lambda x, y: 3 + 0.2 * x)
    )
    entry = made(mesh, Fault("F", *plane_fault()))
    left, right = sheets_by_place(entry, [0, 5, 0], [9, 5, 0])
    for sheet, shift in ((left, 0.0), (right, 3.0)):
        assert_single_valued(sheet, 100.0)
        at = sheet.vertices[:, 0] == 5.0
        assert at.sum() == 22 and (sheet.vertices[at, 2] == 1.0 + shift).all()
    assert (
        np.abs(left.vertices[left.vertices[:, 0] > 5, 2] - 1.0).max() < 1e-9
    )  # nearest: level from the fault on
    assert np.abs(right.vertices[right.vertices[:, 0] < 5, 2] - 4.0).max() < 1e-9


def test_a_gap_at_a_normal_fault_is_covered():
    """The fault leans to the right by 0.5: the lower part ends farther to the right."""
    shape = plane_fault(x=5.0, lean=0.5)
    mesh = together(
        strip([0, 1, 2, 3, 4, 4.5], lambda x, y: 0 * x + 1),
        strip([6, 7, 8, 9, 10], lambda x, y: 0 * x - 2, n=7),
    )
    assert on_fault(mesh[0], FaultShape(*shape))[mesh[0][:, 0] == 4.5].all()
    entry = made(mesh, Fault("F", *shape))
    left, right = sheets_by_place(entry, [-9, 5, 0], [19, 5, 0])
    for sheet, height in ((left, 1.0), (right, -2.0)):
        assert_single_valued(sheet, 100.0)
        assert np.abs(sheet.vertices[:, 2] - height).max() < 1e-9
    assert compartments_of(entry, [[5.2, 5, 0.9]]) == compartments_of(entry, np.array([[9.0, 5, 0]]))


def test_parts_that_do_not_reach_the_fault():
    mesh = together(
        strip([0, 1, 2, 3, 4], lambda x, y: 0 * x), strip([6.5, 7, 8, 9, 10], lambda x, y: 0 * x + 2)
    )
    entry = made(mesh, Fault("F", *plane_fault()))
    left, right = sheets_by_place(entry, [0, 5, 0], [9, 5, 0])
    for sheet, height in ((left, 0.0), (right, 2.0)):
        assert_single_valued(sheet, 100.0)
        assert np.abs(sheet.vertices[:, 2] - height).max() < 1e-9


def test_parts_that_overlap_at_a_reverse_fault():
    """Both heights stand over one place in plan: each side gets its own part as it is."""
    shape = plane_fault(x=5.0, lean=-0.5)
    mesh = together(
        strip([0, 1, 2, 3, 4, 5, 5.5], lambda x, y: 0.01 * y + 1),
        strip([4, 5, 6, 7, 8, 9, 10], lambda x, y: 0 * x - 2),
    )
    entry = made(mesh, Fault("F", *shape))
    left, right = sheets_by_place(entry, [-9, 5, 0], [19, 5, 0])
    for sheet in (left, right):
        assert_single_valued(sheet, 100.0)
    plan = grid_of(0.1, 5.45)
    assert np.abs(heights_at(plan, *left) - 1 - 0.01 * plan[:, 1]).max() < 1e-9
    assert np.abs(heights_at(grid_of(4.05, 9.95), *right) + 2).max() < 1e-9
    plan = grid_of(5.55, 9.95)
    assert np.abs(heights_at(plan, *left) - 1 - 0.01 * plan[:, 1]).max() < 0.02
    corners = {tuple(map(tuple, left.vertices[triangle])) for triangle in left.triangles}
    assert {tuple(map(tuple, mesh[0][triangle])) for triangle in mesh[1][: 6 * 20]} <= corners


def test_a_scissor_fault():
    """A gap at one end that becomes an overlap at the other."""

    def height(shift):
        return lambda x, y: shift * (y - 5) / 5

    shape = plane_fault(x=5.0, lean=0.5)
    left, right = strip([0, 1, 2, 3, 4, 5], height(-1.0)), strip([5, 6, 7, 8, 9, 10], height(1.0))
    for vertices, _ in (left, right):
        at = vertices[:, 0] == 5.0
        vertices[at, 0] = 5.0 - 0.5 * vertices[at, 2]
    entry = made(together(left, right), Fault("F", *shape))
    for sheet, shift in zip(sheets_by_place(entry, [-9, 5, 0], [19, 5, 0]), (-1.0, 1.0), strict=True):
        assert_single_valued(sheet, 100.0)
        plan = sheet.vertices[:, :2]
        assert np.abs(sheet.vertices[:, 2] - height(shift)(*plan.T)).max() < 0.25  # the nearest vertex


def test_a_mesh_on_one_side_only():
    surface = Surface("S", *strip([0, 1, 2, 3, 4], lambda x, y: 0.3 * x))
    rock = Rock("r", [surface], region=np.array([[0, 0], [10, 0], [10, 10], [0, 10.0]]))
    (entry,) = prepared(Project("p", [rock], faults=[Fault("F", *plane_fault())]))
    one, other = entry.structure.sheets
    assert one[0] is other[0]
    assert any(
        "it has no triangles in compartment" in warning.text for _, warning in entry.structure.warnings
    )


def test_bays_of_the_outline_are_not_filled():
    """Where the fault leaves the mesh, the outline may bend inward. That is not a gap."""
    vertices, triangles = strip(range(11), lambda x, y: 0 * x)
    top = vertices[:, 1] == 10.0
    vertices[top, 1] -= 0.9 - 0.18 * np.abs(vertices[top, 0] - 5.0)
    entry = made((vertices, triangles), Fault("F", *plane_fault(x=5.0001)))
    for (sheet,) in entry.structure.sheets:
        assert_single_valued(sheet, 100.0 - 4.5)


def test_partial_coverage_stays():
    """Two islands, neither at the fault: nothing is added between an island and itself."""
    ring = together(strip([0, 1, 2], lambda x, y: 0 * x), strip([8, 9, 10], lambda x, y: 0 * x + 1))
    holed = ring[0], np.delete(ring[1], [3, 13], axis=0)
    entry = made(holed, Fault("F", *plane_fault(x=12.0)))
    assert_single_valued(entry.structure.sheets[0][0], 38.0 if len(holed[1]) == 76 else 39.0)


def test_the_method_of_the_surface_continues_it():
    mesh = together(
        strip([0, 1, 2, 3, 4, 5], lambda x, y: 0.2 * x), strip([5, 6, 7, 8, 9, 10], lambda x, y: 3 + 0.2 * x)
    )
    entry = made(mesh, Fault("F", *plane_fault()), method="plane")
    left, right = sheets_by_place(entry, [0, 5, 0], [9, 5, 0])
    assert np.abs(left.vertices[:, 2] - 0.2 * left.vertices[:, 0]).max() < 1e-9
    assert np.abs(right.vertices[:, 2] - 3 - 0.2 * right.vertices[:, 0]).max() < 1e-9


def test_a_slit_that_dies_out():
    """Open along the fault to its end at y = 6, where both sides share a vertex."""

    def throw(y):
        return np.sqrt(np.clip(6 - y, 0, None))

    vertices, triangles = strip(
        range(11), lambda x, y: np.where(x < 5, -1, 1) * throw(y) * np.exp(-np.abs(x - 5))
    )
    on = np.flatnonzero((vertices[:, 0] == 5) & (vertices[:, 1] < 6))
    vertices[vertices[:, 0] == 5, 2] *= -1
    copies = vertices[on] * [1, 1, -1]
    number = np.arange(len(vertices))
    number[on] = len(vertices) + np.arange(len(on))
    to_right = vertices[triangles, 0].max(axis=1) > 5
    triangles = np.where(to_right[:, None], number[triangles], triangles)
    vertices = np.concatenate([vertices, copies])
    shape = plane_fault(y=(-5.0, 6.0))
    entry = made((vertices, triangles), Fault("F", *shape, dies_out=True))
    left, right = sheets_by_place(entry, [0, 5, 0], [9, 5, 0])
    for sheet in (left, right):
        assert_single_valued(sheet, 100.0)
    beyond = (left.vertices[:, 1] >= 6) & (np.abs(left.vertices[:, 0] - 5) <= 1)
    assert beyond.sum() == 15 and np.array_equal(left.vertices[beyond, 2], right.vertices[beyond, 2])
    plan = grid_of(0.2, 3.9)
    assert np.abs(heights_at(plan, *left) - heights_at(plan, vertices, triangles)).max() < 1e-9
    plan = np.array([[5.0, y] for y in range(6)])
    assert np.allclose(heights_at(plan, *right) - heights_at(plan, *left), 2 * throw(plan[:, 1]))


def test_two_faults_and_a_branch():
    mesh = strip(range(11), lambda x, y: np.where(x < 5, 0.0, np.where(y < 5, 1.0, 2.0)))
    faults = [
        Fault("M", *plane_fault(x=4.5)),
        Fault("B", *plane_fault(turn=90.0, y=(4.5, 15.0)), ends_at=("M",)),
    ]
    faults[1].vertices[:, 1] -= 0.5
    entry = made(mesh, *faults)
    assert len(entry.structure.sheets) == 3
    places = [[1, 5, 0], [9, 1, 0], [9, 9, 0]]
    for sheet, height, place in zip(sheets_by_place(entry, *places), (0.0, 1.0, 2.0), places, strict=True):
        assert_single_valued(sheet, 100.0)
        assert heights_at(np.array([place[:2]], float), *sheet) == height
