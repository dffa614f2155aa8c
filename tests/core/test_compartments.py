# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of space that faults and bodies leave, the compartments of a rock mass, and where they reach."""

import numpy as np
import pytest
from realmodel.core import Body, Fault, InputRefused, Project, Rock, Surface
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import native_module, run
from realmodel.core.cells.joining import blocks_divided
from realmodel.core.cells.reach import PartExtents
from realmodel.core.structures.parts.parts import divide, structures_of
from realmodel.core.structures.shapes.reading import require_meeting
from realmodel.core.surfaces.rock_structure import fault_sides
from realmodel.core.validation.closed_form import BodyOfRock
from structure_cases import ball, plane_fault, prepared

BOX = np.array([[0.0, 0.0, -4.0], [10.0, 10.0, 4.0]])
LEVEL = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0.0]]), np.array([[0, 1, 2]])


def network(faults, bodies=()):
    project = Project("p", [Rock("r", [Surface("S", *LEVEL)])], faults=faults, bodies=list(bodies))
    return run(lambda work: divide(work, structures_of(project, faults, list(bodies)), BOX))


def listric():
    depth = np.linspace(-20.0, 20.0, 12)
    curve = np.column_stack([5 + 0.02 * (depth - 20) ** 2 - 8, np.zeros(12), depth])
    k = np.arange(11)
    triangles = np.concatenate(
        [np.column_stack([k, k + 1, k + 12]), np.column_stack([k + 12, k + 1, k + 13])]
    )
    return np.concatenate([curve - np.array([0, 5, 0]), curve + np.array([0, 15, 0])]), triangles


NETWORKS = {
    "one": [Fault("F", *plane_fault(lean=0.4))],
    "outside": [Fault("F", *plane_fault(x=40.0))],
    "crossing": [Fault("F", *plane_fault()), Fault("G", *plane_fault(turn=70.0, lean=-0.3))],
    "parallel": [Fault("F", *plane_fault(x=3.0)), Fault("G", *plane_fault(x=7.0, lean=0.2))],
    "near": [Fault("F", *plane_fault()), Fault("G", *plane_fault(x=5.1))],
    "branch": [
        Fault("M", *plane_fault()),
        Fault("B", *plane_fault(turn=90.0, y=(2.0, 15.0)), ends_at=("M",)),
    ],
    "branch first": [
        Fault("B", *plane_fault(turn=90.0, y=(2.0, 15.0)), ends_at=("M",)),
        Fault("M", *plane_fault()),
    ],
    "listric": [Fault("L", *listric())],
    "dies out": [Fault("D", *plane_fault(y=(-5.0, 6.0)), dies_out=True)],
}


def sides_at(structures, points):
    """(N, S) sides of points, branches dropped."""
    shapes = structures.fault_shapes()
    columns = [run(lambda work, shape=shape: fault_sides(work, points, shape)) for shape in shapes]
    sides = np.column_stack(columns)
    faults = structures.of_rock(0)
    sides = faults.without_dropped(sides)
    bodies = [BodyOfRock((body.vertices, body.triangles), 0, 0) for body in structures.bodies]
    inside = [np.where(run(lambda work, b=b: b.holds(work, points)), -1, 1) for b in bodies]
    return np.column_stack([sides, *inside]).astype(np.int8)


@pytest.mark.parametrize("name", NETWORKS)
def test_every_point_is_in_a_part_and_within_its_reach(name):
    structures = network(NETWORKS[name], [Body("B", *ball([5, 4, 0], 1.7))])
    points = np.random.default_rng(1).uniform(*BOX, (4000, 3))
    rows = sides_at(structures, points)
    reach = run(lambda work: PartExtents(work, structures))
    sheet = np.array([[x, y, 0] for x in np.linspace(0, 10, 41) for y in np.linspace(0, 10, 41)])
    k = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    squares = np.concatenate([np.column_stack([k, k + 41, k + 42]), np.column_stack([k, k + 42, k + 1])])
    seen = np.zeros(len(points), bool)
    for part, row in enumerate(structures.sides):
        own = (rows == row).all(axis=1)
        seen |= own
        space = reach.cells_of(part)
        assert space[tuple(((points[own] - reach.low) // reach.step).astype(int).T)].all()
        over = reach.over(space.any(axis=2), Sheet(sheet, squares))
        x, y = np.clip((points[own, :2] * 4).astype(int), 0, 39).T
        at = x * 40 + y
        assert over[at].all() and over[at + 1600].all()
        assert own.any() or name == "near"
        # the region for it has all of these points, and nothing that the sheet would not be kept over
        plan, triangles = reach.around(space.any(axis=2))
        level = np.column_stack([plan, np.zeros(len(plan))])
        inside = np.isfinite(native_module().surface_heights(level, triangles, points[:, :2].copy()))
        assert inside[own].all()
        x, y = np.clip((points[inside, :2] * 4).astype(int), 0, 39).T
        assert (over[x * 40 + y] | over[x * 40 + y + 1600]).all()
    assert seen.all()


def test_a_part_reaches_no_farther_than_it_must():
    structures = network(NETWORKS["parallel"])
    reach = run(lambda work: PartExtents(work, structures))
    shares = sorted(reach.cells_of(part).any(axis=2).mean() for part in range(len(structures.sides)))
    assert len(shares) == 3 and sum(shares) < 1.3


def test_kept_sides_of_branches():
    for name in ("branch", "branch first"):
        structures = network(NETWORKS[name])
        faults = structures.of_rock(0)
        branch = faults.names.index("B")
        ((other, side),) = faults.ends[branch]
        assert faults.names[other] == "M"
        far = faults.without_dropped(np.array([[1, 1]], np.int8) * -side)
        assert far[0, branch] == 0


def test_the_larger_part_of_the_area_remains():
    """Of a branch that crosses: by its area, not by the number of its triangles."""
    x = np.array([-10.0, 4.9, 4.95, 4.99, 5.2, 5.4, 5.6, 5.8, 6.0, 7.0])
    vertices = np.array([[at, 5.0, z] for at in x for z in (-20.0, 20.0)])
    k = 2 * np.arange(len(x) - 1)
    triangles = np.concatenate([np.column_stack([k, k + 1, k + 2]), np.column_stack([k + 2, k + 1, k + 3])])
    structures = network([Fault("M", *plane_fault()), Fault("B", vertices, triangles, ends_at=("M",))])
    side = sides_at(structures, np.array([[0.0, 3, 0], [9, 3, 0]]))
    assert side[0, 1] != 0 and side[1, 1] == 0


def test_a_branch_that_is_cut_into_halves_is_refused():
    vertices = np.array([[at, 5.0, z] for at in (-10.0, 20.0) for z in (-20.0, 20.0)])
    branch = Fault("B", vertices, np.array([[0, 1, 2], [2, 1, 3]]), ends_at=("M",))
    with pytest.raises(
        InputRefused, match=r"fault 'B': fault 'M', at which it ends, cuts it into two halves.*make it longer"
    ):
        network([Fault("M", *plane_fault()), branch])


def test_a_branch_that_meets_nothing_is_refused():
    far = Fault("B", *plane_fault(turn=90.0, y=(6.5, 15.0)), ends_at=("M",))
    main = Fault("M", *plane_fault())
    with pytest.raises(
        InputRefused, match=r"fault 'B': it ends at fault 'M', but does not meet it.* is 1\.5 at"
    ):
        require_meeting(far, [main])
    touching = Fault("B", *plane_fault(turn=90.0, y=(5.0, 15.0)), ends_at=("M",))
    require_meeting(touching, [main])
    touching.vertices[:, 0] += 1e-7  # as a file with few digits has it
    require_meeting(touching, [main])


def test_what_acts():
    """By time: a fault on what it displaces and on bodies before it, a body on what is older than it."""
    surfaces = [Surface(f"S{k}", LEVEL[0] + np.array([0, 0, k]), LEVEL[1]) for k in range(4)]
    faults = [Fault("F", *plane_fault(), youngest="S1"), Fault("G", *plane_fault(turn=90.0))]
    bodies = [Body("late", *ball([5, 5, 0], 2), after="S2"), Body("early", *ball([5, 5, 0], 2), after="S0")]
    project = Project("p", [Rock("r", surfaces)], faults=faults, bodies=bodies)
    inputs = prepared(project)
    found = blocks_divided(inputs, structures_of(project, faults, bodies))
    #                             S0 S1 S2 S3  F  G  late early
    assert found[0].tolist() == [1, 1, 0, 0, 0, 0, 0, 1]
    assert found[1].tolist() == [1, 1, 1, 1, 0, 0, 1, 1]
    assert found[2].tolist() == [1, 1, 1, 0, 0, 0, 1, 1]
    assert found[3].tolist() == [1, 0, 0, 0, 0, 0, 0, 1]
