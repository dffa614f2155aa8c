# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in any solid: the beds are closed and together the solid, and lie where the formulas say."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import Cancelled, InputRefused, Strata, UsageError, fill_with_strata
from realmodel.core.filling import PALETTES, closed_mesh, lay_beds
from solids import box, moved, together, torus, volume

FOLDED = Strata(
    beds=8,
    dip=15,
    fold_amplitude=0.3,
    fold_wavelength=2.0,
    fold_axis=40,
    faults=3,
    throw=0.4,
    fault_strike=100,
)
CASES = {
    "level": Strata(beds=5),
    "steep": Strata(beds=9, dip=85, dip_direction=200, faults=2, throw=0.6, fault_strike=70),
    "folded": FOLDED,
    "overturned": replace(FOLDED, fold_amplitude=0.5, axial_dip=30, fault_strike=130),
    "recumbent": Strata(
        beds=7,
        dip=20,
        dip_direction=90,
        fold_amplitude=0.6,
        fold_wavelength=3,
        axial_dip=10,
        unconformity=0.7,
    ),
    "parallel": Strata(beds=6, dip=30, fold_amplitude=0.2, fold_wavelength=1.5, faults=2, throw=0.5, seed=3),
    "unconformity": Strata(beds=9, dip=40, dip_direction=10, faults=2, throw=0.5, unconformity=0.6, seed=2),
}


def ball(steps=3, bumps=0.2):
    """A bumpy ball."""
    vertices = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    triangles = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    triangles = np.array(triangles)
    for _ in range(steps):
        sides = np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
        edges, same = np.unique(sides, axis=0, return_inverse=True)
        a, b, c = same.reshape(3, -1) + len(vertices)
        middles = vertices[edges].sum(axis=1)
        vertices = np.concatenate([vertices, middles / np.linalg.norm(middles, axis=1)[:, None]])
        x, y, z = triangles.T
        parts = [(x, a, c), (y, b, a), (z, c, b), (a, b, c)]
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    x, y, z = vertices.T
    return vertices * (1 + bumps * np.sin(5 * x + 2 * z) * np.cos(4 * y))[:, None], triangles


def terrain(n=12):
    """A heightmap over a square of 10."""
    x, y = (each.ravel() for each in np.meshgrid(*2 * [np.linspace(0, 10, n + 1)], indexing="ij"))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.column_stack([first, first + n + 1, first + n + 2])
    upper = np.column_stack([first, first + n + 2, first + 1])
    return np.column_stack([x, y, 2 + np.sin(x) * np.cos(y)]), np.concatenate([lower, upper])


def fans(boundary):
    """The triangles of a block's boundary."""
    found = []
    for begin, end in zip(boundary.face_offsets[:-1], boundary.face_offsets[1:], strict=True):
        corners = boundary.face_vertices[begin:end].tolist()
        found += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    return np.array(found)


def inside(point, vertices, triangles):
    """Whether the boundary winds around a point (van Oosterom and Strackee 1983)."""
    a, b, c = (vertices[triangles] - point).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    below = x * y * z + (a * b).sum(1) * z + (b * c).sum(1) * x + (c * a).sum(1) * y
    return np.arctan2((a * np.cross(b, c)).sum(1), below).sum() / (2 * math.pi) > 0.5


def blocks_of(model, points):
    """(N,) the block that each point is in, -1: none."""
    found = np.full(len(points), -1)
    for number, block in enumerate(model.blocks):
        if block.cells:
            boundary = model.block_boundary(number)
            triangles = fans(boundary)
            found[[inside(point, boundary.vertices, triangles) for point in points]] = number
    return found


@pytest.mark.parametrize("name", CASES)
def test_beds_are_closed_and_together_the_solid(name):
    vertices, triangles = ball()
    model = fill_with_strata(vertices, triangles, CASES[name])
    assert model.validate().passed
    assert model.volume == pytest.approx(volume(vertices, triangles), rel=1e-12)
    assert [block.name for block in model.blocks] == [f"Bed {n + 1}" for n in range(CASES[name].beds)]
    for number, block in enumerate(model.blocks):
        boundary = model.block_boundary(number)
        assert block.volume > 0
        assert volume(boundary.vertices, fans(boundary)) == pytest.approx(block.volume, rel=1e-9)
    kept = set(map(tuple, model.vertices.tolist()))
    assert kept.issuperset(map(tuple, vertices.tolist()))


@pytest.mark.parametrize("name", CASES)
def test_the_preview_shows_what_is_made(name):
    vertices, triangles = ball()
    random = np.random.default_rng(5)
    points = vertices[random.integers(0, len(vertices), 60)] * random.uniform(0.05, 0.97, (60, 1))
    expected = lay_beds(CASES[name], vertices).numbers(points)
    assert (blocks_of(fill_with_strata(vertices, triangles, CASES[name]), points) == expected).all()


def test_level_beds_of_equal_thickness():
    model = fill_with_strata(*box((0, 0, 0), (2, 3, 4)), Strata(beds=8, variation=0))
    assert [block.volume for block in model.blocks] == pytest.approx([3.0] * 8)


def test_dipping_beds_have_their_thickness_at_right_angles():
    strata = Strata(beds=7, thickness=0.5, variation=0, dip=60, dip_direction=90)
    model = fill_with_strata(*box((-9, -1, -9), (9, 1, 9)), strata)
    # a bed that crosses the box from its floor to its roof: thickness times its area
    assert model.blocks[3].volume == pytest.approx(0.5 * 2 * 18 / math.sin(math.radians(60)))
    points = np.array([(x, 0.0, -math.tan(math.radians(60)) * x) for x in (-5.0, 0.0, 5.0)])
    assert (lay_beds(strata, np.array([(-9.0, -1, -9), (9, 1, 9)])).numbers(points) == 3).all()


def test_a_fault_moves_beds_by_its_throw():
    corners = box((0, 0, 0), (10, 4, 8))
    strata = Strata(beds=4, variation=0, faults=1, throw=1.0, fault_strike=0)
    beds = lay_beds(strata, corners[0])
    (position,) = beds.fault[1] + 5.0
    assert 0 < position < 10
    plan = np.array([(position - 0.01, 1.0), (position + 0.01, 1.0)])
    west, east = beds.datum(plan, beds.strips(plan))
    assert abs(east - west) == 1.0
    model = fill_with_strata(*corners, strata)
    assert model.volume == pytest.approx(320)
    thick = 2.25  # the beds reach over the height and the throw
    assert model.blocks[1].volume == pytest.approx(thick * 40)


def test_folds_have_their_amplitude_and_wavelength():
    strata = Strata(beds=3, fold_amplitude=0.7, fold_wavelength=4.0, fold_axis=90)
    beds = lay_beds(strata, box((0, 0, 0), (10, 12, 5))[0])
    plan = np.column_stack([np.full(2401, 3.0), np.linspace(0, 12, 2401)])
    heights = beds.datum(plan, beds.strips(plan))
    assert (heights.min(), heights.max()) == pytest.approx((-0.7, 0.7), abs=1e-3)
    assert heights[:-800] == pytest.approx(heights[800:], abs=1e-9)
    along = beds.datum(plan[:, ::-1], beds.strips(plan[:, ::-1]))
    assert along[:100] == pytest.approx(along[0])


def test_overturned_folds():
    """Older rock lies above younger, and the axial planes dip as they should."""
    strata = Strata(beds=9, variation=0, fold_amplitude=1.0, fold_wavelength=4.0, axial_dip=45, fold_axis=0)
    corners = box((0, 0, 0), (12, 3, 6))
    beds = lay_beds(strata, corners[0])
    heights = np.linspace(0, 6, 3001)

    def above(x, y):
        return beds.numbers(np.column_stack([np.full(3001, x), np.full(3001, y), heights]))

    assert any((np.diff(above(x, 1.0)) < 0).any() for x in np.linspace(1, 11, 21))
    axial = np.column_stack([heights + 1.0, np.full(3001, 1.0), heights])  # a line in such a plane
    assert (np.diff(beds.numbers(axial)) >= 0).all()
    assert (above(3.0, 0.5) == above(3.0, 2.5)).all()
    model = fill_with_strata(*corners, strata)
    assert model.validate().passed
    assert model.volume == pytest.approx(216, rel=1e-12)
    inner = np.random.default_rng(1).uniform((0, 0, 0), (12, 3, 6), (80, 3))
    assert (blocks_of(model, inner) == beds.numbers(inner)).all()


def test_beds_keep_their_dip_and_thickness_where_their_folds_lean():
    plain = Strata(beds=7, thickness=0.5, variation=0, dip=40, dip_direction=70)
    leaning = replace(plain, fold_amplitude=1e-9, fold_wavelength=9, axial_dip=35, fold_axis=100)
    corners = np.array([(-9.0, -9, -9), (9, 9, 9)])
    points = np.random.default_rng(2).uniform(-1, 1, (400, 3))
    one, other = (lay_beds(strata, corners).numbers(points) for strata in (plain, leaning))
    assert np.abs(one - other).max() <= 1 and len(set(one.tolist())) > 3
    step = np.array(
        [math.sin(math.radians(40)) * math.sin(math.radians(70)), 0.0, math.cos(math.radians(40))]
    )
    step[1] = math.sin(math.radians(40)) * math.cos(math.radians(70))  # at right angles to the beds
    through = lay_beds(leaning, corners).numbers(np.linspace(-1.2, 1.2, 2401)[:, None] * step)
    assert np.unique(through, return_counts=True)[1][1:-1] == pytest.approx(500, abs=2)
    with pytest.raises(InputRefused, match=r"as steep as the axial planes .*; choose a smaller dip"):
        lay_beds(replace(leaning, dip=60, dip_direction=10), corners)


def test_level_beds_cover_an_unconformity():
    corners = box((0, 0, 0), (10, 10, 10))
    strata = Strata(beds=10, dip=30, unconformity=0.7, variation=0)
    model = fill_with_strata(*corners, strata)
    assert sum(block.volume for block in model.blocks[7:]) == pytest.approx(300)
    assert [block.volume for block in model.blocks[7:]] == pytest.approx([100] * 3)
    levels = model.block_boundary(8).vertices[:, 2]
    assert np.unique(levels.round(9)) == pytest.approx([8, 9])


PRINT = Strata(beds=4, variation=0, gap=0.1, pegs=2, peg_size=1.0)


def test_gaps_and_pegs():
    model = fill_with_strata(*box((0, 0, 0), (10, 10, 10)), PRINT)
    gaps = {block.name: block.volume for block in model.blocks if not block.property}
    beds = [block.volume for block in model.blocks if block.property]
    # a hole is as much wider as the gap on each side, and as much higher in all
    taken, added = 2 * 1.2**2 * 1.0, 2 * 1.0
    assert gaps == pytest.approx({f"Gap {n}": 10 + taken - added for n in (1, 2, 3)})
    assert beds == pytest.approx([247.5 - 2.5 + added, *2 * [240 - taken + added], 245 - taken])
    assert model.warnings == [] and model.validate().passed
    heights = np.unique(model.block_boundary(0).vertices[:, 2].round(9))
    assert heights.tolist() == [0, 2.45, 3.45]


@pytest.mark.parametrize("name", CASES)
def test_gaps_part_all_beds(name):
    """In folds, along faults and over an unconformity."""
    pegs = 0 if CASES[name].has_leaning_folds else 3
    strata = replace(CASES[name], gap=0.01, pegs=pegs, peg_size=0.12)
    vertices, triangles = ball()
    model = fill_with_strata(vertices, triangles, strata)
    assert model.validate().passed
    assert model.volume == pytest.approx(volume(vertices, triangles), rel=1e-12)
    beds = [block for block in model.blocks if block.property]
    assert [block.name for block in beds] == [f"Bed {n + 1}" for n in range(strata.beds)]
    assert all(block.volume > 0 for block in beds)
    number_of = np.append([block.property > 0 for block in model.blocks], False)
    both = number_of[model.face_blocks].all(axis=1) & (model.face_blocks[:, 0] != model.face_blocks[:, 1])
    assert not both.any()
    assert ("Gap at Faults" in {block.name for block in model.blocks}) == bool(strata.faults)


def test_a_gap_at_a_fault_has_its_width():
    strata = Strata(beds=4, variation=0, faults=1, throw=1.0, gap=0.25)
    model = fill_with_strata(*box((0, 0, 0), (10, 4, 8)), strata)
    (gap,) = (block for block in model.blocks if block.name == "Gap at Faults")
    assert gap.volume == pytest.approx(0.25 * 4 * 8)


def test_pegs_need_room():
    strata = replace(PRINT, peg_size=4.0)
    assert fill_with_strata(*box((0, 0, 0), (40, 40, 10)), strata).warnings == []
    narrow = fill_with_strata(*box((0, 0, 0), (5, 5, 10)), strata)
    assert [warning.text for warning in narrow.warnings] == [
        "there is room for only 0 of the pegs; 6 are left out"
    ]
    with pytest.raises(InputRefused, match=r"gaps of 3 leave nothing of a bed of 2\.5; choose smaller gaps"):
        fill_with_strata(*box((0, 0, 0), (9, 9, 10)), replace(PRINT, gap=3.0))
    with pytest.raises(UsageError, match="peg_size and gap must be above 0"):
        Strata(pegs=1, peg_size=1.0)


def test_several_parts_holes_and_parts_that_cross():
    rings = together(torus(), moved(torus(), by=(0, 0, 3)))
    assert fill_with_strata(*rings, Strata(dip=20)).volume == pytest.approx(volume(*rings))
    outer, inner = box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (2, 2, 2))
    hollow = together(outer, (inner[0], inner[1][:, ::-1]))
    assert fill_with_strata(*hollow, Strata()).volume == pytest.approx(63)
    crossing = together(outer, box((3, 0, 0), (6, 4, 4)))
    assert fill_with_strata(*crossing, Strata()).volume == pytest.approx(96)


def test_a_terrain_is_filled_down_to_its_base():
    vertices, triangles = terrain()
    for given in (triangles, triangles[:, ::-1]):
        model = fill_with_strata(vertices, given, Strata(dip=10, base=-3.0))
        corners = vertices[triangles]
        sides = corners[:, 1:, :2] - corners[:, :1, :2]
        plan = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
        assert model.volume == pytest.approx((plan * (corners[:, :, 2].mean(axis=1) + 3)).sum())
        assert model.validate().passed
    closed, _ = closed_mesh(vertices, triangles)
    assert (closed[: len(vertices)] == vertices).all()
    lowest, highest = vertices[:, 2].min(), vertices[:, 2].max()
    assert closed[:, 2].min() == pytest.approx(2 * lowest - highest)


def test_a_terrain_with_a_hole():
    vertices, triangles = terrain()
    middle = vertices[triangles].mean(axis=1)[:, :2]
    rest = triangles[(np.abs(middle - 5) > 1.5).any(axis=1)]
    filled = fill_with_strata(vertices, rest, Strata(base=0.0)).volume
    whole = fill_with_strata(vertices, triangles, Strata(base=0.0)).volume
    assert 0.8 * whole < filled < whole


def test_refusals_name_the_place_and_what_to_do():
    vertices, triangles = ball()
    with pytest.raises(InputRefused, match=r"the mesh: it is open, for example near .*; close it") as caught:
        fill_with_strata(vertices, triangles[1:], Strata())
    assert caught.value.place is not None
    with pytest.raises(InputRefused, match=r"not above the base at 1\.5; choose a deeper base"):
        fill_with_strata(*terrain(), Strata(base=1.5))
    apart = together(terrain(), moved(terrain(), by=(20, 0, 0)))
    with pytest.raises(InputRefused, match="open and in 2 parts"):
        fill_with_strata(*apart, Strata(base=0.0))
    mixed = triangles.copy()
    mixed[:100] = mixed[:100, ::-1]
    with pytest.raises(InputRefused, match="the mesh: its triangles face both ways"):
        fill_with_strata(vertices, mixed, Strata())
    flat = np.concatenate([triangles[:1], triangles[:1, ::-1]])
    with pytest.raises(InputRefused, match="it holds no volume"):
        fill_with_strata(vertices, flat, Strata())
    with pytest.raises(InputRefused, match=r"too narrow for a solid .*; choose a wavelength of"):
        fill_with_strata(vertices, triangles, Strata(fold_amplitude=1, fold_wavelength=1e-4))


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"beds": 0}, "beds must be from 1 to 200"),
        ({"beds": 2.0}, "beds must be a whole number"),
        ({"dip": 86}, "dip must be from 0 to 85"),
        ({"throw": math.nan}, "throw must be finite"),
        ({"thickness": "thin"}, "thickness must be a number"),
        ({"palette": "rainbow"}, "palette must be one of"),
        ({"beds": 1, "unconformity": 0.5}, "beds must be 2 or more"),
        ({"axial_dip": 5}, "axial_dip must be from 10 to 90"),
        (
            {"fold_amplitude": 1, "fold_wavelength": 1, "axial_dip": 40, "faults": 1, "fold_axis": 10},
            "fault_strike must be at right angles to fold_axis where axial_dip is below 90, such as 100",
        ),
        (
            {"fold_amplitude": 1, "fold_wavelength": 1, "axial_dip": 40, "pegs": 1, "peg_size": 1, "gap": 1},
            "pegs must be 0 if axial_dip is below 90",
        ),
        ({"fold_wavelength": -1}, "fold_wavelength must be at least 0"),
    ],
)
def test_settings_out_of_range(settings, says):
    with pytest.raises(UsageError, match=says):
        Strata(**settings)


def test_the_same_seed_gives_the_same_beds_and_another_gives_others():
    vertices, triangles = ball()
    strata = Strata(beds=9, dip=20, faults=2, throw=0.2, seed=7)
    one, same = (fill_with_strata(vertices, triangles, strata, threads=threads) for threads in (1, 2))
    assert one.vertices.tobytes() == same.vertices.tobytes()
    assert one.face_vertices.tobytes() == same.face_vertices.tobytes()
    other = fill_with_strata(vertices, triangles, Strata(beds=9, dip=20, faults=2, throw=0.2, seed=8))
    assert other.vertices.tobytes() != one.vertices.tobytes()


@pytest.mark.parametrize("palette", PALETTES)
def test_rocks_of_a_palette(palette):
    model = fill_with_strata(*box((0, 0, 0), (1, 1, 1)), Strata(beds=40, palette=palette))
    numbers = [block.property for block in model.blocks]
    assert all(a != b for a, b in pairwise(numbers))
    assert {model.project.library.get(n).name for n in numbers} == {name for name, _ in PALETTES[palette]}


def test_filling_can_be_cancelled():
    with pytest.raises(Cancelled):
        fill_with_strata(*ball(5), Strata(dip=10), cancel=lambda: True)
