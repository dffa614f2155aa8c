# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with faults and bodies: closed cells, and at every point what the closed form says."""

import dataclasses
import itertools
import sys
from pathlib import Path

import numpy as np
import pytest
from realmodel.batch.table import volume_table
from realmodel.core import (
    Body,
    BuildFailed,
    Fault,
    InputRefused,
    NotEnoughMemory,
    Project,
    Rock,
    Surface,
    build,
    build_surfaces,
    estimate,
)
from realmodel.core.exporters.report import model_report
from realmodel.core.results.displacements import displacements
from realmodel.core.results.surface_quality import residuals
from realmodel.core.results.volumes import volume_deviations
from realmodel.core.settings.rules import RULES
from realmodel.core.structures import setup
from structure_cases import SQUARE, ball, box_body, cells_at, plane_fault

CHECK = Path(__file__).resolve().parents[3] / "shared" / "check"


def points_of(height, seed=1, count=300):
    plan = np.random.default_rng(seed).uniform(0.0, 10.0, (count, 2))
    return np.column_stack([plan, height(*plan.T)])


def surfaces(*heights, rules=None, **more):
    rules = rules or ["erosional"] * len(heights)
    return [
        Surface(f"S{k}", points=points_of(height, k + 1), rule=rule, property=k, **more)
        for k, (height, rule) in enumerate(zip(heights, rules, strict=True))
    ]


def rock(given, base=-6.0, edge_length=1.5):
    return Rock("r", given, region=SQUARE, edge_length=edge_length, base_elevation=base)


def topology(model, tmp_path):
    """The checks of design.md, tests 1-3, on an exported model; skipped where they are not."""
    if not CHECK.is_dir():
        return []
    sys.path.insert(0, str(CHECK))
    try:
        from cell_complex import Complex, check_topology
    finally:
        sys.path.remove(str(CHECK))
    model.save(tmp_path / "m.npz")
    return check_topology(Complex(tmp_path / "m.npz"))


def assert_right(project, tmp_path, count=4000, seed=5, **options):
    """Builds it, checks it, and compares random points with the closed form; returns the model."""
    model = build(project, **options)
    assert topology(model, tmp_path) == []
    assert_blocks(model, count, seed)
    return model


def assert_blocks(model, count=4000, seed=5):
    random = np.random.default_rng(seed)
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    points = random.uniform(low - 0.05 * (high - low), high + 0.05 * (high - low), (count, 3))
    blocks = np.append(model.cell_block, -1)[cells_at(model, points)]
    expected = model.block_at(points)
    wrong = np.flatnonzero(blocks != expected)
    assert len(wrong) == 0, [(points[n].tolist(), blocks[n], expected[n]) for n in wrong[:5]]
    volumes = np.bincount(model.cell_block, model.cell_volumes, len(model.blocks))
    assert np.allclose(volumes, [block.volume for block in model.blocks], rtol=1e-9, atol=1e-9)


EAST = np.array([10.0, 0, 0])
FAULTED = [
    lambda x, y: np.where(x < 5, -2.0, 0.0) + 0.1 * y,
    lambda x, y: np.where(x < 5, -1.0, 1.0) + 0.05 * y,
    lambda x, y: 2.5 + 0.1 * x,
]


@pytest.mark.parametrize("lean", [0.0, 0.4, -0.4])
@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_one_fault(lean, cells, tmp_path):
    given = surfaces(*FAULTED)
    for surface in given[:2]:  # those within 1 of x = 5 would be on the wrong side of one that leans
        surface.points = surface.points[np.abs(surface.points[:, 0] - 5) > 1]
    project = Project("p", [rock(given)], faults=[Fault("F", *plane_fault(lean=lean), youngest="S1")])
    model = assert_right(project, tmp_path, cells=cells)
    assert model.surface_kind.tolist() == [0, 0, 0, 1] and model.surface_names[3] == "F"
    assert sorted(model.compartment_names) == ["above F", "below F", "r"]
    label = [model.compartment_names[n] for n in model.cell_compartment]
    assert all((name == "r") == (block == 2) for name, block in zip(label, model.cell_block, strict=True))
    on_fault = model.face_surface == 3
    assert on_fault.any()
    assert (model.face_blocks[on_fault].max(axis=1) <= 2).all()


@pytest.mark.parametrize("seed", range(4))
def test_all_rules_with_crossing_faults(seed, tmp_path):
    random = np.random.default_rng(seed)
    rules = random.choice(list(RULES), 4).tolist()
    throws = random.uniform(-1.5, 1.5, (4, 2))

    def height(k):
        return lambda x, y: k + throws[k, 0] * (x < 5) + throws[k, 1] * (y < 5) + 0.1 * np.sin(x + k)

    faults = [
        Fault("F", *plane_fault(lean=random.uniform(-0.5, 0.5)), youngest=f"S{random.integers(1, 4)}"),
        Fault(
            "G", *plane_fault(turn=80.0, lean=random.uniform(-0.5, 0.5)), youngest=f"S{random.integers(1, 4)}"
        ),
    ]
    project = Project("p", [rock(surfaces(*map(height, range(4)), rules=rules))], faults=faults)
    assert_right(project, tmp_path)


def test_a_branch(tmp_path):
    def height(k):
        return lambda x, y: k + np.where(x < 5, 0.0, np.where(y < 5, 0.7, -0.6))

    faults = [
        Fault("M", *plane_fault(lean=0.2)),
        Fault("B", *plane_fault(turn=90.0, y=(1.0, 15.0)), ends_at=("M",)),
    ]
    model = assert_right(Project("p", [rock(surfaces(*map(height, range(3))))], faults=faults), tmp_path)
    assert len(model.compartment_names) == 3


def test_a_fault_that_dies_out(tmp_path):
    def height(k):
        def at(x, y):
            throw = np.sqrt(np.clip(6.0 - y, 0.0, None) / 6.0) * np.exp(-np.abs(x - 5.0) / 4.0)
            return k + np.where(x < 5, -throw, throw)

        return at

    given = [Surface(f"S{k}", points=points_of(height(k), k, 1200)) for k in range(3)]
    fault = Fault("F", *plane_fault(y=(-5.0, 6.0)), dies_out=True)
    model = assert_right(Project("p", [rock(given, edge_length=0.7)], faults=[fault]), tmp_path)
    assert model.compartment_names == ["r"]
    assert (model.face_surface == 3).any()


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_fault_parts_what_is_not_connected_beyond_its_tip(cells, tmp_path):
    """It passes one arm of a U and ends before the other one: the end of the first arm is apart. Arms meet
    near the fault, so that each compartment is built as one cell."""
    outline = [[0, 0], [10, 0], [10, 10], [6, 10], [6, 5.98], [4, 5.98], [4, 10], [0, 10]]
    corners = np.array([[-5.0, 6, -20], [5, 6, -20], [5, 6, 20], [-5, 6, 20]])
    fault = Fault("F", corners, np.array([[0, 1, 2], [0, 2, 3]]), dies_out=True)
    given = Rock("r", surfaces(level(0), level(1)), region=outline, edge_length=1.5, base_elevation=-6.0)
    model = assert_right(Project("p", [given], faults=[fault]), tmp_path, cells=cells)
    assert (model.face_surface == 2).any()
    if cells == "blocks":
        assert [block.cells for block in model.blocks] == [2, 2]


def pierced(z):
    """A level square with a triangular hole that touches its west side."""
    plan = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 5], [5, 3], [5, 7]]
    triangles = np.array([[0, 1, 5], [0, 5, 4], [5, 1, 6], [1, 2, 6], [2, 3, 6], [3, 4, 6]], np.int32)
    return np.column_stack([np.array(plan, float), np.full(7, float(z))]), triangles


def test_a_cell_that_touches_itself_is_parted_there(tmp_path):
    """West of the fault it touches itself along a vertical edge, which the west wall passes."""
    given = [Surface(f"S{k}", *pierced(k)) for k in range(2)]
    fault = Fault("F", *plane_fault(x=4.98))
    project = Project("p", [Rock("r", given, base_elevation=-3.0)], faults=[fault])
    model = assert_right(project, tmp_path, cells="blocks")
    assert [block.cells for block in model.blocks] == [3, 3]
    assert [block.components for block in model.blocks] == [1, 1]


def test_a_branch_of_a_fault_that_dies_out(tmp_path):
    """Past the tip all three compartments are one rock, though the branch parts two of them."""

    def height(k):
        def at(x, y):
            fade = np.clip((6.0 - y) / 3.0, 0.0, 1.0) ** 2
            return k + np.where(x > 5, 0.4, np.where(y > 3, -0.4, -0.8)) * fade

        return at

    given = [Surface(f"S{k}", points=points_of(height(k), k, 300)) for k in range(2)]
    corners = np.array([[-5.0, 3, -20], [5.5, 3, -20], [5.5, 3, 20], [-5, 3, 20]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    faults = [
        Fault("F", *plane_fault(y=(-5.0, 6.0)), dies_out=True),
        Fault("B", corners, triangles, ends_at=("F",)),
    ]
    model = assert_right(Project("p", [rock(given, edge_length=1.5)], faults=faults), tmp_path)
    assert sorted(model.compartment_names) == ["above B", "below B", "r"]
    assert {2, 3} <= set(model.face_surface.tolist())


def test_a_branch_leaves_the_throw_of_other_faults_that_die_out():
    def height(k):
        def at(x, y):
            fade = np.clip((6.0 - y) / 3.0, 0.0, 1.0) ** 2 * np.where(x > 4, 0.4, np.where(y > 3, -0.4, -0.8))
            return k + fade + np.clip((y - 4.0) / 3.0, 0.0, 1.0) ** 2 * np.where(x > 8, 0.3, -0.3)

        return at

    given = [Surface(f"S{k}", points=points_of(height(k), k, 500)) for k in range(2)]
    corners = np.array([[-5.0, 3, -20], [4.5, 3, -20], [4.5, 3, 20], [-5, 3, 20]])
    dying = [
        Fault("F", *plane_fault(x=4.0, y=(-5.0, 6.0)), dies_out=True),
        Fault("G", *plane_fault(x=8.0, y=(4.0, 15.0)), dies_out=True),
    ]
    branch = Fault("B", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), ends_at=("F",))
    throws = []
    for faults in (dying, [*dying, branch]):
        model = build(Project("p", [rock(given, edge_length=1.0)], faults=faults))
        throws.append([float(each.throw.mean()) for each in displacements(model) if each.fault == "G"])
    assert throws[1] == pytest.approx(throws[0], rel=0.05)


def test_a_fault_that_ends_inside_is_refused():
    fault = Fault("F", *plane_fault(y=(-5.0, 6.0)))
    with pytest.raises(InputRefused, match=r"fault 'F': it ends inside the rock that it displaces near \("):
        build(Project("p", [rock(surfaces(*FAULTED))], faults=[fault]))


def torn(z):
    """Two level sheets that meet nowhere: x below 5 at z, beyond it 0.4 higher."""
    corners = [[0, 0], [5, 0], [5, 10], [0, 10], [5, 0], [10, 0], [10, 10], [5, 10]]
    heights = [z] * 4 + [z + 0.4] * 4
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], np.int32)
    return np.column_stack([np.array(corners, float), heights]), triangles


def test_a_fault_that_dies_out_in_torn_surfaces_is_refused_for_them():
    given = [Surface(f"S{k}", *torn(k)) for k in range(3)]
    fault = Fault("F", *plane_fault(y=(-5.0, 6.0)), dies_out=True)
    with pytest.raises(
        InputRefused, match=r"surface 'S0': it has two elevations beyond the tip of fault 'F'"
    ):
        build(Project("p", [rock(given)], faults=[fault]))


def level(z):
    return lambda x, y: np.full(len(x), float(z))


@pytest.mark.parametrize("after", [None, "S1"])
@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_body(after, cells, tmp_path):
    body = Body("ball", *ball([5, 5, 1.2], 2.5), after=after, property=9)
    given = surfaces(level(-1), level(1), lambda x, y: 2 + 0.2 * x)
    model = assert_right(Project("p", [rock(given)], bodies=[body]), tmp_path, cells=cells)
    assert model.surface_kind.tolist() == [0, 0, 0, 2]
    block = model.blocks[-1]
    assert (block.name, block.property, block.surface) == ("ball", 9, 3)
    whole = (
        build(Project("p", [rock(given)], bodies=[Body("ball", *ball([5, 5, 1.2], 2.5))])).blocks[-1].volume
    )
    assert block.volume == pytest.approx(whole, rel=1e-9) if after is None else block.volume < whole - 1
    assert cells == "columns" or block.cells == 1


def test_bodies_that_overlap_and_voids(tmp_path):
    bodies = [
        Body("dike", *box_body([2, -1, -9], [4, 11, 9]), after="S1", property=1),
        Body("ore", *ball([4, 5, 0], 1.7), property=2),
        Body("tunnel", *box_body([-1, 4.5, -0.5], [11, 5.5, 0.5]), void=True),
    ]
    given = surfaces(level(-1), level(1), level(2))
    model = assert_right(Project("p", [rock(given)], bodies=bodies), tmp_path)
    assert [block.name for block in model.blocks[-2:]] == ["dike", "ore"]
    solid = build(Project("p", [rock(given)]))
    assert solid.volume - model.volume == pytest.approx(10.0, rel=1e-6)


def test_a_body_across_a_fault(tmp_path):
    bodies = [Body("ball", *ball([5, 5, 0], 2.2), after="S1")]
    project = Project(
        "p",
        [rock(surfaces(*FAULTED))],
        faults=[Fault("F", *plane_fault(lean=0.3), youngest="S1")],
        bodies=bodies,
    )
    model = assert_right(project, tmp_path)
    own = model.cell_compartment[model.cell_block == len(model.blocks) - 1]
    assert len(np.unique(own)) == 2


def test_a_void_that_younger_rock_fills(tmp_path):
    bodies = [Body("cave", *ball([5, 5, 0.5], 1.5), after="S1", void=True)]
    model = assert_right(
        Project("p", [rock(surfaces(level(-1), level(1), level(3)))], bodies=bodies), tmp_path
    )
    assert model.volume == pytest.approx(900.0)  # from the base at -6 to the top at 3
    assert model.blocks[-1].volume > 205


def test_stages(tmp_path):
    project = Project(
        "p",
        [rock(surfaces(*FAULTED))],
        faults=[Fault("F", *plane_fault(lean=0.3), youngest="S1")],
        bodies=[Body("ball", *ball([5, 5, 1], 1.5), after="S1")],
    )
    model = build(project)
    for m in (0, 1, 2):
        stage = model.stage(m)
        assert topology(stage, tmp_path) == []
        assert_blocks(stage)
        assert ("ball" in [block.name for block in stage.blocks]) == (m > 0)
        again = build(project, stage=m)
        assert np.array_equal(again.vertices, stage.vertices)
        assert np.array_equal(again.face_vertices, stage.face_vertices)


def test_several_rock_masses(tmp_path):
    """A fault of one of them, a body in both."""
    left = Rock("left", surfaces(level(-1), level(1)), region=SQUARE, edge_length=2.0, base_elevation=-4.0)
    right = Rock(
        "right",
        [
            Surface("T0", points=points_of(level(0)) + EAST),
            Surface("T1", points=points_of(level(2)) + EAST),
        ],
        region=SQUARE + EAST[:2],
        edge_length=2.0,
        base_elevation=-3.0,
    )
    fault = Fault("F", *plane_fault(turn=90.0, y=(-20.0, 40.0)), rocks=("right",))
    project = Project("p", [left, right], faults=[fault], bodies=[Body("B", *ball([10, 5, 0], 2))])
    model = assert_right(project, tmp_path)
    names = [model.compartment_names[n] for n in model.cell_compartment[model.cell_block < 4]]
    assert set(names) == {"left", "right: above F", "right: below F"}


def test_the_same_bytes_for_any_number_of_threads(tmp_path):
    project = Project(
        "p",
        [rock(surfaces(*FAULTED))],
        faults=[Fault("F", *plane_fault(lean=0.3), youngest="S1")],
        bodies=[Body("ball", *ball([5, 5, 1], 1.5))],
    )
    for threads in (1, 2):
        build(project, threads=threads).save(tmp_path / f"{threads}.npz")
    assert (tmp_path / "1.npz").read_bytes() == (tmp_path / "2.npz").read_bytes()


def test_the_report_has_compartments_throw_and_heave():
    """A normal fault that leans by 0.5: 2 down, so 1 sideways."""
    random = np.random.default_rng(8)
    given = []
    for k, (low, high) in enumerate(((-1.0, 1.0), (0.0, 2.0))):  # lower right of the fault, as it leans there
        x = np.concatenate([random.uniform(0, 5 - high / 2, 150), random.uniform(5 - low / 2, 10, 150)])
        z = np.repeat([high, low], 150)
        given.append(Surface(f"S{k}", points=np.column_stack([x, random.uniform(0, 10, 300), z])))
    given.append(Surface("S2", points=points_of(level(4))))
    project = Project("p", [rock(given)], faults=[Fault("F", *plane_fault(lean=0.5), youngest="S1")])
    model = build(project)
    report = model_report(model)
    assert sum(entry["volume"] for entry in report["compartments"]) == pytest.approx(model.volume)
    by_block = {}
    for compartment in report["compartments"]:
        for block in compartment["blocks"]:
            by_block[block["block"]] = by_block.get(block["block"], 0.0) + block["volume"]
    assert by_block == pytest.approx({block.name: block.volume for block in model.blocks})
    (fault,) = report["faults"]
    assert [entry["surface"] for entry in fault["surfaces"]] == ["S0", "S1"]
    for entry in fault["surfaces"]:
        assert entry["throw"] == pytest.approx({"mean": 2.0, "max": 2.0})
        assert entry["heave"] == pytest.approx({"mean": 1.0, "max": 1.0})
    assert report["counts"]["surfaces"] == 3 and report["validation"]["passed"]


def test_the_proof_finds_what_is_wrong():
    model = build(
        Project("p", [rock(surfaces(*FAULTED))], faults=[Fault("F", *plane_fault(), youngest="S1")])
    )
    assert model.validate(6000).passed
    other = np.where(model.cell_block == 1, 0, model.cell_block).astype(np.int32)
    model = dataclasses.replace(model, complex=dataclasses.replace(model.complex, cell_block=other))
    tests = {test.name: test for test in model.validate(6000).tests}
    assert (
        tests["places"].failed > 50
        and "the closed form block 'S1 block'" in tests["places"].offenders[0].text
    )
    model = build(
        Project("p", [rock(surfaces(*FAULTED))], faults=[Fault("F", *plane_fault(), youngest="S1")])
    )
    other = np.where(model.face_surface == 3, 0, model.face_surface).astype(np.int32)
    model = dataclasses.replace(model, complex=dataclasses.replace(model.complex, face_surface=other))
    tests = {test.name: test for test in model.validate(6000).tests}
    assert tests["surfaces"].failed > 10 and tests["surfaces"].passed is False


def test_the_proof_of_bodies_that_stand_on_the_base():
    deep = Body("deep", *box_body([8, 4, -10], [12, 6, 1]))
    model = build(Project("p", [rock(surfaces(*FAULTED))], bodies=[deep]))
    assert (model.face_surface == -2).any() and model.validate(2000).passed
    tops = [Surface(f"T{k}", points=points_of(level(2 * k)) + EAST) for k in range(2)]
    east = Rock("east", tops, region=SQUARE + EAST[:2], edge_length=2.0, base_elevation=-3.0)
    model = build(Project("p", [rock(surfaces(*FAULTED)), east], bodies=[deep]))
    assert model.validate(2000).passed
    model.vertices[:, 2] = np.where(model.vertices[:, 2] == -6.0, -6.5, model.vertices[:, 2])
    assert not model.validate(2000).passed


def test_eroded_volumes_with_faults_and_bodies():
    given = surfaces(level(-1), level(2), level(1))
    fault, ore = (
        Fault("F", *plane_fault(lean=0.3), youngest="S1"),
        Body("ore", *ball([5, 5, 1], 2), after="S1"),
    )
    erosion = build(Project("p", [rock(given)], faults=[fault], bodies=[ore])).eroded()
    whole = build(Project("p", [rock(given[:2])], bodies=[ore]))
    assert erosion.remaining[3] + erosion.volume[2, 3] == pytest.approx(whole.blocks[2].volume)
    assert erosion.volume[2, 1] == pytest.approx(100 - erosion.volume[2, 3] + cap_above(whole, 2.0), rel=1e-6)


def test_what_a_body_takes_is_no_erosion():
    tunnel = Body("tunnel", *box_body([-1, 4, -0.5], [11, 6, 0.5]), void=True)
    erosion = build(Project("p", [rock(surfaces(level(-2), level(2), level(1)))], bodies=[tunnel])).eroded()
    assert erosion.total == pytest.approx(100.0)
    assert erosion.remaining[1] == pytest.approx(300 - 20.0, rel=1e-6)
    assert erosion.taken == pytest.approx(np.array([[0.0, 20.0, 0.0]]), abs=1e-6)
    assert erosion.deposited[1] == pytest.approx(400.0)


def test_what_each_body_takes():
    """A body of ore that a younger surface cuts, and a tunnel through it and two layers, after all."""
    given = surfaces(level(-2), level(2), level(4), level(3))
    ore = Body("ore", *box_body([2, 2, 0], [8, 8, 4]), after="S2")
    tunnel = Body("tunnel", *box_body([-1, 4, 1], [11, 6, 3]), void=True)
    model = build(Project("p", [rock(given)], bodies=[ore, tunnel]))
    names = [block.name for block in model.blocks]
    erosion = model.eroded()
    taken = [dict(zip(names, row.round(6).tolist(), strict=True)) for row in erosion.taken]
    none = dict.fromkeys(names, 0.0)
    assert taken[0] == none | {"S1 block": 72.0, "S2 block": 72.0}
    assert taken[1] == none | {"S1 block": 8.0, "S2 block": 8.0, "ore": 24.0}
    assert dict(zip(names, erosion.by_block.round(6).tolist(), strict=True)) == none | {
        "S2 block": 64.0,
        "ore": 36.0,
    }
    report = model_report(model, erosion=erosion)["erosion"]
    assert [(entry["name"], entry["taken"]) for entry in report["bodies"]] == [
        ("ore", pytest.approx(144.0)),
        ("tunnel", pytest.approx(40.0)),
    ]
    for entry in report["blocks"]:
        gone = entry["eroded"] + entry["taken"]
        assert entry["deposited"] == pytest.approx(entry["remaining"] + gone)
    assert volume_table(model, erosion).splitlines()[0].split()[-1] == "taken"


def cap_above(model, z):
    """The volume of the ore above a height."""
    half = model.cut_by_plane((0, 0, z), (0, 0, 1)).above
    return half.blocks[2].volume


def test_what_else_takes_a_project_with_faults():
    project = Project("p", [rock(surfaces(*FAULTED))], faults=[Fault("F", *plane_fault(), youngest="S1")])
    plain = Project("p", project.rocks)
    made = build_surfaces(project)
    assert len(made.surface(0)[0]) == 2 * len(made.surface(2)[0])
    expected, of_plain = estimate(project), estimate(plain)  # whose meshes differ beside crowded points
    assert expected.memory / expected.triangles > 2 * of_plain.memory / of_plain.triangles
    with pytest.raises(NotEnoughMemory):
        build(project, memory=of_plain.memory)
    model = build(project)
    assert max(abs(each.values).max() for each in residuals(model)) < 1e-2  # across the fault it would be 2
    cut = model.cut_by_plane((0, 5, 0), (0, 1, 0))
    assert set(cut.above.cell_compartment) == set(model.cell_compartment)
    assert volume_deviations(model)[0] >= 0


def test_parts_that_never_settle_are_refused(monkeypatch):
    """Each round of sheets that reach beyond the divided box finds new parts."""
    depths, parts = itertools.count(1), itertools.count(1)
    real_box, real_divide = setup.box_around, setup.divide

    def farther(inputs, structures, has_sheets=False):
        low, high = real_box(inputs, structures, has_sheets)
        return np.array([low - [0, 0, next(depths) if has_sheets else 0], high])

    def other_parts(work, structures, box):
        found = real_divide(work, structures, box)
        sides = np.concatenate([found.sides, found.sides[:1].repeat(next(parts), axis=0)])
        return dataclasses.replace(found, sides=sides)

    monkeypatch.setattr(setup, "box_around", farther)
    monkeypatch.setattr(setup, "divide", other_parts)
    surface = Surface("S", points=[[x, y, 0.1 * x] for x in range(9) for y in range(9)])
    region = [[0, 0], [8, 0], [8, 8], [0, 8]]
    fault = Fault("F", *plane_fault(4.1, z=(-20.0, 20.0), y=(-9.0, 20.0)))
    project = Project(
        "P", [Rock("R", [surface], region=region, edge_length=2.0, base_elevation=-5.0)], faults=[fault]
    )
    with pytest.raises(BuildFailed, match="new parts each time"):
        build(project)


def test_faults_and_bodies_that_meet_no_rock_are_warned_of():
    given = [rock(surfaces(lambda x, y: 0 * x, lambda x, y: 0 * x + 2))]
    faults = [Fault("near", *plane_fault()), Fault("far", *plane_fault(x=55.0))]
    inside, outside = box_body((3, 3, 0.5), (4, 4, 1)), box_body((33, 3, 0.5), (34, 4, 1))
    bodies = [Body("dyke", *inside), Body("lost", *outside), Body("lost void", *outside, void=True)]
    model = build(Project("p", given, faults=faults, bodies=bodies))
    texts = [str(warning) for warning in model.warnings if warning.kind == "structure"]
    assert texts == [
        "fault 'far' meets no rock and displaces nothing; check its coordinates",
        "body 'lost' lies outside of all rock masses; check its coordinates",
        "body 'lost void' lies outside of all rock masses; check its coordinates",
    ]
