# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of surfaces that are interpolated from points in compartments."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project, Rock, Surface
from realmodel.core.base.work import run
from realmodel.core.surfaces.rock_structure import FaultShape, fault_sides, joined
from structure_cases import (
    SQUARE,
    blocks_at,
    closed_form_of,
    compartments_of,
    heights_at,
    plane_fault,
    prepared,
)


def side_of(shape, *points):
    return run(lambda work: fault_sides(work, np.array(points, float), shape))


def points_of(height, seed=1, count=300):
    plan = np.random.default_rng(seed).uniform(0.0, 10.0, (count, 2))
    return np.column_stack([plan, height(*plan.T)])


def rock(*surfaces, edge_length=1.0, **more):
    return Rock("r", list(surfaces), region=SQUARE, edge_length=edge_length, **more)


def by_side(entry, surface, fault=0):
    """The sheet of a surface on the sides -1 and +1 of a fault."""
    structure = entry.structure
    return {
        int(row[fault]): sheets[surface]
        for row, sheets in zip(structure.compartments, structure.sheets, strict=True)
    }


@pytest.mark.parametrize("lean", [0.0, 0.5, -0.5])
def test_points_count_in_their_compartment(lean):
    """Throw 2 at a plane that may be vertical, normal or reverse; each sheet is its own plane everywhere."""
    fault = Fault("F", *plane_fault(lean=lean))
    shape = FaultShape(*fault.triangulation())
    left = int(side_of(shape, [-9, 5, 0])[0])
    low, high = points_of(lambda x, y: 0.1 * x - 1.0), points_of(lambda x, y: 0.1 * x + 1.0, 2)
    points = np.concatenate([low[side_of(shape, *low) == left], high[side_of(shape, *high) != left]])
    surface = Surface("S", points=points, method="universal_kriging", property=1)
    (entry,) = prepared(Project("p", [rock(surface)], faults=[fault]))
    sheets = by_side(entry, 0)
    left = int(side_of(entry.structure.faults.shapes[0], [-9, 5, 0])[0])
    for side, shift in ((left, -1.0), (-left, 1.0)):
        vertices, triangles = sheets[side]
        assert np.array_equal(triangles, entry.region.triangles)
        assert np.abs(vertices[:, 2] - 0.1 * vertices[:, 0] - shift).max() < 1e-6
    assert np.array_equal(entry.surfaces[0].vertices, joined(entry.structure.distinct(0)).vertices)
    assert len(entry.attributes[0]["distance"]) == len(entry.surfaces[0].vertices)
    assert entry.interpolations[0].method == "universal_kriging"


def test_younger_surfaces_ignore_the_fault():
    shape = plane_fault()
    surfaces = [
        Surface("S0", points=points_of(lambda x, y: np.where(x < 5, -2.0, 0.0))),
        Surface("S1", points=points_of(lambda x, y: np.where(x < 5, -1.0, 1.0), 2)),
        Surface("S2", points=points_of(lambda x, y: 3 + 0.1 * x, 3)),
    ]
    (entry,) = prepared(Project("p", [rock(*surfaces)], faults=[Fault("F", *shape, youngest="S1")]))
    one, other = entry.structure.sheets
    assert one[2] is other[2] and one[1] is not other[1]
    assert entry.surfaces[2] is one[2]
    closed = closed_form_of(entry)
    points = np.array([[x, 5.1, z] for x in (2, 8) for z in (-3, -1.5, -0.5, 0.5, 2)])
    assert blocks_at(closed, points).tolist() == [-1, 1, 2, 2, 2, -1, -1, -1, 1, 2]


def test_a_compartment_without_points_goes_on_as_its_neighbor():
    shapes = [plane_fault(x=3.0), plane_fault(x=7.0)]
    points = points_of(lambda x, y: np.where(x > 7, 5.0, 1.0))
    points = points[(points[:, 0] < 3) | (points[:, 0] > 7)]
    points = points[(points[:, 0] < 3) | (np.arange(len(points)) % 3 == 0)]  # fewer on the right
    project = Project(
        "p",
        [rock(Surface("S", points=points))],
        faults=[Fault(n, *s) for n, s in zip("FG", shapes, strict=True)],
    )
    (entry,) = prepared(project)
    middle = int(compartments_of(entry, [[5.0, 5, 0]])[0])
    left = int(compartments_of(entry, [[1.0, 5, 0]])[0])
    assert entry.structure.sheets[middle][0] is entry.structure.sheets[left][0]
    warnings = [text.text for members, text in entry.structure.warnings if middle in members]
    assert len(warnings) == 1 and warnings[0].startswith(
        f"it has no points in compartment '{entry.structure.names[middle]}'"
    )


def test_points_that_lie_in_no_compartment():
    """All beyond a fault that passes the region by."""
    points = points_of(lambda x, y: 0 * x) + np.array([20.0, 0, 0])
    project = Project("p", [rock(Surface("S", points=points))], faults=[Fault("F", *plane_fault(x=15.0))])
    with pytest.raises(InputRefused, match="rock 'r', surface 'S': its points lie in no compartment"):
        prepared(project)


def test_a_method_without_points_needs_none():
    surfaces = [Surface("S", method="constant", options={"value": 2.0})]
    surfaces.append(Surface("P", method="parallel", options={"to": "S", "thickness": 1.5}))
    (entry,) = prepared(Project("p", [rock(*surfaces)], faults=[Fault("F", *plane_fault())]))
    for sheets in entry.structure.sheets:
        assert (sheets[0].vertices[:, 2] == 2.0).all() and (sheets[1].vertices[:, 2] == 3.5).all()


def test_surfaces_made_from_others_in_their_compartment():
    """Parallel to a displaced surface: displaced with it. With a minimum thickness: above its own side."""
    lower = Surface("S0", points=points_of(lambda x, y: np.where(x < 5, -2.0, 2.0)))
    parallel = Surface("S1", method="parallel", options={"to": "S0", "thickness": 1.0})
    thick = Surface("S2", points=points_of(lambda x, y: np.full(len(x), 0.5)), minimum_thickness=0.25)
    (entry,) = prepared(Project("p", [rock(lower, parallel, thick)], faults=[Fault("F", *plane_fault())]))
    for sheets in entry.structure.sheets:
        bottom, middle, top = (sheet.vertices[:, 2] for sheet in sheets)
        assert np.allclose(middle, bottom + 1.0)
        assert np.allclose(top, np.maximum(0.5, middle + 0.25))
    assert any("stay 0.25 above 'S1'" in warning.text for _, warning in entry.structure.warnings)


def test_a_younger_surface_parallel_to_a_displaced_one():
    """It takes the height of the side on which each node is."""
    lower = Surface("S0", points=points_of(lambda x, y: np.where(x < 5, -2.0, 2.0)))
    upper = Surface("S1", method="parallel", options={"to": "S0", "thickness": 4.0})
    faults = [Fault("F", *plane_fault(), youngest="S0")]
    (entry,) = prepared(Project("p", [rock(lower, upper)], faults=faults))
    vertices, _ = entry.structure.sheets[0][1]
    assert np.allclose(vertices[:, 2], np.where(vertices[:, 0] < 5, 2.0, 6.0))


def test_same_sheets_for_any_number_of_threads():
    surface = Surface("S", points=points_of(lambda x, y: np.where(x < 5, np.sin(x), 3 + y / 9)))
    project = Project("p", [rock(surface)], faults=[Fault("F", *plane_fault(lean=0.3))])
    first, second = (prepared(project, threads)[0] for threads in (1, 2))
    assert np.array_equal(first.surfaces[0].vertices, second.surfaces[0].vertices)


# ---- faults that die out


def dying_height(x, y):
    """A displacement of up to 1 on either side of x = 5, vanishing at y = 6."""
    throw = np.sqrt(np.clip(6.0 - y, 0.0, None) / 6.0) * np.exp(-np.abs(x - 5.0) / 4.0)
    return np.where(x < 5, -throw, throw)


def beyond(sheet, tip):
    """The nodes of triangles through which the fault x = 5 would go on beyond y = tip."""
    nodes, triangles = sheet
    found = set()
    for triangle in triangles:
        for a, b in (triangle[:2], triangle[1:], triangle[::2]):
            x, y = nodes[[a, b], 0] - 5, nodes[[a, b], 1]
            if x[0] * x[1] < 0 and y[0] + (y[1] - y[0]) * x[0] / (x[0] - x[1]) > tip:
                found.update(triangle.tolist())
    return sorted(found)


@pytest.mark.parametrize("method", ["kriging", "dsi", "natural_neighbour"])
def test_a_fault_that_dies_out(method):
    shape = plane_fault(y=(-5.0, 6.0))
    surface = Surface("S", points=points_of(dying_height, count=1500), method=method)
    project = Project("p", [rock(surface, edge_length=0.4)], faults=[Fault("F", *shape, dies_out=True)])
    (entry,) = prepared(project)
    sheets = by_side(entry, 0)
    equal = beyond(sheets[1], 6.0)
    assert len(equal) > 10
    assert np.array_equal(sheets[-1].vertices[equal, 2], sheets[1].vertices[equal, 2])
    shape = entry.structure.faults.shapes[0]
    left = int(side_of(shape, [0, 1, 0])[0])
    plan = np.array([[4.95, y] for y in (0.5, 1.0, 2.0, 3.0)])
    low, high = heights_at(plan, *sheets[left]), heights_at(plan, *sheets[-left])
    throw = 2 * np.sqrt((6 - plan[:, 1]) / 6)
    assert np.abs(high - low - throw).max() < 0.15
    for side, sheet in sheets.items():
        own = (side_of(shape, *surface.points) == side) & (
            np.hypot(*(surface.points[:, :2] - [5, 6]).T) > 2.5
        )
        error = heights_at(surface.points[own, :2], *sheet) - surface.points[own, 2]
        assert np.abs(error).max() < 0.2 and np.sqrt(np.mean(error**2)) < 0.02


def test_a_fault_that_dies_out_upward_does_not_displace_what_is_above():
    shape = plane_fault(z=(-20.0, 0.5))
    surfaces = [
        Surface("S0", points=points_of(lambda x, y: np.where(x < 5, -1.2, -0.8), count=800)),
        Surface("S1", points=points_of(lambda x, y: 2 + 0.05 * x, 2)),
    ]
    project = Project("p", [rock(*surfaces)], faults=[Fault("F", *shape, dies_out=True)])
    (entry,) = prepared(project)
    one, other = entry.structure.sheets
    assert one[1] is other[1] and one[0] is not other[0]


def test_a_fault_that_dies_out_between_others():
    """It ends at a fault on one side, where it does displace, and dies out on the other."""
    main, short = plane_fault(x=2.0), plane_fault(turn=90.0, y=(-20.0, 15.0))
    short[0][:, 0] = np.clip(short[0][:, 0], 2.0, 7.0)

    def height(x, y):
        throw = np.sqrt(np.clip(7.0 - x, 0, None) / 5.0) * np.exp(-np.abs(y - 5) / 4)
        return np.where(x < 2, 0.0, np.where(y > 5, throw, -throw))

    surface = Surface("S", points=points_of(height, count=1500))
    faults = [Fault("M", *main), Fault("B", *short, ends_at=("M",), dies_out=True)]
    (entry,) = prepared(Project("p", [rock(surface, edge_length=0.4)], faults=faults))
    rows, sheets = entry.structure.compartments, [each[0] for each in entry.structure.sheets]
    assert len(rows) == 3
    one, other = (sheets[n] for n in np.flatnonzero(rows[:, 1]))
    plan = np.array([[2.1, 5.0], [3.0, 5.0]])
    assert (np.abs(heights_at(plan, *one) - heights_at(plan, *other)) > 1.2).all()
    corners = one.corners
    met = (corners[:, :, 1] <= 5).any(axis=1) & (corners[:, :, 1] >= 5).any(axis=1)
    far = one.triangles[met & (corners[:, :, 0] > 7.5).all(axis=1)]
    assert len(far) > 3 and np.array_equal(one.vertices[far, 2], other.vertices[far, 2])


def test_points_on_both_sides_of_a_fault_that_dies_out_at_one_position_in_plan():
    """A reverse fault: each position has a point on either side, and beyond the tip one point."""
    shape = plane_fault(lean=-1.0, y=(-5.0, 6.0))
    plan = np.random.default_rng(3).uniform(0.0, 10.0, (600, 2))
    both = np.abs(plan[:, 0] - 5) < 0.5 * np.sqrt(np.clip(6.0 - plan[:, 1], 0, None) / 6.0)
    points = np.concatenate(
        [
            np.column_stack([plan, dying_height(*plan.T)]),
            np.column_stack([plan[both], -dying_height(*plan[both].T)]),
        ]
    )
    assert both.sum() > 20
    surface = Surface("S", points=points)
    project = Project("p", [rock(surface, edge_length=0.4)], faults=[Fault("F", *shape, dies_out=True)])
    (entry,) = prepared(project)
    low, high = entry.structure.sheets[0][0], entry.structure.sheets[1][0]
    apart = np.abs(heights_at(np.array([[5.0, 1.0]]), *high) - heights_at(np.array([[5.0, 1.0]]), *low))
    assert 1.4 < apart[0] < 2.2
    far = low.vertices[:, 1] > 7.0
    assert np.array_equal(
        low.vertices[far & (np.abs(low.vertices[:, 0] - 5) < 0.2), 2],
        high.vertices[far & (np.abs(low.vertices[:, 0] - 5) < 0.2), 2],
    )


def test_picks_that_reach_beyond_a_fault_contradict_those_of_the_other_side():
    """Of two points above one another, the one that fits the other side is left out with a warning, or taken
    for that side, where it is near the fault."""
    shape = plane_fault()
    points = points_of(lambda x, y: np.where(x < 5, -1.0, 1.0))
    wrong = points[(points[:, 0] > 5) & (points[:, 0] < 5.5)] * [1, 1, -1]
    assert len(wrong) > 5
    surface = Surface("S", points=np.concatenate([points, wrong]))
    (entry,) = prepared(Project("p", [rock(surface)], faults=[Fault("F", *shape)]))
    for sheet in by_side(entry, 0).values():
        assert np.ptp(sheet.vertices[:, 2]) < 1e-6
    texts = [warning.text for _, warning in entry.structure.warnings]
    (left_out,) = (int(text.split()[0]) for text in texts if "left out" in text)
    (placed,) = (int(text.split()[0]) for text in texts if "just beyond" in text)  # so near the fault
    assert placed > 0 and left_out + placed == len(wrong)


def test_many_faults_that_die_out_take_no_sheet_for_each_combination_of_sides():
    """Twelve of them one beside another: 4096 combinations, of which few are there."""
    faults = []
    for number in range(12):
        shape = plane_fault(x=number * 0.8 + 0.6, y=(-5.0, 2.0 + number % 3))
        faults.append(Fault(f"F{number}", *shape, dies_out=True))
    surface = Surface("S", points=points_of(lambda x, y: 0.1 * x), method="plane")
    (entry,) = prepared(Project("p", [rock(surface)], faults=faults))
    assert 12 < len(entry.structure.compartments) < 100
    assert np.abs(joined(entry.structure.distinct(0)).vertices @ [0.1, 0, -1.0]).max() < 1e-9
