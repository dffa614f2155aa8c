# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of a rock mass that are made from each other, or keep order."""

import numpy as np
import pytest
from realmodel.core import InputRefused, Project, Rock, Surface, build, interpolate, load_project
from realmodel.core.exporters.report import model_report
from realmodel.core.results.layer_values import at_places
from realmodel.core.settings.rules import RULES
from realmodel.core.surfaces import wrong_sides as wrong_side_module

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]
CORNERS = np.array([[0, 0], [10, 0], [10, 10], [0, 10.0]])


def points(*heights):
    return np.column_stack([CORNERS, heights])


def rock(*surfaces, **options):
    return Project("p", [Rock("r", list(surfaces), region=SQUARE, edge_length=1.0, **options)])


def test_parallel_to_a_younger_surface_and_to_a_ready_mesh():
    mesh = Surface("top", np.column_stack([CORNERS, [10, 10, 14, 14.0]]), np.array([[0, 1, 2], [0, 2, 3]]))
    middle = Surface("middle", method="parallel", options={"to": "top", "thickness": -3})
    bottom = Surface("bottom", method="parallel", options={"to": "middle", "thickness": -2.5})
    floor = Surface("floor", method="constant", options={"value": 1})
    model = build(rock(floor, bottom, middle, mesh))
    assert model.volume == pytest.approx(100 * (12 - 1))
    assert [block.volume for block in model.blocks] == pytest.approx([550, 250, 300])
    y = model.surface(1)[0][:, 1]
    assert model.surface(1)[0][:, 2] == pytest.approx(10 + 0.4 * y - 5.5)
    assert [result and result.method for result in model.interpolations] == [
        "constant", "parallel", "parallel", None
    ]  # fmt: skip


def test_a_stage_keeps_what_was_made_from_a_younger_surface():
    floor = Surface("floor", method="constant", options={"value": 0})
    middle = Surface("middle", method="parallel", options={"to": "top", "thickness": -3})
    top = Surface("top", points=points(10, 10, 14, 14), method="plane")
    project = rock(floor, middle, top)
    model, staged = build(project), build(project, stage=1)
    assert staged.volume == pytest.approx(900)
    assert np.array_equal(model.stage(1).vertices, staged.vertices)
    again = build(model.stage(1).project)
    assert again.volume == pytest.approx(900)
    assert build(staged.project).volume == pytest.approx(900)


def test_minimum_thickness_and_points_on_the_wrong_side():
    low = Surface("low", points=points(0, 0, 6, 6), method="tin")
    high = Surface("high", points=points(2, 2, 4, 8), method="tin", minimum_thickness=0.5)
    model = build(rock(low, high))
    z = [model.surface(k)[0][:, 2] for k in (0, 1)]
    assert (z[1] - z[0]).min() == pytest.approx(0.5)
    plain = build(rock(low, Surface("high", points=points(2, 2, 4, 8), method="tin")))
    free = plain.surface(1)[0][:, 2]
    assert np.array_equal(z[1], np.maximum(free, z[0] + 0.5))
    warnings = {(w.kind, w.surface): w for w in model.warnings}
    assert warnings["wrong_side", "high"].items == (2,)
    assert "1 of its 4 points lie below 'low', the farthest by 2: point 2 at (10, 10, 4)" in str(
        warnings["wrong_side", "high"]
    )
    assert warnings["wrong_side", "low"].items == (2,)
    raised = warnings["minimum_thickness", "high"]
    count = int((free < z[0] + 0.5).sum())
    assert f"raised at {count} of {len(free)} nodes to stay 0.5 above 'low', by up to 2.5 at (10, 10)" in str(
        raised
    )
    assert not [w for w in plain.warnings if w.kind in ("wrong_side", "minimum_thickness")]


def test_what_is_raised_honors_its_points_within_triangles():
    """Points lie 0.6 above a plane or more; a spline through them would lie below that beside them."""
    rng = np.random.default_rng(3)
    at = np.concatenate([CORNERS[:, :2], rng.uniform(0, 10, (12, 2))])
    z = 0.4 * at[:, 0] + 0.6 + 2.0 * (rng.random(len(at)) < 0.4)
    low = Surface("low", points=points(0, 4, 4, 0), method="plane")
    high = Surface("high", points=np.column_stack([at, z]), method="spline", minimum_thickness=0.5)
    model = build(rock(low, high))
    assert [warning.kind for warning in model.warnings] == ["minimum_thickness"]
    thickness = model.surface(1)[0][:, 2] - model.surface(0)[0][:, 2]
    assert thickness.min() == pytest.approx(0.5, abs=1e-12)
    assert np.abs(at_places(*model.surface(1), at) - z).max() < 1e-9


def test_points_of_surfaces_that_meet_there_are_not_on_the_wrong_side():
    heights = np.array([123.4, 567.8, 345.6, 789.1])
    low = Surface("low", points=points(*heights), method="tin")
    below = points(*np.nextafter(heights, 0.0))
    assert wrong_sides(low, Surface("high", points=below, method="tin", minimum_thickness=0.0)) == []
    assert wrong_sides(low, Surface("high", points=below - (0, 0, 0.01), method="tin", minimum_thickness=0.0))


def wrong_sides(*surfaces):
    return [(w.surface, w.items) for w in build(rock(*surfaces)).warnings if w.kind == "wrong_side"]


@pytest.mark.parametrize("low_rule", RULES)
@pytest.mark.parametrize("rule", RULES)
def test_points_below_what_a_surface_does_not_cut_are_listed(low_rule, rule):
    """Those of the older surface above it are not: there the younger one ends, or has cut."""
    low = Surface("low", points=points(0, 0, 6, 6), method="tin", rule=low_rule)
    high = Surface("high", points=points(2, 2, 4, 8), method="tin", rule=rule)
    ends = not RULES[rule].cuts or RULES[low_rule].protects
    assert wrong_sides(low, high) == ([("high", (2,))] if ends else [])


def test_a_fill_that_ends_against_the_rock_is_no_error():
    rock_head = Surface("rock", points=points(0, 0, 8, 8), method="tin", rule="base")
    fill = Surface("fill", points=points(3, 3, 3, 3)[:2], method="constant", rule="conformable")
    assert wrong_sides(rock_head, fill) == []


def test_points_below_a_surface_that_is_not_the_one_before_are_listed():
    """What counts is the top that is there: an erosion lowers it, unless what it met protects itself."""
    ground = Surface("ground", points=points(5, 5, 5, 5), method="tin")
    deep = Surface("deep", points=points(1, 1, 1, 1), method="tin")
    fill = Surface("fill", points=points(3, 3, 3, 3), method="tin", rule="conformable")
    all_points = (0, 1, 2, 3)
    assert wrong_sides(ground, deep, fill) == [("ground", all_points)], "the points of fill are right"
    ground.rule = "base"
    assert wrong_sides(ground, deep, fill) == [("deep", all_points), ("fill", all_points)]
    deep.points = points(1, 1, 7, 1)
    text = [str(w) for w in build(rock(ground, deep, fill)).warnings if w.surface == "fill"]
    assert "4 of its 4 points lie below 'ground' and 'deep', the farthest by 4: point 2" in text[0]


def test_minimum_thickness_above_a_ready_mesh_of_part_of_the_region():
    part = Surface(
        "low", np.array([[0, 0, 3], [5, 0, 3], [5, 10, 3], [0, 10, 3.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    )
    high = Surface("high", method="constant", options={"value": 1}, minimum_thickness=2)
    vertices, _ = build(rock(part, high, base_elevation=0)).surface(1)
    assert set(vertices[vertices[:, 0] <= 5, 2]) == {5.0}
    assert set(vertices[vertices[:, 0] > 5, 2]) == {1.0}


@pytest.fixture
def written(write):
    def put(text):
        return write(
            "p.toml",
            f"""format = 1
name = "p"
[[rock]]
name = "r"
region = {SQUARE}
edge_length = 1
[[rock.surface]]
name = "low"
method = "constant"
value = 2
[[rock.surface]]
name = "high"
{text}""",
        )

    return put


def test_in_a_project_file(written):
    path = written('method = "parallel"\nto = "low"\nthickness = 3\nminimum_thickness = 3.5\n')
    model = build(load_project(path))
    assert model.volume == pytest.approx(350)
    low, high = model_report(model)["surfaces"]
    assert (low["method"], low["points"], high["method"]) == ("constant", 0, "parallel")


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (
            'method = "parallel"\nto = "lwo"\nthickness = 1\n',
            14,
            "'to' names surface 'lwo', which rock 'r' does not",
        ),
        ('method = "parallel"\nto = "high"\nthickness = 1\n', 14, "depends on this surface"),
        ('method = "parallel"\nto = "low"\n', 13, "needs points; add points = ..., or thickness = ..."),
        ('method = "constant"\n', 13, "needs points; add points = ..., or value = ..."),
        ('method = "kriging"\n', 13, "needs points; add points = ..."),
        ('method = "parallel"\nthickness = 1\n', 11, "'to' is missing"),
        ('method = "constant"\nvalue = 3\nminimum_thickness = -1\n', 15, "must be at least 0"),
        (
            'method = "parallel"\nto = "third"\nthickness = 1\n[[rock.surface]]\nname = "third"\n'
            'method = "parallel"\nto = "high"\nthickness = 1\n',
            19,
            "'to' names 'high', which depends on this surface",
        ),
        ('method = "constant"\nvalue = 3\ncorrelation = 1.2\n', 15, "must be at most 1, not 1.2"),
        ('method = "constant"\nvalue = 3\ncorrelation = "all"\n', 15, "must be a finite number"),
        ('mesh = "m.off"\ncorrelation = 0.5\n', 14, "'correlation' has no effect"),
        (
            'mesh = "m.off"\nminimum_thickness = 1\n',
            14,
            "'minimum_thickness' has no effect, as a mesh is not interpolated",
        ),
    ],
)
def test_refused_at_the_line(written, write, text, line, words):
    write("m.off", "OFF\n3 1 0\n0 0 1\n9 0 1\n0 9 1\n3 0 1 2\n")
    with pytest.raises(InputRefused) as raised:
        load_project(written(text))
    assert words in str(raised.value)
    assert raised.value.line == line


@pytest.mark.parametrize("key", ["minimum_thickness", "correlation"])
def test_what_the_oldest_surface_cannot_have(key):
    with pytest.raises(InputRefused, match=f"a {key}, as there is no surface beneath it"):
        build(rock(Surface("a", method="constant", options={"value": 1}, **{key: 0.5})))


def test_a_smooth_surface_that_keeps_off_another():
    low = Surface("low", points=points(0, 0, 4, 4), method="plane")
    wells = np.array([[3, 3, 4.0], [7, 3, 1.5], [5, 8, 4.0]])
    high = Surface("high", points=wells, method="dsi", options={"above": "low", "border": 6})
    model = build(rock(low, high))
    vertices, triangles = model.surface(1)
    assert model.interpolations[1].method == "dsi"
    assert (vertices[:, 2] >= model.surface(0)[0][:, 2]).all()
    on_border = (vertices[:, :2] == 0).any(axis=1) | (vertices[:, :2] == 10).any(axis=1)
    assert set(vertices[on_border, 2]) == {6.0}
    z = interpolate(None, wells[:, :2], "parallel", to=(vertices, triangles), thickness=0).z
    assert z == pytest.approx(wells[:, 2], abs=1e-5)


def test_each_surface_is_asked_once_for_the_points_of_all_younger_ones(monkeypatch):
    asked, real = [], wrong_side_module.heights_at

    def counted(work, shape, plan):
        asked.append(len(plan))
        return real(work, shape, plan)

    monkeypatch.setattr(wrong_side_module, "heights_at", counted)
    stack = [Surface(f"s{k}", points=points(*[10 - k] * 4), method="tin", rule="base") for k in range(5)]
    assert wrong_sides(*stack) == [(f"s{k}", (0, 1, 2, 3)) for k in range(1, 5)]
    assert asked == [16, 12, 8, 4]
