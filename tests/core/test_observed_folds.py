# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of fields from observations, intervals and maps: the blocks that were seen are where they were
seen."""

import json
from dataclasses import replace

import numpy as np
import pytest
from folded_rocks import SIZE, SQUARE, contacts, dome, folded_project, plunging, recumbent, sheet
from realmodel.core import (
    Boreholes,
    Fault,
    InputRefused,
    MapFile,
    Observations,
    Rock,
    Series,
    SpaceDips,
    Surface,
    build,
)
from realmodel.core.base.work import native_module
from realmodel.core.exporters.report import model_report
from realmodel.core.project.project_checks import check_project
from realmodel.core.surfaces.observed.derived import PlaceContext, derive

LEVELS = {recumbent: (1.5, 2.5, 4.0), dome: (3.0, 4.5, 6.0), plunging: (2.5, 4.0, 6.0)}
NAMES = ("f", "fi", "fii", "ground")


def log(f, levels, x, y, top=7.5, bottom=0.2):
    """(top, bottom, number of the block) of each interval of a vertical hole."""
    z = np.linspace(top, bottom, 3000)
    blocks = np.searchsorted(levels, f(np.column_stack([0 * z + x, 0 * z + y, z])))
    found, begin = [], top
    for row in np.flatnonzero(np.diff(blocks)).tolist():
        level, a, b = levels[min(blocks[row], blocks[row + 1])], z[row], z[row + 1]
        for _ in range(60):
            middle = (a + b) / 2
            same = (f([x, y, a]) - level) * (f([x, y, middle]) - level) > 0
            a, b = (middle, b) if same else (a, middle)
        found.append((begin, a, int(blocks[row])))
        begin = a
    return [*found, (begin, bottom, int(blocks[-1]))]


def logs(f, holes):
    """The intervals of vertical holes at (x, y)."""
    rows = []
    for number, (x, y) in enumerate(holes):
        for top, bottom, block in log(f, LEVELS[f], x, y):
            rows += [((x, y, z), NAMES[block], f"B{number}", 7.5 - z) for z in (top, bottom)]
    places, blocks, names, depths = zip(*rows, strict=True)
    return Observations(places, blocks, names, depths)


def holes(count, seed=4):
    return np.random.default_rng(seed).uniform(0.7, 9.3, (count, 2))


def dips_of(f, count=40):
    places = np.random.default_rng(5).uniform(0.5, 9.5, (count, 3))
    moves = 1e-5 * np.eye(3)
    return SpaceDips(places, np.column_stack([f(places + move) - f(places - move) for move in moves]))


def observed_project(f, observations, dips=None, resolution=0.7, **more):
    """A fold without any points of its surfaces."""
    project = folded_project(f, LEVELS[f], **more)
    rock = project.rocks[0]
    for surface in rock.surfaces[:3]:
        surface.points = None
    rock.observations = observations
    rock.series[0].dips, rock.series[0].resolution = dips, resolution
    return project


def right(model, f, count=4000):
    """The share of random points of the rock in the right block."""
    points = np.random.default_rng(3).uniform((0, 0, 0), (SIZE, SIZE, 9), (count, 3))
    cells = native_module().cells_at(model.native(), points)
    rock = cells >= 0
    return (model.cell_block[cells[rock]] == np.searchsorted(LEVELS[f], f(points[rock]))).mean()


def blocks_at(model, points):
    return model.cell_block[native_module().cells_at(model.native(), np.ascontiguousarray(points, float))]


@pytest.mark.parametrize(("f", "share"), [(recumbent, 0.93), (dome, 0.9), (plunging, 0.9)])
def test_intervals_of_vertical_holes_alone(f, share):
    given = logs(f, holes(12))
    model = build(observed_project(f, given))
    found = model.observed()
    assert found.share > 0.999
    assert not found.violated and not found.left_out
    assert found.bounds > 50
    assert max(abs(each.residual) for each in found.contacts) < 1e-9
    middles = 0.5 * (given.places[::2] + given.places[1::2])
    np.testing.assert_array_equal(blocks_at(model, middles), [NAMES.index(b) for b in given.blocks[::2]])
    assert right(model, f) > share
    assert model.validate().passed, model.validate().failure()


def test_older_rock_above_younger_is_no_contradiction():
    """In a recumbent fold a hole meets blocks twice, and in the wrong order."""
    given = logs(recumbent, holes(12))
    numbers = [NAMES.index(block) for block in given.blocks[::2]]
    same = given.holes[:-2:2] == given.holes[2::2]
    assert (np.diff(numbers)[same] > 0).any()  # older above younger
    model = build(observed_project(recumbent, given))
    assert not model.observed().left_out


def test_intervals_with_dips():
    few = logs(recumbent, holes(6))
    alone = build(observed_project(recumbent, few))
    model = build(observed_project(recumbent, few, dips_of(recumbent)))
    assert model.observed().share > 0.999
    assert right(model, recumbent) > max(0.93, right(alone, recumbent))


def test_places_in_blocks_hold():
    """A few contacts alone put them elsewhere."""
    places = np.random.default_rng(8).uniform((0.5, 0.5, 0.5), (9.5, 9.5, 7.2), (150, 3))
    blocks = np.searchsorted(LEVELS[recumbent], recumbent(places))
    project = folded_project(recumbent, LEVELS[recumbent])
    for number, surface in enumerate(project.rocks[0].surfaces[:3]):
        surface.points = contacts(recumbent, LEVELS[recumbent][number], 5, 20 + number)
    without = build(project)
    assert (blocks_at(without, places) != blocks).any()
    project.rocks[0].observations = Observations(places, [NAMES[block] for block in blocks])
    model = build(project)
    assert model.observed().share == 1.0  # some lie on the boundary of their block
    assert not model.observed().violated
    assert (blocks_at(model, places) == blocks).mean() > 0.9
    assert model.validate().passed


def stated(rules, places, blocks, base=True):
    """What places say of a basement b, a series s0 to s2, and younger sheets u and v."""
    names = ("b", "s0", "s1", "s2", "u", "v")
    surfaces = [
        Surface(name, points=[[5.0, 5.0, 5.0]], series="s", rule=rule)
        if name.startswith("s")
        else sheet(name, lambda x, y: 0 * x, rule=rule)
        for name, rule in zip(names, rules, strict=True)
    ]
    rock = Rock("r", surfaces, region=SQUARE, base_elevation=0.0, series=[Series("s")])
    return derive(rock, Observations(places, blocks), PlaceContext())


def said(found, number):
    """(places at or below the level, at or above it) of a level set, by their heights."""
    bounds = found.bounds[number]
    return bounds.lower[:, 2].tolist(), bounds.upper[:, 2].tolist()


def test_what_follows_from_a_block():
    rules = ["erosional"] * 6
    places = [[number, 0.0, float(number)] for number in range(6)]
    found = stated(rules, places, ["b", "s0", "s1", "s2", "u", "v"])
    # below b: f was not greater, or the rock would be gone. Above u, which cuts, nothing follows
    assert said(found, 1) == ([0.0, 1.0], [2.0])
    assert said(found, 2) == ([2.0], [3.0])
    assert said(found, 3) == ([3.0], [4.0])
    assert not any(map(len, found.contacts))
    # the basement is not cut by what only deposits; nor is the series by u, on which v lies
    rules = ["erosional", "conformable", "conformable", "conformable", "conformable", "conformable"]
    found = stated(rules, places, ["b", "s0", "s1", "s2", "u", "v"])
    assert said(found, 1) == ([1.0], [2.0])
    assert said(found, 2) == ([2.0], [3.0])
    assert said(found, 3) == ([3.0], [4.0, 5.0])


def test_contacts_are_between_neighbors():
    place = [5.0, 5.0, 3.0]
    found = stated(["erosional"] * 6, [place] * 2, ["s1", "s2"])
    assert [len(each) for each in found.contacts] == [0, 0, 1, 0, 0, 0]
    assert not found.left_out
    found = stated(["erosional"] * 6, [place] * 2, ["s2", "s0"])
    assert not any(map(len, found.contacts))
    assert not any(len(found.bounds[number]) for number in (1, 2, 3))
    assert [each.kind for each in found.left_out] == ["not_adjacent"]
    # at an unconformity the place is in the older block still
    found = stated(["erosional"] * 6, [place] * 2, ["v", "s1"])
    assert [len(each) for each in found.contacts] == [0, 0, 0, 0, 1, 0]
    assert said(found, 2) == ([3.0], []) and said(found, 1) == ([], [3.0])


def test_a_hole_without_a_bed_has_no_contact_there():
    """Where the log lacks a bed the contact says nothing. What is near it cannot all hold."""
    given = logs(dome, holes(9))
    blocks = given.blocks.copy()
    own = given.holes == "B0"
    blocks[own & (blocks == "fi")] = "f"  # base block to its top, then block fii
    merged = Observations(given.places, blocks, given.holes, given.depths)
    model = build(observed_project(dome, merged))
    left_out = [each for _, each in model.observed().left_out]
    assert [each.hole for each in left_out if each.kind == "not_adjacent"] == ["B0"]
    assert {(each.kind, each.hole) for each in left_out[1:]} <= {("contradiction", "B0")}
    assert any(warning.kind == "not_adjacent" for warning in model.warnings)


def test_sheets_beside_a_series_keep_their_order():
    """Of sheets below a series an older block above a younger one is left out, as without a series."""
    names, heights = ["f", "fi", "b0", "b1"], [4.0, 3.5, 3.0, 2.5, 1.5, 1.2, 1.0, 0.8]
    places = [[2.0, 2.0, z] for z in heights]
    project = folded_project(recumbent, LEVELS[recumbent])
    rock = project.rocks[0]
    rock.surfaces[:0] = [sheet("b0", lambda x, y: 0.5), sheet("b1", lambda x, y: 1.2)]
    given = Observations(places, np.repeat(names, 2), ["H"] * 8, np.subtract(8.0, heights))
    found = derive(rock, given)
    assert [(each.kind, each.block) for each in found.left_out] == [("wrong_order", "b1")]


def thrown(p):
    return dome(np.asarray(p) + np.array([0.0, 0.0, 1.1]))


def on_both_sides(count=14):
    """Holes through a dome that a fault at x = 5 throws down in the west."""
    rows = []
    for number, (x, y) in enumerate(holes(count, 9)):
        f = thrown if x < 5 else dome
        for top, bottom, block in log(f, LEVELS[dome], x, y):
            rows += [((x, y, z), NAMES[block], f"B{number}", 7.5 - z) for z in (top, bottom)]
    places, blocks, names, depths = zip(*rows, strict=True)
    return Observations(places, blocks, names, depths)


def upright_fault():
    vertices = np.array([[5.0, -2, -5], [5.0, 12, -5], [5.0, 12, 20], [5.0, -2, 20]])
    return Fault("F", vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32), youngest="fii")


def test_observations_on_both_sides_of_a_fault():
    model = build(observed_project(dome, on_both_sides(), faults=[upright_fault()]))
    found = model.observed()
    assert found.share > 0.999 and not found.violated
    assert max(abs(each.residual) for each in found.contacts) < 1e-9
    assert not [warning for warning in model.warnings if "compartment" in warning.text]
    assert model.validate().passed, model.validate().failure()


def test_a_compartment_without_contacts_has_a_warning():
    given = on_both_sides()
    east = given.some(given.places[:, 0] > 5)
    model = build(observed_project(dome, east, faults=[upright_fault()]))
    (warning,) = [each for each in model.warnings if "as if no fault displaced it" in each.text]
    assert warning.kind == "contacts" and "f, fi and fii" in warning.text


def test_dips_on_one_side_of_a_fault_say_where_rock_gets_younger_on_the_other():
    project = folded_project(dome, [LEVELS[dome][0]], faults=[replace(upright_fault(), youngest="f")])
    west, east = (contacts(f, LEVELS[dome][0], 40, 5) for f in (thrown, dome))
    rock = project.rocks[0]
    rock.surfaces[0].points = np.concatenate([west[west[:, 0] < 5], east[east[:, 0] > 5]])
    places = east[east[:, 0] > 5][:4]
    normals = np.column_stack([dome(places + move) - dome(places - move) for move in 1e-5 * np.eye(3)])
    rock.series[0].dips = SpaceDips(places, normals)
    model = build(project)
    assert model.validate().passed
    for f, x in ((thrown, 2.5), (dome, 7.5)):
        (below,) = [each for each in model.borehole(x, 4.0) if each.block == 0]
        z = np.linspace(0, 8, 801)
        level = z[np.argmin(np.abs(f(np.column_stack([0 * z + x, 0 * z + 4.0, z])) - LEVELS[dome][0]))]
        assert below.top == pytest.approx(level, abs=0.3)


def test_picks_are_contacts(tmp_path):
    (tmp_path / "picks.csv").write_text(
        "hole,x,y,z,surface\n"
        + "".join(
            f"B{n},{x},{y},{z},{name}\n"
            for name, level in zip(NAMES[:3], LEVELS[dome], strict=True)
            for n, (x, y, z) in enumerate(contacts(dome, level, 8, 3).tolist())
        )
    )
    project = observed_project(dome, None)
    project.rocks[0].boreholes = Boreholes(tmp_path / "picks.csv")
    model = build(project)
    assert [len(each.points) for each in model.rock_inputs[0].data[:3]] == [8, 8, 8]


def test_holes_are_cross_validated():
    model = build(observed_project(dome, logs(dome, holes(10))))
    found = model.cross_validate_holes()
    assert len(found.holes) == 10
    assert found.share > 0.85
    errors = [abs(contact.error) for hole in found.holes for contact in hole.contacts]
    assert 1e-6 < np.median(errors) < 0.5


def test_the_report_has_observations_of_a_series():
    report = model_report(build(observed_project(dome, logs(dome, holes(8)))))
    assert {each["block"] for each in report["observations"]} >= {"base block", "fi block", "fii block"}
    assert report["contacts"] and not report["violated_bounds"]
    json.dumps(report)


def sphere(p):
    """Rock gets older toward a point within."""
    return np.sqrt(((np.asarray(p, float) - np.array([5.0, 5.0, 4.0])) ** 2).sum(axis=-1))


def test_critical_points_are_counted_with_their_places():
    project = folded_project(sphere, (1.2, 2.0, 2.8))
    project.rocks[0].series[0].dips = dips_of(sphere)
    model = build(project)
    (warning,) = [each for each in model.warnings if each.kind == "critical_points"]
    assert "critical point" in warning.text and "series 'folded'" in warning.text
    without = build(observed_project(plunging, logs(plunging, holes(12)), dips_of(plunging)))
    assert not [each for each in without.warnings if each.kind == "critical_points"]


@pytest.mark.parametrize("down", [0.2, 2.5, 4.0])
def test_a_place_that_contradicts_its_hole_is_left_out(down):
    """All others hold."""
    given = logs(dome, holes(10))
    place = given.places[0] - np.array([0.0, 0.0, down])
    wrong = Observations([place], ["f" if dome(place) > LEVELS[dome][1] else "ground"])
    model = build(observed_project(dome, Observations.joined([given, wrong])))
    found = model.observed()
    assert {each.place for _, each in found.left_out} == {tuple(place.tolist())}
    assert {each.place for each in found.violated} == {tuple(place.tolist())}
    (warning,) = [each for each in model.warnings if each.kind == "contradiction"]
    assert "side of 'f" in warning.text
    for _, each in found.left_out:  # with what is known around it
        assert each.block == wrong.blocks[0] and f" in '{each.block}': on the " in each.text
        assert 0 < len(each.contradicts) <= 4
        assert "; ".join(each.contradicts) in each.text and each.text in warning.text
        assert any(said.startswith("hole 'B") for said in each.contradicts)
    assert model.validate().passed


def test_data_in_errors_have_their_names():
    project = observed_project(dome, logs(dome, holes(6)))
    clash = build(project).rock_inputs[0].data[0].contacts[:1]
    project.rocks[0].surfaces[2].points = clash
    with pytest.raises(InputRefused, match="have a contact at one place") as refused:
        build(project)
    assert "series 'folded', surface '" in str(refused.value)
    assert "hole 'B" in str(refused.value) or "point 0" in str(refused.value)


def test_a_map_binds_a_series(tmp_path):
    """The ground cuts upright beds, which strike north."""
    lines = (0.0, 3.0, 5.0, 8.0, 10.0)
    features = [
        {
            "type": "Feature",
            "properties": {"unit": name},
            "geometry": {
                "type": "Polygon",
                "coordinates": [[[a, 0], [b, 0], [b, 10], [a, 10], [a, 0]]],
            },
        }
        for name, a, b in zip(NAMES, lines[:-1], lines[1:], strict=True)
    ]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    project = observed_project(dome, None)
    rock = project.rocks[0]
    rock.map = MapFile(tmp_path / "map.geojson", "unit")
    model = build(project)
    points = np.random.default_rng(1).uniform((0.3, 0.3, 0.3), (9.7, 9.7, 7.0), (500, 3))
    expected = np.searchsorted(lines[1:-1], points[:, 0])
    assert (blocks_at(model, points) == expected).mean() > 0.9
    assert model.observed().share > 0.99
    rock.map = MapFile(tmp_path / "map.geojson", "unit", ground="fii")
    with pytest.raises(InputRefused, match="the ground of the map cannot be 'fii'"):
        check_project(project)
