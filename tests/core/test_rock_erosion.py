# SPDX-License-Identifier: GPL-3.0-or-later
"""Differential erosion of a mesh by its beds: closed, within it, deeper in soft beds, at any strength."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Cancelled,
    DifferentialErosion,
    InputRefused,
    Strata,
    UsageError,
    fill_with_strata,
    rock_shape,
)
from realmodel.core.base import work
from realmodel.core.base.triangles import edges_of, open_edges
from realmodel.core.filling import (
    PIECES,
    SHAPES,
    broken_piece,
    closed_mesh,
    divided_at_beds,
    eroded_within,
    hardness_of_beds,
    joints_at,
    kept_of,
    lay_beds,
    mean_thickness,
    rubble_within,
    scree_within,
)
from realmodel.core.filling.erosion import cubic_lattice, winding
from realmodel.core.structures.shapes.continued import connected
from solids import box, moved, together, torus, volume
from test_filling import ball

COARSE = DifferentialErosion(faces=4000)
BEDS = Strata(beds=8, dip=10, seed=2)


def eroded(mesh, strata=BEDS, erosion=COARSE, **options):
    mesh = closed_mesh(*mesh)
    kept = kept_of(*mesh, len(mesh[1]))
    beds = lay_beds(strata, mesh[0])
    return work.run(lambda job: eroded_within(job, mesh, kept, beds, strata, erosion), **options)


def crosses_itself(mesh):
    """Whether a closed mesh has a place that it goes around more than once, or in the wrong way."""
    model = fill_with_strata(*mesh, Strata(beds=1))
    return not np.isclose(model.blocks[0].volume, volume(*mesh), rtol=1e-9)


@settings(max_examples=15, deadline=None)
@given(
    st.integers(0, 10**6),
    st.floats(0.0, 20.0),
    st.floats(0.0, 0.45),
    st.sampled_from(["level", "folded", "overturned"]),
)
def test_closed_and_inside_at_any_strength(seed, strength, bumps, kind):
    strata = {
        "level": Strata(beds=7, seed=seed),
        "folded": Strata(
            beds=9, dip=30, fold_amplitude=0.2, fold_wavelength=1.3, faults=2, throw=0.2, seed=seed
        ),
        "overturned": Strata(beds=6, fold_amplitude=0.4, fold_wavelength=1.5, axial_dip=40, seed=seed),
    }[kind]
    mesh = ball(bumps=bumps)
    made = eroded(mesh, strata, replace(COARSE, strength=strength))
    assert not len(open_edges(*made))
    assert 0 < volume(*made) <= volume(*mesh) * 1.02
    assert not crosses_itself(made)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.integers(6, 30), st.floats(0.3, 1.0))
def test_an_arch_keeps_its_bridge(seed, beds, strength):
    """However thick its beds are: the thick base beside it does not count for it."""
    mesh = rock_shape("arch", 1.0, seed)
    made = eroded(mesh, Strata(beds=beds, seed=seed), replace(COARSE, strength=strength, faces=20_000))
    parts = connected(edges_of(made[1])).reshape(-1, len(made[1]))[0]
    of_top = made[1][parts == parts[made[0][made[1], 2].max(axis=1).argmax()]]
    assert made[0][:, 2].max() > 0.8 * mesh[0][:, 2].max()
    assert volume(made[0], of_top) > 0.9 * volume(*made)


PRESETS = (
    Strata(beds=24, variation=0.9, dip=2),
    Strata(beds=9, dip=18, unconformity=0.6),
    Strata(beds=16, dip=10, fold_amplitude=0.6, fold_wavelength=3.0),
    Strata(beds=16, dip=4, fold_amplitude=0.8, fold_wavelength=4.0, axial_dip=30),
    Strata(beds=14, dip=12, faults=3, throw=0.4, fault_strike=20),
)


def torus_knot(p, q, tube, n=90, m=9):
    """Around the z axis; a wide tube crosses itself."""
    u = 2 * np.pi * np.arange(n) / n
    line = np.stack(
        [(2 + np.cos(q * u)) * np.cos(p * u), (2 + np.cos(q * u)) * np.sin(p * u), -np.sin(q * u)], 1
    )
    along = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    right = np.cross(along, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right, axis=1)[:, None]
    turn = 2 * np.pi * np.arange(m) / m
    ring = np.cos(turn)[:, None] * right[:, None] + np.sin(turn)[:, None] * np.cross(along, right)[:, None]
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b, c, d = i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    vertices = (line[:, None] + tube * ring).reshape(-1, 3)
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    return (vertices, triangles) if volume(vertices, triangles) > 0 else (vertices, triangles[:, ::-1].copy())


@settings(max_examples=10, deadline=None)
@given(
    st.sampled_from(PRESETS),
    st.sampled_from([(2, 3), (3, 2), (2, 5), (3, 7)]),
    st.floats(0.15, 0.6),
    st.floats(0.0, 20.0),
    st.integers(0, 10**6),
)
def test_torus_knots_with_strata_of_all_kinds(strata, turns, tube, strength, seed):
    strata = replace(strata, seed=seed)
    made = eroded(torus_knot(*turns, tube), strata, replace(COARSE, strength=strength))
    assert not len(open_edges(*made))
    assert volume(*made) > 0
    assert not crosses_itself(made)
    model = fill_with_strata(*made, strata)
    beds = lay_beds(strata, made[0])
    divided = divided_at_beds(*made, beds)
    assert not len(open_edges(*divided))
    assert len(np.unique(divided[0], axis=0)) == len(divided[0])
    assert all(block.volume >= 0 for block in model.blocks)
    assert np.isclose(sum(block.volume for block in model.blocks), volume(*made), rtol=1e-7)


def test_soft_beds_recede():
    block = box((0, 0, 0), (40, 40, 20))
    strata = Strata(beds=10, variation=0.0, seed=5, palette="canyon")
    vertices, _ = eroded(block, strata, DifferentialErosion(joints=0.0, roughness=0.0, faces=60_000))
    hard = hardness_of_beds(10, strata)
    bed = lay_beds(strata, block[0]).numbers(vertices)
    inner = (vertices[:, 2] > 1.0) & (vertices[:, 2] < 17.0) & (np.abs(vertices[:, 1] - 20) < 10)
    at_wall = inner & (vertices[:, 0] < 12)
    soft = np.median(vertices[at_wall & (hard[bed] < 0.4), 0])
    firm = np.median(vertices[at_wall & (hard[bed] > 0.5), 0])
    assert soft > firm + 0.5


def test_the_base_stays_level_and_in_place():
    block = box((0, 0, -3), (10, 10, 5))
    vertices, _ = eroded(block)
    low = np.isclose(vertices[:, 2], -3.0, atol=1e-9)
    assert vertices[:, 2].min() >= -3.0 - 1e-9
    assert low.sum() > 100
    assert vertices[:, 2].max() < 5.0


def test_walls_that_close_an_open_mesh_stay():
    x, y = (a.ravel() for a in np.meshgrid(np.arange(9.0), np.arange(9.0), indexing="ij"))
    number = np.arange(81).reshape(9, 9)
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    ground = (
        np.column_stack([x, y, 4 + np.sin(x)]),
        np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]),
    )
    model = fill_with_strata(*ground, Strata(beds=4, base=0.0), erosion=COARSE)
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    assert np.allclose(low, 0.0, atol=1e-9)
    assert np.allclose(high[:2], 8.0, atol=1e-9)
    whole = sum(block.volume for block in fill_with_strata(*ground, Strata(beds=4, base=0.0)).blocks)
    assert 0.3 * whole < sum(block.volume for block in model.blocks) < 0.98 * whole


def test_beds_of_an_eroded_mesh_are_together_the_mesh():
    mesh = torus()
    model = fill_with_strata(*mesh, BEDS, erosion=COARSE)
    made = eroded(mesh)
    assert np.isclose(sum(block.volume for block in model.blocks), volume(*made), rtol=1e-9)


def test_the_same_for_any_number_of_threads():
    one, two = (eroded(ball(), threads=threads) for threads in (1, 2))
    assert one[0].tobytes() == two[0].tobytes() and one[1].tobytes() == two[1].tobytes()


def test_winding_numbers_of_nodes_on_edges_and_corners():
    solid = together(box((0, 0, 0), (4, 4, 4)), moved(box((0, 0, 0), (1, 1, 1)), (6, 1, 1)))
    corners = solid[0][solid[1]]
    lattice = cubic_lattice(np.array([-1.0, -1.0, -0.5]), 1.0, np.array([10, 7, 7]))
    around = winding(lattice, corners)
    assert set(np.unique(around)) == {0, 1}
    # a node above an edge counts as a little farther to the right and up
    assert around.sum() == 4 * 4 * 4 + 1


@pytest.mark.parametrize("kind", SHAPES)
def test_shapes_are_closed_and_stand_on_a_level_base(kind):
    vertices, triangles = rock_shape(kind, size=20.0, seed=3)
    assert not len(open_edges(vertices, triangles))
    assert volume(vertices, triangles) > 0
    assert np.isclose(vertices[:, 2].min(), 0.0, atol=1e-9)
    assert np.ptp(vertices, axis=0)[0] <= 20.0 + 1e-9
    again, other = rock_shape(kind, 20.0, 3), rock_shape(kind, 20.0, 4)
    assert again[0].tobytes() == vertices.tobytes()
    assert other[0].tobytes() != vertices.tobytes()


def test_refused_values():
    for values in (
        {"strength": -1},
        {"strength": 21},
        {"joints": 3},
        {"faces": 10},
        {"roughness": float("nan")},
    ):
        with pytest.raises(UsageError, match=next(iter(values))):
            DifferentialErosion(**values)
    with pytest.raises(UsageError, match="kind must be one of cliff"):
        rock_shape("cave")
    with pytest.raises(UsageError, match="size"):
        rock_shape("cliff", size=0.0)
    with pytest.raises(InputRefused, match="no volume that erosion could see"):
        eroded(box((0, 0, 0), (10, 10, 0.001)), erosion=DifferentialErosion(faces=1000))


def test_cancel():
    with pytest.raises(Cancelled):
        eroded(ball(), erosion=DifferentialErosion(faces=500_000), cancel=lambda: True)


@pytest.mark.parametrize(
    "strata",
    [
        Strata(beds=30, dip=20, variation=1.0),
        Strata(
            beds=9, dip=30, fold_amplitude=0.3, fold_wavelength=1.3, faults=3, throw=0.3, unconformity=0.6
        ),
        Strata(beds=7, fold_amplitude=0.5, fold_wavelength=1.5, axial_dip=40),
    ],
)
def test_a_mesh_divided_at_beds(strata):
    mesh = ball()
    beds = lay_beds(strata, mesh[0])
    vertices, triangles = divided_at_beds(*mesh, beds)
    assert vertices[: len(mesh[0])].tobytes() == mesh[0].tobytes()
    assert len(np.unique(vertices, axis=0)) == len(vertices), "edges in a boundary are not divided again"
    assert not len(open_edges(vertices, triangles))
    assert np.isclose(volume(vertices, triangles), volume(*mesh), rtol=1e-12)
    corners = vertices[triangles]
    inner = corners.mean(axis=1)[:, None] * 0.9 + corners * 0.1
    bed = beds.numbers(inner.reshape(-1, 3)).reshape(-1, 3)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    of_one = (bed == bed[:, :1]).all(axis=1)
    assert areas[of_one].sum() > 0.98 * areas.sum(), "but folds, which are not linear along an edge"


def test_scree_leans_against_walls_at_its_angle():
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.0, 41.0), np.arange(0.0, 21.0), indexing="ij"))
    number = np.arange(41 * 21).reshape(41, 21)
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    ground = np.column_stack([x, y, np.where(x < 20, 12.0, 2.0)])
    mesh = closed_mesh(ground, triangles, 0.0)
    vertices, made, down = work.run(lambda job: scree_within(job, mesh, 1.0, 34.0, 3, 60_000))
    assert not len(open_edges(vertices, made))
    assert volume(vertices, made) > 0
    corners = vertices[made]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = normal[:, 2] / np.linalg.norm(normal, axis=1)
    middle = corners.mean(axis=1)
    open_ = (middle[:, 0] > 20.5) & (up > 0.3) & (middle[:, 2] > 2.5)
    slope = np.degrees(np.arccos(np.average(up[open_], weights=np.linalg.norm(normal[open_], axis=1))))
    assert 28.0 < slope < 40.0
    assert vertices[:, 2].max() < 10.0
    assert (vertices[:, 0] < 36.0).all()
    assert ((down >= 0.0) & (down <= 1.0)).all()
    seen = np.unique(made[open_])
    seen = seen[np.abs(vertices[seen, 1] - 10.0) < 4.0]
    assert np.corrcoef(down[seen], vertices[seen, 0])[0, 1] > 0.8, "it goes down away from the wall"
    at_end = (vertices[:, 1] < 0.7) & (vertices[:, 0] > 20.5)
    assert vertices[at_end, 2].max(initial=2.0) < 3.0, "nothing holds it beside the end of the ground"
    with pytest.raises(InputRefused, match="no wall"):
        work.run(lambda job: scree_within(job, box((0, 0, 0), (10, 10, 5)), 1.0, 34.0, 3, 5000))


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**31 - 1), st.floats(1e-3, 1e4))
def test_a_piece_of_rubble_is_closed_convex_and_as_thick_as_its_bed(seed, thickness):
    vertices, triangles = work.run(lambda job: broken_piece(job, thickness, seed))
    assert not len(open_edges(vertices, triangles))
    size = np.ptp(vertices, axis=0)
    assert 0.05 * thickness**3 < volume(vertices, triangles) < size.prod()
    assert 0.3 * thickness < size[2] <= thickness * (1 + 1e-9)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    above = np.einsum("tk,tvk->tv", normal, vertices[None] - a[:, None])
    assert above.max() < 1e-9 * thickness**3
    assert vertices[:, 2].min() < 0.0 < vertices[:, 2].max(), "a part of it lies in the ground"


def test_rubble_is_of_hard_beds():
    mesh = rock_shape("canyon", 20.0)
    strata = Strata(beds=24, variation=0.9)
    beds = lay_beds(strata, mesh[0])
    unit = mean_thickness(beds, mesh[0])
    pieces = work.run(lambda job: rubble_within(job, beds, strata, unit))
    again = work.run(lambda job: rubble_within(job, beds, strata, unit))
    assert len(pieces) == PIECES
    assert [piece[0].tobytes() for _, piece in pieces] == [piece[0].tobytes() for _, piece in again]
    hard = hardness_of_beds(24, strata)
    assert hard[[bed for bed, _ in pieces]].mean() > hard.mean()
    thick = np.diff(beds.levels)
    for bed, (vertices, _) in pieces:
        if 0 < bed < 23 and 0.5 * unit < thick[bed - 1] < 2.0 * unit:
            assert np.ptp(vertices[:, 2]) <= thick[bed - 1] * 1.001


def test_joints_are_lines_on_the_walls_of_beds():
    """At about the distances that the thickness of the bed sets; continuous within a bed."""
    strata = Strata(beds=4, variation=0.0, seed=3)
    corners, _ = box((0, 0, 0), (40, 40, 8))
    beds = lay_beds(strata, corners)
    unit = mean_thickness(beds, corners)
    assert np.isclose(unit, 2.0)
    x = np.linspace(0.0, 40.0, 4001)
    near = joints_at(np.column_stack([x, 0 * x + 7.0, 0 * x + 3.0]), beds, strata, unit)
    assert near.dtype == np.float32 and near.min() >= 0.0 and near.max() <= 1.0
    crossed = np.count_nonzero((near[1:-1] > near[:-2]) & (near[1:-1] >= near[2:]) & (near[1:-1] > 0.9))
    assert 40 / (6 * unit) < crossed < 40 / (0.5 * unit)
    assert np.abs(np.diff(near)).max() < 0.2
    assert (near > 0.5).mean() < 0.3
