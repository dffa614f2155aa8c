# SPDX-License-Identifier: GPL-3.0-or-later
"""Logged intervals and observations beside faults, and in bodies."""

from itertools import pairwise

import numpy as np
from realmodel.core import Body, Fault, Observations, Project, Rock, Surface, build
from structure_cases import SQUARE, plane_fault


def level_logs(places, throws, tops=(6.0, 4.0)):
    """Intervals of vertical holes through level surfaces that are lower by the throw at each place."""
    rows = []
    for number, ((x, y), throw) in enumerate(zip(places, throws, strict=True)):
        heights = [9.0, *(top - throw for top in tops), 0.0]
        for block, ends in zip(("S2", "S1", "S0"), pairwise(heights), strict=True):
            rows += [(f"B{number}", (x, y), 9.0 - z, z, block) for z in ends]
    return Observations(
        [[x, y, z] for _, (x, y), _, z, _ in rows],
        [block for *_, block in rows],
        [hole for hole, *_ in rows],
        [depth for _, _, depth, _, _ in rows],
    )


def faulted(seen, fault, bodies=()):
    surfaces = [Surface(name, method="tin") for name in ("S0", "S1")]
    surfaces.append(Surface("S2", points=[[1, 1, 9], [1, 9, 9], [9, 5, 9]], method="tin"))
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-3.0, observations=seen)
    return build(Project("p", [rock], faults=[fault], bodies=list(bodies)))


def test_contacts_and_bounds_among_faults():
    """West of a vertical fault holes find the surfaces 2 higher than east of it."""
    places = [(1, 1), (1, 9), (3, 5), (7, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 2, 2, 2])
    model = faulted(seen, Fault("F", *plane_fault(), youngest="S1"))
    data = model.rock_inputs[0].data
    assert len(data[0].contacts) == len(data[1].contacts) == 6
    found = model.observed()
    assert all(abs(each.residual) < 1e-9 for each in found.contacts)
    assert [each.share for each in found.blocks] == [1.0, 1.0, 1.0]
    assert not found.violated and not found.left_out


def test_a_sheet_without_points_keeps_the_bounds_of_its_compartment():
    """East of the fault holes end in the middle block, above where its base goes on from the west."""
    places = [(1, 1), (1, 9), (3, 5), (7, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 2, 2, 2])
    east = seen.places[:, 0] > 5
    seen = seen.some(~(east & (seen.blocks == "S0")))
    deep = seen.places[:, 2] == 2.0  # the lower top, less the throw: the holes go on to 1 in the same block
    seen.places[deep, 2] = 1.0
    model = faulted(seen, Fault("F", *plane_fault(), youngest="S1"))
    assert len(model.rock_inputs[0].data[0].contacts) == 3
    found = model.observed()
    assert [each.share for each in found.blocks] == [1.0, 1.0, 1.0]
    assert not found.violated


def test_a_bound_beside_a_fault_is_looked_at_on_its_side():
    """One west of it is as high as those east of it."""
    x, y = (each.ravel() for each in np.meshgrid([0.5, 2, 3.5, 6.5, 8, 9.5], np.linspace(0, 10, 6)))
    points = np.column_stack([x, y, np.where(x < 5, 0.0, 5.0)])
    seen = Observations(np.vstack([points, [4.99, 5, 4.8]]) + np.array([0, 0, 0.1]), ["S1"] * 37)
    surfaces = [Surface("S0", points=points, method="tin"), Surface("S1", points=points + 9.0, method="tin")]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-9.0, observations=seen)
    found = build(Project("p", [rock], faults=[Fault("F", *plane_fault())])).observed()
    assert found.share == 1.0 and not found.violated


def hole_b6(ends):
    """The intervals (top, bottom, block) of a vertical hole at (5.5, 5), from z = 9 down."""
    rows = [(z, block) for top, bottom, block in ends for z in (top, bottom)]
    places = [[5.5, 5.0, z] for z, _ in rows]
    return Observations(places, [block for _, block in rows], ["B6"] * len(rows), [9 - z for z, _ in rows])


def test_where_a_hole_passes_a_fault_no_surface_is_known_to_be():
    """Hole B6 passes an inclined normal fault at z = 5, and the younger block again below it."""
    places = [(1, 1), (1, 9), (2, 5), (8, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 2, 2, 2])
    ends = [(9, 6, "S2"), (6, 5, "S1"), (5, 4, "S2"), (4, 2, "S1"), (2, 0, "S0")]
    hole = hole_b6(ends)
    fault = Fault("F", *plane_fault(lean=-0.1), youngest="S1")
    model = faulted(Observations.joined([seen, hole]), fault)
    data = model.rock_inputs[0].data
    there = [[z for x, _, z in each.contacts.tolist() if x == 5.5] for each in data]
    assert there == [[2.0], [6.0, 4.0], []]
    found = model.observed()
    assert not found.left_out and not found.violated
    assert [each.share for each in found.blocks] == [1.0, 1.0, 1.0]
    # without the fault the order is wrong
    rock = model.project.rocks[0]
    assert build(Project("p", [rock])).observed().left_out


def test_what_lies_between_a_fault_and_the_end_of_an_interval_is_listed():
    """Hole B6 passes the fault at z = 5.0, a little below where block S1 begins: it may be the fault that
    divides S2 and S1, and the part of S1 between the two says nothing. All else holds, to the fault."""
    places = [(1, 1), (1, 9), (2, 5), (8, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 2, 2, 2])
    ends = [(9, 5.1, "S2"), (5.1, 2, "S1"), (2, 0, "S0")]
    hole = hole_b6(ends)
    fault = Fault("F", *plane_fault(lean=-0.1), youngest="S1")
    model = faulted(Observations.joined([seen, hole]), fault)
    found = model.observed()
    assert [(each.kind, each.hole, each.block) for _, each in found.left_out] == [("at_fault", "B6", "S1")]
    assert np.isclose(found.left_out[0][1].depth, 3.9)
    S1 = model.rock_inputs[0].data[1]
    assert 5.5 not in S1.contacts[:, 0]
    there = S1.bounds.some(S1.bounds.places[:, 0] == 5.5)
    heights = sorted(there.places[:, 2].tolist())
    assert np.allclose(heights, [5.0, 5.1], atol=1e-5), "below the fault from it on, above it to the end"
    assert [warning.kind for warning in model.warnings if "beside a fault" in warning.text] == ["at_fault"]


def test_an_interval_holds_on_both_sides_of_a_fault_that_it_passes():
    """West of the fault the hole comes below the base of its block, which its end east of it does not say."""
    places = [(1, 1), (1, 9), (3, 9), (8, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 2, 2, 2])
    hole = Observations([[4, 5, 5.0], [5.2, 5, 2.2]], ["S1", "S1"], ["B6"] * 2, [0.0, 3.0])
    model = faulted(Observations.joined([seen, hole]), Fault("F", *plane_fault(), youngest="S1"))
    found = model.observed()
    assert [each.share for each in found.blocks] == [1.0, 1.0, 1.0]
    assert not found.violated and not found.left_out
    bounds = model.rock_inputs[0].data[0].bounds
    near = bounds.places[np.abs(bounds.places[:, 0] - 5.0) < 1e-5]
    assert sorted(near[:, 0] > 5.0) == [False, True] and np.allclose(near[:, 2], 5.0 - 2.8 / 1.2, atol=1e-5)


def test_contacts_beside_a_fault_stay_on_their_side():
    """A contact that fits the surface across the fault, as a point of a horizon there would."""
    places = [(1, 1), (1, 9), (3, 5), (5.1, 5), (7, 5), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 0, 2, 2, 2])
    model = faulted(seen, Fault("F", *plane_fault(), youngest="S1"))
    found = model.observed()
    assert all(abs(each.residual) < 1e-9 for each in found.contacts)
    assert [each.share for each in found.blocks] == [1.0, 1.0, 1.0]
    assert not found.left_out


def test_observations_in_bodies():
    places = [(1, 1), (1, 9), (9, 1), (9, 9)]
    seen = level_logs(places, [0, 0, 0, 0])
    corners = np.array([[x, y, z] for z in (2.0, 5.0) for y in (4.0, 6.0) for x in (6.0, 8.0)])
    box = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    box = np.concatenate([box[:, [0, 1, 2]], box[:, [0, 2, 3]]]).astype(np.int32)
    more = Observations([[7, 5, 3], [7, 5, 4], [2, 5, 3], [2, 5, 4.5]], ["ore", "S0", "ore", "S1"])
    body = Body("ore", corners, box)
    surfaces = [Surface(name, method="tin") for name in ("S0", "S1")]
    surfaces.append(Surface("S2", points=[[1, 1, 9], [1, 9, 9], [9, 5, 9]], method="tin"))
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-3.0)
    rock.observations = Observations.joined([seen, more])
    model = build(Project("p", [rock], bodies=[body]))
    found = model.observed()
    assert [(each.kind, each.block, each.place) for _, each in found.left_out] == [
        ("in_body", "ore", (2.0, 5.0, 3.0)),
        ("in_body", "S0", (7.0, 5.0, 4.0)),
    ]
    assert {each.block: (each.observations, each.share) for each in found.blocks}["ore"] == (1, 1.0)
    (said,) = [warning.text for warning in model.warnings if warning.kind == "in_body"]
    assert "(7, 5, 4)" in said
