# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes: whole boreholes are left out, and models without them say what is there."""

import json
from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import InputRefused, Observations, Project, Rock, Surface, UsageError, build, load_project
from test_batch import run

SQUARE = [[0, 0], [100, 0], [100, 100], [0, 100]]


def logs(height, count=9, wrong=None):
    """Holes of 40 to 20 with clay above sand; the contact is at height(x, y), of one hole elsewhere."""
    rows = []
    draw = np.random.default_rng(3)
    for number, (x, y) in enumerate(draw.uniform(5, 95, (count, 2)).tolist()):
        z = height(x, y) + (8.0 if number == wrong else 0.0)
        for top, bottom, block in ((40.0, z, "clay"), (z, 20.0, "sand")):
            rows += [(x, y, level, block, f"B{number}", 40.0 - level) for level in (top, bottom)]
    places, depths = np.array([row[:3] for row in rows]), np.array([row[5] for row in rows])
    blocks, holes = (np.array([row[k] for row in rows]) for k in (3, 4))
    return Observations(places, blocks, holes, depths)


def model_of(observations, method="plane"):
    ground = np.array([[*corner, 40.0] for corner in SQUARE])
    surfaces = [
        Surface("top of sand", block="sand", method=method),
        Surface("ground", block="clay", points=ground, method="plane"),
    ]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=10.0, base_elevation=0.0, observations=observations)
    return build(Project("p", [rock]))


def test_a_plane_is_known_without_any_hole():
    found = model_of(logs(lambda x, y: 30 + 0.05 * x - 0.02 * y)).cross_validate_holes()
    assert [hole.hole for hole in found.holes] == [f"B{number}" for number in range(9)]
    assert found.groups == 9
    assert found.share == pytest.approx(1.0)
    assert len(found.errors) == 9
    np.testing.assert_allclose(found.errors, 0, atol=1e-9)
    assert all(hole.length == pytest.approx(20.0) for hole in found.holes)


def test_the_hole_that_contradicts_the_others_is_found_by_them():
    model = model_of(logs(lambda x, y: 30 + 0 * x, wrong=4), "natural_neighbour")
    found = model.cross_validate_holes()
    worst = min(found.holes, key=lambda hole: hole.share)
    assert worst.hole == "B4"
    # 8 of its 20 meters are said to be sand, and are clay to the others
    assert worst.share == pytest.approx(0.6, abs=0.03)
    (contact,) = worst.contacts
    assert contact.surface == "top of sand"
    assert contact.error == pytest.approx(-8.0, abs=1e-9)
    assert contact.depth == pytest.approx(2.0)


def test_lost_core_and_what_is_switched_off_have_no_length():
    given = logs(lambda x, y: 30 + 0.05 * x - 0.02 * y)
    lost = np.repeat(np.arange(len(given) // 2), 2)
    lost[1] = len(lost)  # the two ends of the clay in B0 are of two intervals
    used = np.ones(len(given), bool)
    used[4:6] = False  # the clay of B1
    found = model_of(replace(given, intervals=lost, used=used)).cross_validate_holes()
    sand = [given.places[row, 2] - 20.0 for row in (2, 6)]
    assert [hole.length for hole in found.holes[:3]] == pytest.approx([*sand, 20.0])


def test_groups_spread_over_the_table():
    observations = logs(lambda x, y: 30 + 0.05 * x)
    found = model_of(observations).cross_validate_holes(3)
    assert found.groups == 3
    assert len(found.holes) == 9
    assert "9 holes left out in 3 groups, 100.0 % of their length" in found.summary()


def test_the_same_for_any_number_of_threads():
    model = model_of(logs(lambda x, y: 30 + 3 * np.sin(x / 20)), "kriging")
    one, two = (model.cross_validate_holes(threads=threads) for threads in (1, 2))
    assert one == two


def test_picks_are_left_out_with_their_hole(tmp_path):
    rows = [f"B{n},{20 * n},{(n % 2) * 50},40" for n in range(5)]
    (tmp_path / "collars.csv").write_text("\n".join(["hole,x,y,z", *rows]))
    (tmp_path / "picks.csv").write_text(
        "hole,surface,depth\n" + "".join(f"B{n},S,{5 + n}\n" for n in range(5))
    )
    (tmp_path / "p.toml").write_text(
        'format = 1\nname = "p"\n[[rock]]\nname = "r"\nregion = [[0, 0], [80, 0], [80, 50], [0, 50]]\n'
        "edge_length = 10.0\nbase_elevation = 0.0\n"
        'boreholes = { collars = "collars.csv", picks = "picks.csv" }\n'
        '[[rock.surface]]\nname = "S"\nmethod = "plane"\n'
    )
    report = tmp_path / "report.json"
    done = run(tmp_path / "p.toml", "--cross-validate", "5", "--report", report)
    assert done.returncode == 0, done.stderr
    assert "cross-validation: 5 holes left out in 5 groups; elevations of 5 contacts" in done.stdout
    holes = json.loads(report.read_text())["left_out_holes"]
    assert [hole["hole"] for hole in holes] == [f"B{n}" for n in range(5)]
    # heights fall by 1 from hole to hole, along a plane
    for hole in holes:
        (contact,) = hole["contacts"]
        assert contact["error"] == pytest.approx(0.0, abs=1e-9)
        assert hole["share"] is None


def test_refusals():
    model = model_of(logs(lambda x, y: 30 + 0 * x, count=1))
    with pytest.raises(InputRefused, match="1 holes"):
        model.cross_validate_holes()
    with pytest.raises(UsageError, match="folds"):
        model_of(logs(lambda x, y: 30 + 0 * x)).cross_validate_holes(1)


def test_tops_of_intervals_are_no_contacts_where_a_younger_surface_cuts(tmp_path):
    # the channel lies on sand in B2 alone: the top of sand there is the base of the channel
    rows = [
        "B0,0,10,clay",
        "B0,10,20,sand",
        "B1,0,11,clay",
        "B1,11,20,sand",
        "B2,0,15,gravel",
        "B2,15,20,sand",
    ]
    rows += ["B3,0,12,clay", "B3,12,20,sand"]
    (tmp_path / "log.csv").write_text("\n".join(["hole,from,to,block", *rows]))
    collars = [f"B{n},{25 * n},{(n % 2) * 50},40" for n in range(4)]
    (tmp_path / "collars.csv").write_text("\n".join(["hole,x,y,z", *collars]))
    surfaces = (("top of sand", "sand"), ("base of gravel", "clay"), ("ground", "gravel"))
    (tmp_path / "p.toml").write_text(
        'format = 1\nname = "p"\n[[rock]]\nname = "r"\nregion = [[0, 0], [80, 0], [80, 50], [0, 50]]\n'
        "edge_length = 10.0\nbase_elevation = 0.0\n"
        'boreholes = { collars = "collars.csv", intervals = "log.csv" }\n'
        + "".join(
            f'[[rock.surface]]\nname = "{name}"\nblock = "{block}"\nmethod = "natural_neighbour"\n'
            for name, block in surfaces
        )
    )
    found = build(load_project(tmp_path / "p.toml")).cross_validate_holes()
    met = {hole.hole: [contact.surface for contact in hole.contacts] for hole in found.holes}
    assert "top of sand" in met["B0"]
    assert "base of gravel" in met["B2"] and "top of sand" not in met["B2"]
