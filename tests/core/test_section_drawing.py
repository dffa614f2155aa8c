# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and fences as drawings: where things are on the page, and the files of the command line."""

import csv
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Fault, Library, Project, Property, Rock, Surface, UsageError, build
from realmodel.core.drawing.drawing import FilledRings, Line, Text, text_width
from realmodel.core.results.sections.section_drawing import block_outlines, draw_section, flattened
from structure_cases import plane_fault
from test_batch import names, out, refused, run  # noqa: F401 - out is a fixture

ORIGIN = np.array([431000.0, 5398000.0, 0.0])


def at(x, y, z=0.0):
    return ORIGIN + np.array([x, y, z])


@pytest.fixture(scope="module")
def model():
    """Two layers on 100 x 100 feet, tops sloping to the east: 10 + x / 10 and 30."""
    surfaces = []
    for name, height, entry in (("base", 0.0, 0), ("clay", None, 1), ("sand", 30.0, 2)):
        vertices, triangles = grid_surface(
            4, lambda x, y, h=height: 10 + x / 10 if h is None else h + 0 * x, 100.0
        )
        surfaces.append(Surface(name, vertices + ORIGIN, triangles, property=entry, block=name))
    library = Library([Property(1, "Clay", color="#0000ff"), Property(2, "Sand", color="#ffff00")])
    return build(Project("Slope", [Rock("rock", surfaces)], library=library, units="ft"))


def areas(drawing):
    """{layer: area of its filled polygons in units of the section}, heights as drawn."""
    found = {}
    for item in drawing.items:
        if isinstance(item, FilledRings) and item.layer not in ("Axes", "Legend"):
            for ring in item.rings:
                x, y = ring.T / drawing.scale
                area = ((x - x[0]) * (np.roll(y, -1) - y[0]) - (np.roll(x, -1) - x[0]) * (y - y[0])).sum() / 2
                found[item.layer] = found.get(item.layer, 0.0) + area
    return found


def texts(drawing):
    return [item.text for item in drawing.items if isinstance(item, Text)]


def test_a_section_seen_from_the_south(model):
    section = model.section(at(0, 50, 0), (0, -2, 0))
    drawing = draw_section(section, exaggeration=3.0)
    assert areas(drawing) == pytest.approx({"clay": 3 * 1500, "sand": 3 * 1500})
    flat = flattened(section)
    assert flat.min(axis=0).tolist() == [0, 0] and flat.max(axis=0) == pytest.approx([100, 30])
    east = flat[:, 0] == flat[:, 0].max()
    assert section.vertices[east, 0] == pytest.approx(ORIGIN[0] + 100)  # to the right
    # a round scale, in feet: 100 ft on at most 560 points
    assert "Scale 1 : 250, vertical exaggeration 3" in texts(drawing)
    assert drawing.scale == pytest.approx(0.3048 / 250 / (0.0254 / 72))
    named = texts(drawing).index
    assert named("Block") < named("sand") < named("clay")  # in the legend, the youngest on top
    assert {"A", "B", "x 431,000.0  y 5,398,050.0", "x 431,100.0  y 5,398,050.0", "Elevation (ft)"} <= set(
        texts(drawing)
    )
    fills = {item.layer: item.fill for item in drawing.items if isinstance(item, FilledRings)}
    assert (fills["clay"], fills["sand"]) == ((0, 0, 1), (1, 1, 0))


def test_level_and_dipping_planes_are_not_exaggerated(model):
    level = draw_section(model.section(at(0, 0, 15), (0, 0, 1)), exaggeration=5.0)
    assert areas(level) == pytest.approx({"clay": 5000, "sand": 5000})
    assert "Scale 1 : 250, map at elevation 15 ft" in texts(level)
    assert {"East (x) (ft)", "North (y) (ft)"} <= set(texts(level))
    slope = model.section(at(50, 50, 15), (0, -1, 1))
    dipping = draw_section(slope, exaggeration=5.0)
    assert sum(areas(dipping).values()) == pytest.approx(slope.area)
    assert any("plane that dips 45.0° to azimuth 180°" in text for text in texts(dipping))


def test_a_fence_is_one_picture_without_seams_at_its_bends(model):
    fence = model.fence([at(10, 10)[:2], at(90, 10)[:2], at(90, 70)[:2]])
    drawing = draw_section(fence)
    assert areas(drawing) == pytest.approx({"clay": 80 * 15 + 60 * 19, "sand": 80 * 15 + 60 * 11})
    flat = flattened(fence)
    for block in np.unique(fence.block):
        (ring,) = block_outlines(fence, flat, block)
        inside = (ring[:, 1] > 0.1) & (ring[:, 1] < 9)
        assert not (inside & (np.abs(ring[:, 0] - 80) < 1e-6)).any()
    assert flat[:, 0].max() == pytest.approx(fence.length) == 140


def test_bends_of_a_fence_are_marked_but_not_the_points_of_a_curve(model):
    angles = np.linspace(0.0, 0.5 * np.pi, 24)
    arc = [at(20 + 40 * np.sin(angle), 60 - 40 * np.cos(angle))[:2] for angle in angles]
    drawing = draw_section(model.fence([*arc, at(90, 60)[:2]]))  # at the end of the arc it turns at once
    assert len([item for item in drawing.items if isinstance(item, Line) and item.dash]) == 1


def test_what_cannot_be_drawn_is_refused(model):
    section = model.section(at(0, 50, 0), (0, 1, 0))
    with pytest.raises(UsageError, match="exaggeration must be above 0"):
        draw_section(section, 0.0)
    with pytest.raises(UsageError, match="does not meet the model"):
        draw_section(model.section(at(0, 500, 0), (0, 1, 0)))
    vertices, triangles = grid_surface(2, lambda x, y: 12 + 0 * x, 200.0)
    cut = model.cut_by_surface(vertices + at(-50, -50), triangles)
    with pytest.raises(UsageError, match="sections by a plane and fences"):
        draw_section(cut.section)


def test_drawings_of_the_command_line(layers, out):  # noqa: F811
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    project = layers([0, 1, 3])
    done = run(
        project,
        *("--section", f"0.5,0.5,0,1,0,0={out / 's.svg'}", "--section", f"0,0,2,0,0,1={out / 'map.png'}"),
        *("--fence", f"0.1,0.5,0.9,0.5={out / 'f.dxf'}", "--exaggeration", "2"),
    )
    assert done.returncode == 0, done.stderr
    assert names(out) == ["f.dxf", "map.png", "s.svg"]
    assert (out / "map.png").read_bytes().startswith(b"\x89PNG")
    root = ElementTree.parse(out / "s.svg").getroot()
    assert "layers" in {text.text for text in root.iter("{http://www.w3.org/2000/svg}text")}
    document = ezdxf.readfile(out / "f.dxf")
    layer = next(name for name in (entry.dxf.name for entry in document.layers) if name.startswith("S"))
    corners = [
        tuple(vertex.dxf.location)[:2]
        for line in document.modelspace().query(f'POLYLINE[layer=="{layer}"]')
        for vertex in line.vertices
    ]
    x, y = np.array(corners).T
    assert (x.min(), x.max()) == pytest.approx((0.0, 0.8), abs=1e-9)
    assert y.max() == pytest.approx(2 * round(y.max() / 2)) and y.max() > 0  # heights times two
    wrong = run(project, "--exaggeration", "2")
    assert "goes with --section or --fence" in wrong.stderr and wrong.returncode == 2
    assert "not a number above 0" in run(project, "--exaggeration", "0").stderr
    assert "use one of .vtu, .obj, .ply, .stl, .glb, .ts, .csv, .npz, .svg, .pdf, .dxf, .png" in refused(
        run(project, "--section", "0,0,0,1,0,0=a.x"), 2
    )


def test_faults_are_lines_with_their_names(tmp_path):
    """A fault that leans by 0.5 in two layers, on a plane across it, a map, and a fence with a bend."""
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 2.0 * k + 0 * x, 10.0)) for k in range(3)]
    fault = Fault("F", *plane_fault(x=5.0, lean=0.5))
    model = build(Project("p", [Rock("r", levels)], faults=[fault]))
    across = model.section((0.0, 3.0, 0.0), (0.0, -1.0, 0.0))
    (trace,) = across.faults
    length = np.linalg.norm(np.diff(trace.ends, axis=1)[:, 0], axis=1).sum()
    assert trace.name == "F" and length == pytest.approx(np.hypot(4.0, 2.0))
    assert trace.ends[..., 0] == pytest.approx(5.0 - 0.5 * trace.ends[..., 2])
    assert sorted(across.compartment_names) == ["above F", "below F"]
    level = model.section((0.0, 0.0, 1.0), (0.0, 0.0, 1.0)).faults[0]
    assert level.ends[..., 0] == pytest.approx(4.5) and level.ends[..., 2] == pytest.approx(1.0)
    fence = model.fence([(0.0, 5.0), (4.0, 5.0), (4.0, 2.0), (9.0, 2.0)])
    (trace,) = fence.faults
    assert set(trace.panel.tolist()) <= {0, 1, 2}  # on the bend it is on the way of two panels
    for panel, x, z in ((0, (3.0, 4.0), (2.0, 4.0)), (2, (4.0, 5.0), (0.0, 2.0))):
        ends = trace.ends[trace.panel == panel]
        assert (ends[..., 0].min(), ends[..., 0].max()) == pytest.approx(x)
        assert (ends[..., 2].min(), ends[..., 2].max()) == pytest.approx(z)
    for section in (across, fence):
        drawing = draw_section(section)
        lines = [item for item in drawing.items if isinstance(item, Line) and item.layer == "F"]
        assert len(lines) == len(section.faults[0].ends)
        assert [item.text for item in drawing.items if isinstance(item, Text) and item.layer == "F"] == ["F"]
        section.save(tmp_path / "s.csv")
        rows = list(csv.DictReader((tmp_path / "s.csv").read_text().splitlines()))
        assert {row["compartment"] for row in rows} == set(model.compartment_names)
        section.save(tmp_path / "s.npz")
        with np.load(tmp_path / "s.npz") as read:
            assert len(read["compartment"]) == len(section)
            assert read["compartment_names"].tolist() == model.compartment_names


def test_names_of_faults_are_not_over_one_another():
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 2.0 * k + 0 * x, 10.0)) for k in range(3)]
    faults = [Fault(f"A long name {x}", *plane_fault(x=x)) for x in (4.0, 4.3)]
    model = build(Project("p", [Rock("r", levels)], faults=faults))
    drawing = draw_section(model.section((0.0, 3.0, 0.0), (0.0, -1.0, 0.0)))
    first, second = (item for item in drawing.items if isinstance(item, Text) and "A long" in item.text)
    beside = abs(first.x - second.x) > text_width(first.text, first.size)
    assert beside or abs(first.y - second.y) > first.size


def test_names_of_faults_are_not_on_their_lines():
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 2.0 * k + 0 * x, 10.0)) for k in range(3)]
    for lean in (0.8, -0.8):
        fault = Fault("A name", *plane_fault(x=5.0, lean=lean))
        model = build(Project("p", [Rock("r", levels)], faults=[fault]))
        for exaggeration in (1.0, 3.0):
            drawing = draw_section(model.section((0.0, 3.0, 0.0), (0.0, -1.0, 0.0)), exaggeration)
            (name,) = (item for item in drawing.items if isinstance(item, Text) and item.text == "A name")
            lines = [
                item.points for item in drawing.items if isinstance(item, Line) and item.layer == "A name"
            ]
            along = np.linspace(0.0, 1.0, 50)[:, None]
            places = np.concatenate([a + along * (b - a) for a, b in np.asarray(lines, float)])
            x, y = (places - (name.x, name.y)).T
            width = text_width("A name", name.size)
            assert not ((x > 0) & (x < width) & (y > 0) & (y < name.size)).any()


def ring_areas(section):
    """(B,) the area of the outlines of each block."""
    flat, found = flattened(section), np.zeros(len(section.block_names))
    for block in range(len(found)):
        for x, y in (ring.T for ring in block_outlines(section, flat, block)):
            x, y = x - x[0], y - y[0]
            found[block] += (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    return found


def test_outlines_have_the_areas_of_their_blocks():
    """With two faults some polygons of a section are so thin that an edge has another one on its own side."""
    random = np.random.default_rng(7)
    levels = [
        Surface(f"S{k}", *grid_surface(9, lambda x, y, k=k: 2.0 * k + np.sin(0.7 * x + k) * np.cos(y), 10.0))
        for k in range(4)
    ]
    faults = [
        Fault("F", *plane_fault(x=4.0, lean=0.4, turn=20.0)),
        Fault("G", *plane_fault(x=5.0, lean=-0.7)),
    ]
    model = build(Project("p", [Rock("r", levels)], faults=faults))
    for _ in range(80):
        section = model.section(random.uniform(2, 8, 3), random.normal(size=3))
        if len(section):
            assert ring_areas(section) == pytest.approx(section.area_by_block(), rel=1e-6, abs=1e-6)


def test_an_edge_of_three_polygons_is_counted(model):
    """The third one, of no area, lies along the edge of the first two."""
    section = model.section(at(0, 50, 0), (0, -1, 0))
    corners = np.array([[0.0, 0, 0], [10, 0, 0], [10, 0, 10], [0, 0, 10]])
    rings = [[0, 1, 2], [0, 2, 3], [0, 2, 0, 2]]
    section.vertices = corners
    section.polygon_vertices = np.concatenate(rings).astype(section.polygon_vertices.dtype)
    section.offsets = np.cumsum([0, *map(len, rings)])
    section.block = np.zeros(3, section.block.dtype)
    assert np.abs(ring_areas(section)[0]) == pytest.approx(100.0)
    section.polygon_vertices = np.array([0, 1, 2, 0, 2, 3, 0, 2, 1], section.polygon_vertices.dtype)
    section.offsets = np.array([0, 3, 6, 9])
    assert np.abs(ring_areas(section)[0]) == pytest.approx(
        50.0
    )  # one of two polygons at a place is taken back


@pytest.mark.parametrize("width", [0.5, 2, 4, 10, 30])
def test_the_ends_of_narrow_sections_are_below_the_subtitle(model, width):
    drawing = draw_section(model.fence([at(48, 50)[:2], at(48 + width, 50)[:2]]))
    level = [item for item in drawing.items if isinstance(item, Text) and not item.angle]
    shift = {"start": 0.0, "middle": 0.5, "end": 1.0}
    boxes = []
    for item in level:
        long = text_width(item.text, item.size)
        left = item.x - shift[item.anchor] * long
        boxes.append((left, item.y, left + long, item.y + item.size))
    assert sum(item.text.startswith("x ") for item in level) == 2
    for number, one in enumerate(boxes):
        assert one[0] >= 0 and one[2] <= drawing.width and one[3] <= drawing.height
        for other in boxes[:number]:
            assert one[0] >= other[2] or other[0] >= one[2] or one[1] >= other[3] or other[1] >= one[3]
