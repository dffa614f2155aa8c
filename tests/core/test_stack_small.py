# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks small enough to count by hand: vertices, faces, cells and volumes."""

import numpy as np
import pytest
from realmodel._native import InputError, build_parts, build_rock_masses, build_stack
from stacks.case import as_region, as_surface

RISING = [(0, 1, 2), (0, 2, 3)]
FALLING = [(0, 1, 3), (1, 2, 3)]


def square(z, triangles=RISING, size=2.0, at=(0.0, 0.0)):
    """A square with corner heights, counter-clockwise from its lower left corner."""
    plan = [(0, 0), (size, 0), (size, size), (0, size)]
    return as_surface([(x + at[0], y + at[1], h) for (x, y), h in zip(plan, z, strict=True)], triangles)


def counts(result):
    return len(result["vertices"]), len(result["face_cells"]), len(result["cell_block"])


def walls(result):
    return np.count_nonzero(result["face_surface"] == -1)


def test_one_layer_on_one_mesh():
    """Two prisms: 2 faces above, 2 below, 4 walls outside, 1 between."""
    surfaces = [square([0] * 4), square([1] * 4)]
    result = build_stack(surfaces)
    assert counts(result) == (8, 9, 2)
    assert walls(result) == 5
    assert result["volumes"] == pytest.approx([0, 4])
    assert result["cell_block"].tolist() == [1, 1]
    assert sorted(result["face_surface"]) == [-1] * 5 + [0, 0, 1, 1]
    as_block = build_stack(surfaces, cells="blocks")
    assert counts(as_block) == (8, 8, 1)
    assert as_block["volumes"] == pytest.approx([0, 4])


def in_one_part(rock, wanted):
    """A model of one rock mass whose space no structure divides."""
    numbers = [(number, number, None) for number in range(len(rock[0]))]
    parts = [([], [(rock, numbers, [], [])], wanted, None)]
    return build_parts(parts, (len(numbers), []), np.empty((0, len(numbers)), np.uint8))


def test_columns_where_nothing_is_wanted_are_left_out():
    rock = [square([0] * 4), square([1] * 4), square([3] * 4)], None, None, []
    cells = np.zeros((2, 2, 2), np.uint8)
    wanted = ([0.0, 0.0, 0.0], [1.0, 1.0, 1.5], cells)
    for layers, blocks in (([0, 0], []), ([1, 0], [2, 2, 1, 1]), ([0, 1], [2, 2]), ([1, 1], [2, 2, 1, 1])):
        cells[1] = layers
        result = in_one_part(rock, wanted)
        assert result["cell_block"].tolist() == blocks  # each column of the lower layer is below 1.5
        assert walls(result) == {0: 0, 2: 5, 4: 10}[len(blocks)]
    with pytest.raises(ValueError, match="64 layers at most"):
        in_one_part(rock, (*wanted[:2], np.ones((1, 1, 65), np.uint8)))


def test_one_layer_with_the_other_diagonal():
    """Below each upper triangle lie pieces of both lower ones: the diagonals cross in one new vertex."""
    result = build_stack([square([0] * 4), square([1] * 4, FALLING)])
    assert counts(result)[2] == 2
    assert np.count_nonzero(result["face_surface"] == 0) == 4
    assert np.count_nonzero(result["face_surface"] == 1) == 2
    assert result["volumes"] == pytest.approx([0, 4])
    assert [1, 1, 0] in result["vertices"].tolist()


def test_two_crossing_planes():
    """z = x - 1 over z = 0: a wedge in two cells, its edge on the line x = 1."""
    result = build_stack([square([0] * 4), square([-1, 1, 1, -1])])
    assert counts(result) == (7, 8, 2)
    assert result["volumes"] == pytest.approx([0, 1])
    edge = result["vertices"][result["vertices"][:, 0] == 1]
    assert sorted(edge.tolist()) == [[1, 0, 0], [1, 1, 0], [1, 2, 0]]


def test_three_planes_through_one_line():
    """z = 0, x - 1 and 2 (x - 1): two wedges on one side share a face and the line."""
    tilted = [square([-s, s, s, -s]) for s in (1, 2)]
    result = build_stack([square([0] * 4), *tilted])
    assert result["volumes"] == pytest.approx([0, 1, 1])
    assert counts(result) == (9, 14, 4)
    shared = result["face_cells"][result["face_surface"] == 1]
    assert (shared >= 0).all()


def test_surfaces_that_coincide_over_half():
    """The upper surface folds up along the diagonal: one triangle of zero thickness forms nothing."""
    result = build_stack([square([0] * 4), square([0, 1, 0, 0])])
    assert counts(result) == (4, 4, 1)
    assert result["volumes"] == pytest.approx([0, 2 / 3])


def test_touching_in_a_point_or_along_an_edge_only():
    tip = square([0, 1, 1, 1])
    result = build_stack([square([0] * 4), tip])
    assert result["volumes"] == pytest.approx([0, 4 - 2 / 3 - 2 / 3])
    assert counts(result)[2] == 2
    ridge = square([0, 1, 0, 1])
    result = build_stack([square([0] * 4), ridge])
    assert counts(result) == (6, 8, 2)
    assert result["volumes"] == pytest.approx([0, 4 / 3])
    assert len(build_stack([square([0] * 4), ridge], cells="blocks")["cell_block"]) == 2


def test_cone_cut_through_its_tip():
    """A level plane through the tip of a pyramid takes nothing off it; a little lower it leaves a frustum."""
    pyramid = as_surface(
        [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 1)], [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    )
    level = square([0] * 4)
    assert build_stack([level, pyramid, square([1] * 4)])["volumes"] == pytest.approx([0, 4 / 3, 8 / 3])
    result = build_stack([level, pyramid, square([0.5] * 4)])
    assert result["volumes"] == pytest.approx([0, 7 / 6, 5 / 6])


def test_an_island_and_a_jump():
    """A square island floats over the middle; a jump leaves a wall within one surface."""
    ground = square([0] * 4, size=4.0)
    island = square([1] * 4, at=(1, 1))
    result = build_stack([ground, island])
    assert result["volumes"] == pytest.approx([0, 4])
    assert counts(result)[2] == 2
    (v, t), (w, u) = square([1] * 4), square([3] * 4, at=(2, 0))
    jump = as_surface(np.vstack([v, w]), np.vstack([t, u + 4]))
    result = build_stack([ground, jump])
    assert result["volumes"] == pytest.approx([0, 16])
    between = (result["face_surface"] == -1) & (result["face_cells"] >= 0).all(axis=1)
    assert np.count_nonzero(between) == 3


def test_region_and_base():
    region = as_region([(1, 0), (2, 0), (2, 1), (1, 1)], RISING)
    ground, top = square([0] * 4, size=4.0), square([1] * 4, size=4.0, triangles=FALLING)
    result = build_stack([ground, top], region, -2.0)
    assert result["volumes"] == pytest.approx([2, 1])
    assert result["vertices"].min(axis=0).tolist() == [1, 0, -2]
    assert result["vertices"].max(axis=0).tolist() == [2, 1, 1]
    assert np.count_nonzero(result["face_surface"] == -2) >= 1


def test_nothing_at_all():
    """One surface, or surfaces that cover different places, form no block."""
    for surfaces in ([square([0] * 4)], [square([0] * 4), square([1] * 4, at=(2, 0))]):
        result = build_stack(surfaces)
        assert counts(result) == (0, 0, 0)
        assert not result["volumes"].any()
        assert result["face_offsets"].tolist() == [0]


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        ("erosional erosional erosional", [16, 0, 0]),
        ("erosional erosional conformable", [20, 8, 0]),
        ("erosional erosional base", [20, 8, 0]),
        ("erosional erosional discontinuous", [16, 0, 0]),
        ("erosional discontinuous erosional", [20, 8, 0]),
        ("base erosional erosional", [20, 0, 0]),
        ("discontinuous erosional erosional", [20, 0, 0]),
    ],
)
def test_rules_decide_what_the_youngest_surface_cuts(rules, expected):
    """Ground at 0 and a layer to 2 above a base at -5; then a surface at -1, over an area of 4."""
    surfaces = [square([z] * 4) for z in (0, 2, -1)]
    result = build_stack(surfaces, None, -5.0, rules=rules.split())
    assert result["volumes"] == pytest.approx(expected)
    assert sorted(set(result["cell_block"])) == [k for k, volume in enumerate(expected) if volume]


def test_rock_masses_side_by_side_share_a_wall():
    """Two blocks of unequal height: the common part of their wall is one face between them."""
    low = ([square([0] * 4), square([1] * 4)], None, None, [])
    high = ([square([0] * 4, at=(2, 0)), square([3] * 4, at=(2, 0))], None, None, [])
    result = build_rock_masses([low, high], cells="blocks")
    assert result["volumes"] == pytest.approx([0, 4, 0, 12])
    assert len(result["vertices"]) == 14
    shared = (result["face_cells"] >= 0).all(axis=1)
    assert np.count_nonzero(shared) == 1
    assert result["face_surface"][shared].tolist() == [-1]


def test_rock_masses_that_overlap_are_refused():
    one = ([square([0] * 4), square([1] * 4)], None, None, [])
    other = ([square([5] * 4, at=(1.5, 0)), square([6] * 4, at=(1.5, 0))], None, None, [])
    with pytest.raises(InputError) as raised:
        build_rock_masses([one, other])
    assert raised.value.kind == "rocks_overlap"
    assert list(raised.value.items) == [0, 1]
    x, y, _ = raised.value.place
    assert 1.5 <= x <= 2
    assert 0 <= y <= 2
