# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes on sections and fences: those within a width, moved onto them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Observations, Project, Rock, Surface, build
from realmodel.core.drawing.drawing import FilledRings, Line, Text
from realmodel.core.results.sections.section_drawing import draw_section, holes_on
from realmodel.core.results.sections.section_holes import UNKNOWN, hole_lines, near_plane


@pytest.fixture(scope="module")
def model():
    surfaces = [
        Surface(name, method="constant", options={"value": z}, block=block)
        for name, block, z in (("clay", "Clay", 4.0), ("sand", "Sand", 10.0))
    ]
    seen = Observations(
        [(3, 5, 10), (3, 5, 4), (3, 5, 4), (3, 5, 1), (8, 7, 10), (8, 3, 2)],
        ["sand", "sand", "clay", "clay", "Sand", "Sand"],
        ["B1"] * 4 + ["B2"] * 2,
    )
    picks = {"P1": (np.array([6.0, 5.0, 10.0]), [("sand", [6.0, 5.0, 9.0]), ("clay", [6.0, 5.0, 3.0])])}
    rock = Rock("rock", surfaces, [[0, 0], [10, 0], [10, 10], [0, 10]], edge_length=5.0, base_elevation=0.0)
    rock.observations, rock.hole_picks = seen, picks
    return build(Project("holes", [rock]))


def test_holes_have_the_blocks_that_are_known_of_them(model):
    lines = {hole.name: hole for hole in hole_lines(model)}
    assert [block.name for block in model.blocks] == ["Clay", "Sand"]
    assert lines["B1"].places[:, 2].tolist() == [10, 4, 1] and lines["B1"].blocks.tolist() == [1, 0]
    assert lines["B2"].blocks.tolist() == [1]
    assert lines["P1"].places[:, 2].tolist() == [10, 9, 3] and lines["P1"].blocks.tolist() == [UNKNOWN, 1]


def test_only_what_is_near_is_on_a_section(model):
    section = model.section((0, 5, 0), (0, -1, 0))
    assert [part.name for part, _ in holes_on(section, 0.5)] == ["B1", "B2", "P1"]
    parts = {part.name: part for part, _ in holes_on(section, 1.0)}
    assert np.allclose(parts["B2"].places, [(8, 5, 8), (8, 5, 4)]), "it crosses the plane at a slant"
    assert [part.name for part, _ in holes_on(model.section((0, 0, 0), (0, -1, 0)), 1.0)] == []


def test_holes_are_drawn_in_the_colors_of_their_blocks(model):
    section = model.section((0, 5, 0), (0, -1, 0))
    plain = draw_section(section)
    assert not any(item.layer == "Boreholes" for item in plain.items)
    drawing = draw_section(section, hole_width=0.5)
    own = [item for item in drawing.items if item.layer == "Boreholes"]
    assert [item.text for item in own if isinstance(item, Text)] == ["B1", "B2", "P1"]
    colors = [item.color for item in own if isinstance(item, Line)]
    clay, sand = (tuple(color) for color in section.block_colors)
    assert colors[1:3] == [sand, clay]
    assert drawing.width == plain.width, "they are within the section"


def test_names_over_holes_are_within_the_frame(model):
    drawing = draw_section(model.section((0, 5, 0), (0, -1, 0)), exaggeration=0.2, hole_width=0.5)
    frame = next(item for item in drawing.items if isinstance(item, FilledRings) and item.layer == "Axes")
    names = [item for item in drawing.items if isinstance(item, Text) and item.layer == "Boreholes"]
    assert {item.text for item in names} == {"B1", "B2", "P1"}
    top = max(ring[:, 1].max() for ring in frame.rings)
    assert all(item.y + item.size <= top + 1e-9 for item in names)


def test_a_fence_has_each_hole_on_the_panel_beside_it(model):
    fence = model.fence([[3, 4], [6, 4], [6, 9]])
    found = {part.name: flat for part, flat in holes_on(fence, 1.5)}
    assert np.allclose(found["B1"][:, 0], 0.0) and np.allclose(found["P1"][:, 0], 4.0)
    assert "B2" not in found


@pytest.mark.parametrize("ending", ["svg", "dxf", "png"])
def test_files_have_them(model, tmp_path, ending):
    section, files = model.section((0, 5, 0), (0, -1, 0)), []
    for width in (0.0, 0.5):
        files.append(tmp_path / f"{width}.{ending}")
        section.save(files[-1], hole_width=width)
    without, with_holes = (file.read_bytes() for file in files)
    assert without != with_holes
    if ending != "png":
        assert b"boreholes" in with_holes.lower() and b"boreholes" not in without.lower()


coordinate = st.floats(-10, 10).map(lambda value: round(value, 3))
place = st.tuples(coordinate, coordinate, coordinate)


@settings(derandomize=True, max_examples=200)
@given(place, place, st.floats(0.01, 5))
def test_parts_near_a_plane_are_those_within_the_width(begin, end, width):
    plane = np.array([1.0, 0, 0]), np.array([0.6, 0.8, 0.0])
    kept, *ends = near_plane([begin], [end], plane, width)
    shares = np.linspace(0, 1, 401)
    line = np.array(begin) + shares[:, None] * (np.array(end) - begin)
    away = (line - plane[0]) @ plane[1]
    inside = np.abs(away) < width * (1 - 1e-9)
    if inside.sum() > 1:
        assert kept.tolist() == [0]
    for at in ends if len(kept) else ():
        assert abs(((at - plane[0]) @ plane[1])[0]) < 1e-9
    if len(kept):
        length = np.linalg.norm((ends[1] - ends[0])[0])
        moved = line - away[:, None] * plane[1]
        expected = np.linalg.norm(moved[-1] - moved[0]) * inside.mean()
        assert abs(length - expected) < 0.02 * (np.linalg.norm(moved[-1] - moved[0]) + 1e-9) + 1e-9
