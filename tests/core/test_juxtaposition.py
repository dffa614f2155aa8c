# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on both sides of faults, against closed forms; the drawing; the command line."""

import itertools
import json

import numpy as np
import pytest
from displaced_surfaces import Displacing, leaning, level, points_of
from faulted.generate import random_case
from realmodel.core import Fault, Project, Rock, Surface, UsageError, build
from realmodel.core.drawing.drawing import FilledRings, Line
from realmodel.core.results.faults.juxtaposition_drawing import draw_juxtaposition, hatched
from realmodel.core.results.faults.strike_line import StrikeLine
from sample_scripts import SAMPLES
from structure_cases import SQUARE, assert_areas_of_faces, plane_fault
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


DROP, BASE = 0.75, -6.0
SHEETS = {"S0": -1.5, "S1": -0.5, "S2": 1.0}


def listric(y, z):
    return 4.5 - 0.6 * z + 0.04 * z * z


def lowered(fault):
    """Level layers of a fault of displaced_surfaces, lower by DROP east of it."""
    surfaces = [
        Surface(
            name,
            points=points_of(lambda x, y, top=top: top + level(x, y), [fault]),
            method="natural_neighbour",
            block=name,
        )
        for name, top in SHEETS.items()
    ]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=BASE)
    return build(Project("p", [rock], faults=[fault.fault()]))


def areas_between_heights(fault, low_side, high_side):
    """By pair of blocks: of the faces on a fault between the heights where both are, whose tops are lowered
    by low_side in the footwall and by high_side in the hanging wall."""
    z = np.linspace(-9, 9, fault.lines[1])
    passed = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(z), np.diff(fault.at(0.0, z))))])
    layers = []
    for drop in (low_side, high_side):
        heights = [BASE, *(top - drop for top in SHEETS.values()), np.inf]
        layers.append([*zip(heights[:-1], heights[1:], [*SHEETS, None], strict=True)])
    areas = {}
    for (a, b, footwall), (c, d, hanging_wall) in itertools.product(*layers):
        low, high = max(a, c), min(b, d)
        if low < high < np.inf:
            areas[footwall, hanging_wall] = 10.0 * float(np.diff(np.interp([low, high], z, passed))[0])
    return areas


SHAPES = {
    "normal": (leaning(lean=0.5), 2, (0.0, DROP)),
    "flat": (leaning(lean=0.8), 2, (0.0, DROP)),
    "reverse": (leaning(lean=-0.5), 2, (DROP, 0.0)),
    "listric": (listric, 41, (0.0, DROP)),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_areas_cutoffs_and_throws_in_closed_form(kind):
    """A cutoff line is whole also where it lies between two columns of one block."""
    at, lines, (low_side, high_side) = SHAPES[kind]
    fault = Displacing("F", at, drop=DROP, lines=(2, lines))
    model = lowered(fault)
    sides = model.juxtaposition("F")
    areas = {pair: area for pair, area in sides.areas.items() if area > 1e-12}  # less is rounding
    assert areas == pytest.approx(areas_between_heights(fault, low_side, high_side), rel=1e-9)
    assert_areas_of_faces(model)
    assert {(line.surface, line.side) for line in sides.cutoffs} == {
        (name, side) for name in SHEETS for side in ("footwall", "hanging wall")
    }
    for cutoff in sides.cutoffs:
        (line,) = cutoff.lines
        top = SHEETS[cutoff.surface] - (low_side if cutoff.side == "footwall" else high_side)
        assert line[:, 2] == pytest.approx(top, abs=1e-9)
        assert np.abs(np.diff(line[:, 1])).sum() == pytest.approx(10.0) == np.ptp(line[:, 1])
    flat = sides.unrolled()
    assert flat[:, 0] == pytest.approx(
        sides.vertices[:, 1] if kind != "reverse" else 10 - sides.vertices[:, 1]
    )
    for name in SHEETS:
        assert sides.throw_profile(name)[:, 1] == pytest.approx(high_side - low_side, abs=1e-6)


@pytest.mark.parametrize("turn", [-35.0, 20.0])
def test_distance_is_along_the_strike(turn):
    surface = Surface("top", points=[(1, 1, 0), (9, 1, 0), (1, 9, 0), (9, 9, 0)])
    fault = Fault("F", *plane_fault(lean=0.4, turn=turn))
    rock = Rock("r", [surface], region=SQUARE, edge_length=1.0, base_elevation=-3.0)
    sides = build(Project("p", [rock], faults=[fault])).juxtaposition("F")
    along = sides.vertices[:, :2] @ [-np.sin(np.radians(turn)), np.cos(np.radians(turn))]
    assert sides.unrolled()[:, 0] == pytest.approx(along - along.min(), abs=1e-9)


@pytest.mark.parametrize("seed", [5, 7, 10, 11, 13, 22, 30, 31, 32, 33])
def test_areas_of_random_faults_are_those_of_their_faces(seed):
    """Branches, faults that die out, several rock masses; columns and whole blocks."""
    case = random_case(seed)
    assert_areas_of_faces(build(case.project(), cells=case.cells))


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_sides_of_a_fault_that_dies_out_in_a_block(cells):
    """A whole block is on both sides of it, where nothing is juxtaposed; the west is its footwall."""
    fault = Displacing("F", leaning(lean=0.5), lambda y: 0.1 * (8.0 - y), tip=8.0)
    points = points_of(level, [fault])
    surface = Surface("top", points=points, method="natural_neighbour", block="bed")
    rock = Rock("r", [surface], region=SQUARE, edge_length=1.0, base_elevation=BASE)
    model = build(Project("p", [rock], faults=[fault.fault()]), cells=cells)
    sides = model.juxtaposition("F")
    pairs = {pair for pair, area in sides.areas.items() if area > 1e-9}
    divided = {("bed", "bed")} if cells == "columns" else set()
    assert pairs == {("bed", None)} | divided  # the hanging wall is lower
    for cutoff in sides.cutoffs:
        (line,) = cutoff.lines
        lower = 0.1 * (8.0 - line[:, 1]) if cutoff.side == "hanging wall" else 0.0
        assert line[:, 2] == pytest.approx(-lower, abs=0.02)
        assert np.ptp(line[:, 1]) == pytest.approx(8.0, abs=1e-6)


def test_the_throw_along_a_fault_is_what_the_beds_have():
    sides = stepped(lambda y: 0.2 * y, lean=0.1).juxtaposition("F")
    rows = sides.throw_profile("A")
    north = sides.strike.at(rows[:, 0])[:, 1]
    assert len(rows) > 3 and rows[:, 1] == pytest.approx(0.2 * north, abs=0.1)
    assert (np.diff(rows[:, 0]) >= 0).all()


def test_a_branch_ends_at_its_fault_and_both_have_their_areas():
    branch = Fault("G", *plane_fault(7.0, z=(-20.0, 40.0), turn=30.0), ends_at=["F"])
    model = stepped(1.0, faults=[branch])
    assert_areas_of_faces(model)
    for number, name in enumerate("FG"):
        assert len(model.juxtaposition(name)) == (model.face_surface == 3 + number).sum() > 0


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
    with pytest.raises(UsageError, match="no fault named 'G'; faults are F"):
        stepped(1.5).juxtaposition("G")
    rock = Rock("r", [Surface("top", points=[(1, 1, 0), (9, 1, 0), (5, 9, 0)])], region=SQUARE)
    rock.edge_length, rock.base_elevation = 2.0, -3.0
    with pytest.raises(UsageError, match="there are no faults"):
        build(Project("p", [rock])).juxtaposition(0)


def test_dashes_go_on_over_the_ends_of_edges():
    drawing = draw_juxtaposition(lowered(Displacing("F", leaning(), drop=DROP)).juxtaposition("F"))
    dashed = [item for item in drawing.items if isinstance(item, Line) and item.dash]
    assert len(dashed) == len(SHEETS)
    for line in dashed:
        step = np.diff(line.points[:, 0])
        assert len(step) > 4 and ((step > 0).all() or (step < 0).all())


def test_drawings_have_the_same_bytes_each_time(tmp_path):
    model = lowered(Displacing("F", leaning(), drop=DROP))
    for ending in ("svg", "pdf", "dxf", "png"):
        files = [tmp_path / f"{number}.{ending}" for number in range(2)]
        for file in files:
            model.juxtaposition("F").save(file, exaggeration=2.0)
        assert files[0].read_bytes() == files[1].read_bytes()
    text = (tmp_path / "0.svg").read_text()
    for shown in (*SHEETS, "Throw (m)", "Distance along strike (m)", "vertical exaggeration 2"):
        assert shown in text


def test_files_and_report_of_the_command_line(out):  # noqa: F811 - the fixture
    files = [out / "main.svg", out / "branch.dxf", out / "report.json"]
    wanted = [f"main fault={files[0]}", f"branch={files[1]}"]
    done = run(SAMPLE, "--juxtaposition", wanted[0], "--juxtaposition", wanted[1], "--report", files[2])
    assert done.returncode == 0, done.stderr
    assert "juxtaposition main.svg: fault 'main fault', area " in done.stdout
    assert "<title>hanging wall Sand</title>" in files[0].read_text()
    report = json.loads(files[2].read_text())
    for fault in report["faults"]:
        pairs = [pair for pair in report["juxtapositions"] if pair["fault"] == fault["name"]]
        areas = {(pair["footwall"], pair["hanging_wall"]): pair["area"] for pair in pairs}
        assert areas["Clay", "Clay"] > 0 and areas["Sand", "Till"] > 0
    assert names(out) == ["branch.dxf", "main.svg", "report.json"]


def test_what_is_asked_for_wrongly_is_refused(out):  # noqa: F811 - the fixture
    line = refused(run(SAMPLE, "--juxtaposition", f"east={out / 'a.svg'}"), 2)
    assert line == (
        "--juxtaposition: no fault is called 'east'; the project has main fault, branch, western fault"
    )
    assert "expected --juxtaposition FAULT=FILE" in refused(run(SAMPLE, "--juxtaposition", "east"), 2)
    assert "not written as '.vtu'" in refused(run(SAMPLE, "--juxtaposition", "branch=a.vtu"), 2)
    assert not names(out)
