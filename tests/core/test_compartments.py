# SPDX-License-Identifier: GPL-3.0-or-later
"""The compartments that faults leave."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project, Rock, Surface
from realmodel.core.structures.branches import faults_of_rock
from realmodel.core.structures.compartments import compartment_names, compartments
from realmodel.core.structures.sides import RockFaults, sides_of
from realmodel.core.work import run
from structure_cases import plane_fault, sides  # noqa: F401

pytestmark = pytest.mark.usefixtures("sides")
LOW, HIGH = np.array([0.0, 0.0, -4.0]), np.array([10.0, 10.0, 4.0])


def network(*faults):
    """RockFaults of (name, shape) or (name, shape, ends_at)."""
    given = [Fault(name, *shape, ends_at=ends[0] if ends else ()) for name, shape, *ends in faults]
    level = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]])
    project = Project("p", [Rock("r", [Surface("S", *level)])], faults=given)
    return run(lambda work: faults_of_rock(work, project, given, 0))


def found_in(faults, low=LOW, high=HIGH):
    rows, seen = run(lambda work: compartments(work, faults, low, high))
    points = np.random.default_rng(1).uniform(low, high, (20_000, 3))
    there = set(map(tuple, run(lambda work: sides_of(work, points, faults)).tolist()))
    assert there <= set(map(tuple, rows.tolist())), "a compartment was missed"
    assert set(map(tuple, rows[seen].tolist())) <= there | set(map(tuple, rows.tolist()))
    return rows, there


def test_no_fault():
    rows, seen = run(lambda work: compartments(work, RockFaults([], [], []), LOW, HIGH))
    assert rows.shape == (1, 0) and seen.all()


def test_one_fault_and_one_outside():
    rows, _ = found_in(network(("F", plane_fault())))
    assert sorted(rows.tolist()) == [[-1], [1]]
    rows, _ = found_in(network(("F", plane_fault(x=40.0))))
    assert len(rows) == 1


def test_crossing_and_parallel_faults():
    crossing = network(("F", plane_fault()), ("G", plane_fault(turn=70.0)))
    assert len(found_in(crossing)[0]) == 4
    parallel = network(("F", plane_fault(x=3.0)), ("G", plane_fault(x=7.0, lean=0.2)))
    rows, there = found_in(parallel)
    assert len(there) == len(rows) == 3
    named = compartment_names(parallel, rows)
    assert len(set(named)) == 3 and all("F" in name and "G" in name for name in named)


def test_near_faults_may_list_what_is_not_there():
    rows, there = found_in(network(("F", plane_fault(x=5.0)), ("G", plane_fault(x=5.1))))
    assert len(there) <= 3 and len(rows) == 4


def test_a_branch_is_on_one_side_only():
    main, branch = plane_fault(), plane_fault(turn=90.0, y=(2.0, 15.0))
    faults = network(("M", main), ("B", branch, ["M"]))
    assert faults.ends[1][0][0] == 0
    rows, there = found_in(faults)
    assert len(rows) == len(there) == 3
    assert sorted(np.abs(rows[:, 1]).tolist()) == [0, 1, 1]
    dropped = rows[rows[:, 1] == 0, 0]
    assert dropped.tolist() == [-faults.ends[1][0][1]]
    other_way = network(("B", branch, ["M"]), ("M", main))
    assert len(found_in(other_way)[0]) == 3


def test_the_larger_part_of_the_area_remains():
    """Of a branch that crosses: by its area, not by the number of its triangles."""
    main = plane_fault()
    z = np.array([[-20.0], [20.0]])
    x = np.array([-10.0, 4.9, 4.95, 4.99, 5.2, 5.4, 5.6, 5.8, 6.0, 7.0])
    columns = [np.column_stack([np.full((2, 1), at), np.full((2, 1), 5.0), z]) for at in x]
    triangles = [
        t
        for k in range(len(x) - 1)
        for t in ([2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 2, 2 * k + 1, 2 * k + 3])
    ]
    faults = network(("M", main), ("B", (np.concatenate(columns), np.array(triangles)), ["M"]))
    side = run(lambda work: sides_of(work, np.array([[0.0, 3, 0], [9, 3, 0]]), faults))
    assert side[0, 1] != 0 and side[1, 1] == 0


def test_a_branch_that_meets_nothing_is_refused():
    with pytest.raises(
        InputRefused, match=r"fault 'B': it ends at fault 'M', but does not meet it.* is 1\.5 at"
    ):
        network(("M", plane_fault()), ("B", plane_fault(turn=90.0, y=(6.5, 15.0)), ["M"]))
    touching = plane_fault(turn=90.0, y=(5.0, 15.0))
    touching[0][:, 0] += 1e-7  # as a file with few digits has it
    assert len(network(("M", plane_fault()), ("B", touching, ["M"])).ends[1]) == 1


def test_a_listric_fault():
    depth = np.linspace(-20.0, 20.0, 12)
    curve = np.column_stack([5 + 0.02 * (depth - 20) ** 2 - 8, np.zeros(12), depth])
    vertices = np.concatenate([curve - np.array([0, 5, 0]), curve + np.array([0, 15, 0])])
    k = np.arange(11)
    triangles = np.concatenate(
        [np.column_stack([k, k + 1, k + 12]), np.column_stack([k + 12, k + 1, k + 13])]
    )
    rows, there = found_in(network(("L", (vertices, triangles))))
    assert len(rows) == len(there) == 2


def test_too_many():
    faults = network(*((f"F{k}", plane_fault(turn=180.0 * k / 14)) for k in range(14)))
    with pytest.raises(InputRefused, match="more than 4096 compartments"):
        run(lambda work: compartments(work, faults, LOW, HIGH))
