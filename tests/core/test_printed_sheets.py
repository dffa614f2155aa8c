# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets to print: paper, lengths on it, what stands where, and the files of the command line."""

import shutil
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Fault, Library, Project, Property, Rock, Surface, UsageError, build
from realmodel.core.drawing.drawing import FilledRings, Line, Text, text_width
from realmodel.core.results.geological_map import fault_lines, ground_of
from realmodel.core.results.sheets import SHEET_SIZES, draw_sheets
from structure_cases import plane_fault
from test_batch import names, out, run  # noqa: F401 - out is a fixture

MM = 72 / 25.4
PAPERS = {"A4": (297, 210), "A3": (420, 297), "A2": (594, 420), "A1": (841, 594), "A0": (1189, 841)}
ORIGIN = np.array([431000.0, 5398000.0, 0.0])


def made(units="m", faults=(), crs="EPSG:25832"):
    """1,000 by 1,000: clay, and sand on its eastern half, which removed clay in the west."""
    surfaces = []
    for name, entry in (("base", 0), ("clay", 1), ("sand", 2)):
        height = {
            "base": lambda x, y: -200 + 0 * x,
            "clay": lambda x, y: 0 * x,
            "sand": lambda x, y: x / 5 - 100,
        }
        vertices, triangles = grid_surface(4, height[name], 1000.0)
        surfaces.append(Surface(name, vertices + ORIGIN, triangles, property=entry, block=name))
    library = Library([Property(1, "Clay", color="#0000ff"), Property(2, "Sand", color="#ffff00")])
    rocks = [Rock("rock", surfaces)]
    return build(Project("Slope", rocks, library=library, units=units, crs=crs, faults=list(faults)))


@pytest.fixture(scope="module")
def model():
    return made()


def lines_of(model, count=2):
    """Fences from the west to the east."""
    y = ORIGIN[1] + 1000.0 * (np.arange(count) + 1) / (count + 1)
    return [model.fence([[ORIGIN[0], at], [ORIGIN[0] + 1000.0, at]]) for at in y]


def texts(drawing):
    return [item.text for item in drawing.items if isinstance(item, Text)]


def extents(drawing, layer):
    """(N, 2) width and height in mm of each polygon of a layer."""
    filled = [item for item in drawing.items if isinstance(item, FilledRings) and item.layer == layer]
    return np.array([np.ptp(np.concatenate(item.rings), axis=0) for item in filled]) / MM


@pytest.mark.parametrize("size", SHEET_SIZES)
def test_paper_has_its_size(model, size):
    (drawing, *others) = draw_sheets(model, lines_of(model), size, 20_000)
    paper, _, upright = size.partition("-")
    expected = PAPERS[paper][::-1] if upright else PAPERS[paper]
    for page in (drawing, *others):
        assert (page.width / MM, page.height / MM) == pytest.approx(expected, abs=1e-6)
        assert_within(page)


def assert_within(drawing):
    """Nothing is drawn beyond the frame."""
    margin = 10 * MM - 1e-6
    for item in drawing.items:
        if isinstance(item, FilledRings):
            points = np.concatenate(item.rings)
        elif isinstance(item, Line):
            points = item.points
        elif isinstance(item, Text) and not item.angle:
            width = text_width(item.text, item.size)
            begin = item.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[item.anchor] * width
            points = np.array([[begin, item.y], [begin + width, item.y + item.size]])
        else:
            continue
        assert (points >= margin).all(), item
        assert (points <= (drawing.width - margin, drawing.height - margin)).all(), item


@pytest.mark.parametrize(
    "units, meters, scale", [("m", 1.0, 12_500), ("ft", 0.3048, 2_400), ("km", 1000.0, 9e6)]
)
def test_lengths_on_paper_are_those_of_the_scale(units, meters, scale):
    model = made(units)
    pages = draw_sheets(model, lines_of(model), "A2", scale, exaggeration=1.5)
    expected = 1000.0 * meters * 1000 / scale
    assert expected > 50  # mm
    widths = [width for page in pages for layer in ("clay", "sand") for width, _ in extents(page, layer)]
    # clay is seen in the west of the map, sand in its east, and clay below all of both sections
    assert sorted(widths) == pytest.approx(sorted([0.5 * expected] * 4 + [expected] * 2), abs=1e-6)
    (high,) = {
        round(height, 6) for page in pages for width, height in extents(page, "sand") if height < width
    }
    assert high == pytest.approx(0.1 * expected * 1.5, abs=1e-6)
    written = f"Scale 1 : {scale:,.0f}"
    assert all(sum(text.startswith(written) for text in texts(page)) >= 2 for page in pages)


def test_a_map_has_the_lines_of_its_sections(model):
    sections = [*lines_of(model), model.section(ORIGIN + np.array([500, 0, 0]), (1, 0, 0))]
    sections.append(model.section(ORIGIN - np.array([0, 0, 50]), (0, 0, 1)))  # level: no line
    pages = draw_sheets(model, sections, "A1")
    drawn = [item for page in pages for item in page.items if item.layer == "Sections"]
    written = [item for item in drawn if isinstance(item, Text)]
    assert [item.text for item in written] == ["A", "A'", "B", "B'", "C", "C'"]
    every = [text for page in pages for text in texts(page)]
    assert {"Section A-A'", "Section B-B'", "Section C-C'", "Section"} <= set(every)
    clay = next(
        np.concatenate(item.rings)
        for item in pages[0].items
        if isinstance(item, FilledRings) and item.layer == "clay"
    )
    corner, scale = clay.min(axis=0), np.ptp(clay[:, 1]) / 1000.0
    lines = [item.points for item in drawn if isinstance(item, Line)][1::2]
    in_model = [(line - corner) / scale for line in lines]
    assert in_model[0] == pytest.approx(np.array([[0, 1000 / 3], [1000, 1000 / 3]]), abs=1e-6)
    assert in_model[2] == pytest.approx(np.array([[500, 0], [500, 1000]]), abs=1e-6)  # seen from the east


def test_title_block_legend_and_north(model):
    pages = draw_sheets(model, lines_of(model, 5), "A4")
    assert len(pages) > 1
    for number, page in enumerate(pages, 1):
        assert {"Slope", "Coordinates: EPSG:25832, m", f"Sheet {number} of {len(pages)}"} <= set(texts(page))
        named = texts(page).index
        assert named("Legend") < named("sand") < named("clay")
        assert ("N" in texts(page)) == ("Geological map" in texts(page))
    assert {"Contour", "Line of a section"} <= set(texts(pages[0]))
    assert "Fault" not in texts(pages[0])


def test_the_scale_that_fits_is_the_largest_round_one(model):
    for size in ("A4", "A3-portrait", "A0"):
        page = draw_sheets(model, lines_of(model), size)[0]
        ratio = 1e6 / (2 * extents(page, "clay")[0][0])  # clay is half of the map
        assert ratio / 10 ** np.floor(np.log10(ratio)) == pytest.approx(
            min((1, 2, 2.5, 5, 10), key=lambda f: abs(f - ratio / 10 ** np.floor(np.log10(ratio))))
        )
        with pytest.raises(UsageError, match=f"{size} has .* mm for both; take"):
            draw_sheets(model, lines_of(model), size, ratio / 2.6)


def test_what_does_not_fit_names_what_does(model):
    with pytest.raises(UsageError, match=r"'Geological map' takes 212 x 212 mm at 1 : 5,000") as caught:
        draw_sheets(model, lines_of(model), "A4", 5_000)
    size, ratio = str(caught.value).rpartition("; take ")[2].split(", or the scale 1 : ")
    assert draw_sheets(model, lines_of(model), "A4", float(ratio.replace(",", "")))
    assert draw_sheets(model, lines_of(model), size, 5_000)
    smaller = list(PAPERS)[: list(PAPERS).index(size)]
    for paper in smaller:
        with pytest.raises(UsageError, match="take"):
            draw_sheets(model, lines_of(model), paper, 5_000)
    for scale in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(UsageError, match="above 0"):
            draw_sheets(model, (), "A4", scale)
    with pytest.raises(UsageError, match="no paper 'B4'; choose from A4, A3"):
        draw_sheets(model, (), "B4")


def test_faults_come_to_the_top_where_they_are():
    """Also where the same fault lies below other places: in plan the one that dips is there, too."""
    vertices, triangles = plane_fault(300.0, 0.5, (-500.0, 1500.0), (-400.0, 400.0))
    model = made(faults=[Fault("F", vertices + ORIGIN, triangles)])
    ((name, line),) = fault_lines(model, ground_of(model))
    assert name == "F"
    assert np.ptp(line[:, 1]) == pytest.approx(1000.0)
    assert line[:, 0] - ORIGIN[0] == pytest.approx(350.0 / 1.1, abs=1e-6)  # the ground there is x / 5 - 100
    pages = draw_sheets(model, size="A3")
    drawn = [item for item in pages[0].items if item.layer == "Faults"]
    assert [type(item) for item in drawn] == [Line, Text]
    assert "Fault" in texts(pages[0])


def test_files_of_the_command_line(layers, out):  # noqa: F811
    project = layers([0, 1, 3])
    sheet = ("--sheet-size", "A4", "--sheet-scale", "25")
    cut = ("--fence", f"0.1,0.5,0.9,0.5={out / 'f.svg'}", "--section", f"0.5,0.5,0,1,0,0={out / 's.npz'}")
    done = run(project, *cut, "--sheet", out / "a.pdf", *sheet)
    assert done.returncode == 0, done.stderr
    assert "sheets on A4" in done.stdout
    assert (out / "a.pdf").read_bytes().startswith(b"%PDF-1.7")
    first = (out / "a.pdf").read_bytes()
    assert run(project, *cut, "--sheet", out / "a.pdf", *sheet).returncode == 0
    assert (out / "a.pdf").read_bytes() == first
    several = out / "s{sheet}.svg"
    assert run(project, *cut, "--sheet", several, *sheet).returncode == 0
    sheets = [name for name in names(out) if name.startswith("s") and name.endswith(".svg")]
    assert sheets == [f"s{number}.svg" for number in range(1, len(sheets) + 1)] and len(sheets) > 1
    assert ElementTree.parse(out / "s1.svg").getroot().get("width") == "841.89pt"
    for arguments, text in (
        ((*cut, "--sheet", out / "one.svg", *sheet), "put {sheet} into its name"),
        (("--sheet-size", "A4", "--export", out / "m.npz"), "--sheet-size goes with --sheet"),
        (("--sheet", out / "b.pdf", "--sheet-size", "A9"), "'A9' is not one of A4"),
        (("--sheet", out / "b.pdf", "--sheet-scale", "1.5"), "take A"),
        (("--sheet", out / "b.png"), "sheets are not written as '.png'"),
    ):
        done = run(project, *arguments)
        assert done.returncode == 2 and text in done.stderr, done.stderr
    assert not {"b.pdf", "b.png", "one.svg"} & set(names(out))


@pytest.mark.skipif(not shutil.which("pdftoppm"), reason="poppler-utils is not installed")
def test_a_printed_length(model, tmp_path):
    """The map of the file, measured on its page, ten pixels for each millimeter."""
    file = tmp_path / "a.pdf"
    model.save_sheets(file, lines_of(model), "A3", 8_000)
    told = subprocess.run(["pdfinfo", file], check=True, capture_output=True, text=True).stdout
    size = next(line for line in told.splitlines() if line.startswith("Page size")).split()[2:5:2]
    assert np.array(size, float) / MM == pytest.approx(PAPERS["A3"], abs=0.1)
    text = subprocess.run(["pdftotext", file, "-"], check=True, capture_output=True, text=True).stdout
    assert {"Section A-A'", "Scale 1 : 8,000", "Slope", "A'"} <= set(text.splitlines())
    options = ["-r", "254", "-f", "1", "-l", "1", "-singlefile", "-aa", "no"]
    subprocess.run(["pdftoppm", *options, file, tmp_path / "a"], check=True)
    _, size, _, pixels = (tmp_path / "a.ppm").read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    page = np.frombuffer(pixels, np.uint8).reshape(height, width, 3)
    is_blue = (page == (0, 0, 255)).all(axis=2)
    rows = np.flatnonzero(is_blue.sum(axis=1) > 500)  # clay of the map is 625 wide; the legend is narrower
    longest = max(np.ptp(run) + 1 for run in np.split(rows, np.flatnonzero(np.diff(rows) > 20) + 1))
    assert longest / 10 == pytest.approx(1000.0 * 1000 / 8_000, abs=0.15)
