# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on both sides of faults, against closed forms; the drawing; the command line."""

import json

import numpy as np
import pytest
from realmodel.core import Fault, Project, Rock, Surface, UsageError, build
from realmodel.core.drawing.drawing import FilledRings
from realmodel.core.results.faults.juxtaposition_drawing import draw_juxtaposition, hatched
from realmodel.core.results.faults.strike_line import StrikeLine
from sample_scripts import SAMPLES
from structure_cases import SQUARE, plane_fault
from test_batch import names, out, refused, run  # noqa: F401 - out is a fixture

SAMPLE = SAMPLES / "fault_blocks/project.toml"
TOPS = (4.0, 6.0, 9.0)  # of A, B and C above the base at 0


def stepped(throw, fault=None, x=5.0, lean=0.0, faults=(), cells="columns"):
    """Level beds A, B and C, higher by `throw` west of a fault along y at x and z = 0; throw: a number, or a
    function of y. Each bed has contacts at both sides of the fault."""
    y = np.linspace(0.0, 10.0, 11)
    surfaces = []
    for name, top in zip("ABC", TOPS, strict=True):
        rows = []
        for east in (0.5, 2.0, 3.0, 7.0, 8.5, 9.5):
            up = throw(y) if callable(throw) else np.full(len(y), float(throw))
            rows.append(np.column_stack([np.full(len(y), east), y, top + up * (east < 5)]))
        points = np.concatenate(rows)
        options = {"extrapolate": "nearest"}
        surfaces.append(
            Surface(name, points=points, method="natural_neighbour", options=options, block=f"bed {name}")
        )
    rock = Rock("rock", surfaces, SQUARE, edge_length=2.0, base_elevation=0.0)
    fault = fault or Fault("F", *plane_fault(x, lean, z=(-20.0, 40.0)))
    return build(Project("steps", [rock], faults=[fault, *faults]), cells=cells)


def overlaps(throw, length=10.0, slope=1.0):
    """The areas by (west, east) of level beds of which the western ones are higher by `throw`."""
    west, east = np.array([0.0, *(top + throw for top in TOPS)]), np.array([0.0, *TOPS])
    pairs = {}
    for i, one in enumerate("ABC"):
        for j, other in enumerate("ABC"):
            high = min(west[i + 1], east[j + 1]) - max(west[i], east[j])
            if high > 0:
                pairs[f"bed {one}", f"bed {other}"] = high * length * slope
    above = west[-1] - max(east[-1], west[-2])
    if above > 0:
        pairs["bed C", None] = above * length * slope
    return pairs


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("lean", [0.0, 0.2, -0.2])
def test_areas_of_level_beds_are_those_of_their_overlaps(lean, cells):
    areas = stepped(1.5, lean=lean, cells=cells).juxtaposition("F").areas
    # the west is the footwall where the fault dips to the east; of a vertical one it may be either side
    if lean < 0 or (lean == 0 and ("bed B", "bed A") in areas):
        areas = {pair[::-1]: area for pair, area in areas.items()}
    assert areas == pytest.approx(overlaps(1.5, slope=np.hypot(1.0, lean)))


def test_the_areas_add_up_to_the_faces_on_the_fault():
    model = stepped(1.5, lean=0.3)
    sides = model.juxtaposition(0)
    faces = np.flatnonzero(model.face_surface == 3)
    total = 0.0
    for face in faces:
        corners = model.vertices[model.face_vertices[slice(*model.face_offsets[face : face + 2])]]
        total += np.linalg.norm(np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(0)) / 2
    assert sum(sides.areas.values()) == pytest.approx(total, rel=1e-12) == sides.area
    assert len(sides) == len(faces)


@pytest.mark.parametrize("throw", [1.5, -1.5])
def test_cutoff_lines_lie_at_the_heights_of_the_beds(throw):
    """The fault dips to the east: the west is the footwall; where this is lower, the fault is reverse."""
    sides = stepped(throw, lean=0.2).juxtaposition("F")
    for name, top in zip("AB", TOPS, strict=False):
        for side, height in (("footwall", top + throw), ("hanging wall", top)):
            (line,) = [one for one in sides.cutoffs if (one.surface, one.side) == (name, side)]
            assert line.ends[..., 2] == pytest.approx(np.full(line.ends.shape[:2], height))
            along = sides.strike.along(line.ends[..., :2].reshape(-1, 2))
            assert (along.min(), along.max()) == pytest.approx((0.0, 10.0))
        assert sides.throw_profile(name)[:, 1] == pytest.approx(throw)


def test_the_throw_along_a_fault_is_what_the_beds_have():
    sides = stepped(lambda y: 0.2 * y, lean=0.1).juxtaposition("F")
    rows = sides.throw_profile("A")
    north = sides.strike.at(rows[:, 0])[:, 1]
    assert len(rows) > 3 and rows[:, 1] == pytest.approx(0.2 * north, abs=0.1)
    assert (np.diff(rows[:, 0]) >= 0).all()


def listric():
    """A fault that flattens downward, to the east."""
    z = np.linspace(-4.0, 14.0, 10)
    x = 4.0 + 6.0 * np.exp(-(z + 4.0) / 4.0)
    y = np.array([-5.0, 15.0])
    vertices = np.array([(a, b, c) for a, c in zip(x, z, strict=True) for b in y])
    rows = 2 * np.arange(len(z) - 1)[:, None]
    triangles = np.concatenate([rows + np.array(corners) for corners in ([0, 1, 3], [0, 3, 2])])
    return Fault("F", vertices, triangles.astype(np.int32))


def test_a_listric_fault_keeps_lengths_along_strike():
    sides = stepped(1.0, listric()).juxtaposition("F")
    flat = sides.unrolled()
    assert (flat[:, 0].min(), flat[:, 0].max()) == pytest.approx((0.0, 10.0))
    places = sides.vertices
    assert flat[:, 0] == pytest.approx(places[:, 1])  # the fault dips to the east: north is to the right
    assert sides.areas["bed A", "bed A"] > sides.areas["bed A", "bed B"] > 0


def test_a_branch_ends_at_its_fault_and_both_have_their_areas():
    branch = Fault("G", *plane_fault(7.0, z=(-20.0, 40.0), turn=30.0), ends_at=["F"])
    model = stepped(1.0, faults=[branch])
    for number, name in enumerate("FG"):
        sides = model.juxtaposition(name)
        faces = model.face_surface == 3 + number
        assert len(sides) == faces.sum() and sides.fault == name
        assert sum(sides.areas.values()) == pytest.approx(sides.area)


def test_a_curved_line_is_unrolled_along_itself():
    angle = np.linspace(0.0, np.pi / 2, 19)
    line = StrikeLine(100.0 * np.column_stack([np.cos(angle), np.sin(angle)]))
    chord = 2 * 100.0 * np.sin(np.pi / 72)
    assert line.along(line.points) == pytest.approx(chord * np.arange(19))
    inner = line.along(0.8 * line.points[1:-1])
    assert inner == pytest.approx(chord * np.arange(1, 18))  # along the lines that halve the bends
    between = line.along(1.1 * (line.points[3:4] + line.points[4:5]) / 2)
    assert between == pytest.approx([3.5 * chord])
    assert line.at(line.along(line.points[4:6])) == pytest.approx(line.points[4:6])


def test_hatching_stays_within_a_ring():
    ring = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    hole = ring[::-1] * 0.4 + 3.0
    for number in range(2):
        lines = np.array(hatched([ring, hole], 0.01, number))
        length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
        assert 0.01 * length == pytest.approx(100.0 - 16.0, rel=1e-3)


def test_the_drawing_has_the_areas_at_its_scale():
    sides = stepped(1.5).juxtaposition("F")
    drawing = draw_juxtaposition(sides, exaggeration=2.0)
    filled = 0.0
    for item in drawing.items:
        if isinstance(item, FilledRings) and item.layer.startswith("footwall"):
            for ring in item.rings:
                x, y = (ring / drawing.scale).T
                filled += (
                    (x - x[0]) * (np.roll(y, -1) - y[0]) - (np.roll(x, -1) - x[0]) * (y - y[0])
                ).sum() / 2
    assert filled == pytest.approx(2.0 * sides.area)
    with pytest.raises(UsageError, match="exaggeration"):
        draw_juxtaposition(sides, 0.0)
    with pytest.raises(UsageError, match="fault"):
        stepped(1.5).juxtaposition("G")


def test_files_and_report_of_the_command_line(out):  # noqa: F811 - the fixture
    files = [out / "main.svg", out / "branch.dxf", out / "report.json"]
    wanted = [f"main fault={files[0]}", f"branch={files[1]}"]
    done = run(SAMPLE, "--juxtaposition", wanted[0], "--juxtaposition", wanted[1], "--report", files[2])
    assert done.returncode == 0, done.stderr
    assert "juxtaposition main.svg: fault 'main fault', area " in done.stdout
    assert "<title>hanging wall Sand</title>" in files[0].read_text()
    for fault in json.loads(files[2].read_text())["faults"]:
        areas = {(pair["footwall"], pair["hanging_wall"]): pair["area"] for pair in fault["juxtaposition"]}
        assert areas["Clay", "Clay"] > 0 and areas["Sand", "Till"] > 0
    assert names(out) == ["branch.dxf", "main.svg", "report.json"]


def test_what_is_asked_for_wrongly_is_refused(out):  # noqa: F811 - the fixture
    line = refused(run(SAMPLE, "--juxtaposition", f"east={out / 'a.svg'}"), 2)
    assert line == (
        "--juxtaposition: no fault is called 'east'; the project has main fault, branch, western fault"
    )
    assert "expected --juxtaposition FAULT=FILE" in refused(run(SAMPLE, "--juxtaposition", "east"), 2)
    assert "not written as '.jpg'" in refused(run(SAMPLE, "--juxtaposition", "branch=a.jpg"), 2)
    assert not names(out)
