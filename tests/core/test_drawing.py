# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings and the files that they are written to, as other programs read them."""

import io
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from realmodel.core import UsageError
from realmodel.core.drawing import DRAWINGS, Drawing, save_drawing
from realmodel.core.drawing.charts import Axes, color_bar, legend, round_length, tick_texts, ticks
from realmodel.core.drawing.drawing import Text, text_width
from realmodel.core.drawing.png import over, rasterize, write_pixels

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def test_a_filled_rectangle_covers_its_exact_part_of_each_pixel():
    drawing = Drawing(4.0, 3.0)
    drawing.rectangle((0.75, 1.0, 2.0, 1.0), fill=RED)
    green = rasterize(drawing, 1.0)[..., 1]
    assert green == pytest.approx(np.array([[1, 1, 1, 1], [0.75, 0, 0.25, 1], [1, 1, 1, 1]]), abs=1e-6)


def test_holes_stay_open_and_pieces_leave_no_seams():
    drawing = Drawing(6.0, 6.0)
    outer = np.array([[0, 0], [6, 0], [6, 6], [0, 6]])
    inner = np.array([[2, 2], [2, 4], [4, 4], [4, 2]])
    drawing.polygon([outer, inner], fill=BLUE)
    red = rasterize(drawing, 1.0)[..., 0]
    assert red.sum() == pytest.approx(4.0)
    assert (red[2:4, 2:4] == 1.0).all()
    drawing = Drawing(6.0, 6.0)
    left, right = [[0, 0], [2.3, 0], [3.7, 6], [0, 6]], [[2.3, 0], [6, 0], [6, 6], [3.7, 6]]
    drawing.polygon([left, right], fill=BLUE)
    assert np.abs(rasterize(drawing, 1.0)[..., 0]).max() < 1e-6


def test_lines_have_their_width_and_dashes_their_length():
    drawing = Drawing(20.0, 10.0)
    drawing.line([(2, 5), (18, 5)], width=2.0)
    dark = 1.0 - rasterize(drawing, 1.0)[..., 0]
    assert dark.sum() == pytest.approx(32.0)
    drawing.items.clear()
    drawing.line([(0, 5), (20, 5)], width=2.0, dash=4.0)
    assert (1.0 - rasterize(drawing, 1.0)[..., 0]).sum() == pytest.approx(2 * 12.0)


def test_a_transparent_picture_is_put_over_another_one():
    drawing = Drawing(2.0, 1.0)
    drawing.rectangle((1, 0, 1, 1), fill=(*RED, 0.5))
    pixels = rasterize(drawing, 1.0, background=None)
    assert pixels[0, :, 3].tolist() == [0.0, 0.5]
    assert pixels[0, 1, :3].tolist() == [1.0, 0.0, 0.0]
    below = np.zeros((3, 3, 4), np.float32)
    over(below, pixels, 2, 1)  # what sticks out on the right is cut off
    assert not below.any()
    over(below, pixels, 1, 1)
    assert below[1, 2].tolist() == [0.5, 0.0, 0.0, 0.0]


def test_text_is_as_wide_as_it_says():
    for text in ("Größe 38.9 M m³", "Σγ Ж", "A"):
        drawing = Drawing(200.0, 40.0)
        drawing.text(100, 20, text, 20, anchor="middle")
        inked = np.flatnonzero((rasterize(drawing, 1.0)[..., 0] < 0.5).any(axis=0))
        assert np.ptp(inked) == pytest.approx(text_width(text, 20), abs=5)
        assert inked.mean() == pytest.approx(100, abs=4)
    assert text_width("\u4e2d", 10) == text_width("\ufffd", 10) > 0  # no letter of ours: a sign in its place


def test_ticks_are_round():
    assert ticks(0.0, 1234.5, 3).tolist() == [0, 500, 1000]
    assert tick_texts(ticks(0.1, 0.13)) == ["0.10", "0.11", "0.12", "0.13"]
    assert tick_texts(ticks(5390000, 5391200)) == ["5,390,000", "5,390,500", "5,391,000"]
    assert tick_texts(ticks(-1, 1, 3)) == ["\u22121", "0", "1"]
    assert ticks(3.0, 3.0).tolist() == [3.0]
    assert [round_length(value) for value in (99, 100, 0.3)] == pytest.approx([50, 100, 0.2])


def chart():
    """A drawing with all that there is, of which 2 points are a unit."""
    drawing = Drawing(200.0, 120.0, scale=2.0, origin=(10.0, 20.0))
    axes = Axes(drawing, (40, 30, 100, 70), (0.0, 50.0), (100.0, 135.0))
    axes.frame("Distance (m)", "Größe <m³>", layer="Axes")
    drawing.polygon(axes.at([[0, 100], [50, 100], [50, 135]]), fill=RED, layer="Upper Clay & Sand")
    drawing.dots([(60, 50), (70, 60)], [2, 3], BLUE, layer="Points")
    drawing.line([(10, 20), (30, 40)], BLUE, layer="upper clay + sand")
    drawing.text(10, 110, "Ж")
    drawing.polygon([(0, 0), (1, 0), (1, 1)], fill=BLUE, layer="Grès à Voltzia")
    legend(drawing, (150, 100), "Block", [("Clay", RED), ("Sand", BLUE)])
    color_bar(drawing, (150, 20, 8, 40), (0.0, 1.0), np.eye(3))
    return drawing


def test_names_beside_a_color_bar_do_not_overlap():
    """They stand where their values are, and apart where these are near: a run of them keeps its middle."""
    drawing = Drawing(200.0, 120.0)
    names = [("Base", 0.1), ("Lower", 0.5), ("Upper", 0.51), ("Top", 0.9)]
    color_bar(drawing, (20, 10, 8, 100), (0.0, 1.0), np.eye(3), names[::-1])
    texts = [item for item in drawing.items if isinstance(item, Text)]
    assert [text.text for text in texts] == ["Base", "Lower", "Upper", "Top"]
    heights = [text.y + 0.36 * 8.0 for text in texts]
    assert heights == pytest.approx([20.0, 60.5 - 4.4, 60.5 + 4.4, 100.0])


@pytest.mark.parametrize("ending", [known.ending for known in DRAWINGS])
def test_the_same_drawing_gives_the_same_bytes(ending, tmp_path):
    save_drawing(chart(), tmp_path / f"a{ending}")
    save_drawing(chart(), tmp_path / f"b{ending}")
    assert (tmp_path / f"a{ending}").read_bytes() == (tmp_path / f"b{ending}").read_bytes()


def test_an_unknown_ending_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r"not written as '\.bmp'; use one of \.svg, \.pdf, \.dxf, \.png"):
        save_drawing(chart(), tmp_path / "a.bmp")
    assert not list(tmp_path.iterdir())


def test_svg_is_xml_with_its_layers_and_texts(tmp_path):
    save_drawing(chart(), tmp_path / "a.svg")
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    name = "{http://www.w3.org/2000/svg}"
    assert root.get("viewBox") == "0 0 200.00 120.00"
    assert {title.text for title in root.iter(f"{name}title")} >= {"Axes", "Upper Clay & Sand", "Points"}
    assert "Größe <m³>" in [text.text for text in root.iter(f"{name}text")]
    assert len(list(root.iter(f"{name}circle"))) == 2


def test_png_is_read_by_others():
    image = pytest.importorskip("PIL.Image", reason="pillow is not installed")
    pixels = rasterize(chart(), 1.5)
    see_through = pixels.copy()
    see_through[0, 0, 3] = 0.5
    for given, mode in ((pixels, "RGB"), (see_through, "RGBA")):
        file = io.BytesIO()
        write_pixels(given, file, 150)
        read = image.open(file)
        assert (read.mode, read.size) == (mode, (300, 180))
        assert np.rint(given * 255)[..., : len(mode)] == pytest.approx(np.asarray(read))
        assert read.info["dpi"] == pytest.approx((150, 150), abs=0.1)


def test_dxf_is_read_by_ezdxf(tmp_path):
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    from ezdxf import recover

    save_drawing(chart(), tmp_path / "a.dxf")
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert document.dxfversion == "AC1009"
    assert not recover.readfile(tmp_path / "a.dxf")[1].errors
    layers = {layer.dxf.name: layer.dxf.color for layer in document.layers}
    assert layers["UPPER_CLAY___SAND"] == 10  # red
    assert layers["UPPER_CLAY___SAND_2"] == 170  # blue
    assert "GRES_A_VOLTZIA" in layers
    space = document.modelspace()
    (shape,) = space.query('POLYLINE[layer=="UPPER_CLAY___SAND"]')
    assert shape.is_closed
    corners = [tuple(vertex.dxf.location)[:2] for vertex in shape.vertices]
    assert np.array(corners) == pytest.approx(np.array([[15, 5], [65, 5], [65, 40]]))  # units, not points
    assert sorted(circle.dxf.radius for circle in space.query("CIRCLE")) == [1.0, 1.5]
    texts = {text.dxf.text for text in space.query("TEXT")}
    assert {"Clay", "Sand", "Größe <m³>", "\\U+0416"} <= texts
