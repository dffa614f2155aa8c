# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutting finished models: halves that are models, sections, fences."""

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Cancelled, InputRefused, Project, Rock, Surface, UsageError, build


def made(heights, n=6, cells="columns", base=-2.0, size=1.0):
    """A model of surfaces over the unit square, heights as functions of x and y."""
    surfaces = []
    for number, height in enumerate(heights):
        vertices, triangles = grid_surface(n + number, height, size)
        surfaces.append(Surface(f"S{number}", vertices=vertices, triangles=triangles, property=number + 1))
    return build(Project("cut", [Rock("rock", surfaces=surfaces, base_elevation=base)]), cells=cells)


def waves():
    return [
        lambda x, y: 0.3 * np.sin(4 * x) + 0 * y,
        lambda x, y: 0.4 + 0.2 * np.cos(5 * y) * x,
        lambda x, y: 0.5 - 0.6 * x + 0.5 * y * y,
    ]


PLANES = [
    ((0.37, 0.5, 0.1), (1.0, 0.4, 0.2)),
    ((0.5, 0.43, 0.0), (0.0, 1.0, 0.0)),
    ((0.5, 0.5, 0.21), (0.1, -0.2, 1.0)),
]


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("point, normal", PLANES)
def test_section_area_is_how_fast_the_volume_below_grows(cells, point, normal):
    model = made(waves(), cells=cells)
    point, normal = np.array(point), np.array(normal) / np.linalg.norm(normal)
    section = model.section(point, normal)
    step = 1e-5
    volumes = []
    for side in (-1, 1):
        below = model.cut_by_plane(point + side * step * normal, normal).below
        volumes.append([block.volume for block in below.blocks])
    growth = (np.array(volumes[1]) - volumes[0]) / (2 * step)
    assert section.area_by_block() == pytest.approx(growth, abs=2e-5)
    assert section.area == pytest.approx(growth.sum(), abs=5e-5)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_halves_are_models_that_can_be_saved_and_cut_again(cells, tmp_path):
    model = made(waves(), cells=cells)
    before = model.vertices.copy(), model.face_cells.copy()
    cut = model.cut_by_plane((0.4, 0.5, 0.1), (1, 0.3, 0))
    assert (model.vertices == before[0]).all() and (model.face_cells == before[1]).all()
    for number, block in enumerate(model.blocks):
        parts = cut.above.blocks[number].volume, cut.below.blocks[number].volume
        assert sum(parts) == pytest.approx(block.volume, rel=1e-12)
    assert (model.cell_block[cut.above_cells] == cut.above.cell_block).all()
    assert (cut.above.face_surface == -3).sum() == len(cut.section) == (cut.below.face_surface == -3).sum()
    for name in ("npz", "vtu"):
        cut.above.save(tmp_path / f"above.{name}")
    with np.load(tmp_path / "above.npz") as saved:
        assert saved["block_volume"] == pytest.approx([block.volume for block in cut.above.blocks])
        assert str(saved["cell_kind"]) == cells
    again = cut.above.cut_by_plane((0, 0, 0.2), (0, 0, 1))
    assert again.above.volume + again.below.volume == pytest.approx(cut.above.volume, rel=1e-12)
    assert cut.above.validate().passed and cut.below.validate().passed
    with pytest.raises(UsageError, match="stage of the whole model"):
        cut.above.stage(0)
    boundary = cut.below.block_boundary(1)
    assert (boundary.face_surface == -3).any()


def test_along_a_surface_the_section_names_both_blocks():
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + 0 * x])
    section = model.section((0, 0, 0), (0, 0, 1))
    assert (section.blocks == [0, 1]).all()
    assert (section.block == 0).all() and (section.property == 1).all()
    assert section.area == pytest.approx(1.0)
    below = model.section((0, 0, 0), (0, 0, -1))
    assert (below.block == 1).all()
    top = model.section((0, 0, 1), (0, 0, 1))
    assert (top.blocks == [1, -1]).all()
    assert model.section((0, 0, 5), (0, 0, 1)).area == 0


def test_polygons_turn_left_seen_from_above():
    section = made(waves()).section((0.4, 0.5, 0.1), (0.2, 0.1, 1))
    for k in range(len(section)):
        x, y, _ = section.polygon(k).T
        assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > -1e-15  # a corner may just be touched


def test_a_fence_is_as_long_as_its_polyline():
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + x], base=-1.0)
    line = np.array([[0.1, 0.2], [0.7, 0.2], [0.7, 0.9], [0.3, 0.6]])
    fence = model.fence(line)
    lengths = np.hypot(*np.diff(line, axis=0).T)
    by_panel = np.bincount(fence.panel, weights=fence.polygon_areas)
    assert by_panel == pytest.approx([0.6 * 2.4, 0.7 * 2.7, lengths[2] * 2.5])
    assert fence.area_by_block()[0] == pytest.approx(lengths.sum())
    unrolled = fence.unrolled()
    assert unrolled[:, 0].min() == pytest.approx(0.0, abs=1e-12)
    assert unrolled[:, 0].max() == pytest.approx(lengths.sum())
    doubled = 0.0
    for k in range(len(fence)):
        along, z = unrolled[fence.polygon_vertices[fence.offsets[k] : fence.offsets[k + 1]]].T
        part = (along * np.roll(z, -1) - z * np.roll(along, -1)).sum()
        assert part > 0
        doubled += part
    assert doubled / 2 == pytest.approx(fence.area)


def test_a_fence_along_the_border_and_beyond():
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + 0 * x], base=-1.0)
    assert model.fence([[-1, 0.5], [3, 0.5]]).area == pytest.approx(2.0)
    assert model.fence([[0, 0], [1, 0]]).area == pytest.approx(2.0)
    assert model.fence([[5, 5], [6, 7]]).area == 0


def test_a_section_is_saved(tmp_path):
    section = made(waves()).section((0.4, 0.5, 0.1), (1, 0, 0))
    section.save(tmp_path / "section.npz")
    with np.load(tmp_path / "section.npz") as saved:
        assert set(saved.files) == set(section.arrays())
        assert (saved["block"] == section.block).all()
    with pytest.raises(UsageError, match="npz"):
        section.save(tmp_path / "section.txt")


@pytest.mark.parametrize(
    "point, normal, words",
    [
        ((0, 0), (0, 0, 1), "point must be three finite numbers"),
        ((0, 0, np.inf), (0, 0, 1), "point must be three finite numbers"),
        ((0, 0, 0), (0, 0, 0), "normal must not be zero"),
        ((0, 0, 0), "up", "normal must be three numbers"),
    ],
)
def test_a_plane_that_is_none(point, normal, words):
    with pytest.raises(UsageError, match=words):
        made(waves()).section(point, normal)


@pytest.mark.parametrize(
    "line, words",
    [
        ([[0, 0]], "N > 1"),
        ([[0, 0], [np.nan, 1]], "finite"),
        ([[0, 0], [1, 1], [1, 1]], "two consecutive points that are equal"),
    ],
)
def test_a_polyline_that_is_none(line, words):
    with pytest.raises(UsageError, match=words):
        made(waves()).fence(line)


def box(low, high):
    """A closed surface: the corners and triangles of a box."""
    corners = np.array(
        [
            [(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]]
            for i in (0, 1)
            for j in (0, 1)
            for k in (0, 1)
        ],
        float,
    )
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_level_surface_cuts_as_a_plane_does(cells):
    model = made(waves(), n=5, cells=cells)
    by_plane = model.cut_by_plane((0, 0, 0.1), (0, 0, 1))
    vertices, triangles = grid_surface(3, lambda x, y: 0.1 + 0 * x, 3.0)
    by_surface = model.cut_by_surface(vertices - [1, 1, 0], triangles)
    for half in ("above", "below"):
        volumes = [[block.volume for block in getattr(cut, half).blocks] for cut in (by_plane, by_surface)]
        assert volumes[0] == pytest.approx(volumes[1], rel=1e-12, abs=1e-14)
    assert by_surface.section.area_by_block() == pytest.approx(by_plane.section.area_by_block())


def test_a_surface_that_was_eroded_away_shows_what_it_would_have_left():
    # above and below a surface that the model was built from and lost: the volumes of the closed form
    flat = [lambda x, y: 0 * x, lambda x, y: 1 + 0 * x]
    model = made(flat, base=-1.0)
    vertices, triangles = grid_surface(5, lambda x, y: 1.5 - 2 * x, 1.0)
    cut = model.cut_by_surface(vertices, triangles)
    x = np.linspace(0, 1, 200001)
    height = np.clip(1.5 - 2 * x, -1, 1)
    assert cut.below.volume == pytest.approx(np.trapezoid(height + 1, x), abs=1e-9)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_the_inside_of_a_box(cells, tmp_path):
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + 0 * x], cells=cells, base=-1.0)
    cut = model.cut_by_surface(*box((0.25, 0.25, -0.5), (0.75, 2.0, 0.5)))
    assert [block.volume for block in cut.inside.blocks] == pytest.approx([0.1875, 0.1875])
    assert cut.outside.volume == pytest.approx(2.0 - 0.375)
    assert cut.section.area == pytest.approx(2 * 0.75 * 1.0 + 0.5 * 1.0 + 2 * 0.5 * 0.75)
    cut.outside.save(tmp_path / "outside.vtu")
    assert cut.inside.validate().passed and cut.outside.validate().passed


def test_a_block_of_its_own_is_taken_out_whole():
    model = made(waves())
    cut = model.cut_by_block(model, 1)
    assert cut.inside.volume == model.blocks[1].volume
    assert set(cut.inside.cell_block) == {1} and 1 not in cut.outside.cell_block
    assert (cut.section.blocks == 1).any(axis=1).all()
    named = model.cut_by_block(model, model.blocks[1].name)
    assert (named.inside.face_vertices == cut.inside.face_vertices).all()


def test_a_block_of_another_model():
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + 0 * x], base=-1.0)
    other = made([lambda x, y: -0.5 + 0 * x, lambda x, y: 0.25 + x], n=3, base=-3.0)
    cut = model.cut_by_block(other, 1)
    x = np.linspace(0, 1, 200001)
    assert cut.inside.blocks[0].volume == pytest.approx(0.5)
    assert cut.inside.blocks[1].volume == pytest.approx(np.trapezoid(np.minimum(0.25 + x, 1), x), abs=1e-9)


def test_what_is_refused_says_where():
    model = made([lambda x, y: 0 * x, lambda x, y: 1 + 0 * x])
    vertices, triangles = grid_surface(2, lambda x, y: 0.5 + 0 * x, 0.5)
    with pytest.raises(
        InputRefused, match=r"ends inside of it near .*; extend it beyond the model"
    ) as refused:
        model.cut_by_surface(vertices, triangles)
    assert refused.value.place[2] == 0.5
    with pytest.raises(InputRefused, match="names vertices"):
        model.cut_by_surface(vertices, triangles + 100)
    with pytest.raises(UsageError, match="there is no block 7; blocks are"):
        model.cut_by_block(model, 7)
    with pytest.raises(UsageError, match="no block named 'chalk'"):
        model.cut_by_block(model, "chalk")
    lying = made([lambda x, y: 0 * x, lambda x, y: 0 * x])
    with pytest.raises(InputRefused, match="no cells; choose a block that has cells"):
        model.cut_by_block(lying, 1)


def test_cutting_is_cancelled():
    for n in (60, 120, 240):  # until the cut takes longer than it takes to ask
        model = made(waves(), n=n)
        try:
            model.cut_by_plane((0.5, 0.5, 0.3), (0, 0.2, 1), cancel=lambda: True, progress=lambda *_: None)
        except Cancelled:
            return
    pytest.fail("cut to the end, though asked to stop from the first moment on")
