# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about points that contradict the order of surfaces that cut."""

from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build, load_project
from realmodel.core.settings.rules import RULES
from sample_scripts import built_sample

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
SQUARE = [[0, 0], [100, 0], [100, 100], [0, 100]]
WELLS = np.random.default_rng(5).random((30, 2)) * 100.0


def top(name, height, wells=WELLS, **options):
    return Surface(
        name, points=np.column_stack([wells, np.broadcast_to(height, len(wells))]), method="tin", **options
    )


def warned(*surfaces, **options):
    """(surface, points, text) of each warning of the kind."""
    rock = Rock("r", list(surfaces), region=SQUARE, edge_length=20.0, base_elevation=-100.0, **options)
    found = build(Project("p", [rock])).warnings
    return [(w.surface, w.items, w.text) for w in found if w.kind == "wrong_side"]


def test_a_wrong_order_is_said():
    few = top("few", 5.0, WELLS[:7])
    assert warned(top("low", 0.0), few, top("high", 10.0)) == []
    (name, items, text), *others = warned(few, top("high", 10.0), top("low", 0.0))
    assert (name, items) == ("few", tuple(range(7)))
    assert text.startswith(
        "7 of its 7 points lie above those of 'low' at the same place, the farthest by 5: point 4 at ("
    )
    assert "check the order of the surfaces" in text
    assert [(each, len(numbers)) for each, numbers, _ in others] == [("high", 30)]


def test_several_younger_ones_are_named_together():
    ((name, items, text),) = warned(
        top("old", 9.0), top("a", 1.0), top("b", np.where(np.arange(30) < 20, 3.0, 12.0))
    )
    assert (name, len(items)) == ("old", 30)
    assert "above those of 'a' and 'b'" in text
    assert "the farthest by 8:" in text


def test_a_few_points_that_were_continued_above_a_younger_surface_are_not_meant():
    """In a table of points nobody knows; most of them say what the order is."""
    ground = top("ground", np.where(np.arange(30) < 8, -2.0, 5.0))
    assert warned(top("clay", 0.0), ground) == []


def test_picks_in_one_hole_always_are():
    ground = top("ground", np.where(np.arange(30) < 2, -2.0, 5.0))
    clay = top("clay", 0.0)
    holes = {
        f"B{n}": (None, [("ground", tuple(ground.points[n])), ("clay", tuple(clay.points[n]))])
        for n in range(30)
    }
    ((name, items, text),) = warned(clay, ground, hole_picks=holes)
    assert (name, items) == ("clay", (0, 1))
    assert (
        "2 of its 30 points lie above those of 'ground' at the same place, the farthest by 2: point 1 at"
        in text
    )
    assert "; holes B0 and B1;" in text


def test_picks_of_a_deviated_hole(write):
    write("collars.csv", "hole,x,y,z,azimuth,dip\nB1,20,50,0,90,-45\nB2,60,20,0,90,-45\nB3,70,80,0,90,-45\n")
    write("picks.csv", "hole,surface,depth\nB1,b,10\nB1,a,20\nB2,b,12\nB2,a,22\nB3,a,5\nB3,b,25\n")
    path = write(
        "p.toml",
        f"""format = 1
name = "p"
[[rock]]
name = "r"
region = {SQUARE}
edge_length = 20
base_elevation = -100
boreholes = {{ collars = "collars.csv", picks = "picks.csv" }}
[[rock.surface]]
name = "a"
method = "plane"
[[rock.surface]]
name = "b"
method = "plane"
""",
    )
    (text,) = [str(w) for w in build(load_project(path)).warnings if w.kind == "wrong_side"]
    assert (
        "surface 'a': 1 of its 3 points lie above those of 'b' at the same place, the farthest by 14.14"
        in text
    )
    assert "; holes B3;" in text


def test_rasters_may_be_the_ground_at_two_times():
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.0, 101.0, 4.0), np.arange(0.0, 101.0, 4.0)))
    nodes = np.column_stack([x, y])
    assert warned(top("before", 10.0, nodes), top("after", 5.0, nodes)) == []
    scattered = nodes + np.random.default_rng(1).random(nodes.shape)
    assert len(warned(top("before", 10.0, scattered), top("after", 5.0, scattered))) == 1


@pytest.mark.parametrize("old_rule", RULES)
@pytest.mark.parametrize("rule", RULES)
def test_each_contradiction_is_said_once(old_rule, rule):
    """Of rules that do not cut, or what is not cut, the points of the younger surface are listed instead."""
    names = [name for name, _, _ in warned(top("old", 5.0, rule=old_rule), top("young", 0.0, rule=rule))]
    cut = RULES[rule].cuts and not RULES[old_rule].protects
    assert names == (["old"] if cut else ["young"])
    apart = top("young", 0.0, rule=rule, minimum_thickness=1.0)
    assert [name for name, _, _ in warned(top("old", 5.0, rule=old_rule), apart)].count("old") == 1


@pytest.mark.parametrize("sample", ["two_layers", "block_diagram", "gravel_plain", "quarry", "intrusion"])
def test_samples_have_none(sample):
    model = built_sample(sample)
    assert [w for w in model.warnings if "at the same place" in w.text] == []


@pytest.mark.parametrize(("below", "kind"), [(1, "wrong_side"), (40, "ends"), (90, "wrong_side")])
def test_where_many_points_of_a_survey_lie_below_the_top_a_surface_that_does_not_cut_ends(below, kind):
    plan = np.random.default_rng(6).random((90, 2)) * 100.0
    x = np.append(np.sort(plan[:, 0]), 101.0)
    soil = top("soil", 0.1 * (plan[:, 0] - x[below - 1 : below + 1].mean()), plan, rule="conformable")
    rock = Rock("r", [top("low", 0.0), soil], region=SQUARE, edge_length=20.0, base_elevation=-100.0)
    (warning,) = [w for w in build(Project("p", [rock])).warnings if w.surface == "soil"]
    assert (warning.kind, len(warning.items)) == (kind, below)
    assert ("its rule is conformable: it ends there" in warning.text) == (kind == "ends")
