# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands over a view: at the right places, with true numbers."""

import numpy as np
import pytest
from realmodel.core.drawing import color_scale
from realmodel.core.drawing.drawing import FilledRings, Text
from realmodel.core.drawing.overlay import ColorKey, Eye, Shown, draw_overlay
from realmodel.core.drawing.png import rasterize
from realmodel.core.results import layer_values

SIZE = (900.0, 600.0)
ORIGIN = np.array([3_431_000.0, 5_390_800.0, 100.0])


def eye(azimuth, elevation, reach=300.0, perspective=False):
    """Looks from an azimuth (clockwise from north) and elevation, degrees, at the zero of the world."""
    azimuth, elevation = np.radians([azimuth, elevation])
    flat = np.cos(elevation)
    back = np.array([flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(elevation)])
    right = np.array([-np.cos(azimuth), np.sin(azimuth), 0.0])
    up = np.cross(back, right)
    view = np.eye(4)
    view[:3, :3] = right, up, back
    at = 3.0 * reach * back
    view[:3, 3] = -view[:3, :3] @ at
    aspect = SIZE[0] / SIZE[1]
    if perspective:
        projection = np.array([[3.0, 0, 0, 0], [0, 3.0 * aspect, 0, 0], [0, 0, -1, -1], [0, 0, -1, 0]])
        return Eye(projection @ view, np.array([*at, 1.0]), right, up, SIZE)
    projection = np.diag([1 / reach, aspect / reach, -0.01 / reach, 1.0])
    return Eye(projection @ view, np.array([*back, 0.0]), right, up, SIZE)


def shown(factor=1.0):
    placed = np.eye(4)
    placed[2, 2] = factor
    placed[:3, 3] = -(ORIGIN * (1.0, 1.0, factor))
    half = np.array([100.0, 80.0, 20.0])
    return Shown(ORIGIN - half, ORIGIN + half, placed, "m", factor)


def texts(drawing):
    return {item.text: item for item in drawing.items if isinstance(item, Text)}


def test_ticks_stand_where_their_coordinates_are():
    for factor in (1.0, 4.0):
        looking = eye(180, 0)  # from the south: x to the right, heights up
        drawing = draw_overlay(looking, shown(factor), (), ["axes"])
        found = texts(drawing)
        heights = [
            text
            for text in found
            if text.replace(",", "").isdigit() and 80 <= int(text.replace(",", "")) <= 120
        ]
        assert len(heights) >= 3
        lines = [item.points for item in drawing.items if hasattr(item, "points")]
        for text in heights:
            place = shown(factor).world([[ORIGIN[0], ORIGIN[1], float(text)]])
            at = looking.at(place)[0][1]
            assert any(abs(points[:, 1] - at).max() < 1e-6 for points in lines), text
            assert abs(found[text].y - at) < 9.0
        east = [text for text in found if text.startswith("3,43")]
        for text in east:
            at = looking.at(shown().world([[float(text.replace(",", "")), *ORIGIN[1:]]]))[0][0]
            assert abs(found[text].x - at) < 1.0
        assert len(east) >= 3


@pytest.mark.parametrize(("azimuth", "elevation"), [(152, 27), (20, 60), (250, -10), (180, 90)])
def test_the_box_never_lies_before_the_model(azimuth, elevation):
    """Its lines are edges of the outline: all corners of the box are on one side of each."""
    looking = eye(azimuth, elevation)
    drawing = draw_overlay(looking, shown(), (), ["axes"])
    box = shown()
    corners = looking.at(
        box.world(np.array(np.meshgrid(*zip(box.low, box.high, strict=True))).reshape(3, -1).T)
    )
    edges = [
        i.points
        for i in drawing.items
        if hasattr(i, "points") and np.hypot(*np.diff(i.points, axis=0)[0]) > 20
    ]
    assert len(edges) >= 4
    for begin, end in edges:
        (x, y), (u, v) = end - begin, (corners - begin).T
        side = (x * v - y * u) / np.hypot(x, y)
        assert side.min() > -1e-6 or side.max() < 1e-6


def test_the_scale_bar_is_as_long_as_it_says():
    drawing = draw_overlay(eye(152, 27), shown(), (), ["scale"])
    label = next(text for text in texts(drawing) if text.endswith(" m"))
    bars = [i.rings[0] for i in drawing.items if isinstance(i, FilledRings) and i.fill is None]
    length = np.ptp(bars[-1][:, 0])
    assert length == pytest.approx(float(label.removesuffix(" m")) * SIZE[0] / 600.0)
    shown_texts = texts(draw_overlay(eye(152, 27, perspective=True), shown(3.0), (), ["scale"]))
    assert "at the center of the model" in shown_texts
    assert "vertical exaggeration 3\u00d7" in shown_texts


def test_what_is_covered_below_is_left_free_by_legend_and_scale():
    entries = [("Sand", (0.9, 0.8, 0.4))]
    key = ColorKey("Property", entries)
    drawing = draw_overlay(eye(152, 27), shown(), [key], ["scale"], (0.0, 0.0, 40.0))
    rings = [ring for item in drawing.items if isinstance(item, FilledRings) for ring in item.rings]
    assert min(ring[:, 1].min() for ring in rings) > 40


def test_the_arrow_points_north():
    for azimuth, expected in ((180, (0, 1)), (90, (1, 0)), (270, (-1, 0)), (0, (0, -1))):
        drawing = draw_overlay(eye(azimuth, 50), shown(), (), ["north"])
        letter = texts(drawing)["N"]
        paper = drawing.items[0].rings[0]
        away = np.array([letter.x, letter.y + 3]) - paper.mean(axis=0)
        assert away @ np.array(expected) > 0.9 * np.hypot(*away)


def test_legends_fit_and_are_drawn():
    entries = [(f"Rock {n}", (n / 99, 0.5, 0.1)) for n in range(99)]
    drawing = draw_overlay(eye(152, 27), shown(), [ColorKey("Property", entries)], [])
    assert "Rock 0" in texts(drawing)
    assert any(text.endswith(" more") for text in texts(drawing))
    assert max(item.y for item in texts(drawing).values()) < SIZE[1]
    key = ColorKey("Elevation (m)", limits=(80.0, 120.0), colors=color_scale.RISING)
    pixels = rasterize(draw_overlay(eye(152, 27), shown(), [key], []), 1.0, None)
    for color in color_scale.RISING:
        assert (np.abs(pixels[..., :3] - color).max(axis=2) < 0.02).any()


def test_what_the_eye_does_not_see_is_left_out():
    within = eye(152, 27, reach=10.0, perspective=True)
    draw_overlay(within, shown(), (), ["north", "scale", "axes"])


def test_thickness_is_vertical():
    """A wedge from 2 to 6 thick on a slope."""
    corners = [(0, 0, 1), (10, 0, 3), (10, 8, 3), (0, 8, 1), (0, 0, 3), (10, 0, 9), (10, 8, 9), (0, 8, 3)]
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    triangles = np.array([[f[0], f[k], f[k + 1]] for f in faces for k in (1, 2)], np.int32)
    plan = np.array([[0.0, 0.0], [10.0, 8.0], [5.0, 4.0], [2.5, 1.0], [11.0, 4.0]])
    found = layer_values.thickness(np.array(corners, float), triangles, plan)
    np.testing.assert_allclose(found, [2.0, 6.0, 4.0, 3.0, np.nan])


def test_colors_are_even_and_gray_where_nothing_is_known():
    found = color_scale.colors(np.array([1.0, np.nan, 3.0, 2.0]), (1.0, 3.0))
    np.testing.assert_allclose(found[0, :3], color_scale.RISING[0], atol=1e-6)
    np.testing.assert_allclose(found[2, :3], color_scale.RISING[-1], atol=1e-6)
    np.testing.assert_allclose(found[1], (*color_scale.UNKNOWN, 1.0))
    np.testing.assert_allclose(found[3, :3], color_scale.RISING[2:4].mean(axis=0), atol=1e-6)
