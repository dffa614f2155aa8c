# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes as they are logged, and observations: read, built, reported, written and read again."""

import json

import numpy as np
import pytest
from realmodel.core import (
    Boreholes,
    InputRefused,
    Model,
    ObservationFile,
    Observations,
    Project,
    Rock,
    Surface,
    build,
    load_project,
)
from realmodel.core.exporters.report import write_report
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import UnitNames, read_observed_places, read_picks
from structure_cases import SQUARE

UNITS = UnitNames(["S0", "S1", "S2"], ["basement", "clay", "sand"], ["salt"], {"SST": "sand", "X": ""})
COLLARS = "hole,x,y,z\nB1,0,0,10\nB2,10,0,10\nB3,10,10,10\nB4,0,10,10\nB5,5,5,10\n"
LOG = """hole,from,to,block
B1,0,2,SST
B1,2,6,clay
B1,6,9,basement
B2,0,3,sand
B2,3,8,basement
B3,0,2,sand
B3,2,5,lost core
B3,5,6,S1
B3,6,7,basement
B4,0,1,SST
B4,1,4,clay
B5,0,2,sand
B5,2,2,clay
B5,2,8,basement
"""
PROJECT = """format = 1
name = "logs"

[[rock]]
name = "r"
region = [[0, 0], [10, 0], [10, 10], [0, 10]]
edge_length = 1.0
base_elevation = -5.0
boreholes = {{ collars = "collars.csv", intervals = "log.csv"{more} }}
names = {{ SST = "sand" }}
{rock}
[[rock.surface]]
name = "S0"
block = "basement"
method = "tin"
[[rock.surface]]
name = "S1"
block = "clay"
method = "tin"
[[rock.surface]]
name = "S2"
block = "sand"
method = "tin"
"""


@pytest.fixture
def project(write):
    def made(more="", rock="", log=LOG):
        for name, text in (("collars.csv", COLLARS), ("log.csv", log)):
            write(name, text)
        return write("p.toml", PROJECT.format(more=more, rock=rock))

    return made


def read(write, log, collars=COLLARS, units=UNITS, survey=None, step=None, **keys):
    given = Boreholes(
        collars=collars and write("c.csv", collars),
        survey=survey and write("s.csv", survey),
        intervals=write("log.csv", log),
        **keys,
    )
    return read_picks(given, units=units, plan_step=step)


def rows(observations):
    return list(
        zip(
            observations.holes.tolist(),
            observations.depths.tolist(),
            observations.places[:, 2].tolist(),
            observations.blocks.tolist(),
            strict=True,
        )
    )


@pytest.mark.parametrize(
    ("header", "keys", "apart"),
    [
        ("hole,from,to,block", {}, ","),
        ("BHID;FROM;TO;LITHOLOGY", {}, ";"),
        ("Well\tDepth_From (m)\tDepth_To (m)\tUnit", {}, "\t"),
        ("Hole-ID;Depth From (m);Depth To (m);Lith Code", {}, ";"),
        ("who,a,b,c", {"columns": {"hole": "who", "from": "a", "to": "b", "block": 4}}, ","),
    ],
)
def test_tables(write, header, keys, apart):
    log = (header.replace(apart, ",") + "\n" + LOG.partition("\n")[2]).replace(",", apart)
    collars = COLLARS.replace("hole", "who") if "columns" in keys else COLLARS
    found = read(write, log, collars, **keys)
    (observations,) = found.observations
    assert rows(observations)[:6] == [
        ("B1", 0.0, 10.0, "S2"),
        ("B1", 2.0, 8.0, "S2"),
        ("B1", 2.0, 8.0, "S1"),
        ("B1", 6.0, 4.0, "S1"),
        ("B1", 6.0, 4.0, "S0"),
        ("B1", 9.0, 1.0, "S0"),
    ]
    assert not found.left_out and not found.points
    assert [(name, place.tolist()) for name, place in found.holes["B5"][1]] == [
        ("S2", [5.0, 5.0, 10.0]),
        ("S0", [5.0, 5.0, 8.0]),
    ]


def test_without_collars_each_row_has_the_place(write):
    log = "hole,x,y,z,from,to,block\nB1,1,2,10,0,4,sand\nB1,1,2,10,4,6,clay\n"
    (observations,) = read(write, log, None).observations
    assert observations.places.tolist() == [[1, 2, 10], [1, 2, 6], [1, 2, 6], [1, 2, 4]]


def test_units(write):
    given = Boreholes(
        collars=write("c.csv", COLLARS), intervals=write("log.csv", LOG), units={"xy": "m", "z": "ft"}
    )
    (in_feet,) = read_picks(given, units=UNITS).observations
    (plain,) = read(write, LOG).observations
    np.testing.assert_allclose(in_feet.places, plain.places * [1, 1, 0.3048], rtol=1e-15)
    assert in_feet.depths.tolist() == plain.depths.tolist()  # as the table has them


def test_inclined_holes_have_places_between_the_ends(write):
    survey = "hole,depth,azimuth,inclination\nB1,0,90,45\n"
    log = "hole,from,to,block\nB1,0,10,sand\nB1,10,12,clay\n"
    (observations,) = read(write, log, survey=survey, step=2.0).observations
    assert observations.blocks.tolist() == ["S2"] * 5 + ["S1"] * 2
    np.testing.assert_allclose(
        np.diff(observations.places[:5], axis=0), [[10 / 4 / 2**0.5, 0, -10 / 4 / 2**0.5]] * 4, atol=1e-14
    )
    assert observations.places[4].tolist() == observations.places[5].tolist()


def test_a_hole_that_bends_has_places_close_enough_to_follow_it(write):
    survey = "hole,depth,azimuth,inclination\nB1,0,90,0\nB1,12,90,90\n"  # a quarter of a circle
    log = "hole,from,to,block\nB1,0,12,sand\n"
    (observations,) = read(write, log, survey=survey, step=2.0).observations
    assert 20 < len(observations) < 40
    x, _, z = (observations.places - observations.places[0]).T
    radius = 12 / (np.pi / 2)
    np.testing.assert_allclose(np.hypot(x - radius, z), radius, rtol=1e-12)
    half = 0.5 * np.diff(observations.depths) / radius
    assert (radius * (1 - np.cos(half))).max() < 2e-3 * 1.01


@pytest.mark.parametrize(
    ("more", "kind", "depth", "words"),
    [
        ("B4,3,6,sand\n", "overlap", 3.0, "hole 'B4' from 3 to 4: intervals of 'S1' and 'S2' overlap"),
        ("B4,3,2,sand\n", "from_to", 3.0, "line 16, hole 'B4' at 3, 'sand': from 3 is below to 2"),
        ("B4,,8,sand\n", "no_depth", 8.0, "line 16, hole 'B4' at 8, 'sand': 'from' has no value"),
        ("B4,7,8,slate\n", "unknown_block", 7.0, "line 16, hole 'B4' at 7, 'slate': this is no block"),
        ("B9,7,8,sand\n", "no_collar", 7.0, "line 16, hole 'B9' at 7, 'sand': it has no collar in"),
    ],
)
def test_rows_that_are_listed(write, more, kind, depth, words):
    found = read(write, LOG + more)
    (entry,) = found.left_out
    assert (entry.kind, entry.hole) == (kind, more[:2])
    assert entry.depth == depth
    assert entry.text.startswith(words)
    plain = rows(read(write, LOG).observations[0])
    own = [row for row in rows(found.observations[0]) if row[0] == "B4"]
    if kind == "overlap":  # what only one of them claims stays
        assert [row[1] for row in own] == [0.0, 1.0, 1.0, 3.0, 4.0, 6.0]
    else:
        assert rows(found.observations[0]) == plain


@pytest.mark.parametrize("code", ["", "-", "NA", "lost core", "LOST_CORE", "Core loss", "not logged", "X"])
def test_codes_that_say_nothing(write, code):
    found = read(write, LOG + f"B4,7,8,{code}\n")
    assert not found.left_out
    assert len(found.observations[0]) == len(read(write, LOG).observations[0])


def test_digits_do_not_part_intervals(write):
    log = "hole,from,to,block\nB1,0,3.00000001,sand\nB1,3,5,sand\nB1,5,7.9999999,clay\nB1,8,9,basement\n"
    (observations,) = read(write, log).observations
    assert [row[1] for row in rows(observations)] == [0.0, 5.0, 5.0, 7.9999999, 7.9999999, 9.0]


def test_names():
    units = UnitNames(["S0", "S1"], ["51", "dune"], ["salt"], {"49.5": "dune", "Q": "S0", "none": "dune"})
    assert [units.block(code) for code in ("51", "51.0", "dune", "S1", "49.5", "Q", "salt", "what")] == [
        *("S0", "S0", "S1", "S1", "S1", "S0", "salt", None)
    ]
    assert not units.says_nothing("none") and units.says_nothing("None")
    assert [units.surface(code) for code in ("51", "Q", "S1", "what")] == ["S0", "S0", "S1", "what"]
    # a block of which there are two
    assert UnitNames(["S0", "S1"], ["sand", "sand"]).block("sand") is None


def test_names_in_other_capitals_and_signs():
    units = UnitNames(["Top Clay", "sand"], ["Clay-2", "SAND"], ["Na"], {"SST": "sand", "Till": ""})
    codes = ("TOP_CLAY", "clay 2", "sst", "Sst", "Sand", "na")
    # 'Sand' may be the surface, or the block of which it is the top
    assert [units.block(code) for code in codes] == ["Top Clay", "Top Clay", "sand", "sand", None, None]
    assert units.says_nothing("TILL") and units.means_nothing("TILL")
    assert units.says_nothing("na") and not units.says_nothing("Na"), "what stands for nothing is no name"


def test_a_table_of_holes_without_collars_is_refused(write):
    with pytest.raises(InputRefused, match="no hole of it has a collar") as raised:
        read(write, LOG.replace("B", "C"))
    assert (raised.value.file.name, raised.value.line) == ("log.csv", 2)


def test_names_are_for_picks_too(write):
    given = Boreholes(
        write("p.csv", "hole,surface,depth\nB1,SST,1\nB2,clay,4\nB3,S2,2\n"), write("c.csv", COLLARS)
    )
    points = read_picks(given, units=UNITS).points
    assert {name: len(own) for name, own in points.items()} == {"S2": 2, "S1": 1}


def test_observed_places(write):
    table = "Easting,Northing,Elevation,Unit\n1,2,3,SST\n4,5,6,basement\n7,8,9,\n"
    table += "1,1,,clay\n2,2,2,slate\n,2,2,clay\n"
    found, left_out = read_observed_places(ObservationFile(write("o.csv", table)), UNITS)
    assert found.places.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert found.blocks.tolist() == ["S2", "S0"]
    assert [(each.kind, each.block) for each in left_out] == [
        ("no_depth", "clay"),
        ("unknown_block", "slate"),
        ("no_depth", "clay"),
    ]


@pytest.mark.parametrize(
    ("rock", "more", "words"),
    [
        ("observations = 3", "", "'observations' must be a file or a table"),
        ('observations = "none.csv"', "", "file not found"),
        ('observations = { file = "log.csv", column = 1 }', "", "did you mean 'columns'?"),
        ('observations = { file = "log.csv", columns = { unit = "x" } }', "", "unknown column 'unit'"),
        ("", ', columns = { blok = "x" }', "unknown column 'blok'"),
        ("", ', intervals2 = "x"', "did you mean 'intervals'?"),
    ],
)
def test_keys_that_make_no_sense(project, rock, more, words):
    with pytest.raises(InputRefused, match=words.replace("?", r"\?")):
        load_project(project(more, rock))


def test_a_name_for_nothing_known_is_refused(project, write):
    path = project()
    path.write_text(path.read_text().replace('SST = "sand"', 'SST = "sandd"'))
    with pytest.raises(
        InputRefused, match="which is no block, surface or body; did you mean 'sand'"
    ) as raised:
        load_project(path)
    assert raised.value.line == 10


def test_arrays_that_do_not_fit():
    with pytest.raises(InputRefused, match="2 places have 1 blocks"):
        Observations([[0, 0, 1], [0, 0, 2]], ["a"])
    with pytest.raises(InputRefused, match="not finite"):
        Observations([[0, 0, np.nan]], ["a"])
    with pytest.raises(InputRefused, match="not an array of numbers"):
        Observations([["x", 0, 1]], ["a"])


def test_places_of_a_hole_in_any_order():
    rows = [
        (0, 5, "b", 5),
        (9, 1, "", np.nan),
        (0, 9, "b", 1),
        (3, 2, "a", np.nan),
        (3, 8, "a", 2),
        (0, 5, "b", 5),
    ]
    given = Observations(
        [[x, 0, z] for x, z, *_ in rows], list("123456"), [row[2] for row in rows], [row[3] for row in rows]
    )
    assert given.along_holes().blocks.tolist() == ["2", "5", "4", "3", "1", "6"]
    assert not len(Observations(np.empty((0, 3)), []).along_holes())


def test_a_model_of_logs_alone(project, tmp_path):
    """B2 and B5 meet no clay: sand lies on the basement, which the surface over the clay is."""
    model = build(load_project(project()))
    surfaces = model.rock_inputs[0].data
    assert sorted(surfaces[0].points.tolist()) == [[0.0, 0.0, 4.0], [10.0, 10.0, 4.0]]
    assert sorted(surfaces[1].points.tolist()) == [
        *([0.0, 0.0, 8.0], [0.0, 10.0, 9.0], [5.0, 5.0, 8.0], [10.0, 0.0, 7.0])
    ]
    # no observation is on the ground: it goes through the collars, which it lies at or above
    assert surfaces[2].points[:, 2].tolist() == [10.0] * 5
    assert [w.surface for w in model.warnings if w.kind == "no_contact"] == ["S2"]
    assert [
        (b.holes.tolist(), b.places[:, 2].tolist(), b.is_lower.tolist()) for b in [surfaces[0].bounds]
    ] == [(["B2", "B5", "B4"], [7.0, 8.0, 6.0], [True, True, False])]
    found = model.observed()
    assert [(each.block, each.observations) for each in found.blocks] == [
        ("basement", 4),
        ("clay", 3),
        ("sand", 5),
    ]
    assert all(abs(each.residual) < 1e-12 for each in found.contacts)
    assert {(each.hole, each.depth) for each in found.contacts if each.surface == "S1"} == {
        ("B1", 2.0),
        ("B2", 3.0),
        ("B4", 1.0),
        ("B5", 2.0),
    }
    assert "12 observations" in found.summary()
    report = model.report()
    assert report["observations"][0]["block"] == "basement"
    assert len(report["contacts"]) == 6  # the collars are none
    with open(tmp_path / "report.json", "wb") as file:
        write_report(report, file)
    assert json.loads((tmp_path / "report.json").read_text())["left_out"] == []


def test_what_is_left_out_is_said_with_hole_and_depth(project):
    log = LOG + "B4,4,6,basement\nB4,6,12,clay\nB1,9,7,clay\nB1,8.5,9.5,clay\nB2,9,10,tuff\n"
    model = build(load_project(project(log=log)))
    said = {warning.kind: warning.text for warning in model.warnings}
    assert "hole 'B4' at 4, 'S0': an older block lies above a younger one" in said["wrong_order"]
    assert "hole 'B1' at 9" in said["from_to"]
    assert "hole 'B1' from 8.5 to 9: intervals of 'S0' and 'S1' overlap" in said["overlap"]
    assert "hole 'B2' at 9, 'tuff'" in said["unknown_block"]
    kinds = {each["kind"] for each in model.report()["left_out"]}
    assert kinds == {"wrong_order", "from_to", "overlap", "unknown_block"}


def test_a_read_project_is_the_same_again_in_memory_and_on_disk(project, write, tmp_path):
    write("seen.csv", "x,y,z,block\n8,2,5,basement\n2,8,7,clay\n")
    model = build(load_project(project(rock='observations = "seen.csv"')))
    again = build(model.project)
    folder = tmp_path / "written"
    folder.mkdir()
    files = save_project(model.project, folder / "p.toml")
    assert {file.name for file in files} == {"p.toml", "p_r_observations.csv"}
    written = build(load_project(folder / "p.toml"))
    model.save(tmp_path / "a.npz")
    for other in (again, written, Model.load(tmp_path / "a.npz")):
        np.testing.assert_array_equal(other.vertices, model.vertices)
        assert len(other.project.rocks[0].observed) == 26
        for first, second in zip(model.rock_inputs[0].data, other.rock_inputs[0].data, strict=True):
            np.testing.assert_array_equal(first.points, second.points)
            np.testing.assert_array_equal(first.bounds.places, second.bounds.places)
        assert other.observed().blocks == model.observed().blocks


def test_contacts_follow_the_rules_when_these_change(project):
    model = build(load_project(project()))
    changed = model.project
    changed.rocks[0].surfaces[1].rule = "conformable"
    surfaces = build(changed).rock_inputs[0].data
    # where the clay does not cut the basement, sand on the basement is the surface of that
    assert len(surfaces[0].points) == 4 and len(surfaces[1].points) == 2


@pytest.mark.parametrize("tie", [False, True])
def test_arrays_and_own_points_go_together(tie):
    square = [[0, 0], [10, 0], [10, 10], [0, 10]]
    own = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]]
    surfaces = [
        Surface("S0", points=own, method="tin", tie=tie),
        Surface("S1", points=np.array(own) + np.array([0, 0, 5]), method="tin", block="clay", tie=tie),
    ]
    seen = Observations([[5, 5, 2], [5, 5, 8]], ["base block", "clay"])
    rock = Rock("r", surfaces, region=square, edge_length=2.0, base_elevation=-1.0, observations=seen)
    model = build(Project("p", [rock]))
    assert [len(surface.points) for surface in model.rock_inputs[0].data] == [4, 4]
    found = model.observed()
    share = float(tie)  # tin is not told of bounds, ties are
    assert [(each.block, each.share) for each in found.blocks] == [("base block", share), ("clay", share)]
    expected = [] if tie else [("S1", True, 3.0), ("S0", True, 2.0)]
    assert [(each.surface, each.is_lower, each.by) for each in found.violated] == expected


def test_a_surface_that_needs_no_points_gets_none_from_bounds():
    surfaces = [Surface("S0", method="constant", options={"value": 3.0}), Surface("S1", method="tin")]
    seen = Observations([[1, 1, 8], [8, 1, 8], [5, 8, 8], [5, 5, 1]], ["S1", "S1", "S1", "S0"])
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-3.0, observations=seen)
    model = build(Project("p", [rock]))
    points = [surface.points.tolist() for surface in model.rock_inputs[0].data]
    assert points[0] == [] and len(points[1]) == 4
    assert [warning.surface for warning in model.warnings if warning.kind == "no_contact"] == ["S1"]


def test_lost_core_within_a_block_parts_two_intervals():
    """Also where one hole follows another, and where a place was seen within an interval."""
    places = [[0, 0, -z] for z in (0, 4, 6, 9)]
    hole = Observations(places, ["clay"] * 4, ["B"] * 4, [0, 4, 6, 9], [0, 0, 1, 1])
    assert hole.goes_on.tolist() == [False, True, False, True]
    assert hole.some(np.array([0, 2, 3])).goes_on.tolist() == [False, False, True]
    seen = Observations([[0, 0, -7], [5, 5, 0]], ["clay"] * 2, ["B", ""], [7, np.nan])
    both = Observations.joined([hole, seen, hole]).along_holes()
    assert both.depths[both.holes == "B"].tolist() == [0, 0, 4, 4, 6, 6, 7, 9, 9]
    (log,) = Observations.joined([hole, seen]).logs().values()
    assert log.depths.tolist() == [0, 4, 6, 7, 9]
    assert log.goes_on.tolist() == [False, True, False, True, True]
    without = Observations(places, ["clay"] * 4, ["B"] * 4, [0, 4, 6, 9])
    assert without.goes_on.tolist() == [False, True, True, True]
    assert Observations.joined([]).logs() == {}
    with pytest.raises(InputRefused, match="4 places have 3 numbers of intervals"):
        Observations(places, ["clay"] * 4, intervals=[0, 0, 1])


def test_a_surface_that_no_hole_meets_does_not_follow_inclined_holes_down():
    """Holes that lie in the sand alone: the ground is at their collars, not along them."""
    rows = []
    for name, x, way in (("B1", 1.0, 6.0), ("B2", 9.0, -6.0), ("B3", 2.0, 5.0)):
        at = np.linspace(0.0, 1.0, 7)[:, None]
        y = 2.0 * len(rows)
        rows.append((name, np.array([x, y, 9.0]) + at * [way, 0.0, -8.0], 10.0 * at.ravel()))
    seen = Observations(
        np.concatenate([places for _, places, _ in rows]),
        np.full(21, "sand"),
        np.repeat([name for name, *_ in rows], 7),
        np.concatenate([depths for *_, depths in rows]),
    )
    points = np.array([[0, 0, -2.0], [10, 0, -2], [0, 10, -2]])
    surfaces = [Surface("S0", points=points, method="plane"), Surface("S1", method="spline", block="sand")]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-5.0, observations=seen)
    model = build(Project("p", [rock]))
    ground = model.rock_inputs[0].data[1]
    expected = [[1.0, 0.0, 9.0], [2.0, 4.0, 9.0], [9.0, 2.0, 9.0]]
    np.testing.assert_allclose(ground.points, expected, atol=1e-5)  # just above the collars
    assert [(each.block, each.share) for each in model.observed().blocks] == [("sand", 1.0)]


def test_places_on_bounds_part_blocks_and_yield_to_other_bounds():
    """Outcrops of the youngest block are on no surface, and an older surface below has no contacts either."""
    x, y = np.mgrid[1:10:4, 1:10:4].reshape(2, -1)
    places = np.column_stack([x + 0.1, y + 0.2, 5.0 + 0.1 * x])
    hole = [[5.0, 5.0, 9.0], [5.3, 5.1, 7.5], [5.6, 5.25, 6.0]]
    seen = Observations(
        np.concatenate([places, hole]),
        ["sand"] * 12,
        [""] * 9 + ["B1"] * 3,
        [np.nan] * 9 + [0.0, 1.5, 3.0],
    )
    low = Surface("S0", points=[[0, 0, 0.0], [10, 0, 0], [0, 10, 0]], method="plane")
    surfaces = [low, Surface("S1", method="tin", block="clay"), Surface("S2", method="idw", block="sand")]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=2.0, base_elevation=-5.0, observations=seen)
    model = build(Project("p", [rock]))
    found = model.observed()
    assert [(each.block, each.share) for each in found.blocks] == [("sand", 1.0)]
    assert not found.contacts and not found.violated and not model.misfits()
