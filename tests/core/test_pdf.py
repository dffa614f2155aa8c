# SPDX-License-Identifier: GPL-3.0-or-later
"""PDF files, as the programs of poppler read them."""

import io
import shutil
import subprocess

import numpy as np
import pytest
from realmodel.core.drawing import Drawing, save_drawing
from realmodel.core.drawing.pdf import write_pages
from realmodel.core.drawing.png import rasterize

pytestmark = pytest.mark.skipif(
    not all(map(shutil.which, ("pdfinfo", "pdffonts", "pdftotext", "pdftoppm"))),
    reason="poppler-utils is not installed",
)
TEXTS = ("Höhe 1 : 25,000", "−12.5 m³ ± 3°", "Kalkstein (Kreide)")


def a_drawing(width=200.0, height=120.0):
    drawing = Drawing(width, height)
    drawing.rectangle((10, 10, 60, 40), (0.8, 0.2, 0.1), (0.0, 0.0, 0.0), 2.0)
    ring = np.array([[90, 10], [150, 15], [140, 60], [95, 50]])
    drawing.polygon([ring, 0.5 * ring[::-1] + 0.25 * ring.sum(axis=0) * 0.5], (0.1, 0.4, 0.9, 0.5))
    drawing.line([(5, 70), (60, 90), (120, 65)], (0.0, 0.5, 0.0), 3.0)
    drawing.line([(130, 70), (190, 70)], width=2.0, dash=6.0)
    drawing.dots([(170, 30), (180, 45)], [6.0, 3.0], (0.3, 0.0, 0.3))
    for number, text in enumerate(TEXTS):
        drawing.text(100, 80 + 12 * number, text, 9.0, anchor=("start", "middle", "end")[number])
    drawing.text(195, 20, "upright", 8.0, angle=90)
    return drawing


def told_by(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def test_a_page_looks_like_the_picture_of_the_drawing(tmp_path):
    drawing = a_drawing()
    save_drawing(drawing, tmp_path / "a.pdf")
    told_by("pdftoppm", "-r", "144", "-singlefile", tmp_path / "a.pdf", tmp_path / "a")
    head, size, _, pixels = (tmp_path / "a.ppm").read_bytes().split(b"\n", 3)
    assert (head, size) == (b"P6", b"400 240")
    page = np.frombuffer(pixels, np.uint8).reshape(240, 400, 3) / 255.0
    picture = rasterize(drawing, 2.0)[..., :3]
    assert (picture < 0.9).any(axis=2).mean() > 0.1
    apart = np.abs(page - picture).max(axis=2)
    assert apart.mean() < 0.01
    assert (apart > 0.5).mean() < 0.004  # no item is missing, or elsewhere


def test_letters_are_embedded_and_texts_are_found(tmp_path):
    save_drawing(a_drawing(), tmp_path / "a.pdf")
    fonts = told_by("pdffonts", tmp_path / "a.pdf").splitlines()[2:]
    assert len(fonts) == 1
    assert fonts[0].split()[-5:-2] == ["yes", "no", "yes"]  # embedded, with letters known to Unicode
    text = told_by("pdftotext", "-enc", "UTF-8", tmp_path / "a.pdf", "-")
    assert all(line in text for line in (*TEXTS, "upright"))


def test_more_letters_than_a_font_has(tmp_path):
    letters = [chr(code) for code in (*range(0x21, 0x7F), *range(0xC0, 0x180))]
    drawing = Drawing(500.0, 400.0)
    for row in range(0, len(letters), 20):
        drawing.text(10, 380 - row, "".join(letters[row : row + 20]), 10.0)
    save_drawing(drawing, tmp_path / "a.pdf")
    assert len(told_by("pdffonts", tmp_path / "a.pdf").splitlines()[2:]) == 2
    text = told_by("pdftotext", "-enc", "UTF-8", tmp_path / "a.pdf", "-")
    assert "".join(text.split()) == "".join(letters)


def test_pages_have_their_sizes_and_files_their_bytes(tmp_path):
    sizes = [(200.0, 120.0), (841.8897637795276, 1190.5511811023623)]  # the second is A3
    files = []
    for name in ("a.pdf", "b.pdf"):
        file = io.BytesIO()
        write_pages([a_drawing(*size) for size in sizes], file)
        (tmp_path / name).write_bytes(file.getvalue())
        files.append(file.getvalue())
    assert files[0] == files[1]
    told = told_by("pdfinfo", "-l", "9", tmp_path / "a.pdf").splitlines()
    pages = [line.split()[3:6:2] for line in told if line.startswith("Page ") and "size" in line]
    assert np.array(pages, float) == pytest.approx(np.array(sizes), abs=0.02)
