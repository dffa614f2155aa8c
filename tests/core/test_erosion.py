# SPDX-License-Identifier: GPL-3.0-or-later
"""What surfaces removed of blocks, and the volumes of connected parts, against closed forms and fractions."""

import json
from fractions import Fraction

import numpy as np
import pytest
from conftest import grid_surface
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from realmodel.batch.table import volume_table
from realmodel.core import Cancelled, Project, Rock, Surface, UsageError, build
from realmodel.core.exporters.report import model_report
from stacks.generate import random_stack
from stacks.judge import volume_allowance
from stacks.model_view import rocks_of
from stacks.rational import block_volumes
from stacks.rock_masses import random_rock_masses
from validated import as_model

PLAN = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def square(name, heights, **options):
    return Surface(name, np.column_stack([PLAN, heights]), TRIANGLES, **options)


def hill(clay="erosional", sand="erosional", ground="erosional", base=0.0):
    """Clay up to 2, sand up to 3, and a ground that rises from 1 in the west to 5 in the east."""
    surfaces = [
        square("clay", [2, 2, 2, 2], rule=clay, block="clay"),
        square("sand", [3, 3, 3, 3], rule=sand, block="sand"),
        square("ground", [1, 5, 5, 1], rule=ground, block="soil"),
    ]
    return Rock("hill", surfaces, base_elevation=base)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize(
    "rules, clay, sand",
    [
        ({}, 2, 6),  # the wedges x < 1 of clay and x < 2 of sand, 4 wide
        ({"ground": "conformable"}, 0, 0),
        ({"ground": "base"}, 0, 0),
        ({"ground": "discontinuous"}, 2, 6),
        ({"clay": "base"}, 0, 6),  # the ground cuts down to the clay only
        ({"clay": "discontinuous", "sand": "conformable"}, 0, 6),
        ({"sand": "base"}, 0, 0),
        ({"sand": "discontinuous"}, 0, 0),
    ],
)
def test_the_ground_cuts_sand_and_clay(rules, clay, sand, cells):
    model = build(Project("hill", [hill(**rules)]), cells=cells)
    erosion = model.eroded()
    assert erosion.volume.shape == (3, 3)
    assert erosion.volume[2].tolist() == pytest.approx([clay, sand, 0], rel=1e-12)
    assert (erosion.volume[:2] == 0).all()
    assert erosion.by_block.tolist() == pytest.approx([clay, sand, 0])
    assert erosion.by_surface.tolist() == pytest.approx([0, 0, clay + sand])
    assert erosion.total == pytest.approx(clay + sand)
    assert erosion.deposited[:2].tolist() == pytest.approx([32, 16])
    assert erosion.remaining.tolist() == [block.volume for block in model.blocks]


def test_nothing_is_nothing_exactly():
    """Rounding differs from stage to stage; what it makes is not reported as erosion."""
    rng = np.random.default_rng(3)
    nodes, third = rng.uniform(4.5e6, 4.5e6 + 1000, (60, 2)), 1 / 3
    corners = 4.5e6 + np.array([[0, 0], [1000, 0], [1000, 1000], [0, 1000]])
    region = corners.tolist()
    surfaces = []
    for k in range(4):
        points = np.vstack([nodes, corners])
        z = 100 * third * k + 3 * np.sin(points[:, 0] / 90 + k)
        surfaces.append(Surface(f"S{k}", points=np.column_stack([points, z])))
    rock = Rock("plain", surfaces, region=region, edge_length=80, base_elevation=-100 * third)
    assert (build(Project("plain", [rock])).eroded().volume == 0).all()


def test_each_surface_has_its_own_volumes():
    """Two valleys, one after the other; the second cuts deeper on one half."""
    valleys = [
        square("old top", [10, 10, 10, 10]),
        square("first valley", [8, 8, 8, 8]),
        square("fill", [9, 9, 9, 9]),
        square("second valley", [7, 7, 7, 7]),
    ]
    erosion = build(Project("valleys", [Rock("rock", valleys, base_elevation=0.0)])).eroded()
    assert erosion.volume[1].tolist() == [32, 0, 0, 0]
    assert erosion.volume[2].tolist() == [0, 0, 0, 0]
    assert erosion.volume[3].tolist() == [16, 0, 16, 0]
    assert erosion.deposited.tolist() == [160, 0, 16, 0]


def test_rock_masses_of_different_ages():
    east = Rock("east", [square("bottom", [0, 0, 0, 0]), square("top", [1, 1, 1, 1])])
    for surface in east.surfaces:
        surface.vertices[:, 0] += 4
    model = build(Project("two", [hill(), east]))
    erosion = model.eroded()
    assert erosion.volume.shape == (5, 4)
    assert erosion.volume[2].tolist() == pytest.approx([2, 6, 0, 0])
    assert (np.delete(erosion.volume, 2, axis=0) == 0).all()
    assert erosion.deposited.tolist() == pytest.approx([32, 16, 8, 16])


def exact_erosion(case):
    """(S, B) fractions: exact volumes of each prefix of each stack, subtracted."""
    rows, columns = [], []
    for stack in rocks_of(case):
        count = len(stack.surfaces)
        stages = []
        for m in range(count):
            volumes = block_volumes(
                stack.surfaces[: m + 1], stack.all_rules()[: m + 1], stack.region, stack.base_elevation
            )
            stages.append([*volumes, *[Fraction(0)] * (count - 1 - m)])
        lowest = 0 if stack.base_elevation is not None else 1
        removed = [[Fraction(0)] * count]
        for k in range(1, count):
            removed.append([stages[k - 1][j] - stages[k][j] if j < k else Fraction(0) for j in range(count)])
        rows.append(np.array(removed, object)[:, lowest:])
        columns.append(count - lowest)
    total = np.full((sum(len(r) for r in rows), sum(columns)), Fraction(0), object)
    i = j = 0
    for block in rows:
        total[i : i + block.shape[0], j : j + block.shape[1]] = block
        i, j = i + block.shape[0], j + block.shape[1]
    return total


@settings(
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
    max_examples=80,
)
@given(
    st.sampled_from(
        ["own lattices", "partial", "jumps", "regions", "rules", "rules in general", "utm", "rock masses"]
    ),
    st.randoms(use_true_random=True),
)
def test_random_stacks(family, rng):
    case = random_rock_masses(rng) if family == "rock masses" else random_stack(rng, family)
    model = as_model(case)
    erosion = model.eroded()
    exact = exact_erosion(case)
    assert erosion.volume.shape == exact.shape
    assert (erosion.volume >= 0).all()
    blocks = [block.surface for block in model.blocks]
    whole = [Fraction(0)] * len(model.surface_names)
    for b, surface in enumerate(blocks):
        whole[surface] = exact[:, b].sum() + Fraction(model.blocks[b].volume)
    allowed = np.array(volume_allowance(case, whole))[blocks]
    assert (np.abs(erosion.volume - exact.astype(float)) <= 4 * allowed).all()
    # what was laid down, less what was removed, is what is left
    left = np.array([block.volume for block in model.blocks])
    assert erosion.deposited - erosion.by_block == pytest.approx(left, rel=1e-12, abs=1e-300)
    laid = np.array([float(whole[surface]) for surface in blocks])
    assert (np.abs(erosion.deposited - laid) <= 4 * len(exact) * allowed).all()


def test_it_can_be_cancelled():
    surfaces = [
        Surface(f"S{k}", *grid_surface(70 + k, lambda x, y, k=k: np.sin(9 * x + k) * np.cos(8 * y - k)))
        for k in range(5)
    ]
    model = build(Project("waves", [Rock("rock", surfaces)]))
    with pytest.raises(Cancelled):
        model.eroded(cancel=lambda: True)


def ridge(cells):
    """A surface that rises to 2 and to 1, and touches the level one below it in between."""
    corners = [(x, y, z) for x, z in enumerate([0, 2, 0, 1, 0]) for y in (0, 1)]
    triangles = [t for a in range(0, 8, 2) for t in ((a, a + 2, a + 3), (a, a + 3, a + 1))]
    flat = np.array([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0]], float)
    bottom = Surface("bottom", flat, TRIANGLES)
    top = Surface("top", np.array(corners, float), np.array(triangles))
    return build(Project("ridge", [Rock("rock", [bottom, top])]), cells=cells)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_volumes_of_connected_parts(cells):
    model = ridge(cells)
    (block,) = model.blocks
    assert block.components == 2
    (parts,) = model.component_volumes
    assert parts.tolist() == pytest.approx([2, 1])
    assert model.cell_volumes.shape == model.cell_block.shape
    assert model.cell_volumes.sum() == pytest.approx(block.volume)
    assert model_report(model)["blocks"][0]["component_volumes"] == pytest.approx([2, 1])
    assert "66.67 %" in volume_table(model)


def test_parts_of_absent_blocks():
    model = build(
        Project("x", [Rock("r", [square("a", [1] * 4), square("b", [0] * 4)], base_elevation=-1.0)])
    )
    assert [parts.tolist() for parts in model.component_volumes] == [[pytest.approx(16)], []]
    lone = build(Project("x", [Rock("r", [square("a", [1] * 4)])]))
    assert lone.component_volumes == [] and lone.eroded().volume.shape == (1, 0)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_parts_add_up(cells):
    model = build(Project("hill", [hill()]), cells=cells)
    for block, parts in zip(model.blocks, model.component_volumes, strict=True):
        assert len(parts) == block.components
        assert parts.sum() == pytest.approx(block.volume)
        assert (np.diff(parts) <= 0).all()


def test_table_and_report():
    model = build(Project("hill", [hill()]))
    assert "eroded" not in volume_table(model) and "erosion" not in model_report(model)
    erosion = model.eroded()
    lines = volume_table(model, erosion).splitlines()
    assert lines[0].split()[-3:] == ["eroded", "surface", "eroded"]
    soil = next(line for line in lines if line.startswith("soil"))
    sand = next(line for line in lines if line.startswith("sand"))
    assert [float(figure) for figure in soil.split()[-2:]] == pytest.approx([0, 8])
    assert [float(figure) for figure in sand.split()[-2:]] == pytest.approx([6, 0])
    assert [float(figure) for figure in lines[-1].split()[-2:]] == pytest.approx([8, 8])
    report = json.loads(json.dumps(model_report(model, erosion=erosion), allow_nan=False))["erosion"]
    assert report["total"] == pytest.approx(8)
    assert [block["name"] for block in report["blocks"]] == ["clay", "sand", "soil"]
    assert [block["deposited"] for block in report["blocks"]] == pytest.approx([32, 16, 8])
    assert report["surfaces"][2]["rock"] == "hill" and report["surfaces"][0]["blocks"] == []
    assert {entry["block"]: entry["eroded"] for entry in report["surfaces"][2]["blocks"]} == {
        "clay": pytest.approx(2),
        "sand": pytest.approx(6),
    }


def test_a_half_has_no_erosion_of_its_own():
    half = build(Project("hill", [hill()])).cut_by_plane((2, 2, 2), (1, 0, 0)).above
    with pytest.raises(UsageError, match="ask the whole model"):
        half.eroded()
