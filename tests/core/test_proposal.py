# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects from data alone: orders, lenses, rules, maps, and the folder that is written."""

import csv
import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Boreholes,
    InputRefused,
    OutputFailed,
    PointFile,
    UsageError,
    build,
    load_project,
    propose_project,
    read_boreholes,
)
from realmodel.core.proposal.order import evidence_of, find_order
from test_hole_files import ags4
from test_point_formats import workbook

PLAN = [(100.0 * (n % 3), 100.0 * (n // 3)) for n in range(9)]
PLAIN = [("Soil", 2), ("Sand", 5), ("Clay", 18), ("Rock", 20)]


def write_tables(folder, holes, plan=PLAN, rows_in=None):
    """Tables of holes, each (unit, thickness) from above. rows_in: the random numbers that shuffle rows."""
    collars = [f"H{n},{plan[n][0]},{plan[n][1]},50" for n in range(len(holes))]
    intervals = []
    for number, hole in enumerate(holes):
        depth = 0.0
        for unit, thickness in hole:
            intervals.append(f"H{number},{depth},{depth + thickness},{unit}")
            depth += thickness
    if rows_in is not None:
        intervals = [intervals[row] for row in rows_in.permutation(len(intervals))]
        collars = [collars[row] for row in rows_in.permutation(len(collars))]
    (folder / "collars.csv").write_text("\n".join(["hole,x,y,z", *collars, ""]), encoding="utf-8")
    (folder / "intervals.csv").write_text("\n".join(["hole,from,to,block", *intervals, ""]), encoding="utf-8")
    return {"collars": folder / "collars.csv", "intervals": folder / "intervals.csv"}


def proposed(folder, holes, **keys):
    return propose_project(boreholes=write_tables(folder, holes, **keys))


def intervals_of(model, block, x, y):
    return [i for i in model.borehole(x, y) if model.blocks[i.block].name == block]


def shares(model):
    return {block.name: block.volume / model.volume for block in model.blocks}


def test_the_order_of_units_follows_from_which_lies_over_which(tmp_path):
    project = proposed(tmp_path, [PLAIN] * 9)
    assert project.proposal.order == ["Rock", "Clay", "Sand", "Soil"]
    assert [s.block for s in project.rocks[0].surfaces] == project.proposal.order
    assert not project.proposal.warnings
    assert build(project).observed().share == 1.0


def test_two_orders_that_the_data_allow_are_both_offered(tmp_path):
    first, second = ([("soil", 2), (unit, 5), ("rock", 13)] for unit in ("clay", "sand"))
    proposal = proposed(tmp_path, [first, second]).proposal
    (other,) = proposal.alternatives
    assert {other.younger, other.older} == {"clay", "sand"}
    assert sorted([proposal.order, list(other.order)]) == [
        ["rock", "clay", "sand", "soil"],
        ["rock", "sand", "clay", "soil"],
    ]
    assert any("elevations" in reason for reason in other.reasons)
    assert any("'clay'" in text and "'sand'" in text for text in proposal.warnings)


def test_heights_decide_what_no_hole_does(tmp_path):
    high, low = [("soil", 2), ("sand", 5)], [("soil", 2), ("silt", 9), ("clay", 5)]
    proposal = proposed(tmp_path, [high, low]).proposal
    assert proposal.order.index("clay") < proposal.order.index("sand")
    pair = next(other for other in proposal.alternatives if {other.younger, other.older} == {"sand", "clay"})
    assert any("'sand' lies" in reason for reason in pair.reasons)


def test_units_in_the_wrong_order_are_listed_with_hole_and_depth(tmp_path):
    wrong = [("Soil", 2), ("Clay", 5), ("Sand", 18), ("Rock", 20)]
    proposal = proposed(tmp_path, [*[PLAIN] * 4, wrong, *[PLAIN] * 4]).proposal
    assert proposal.order == ["Rock", "Clay", "Sand", "Soil"]
    (conflict,) = proposal.conflicts
    assert (conflict.upper, conflict.lower, conflict.hole) == ("Clay", "Sand", "H4")
    assert (conflict.depth, conflict.elevation) == (7.0, 43.0)
    assert any("hole 'H4', depth 7" in text for text in proposal.warnings)


def test_a_unit_within_another_becomes_a_body_as_thick_as_it_was_seen(tmp_path):
    plain = [("Soil", 2), ("Clay", 18), ("Rock", 20)]
    lens = [("Soil", 2), ("Clay", 6), ("Sand", 4), ("Clay", 8), ("Rock", 20)]
    project = proposed(tmp_path, [*[plain] * 4, lens, *[plain] * 4])
    assert project.proposal.order == ["Rock", "Clay", "Soil"]
    assert any("hole 'H4', depth 8 to 12" in text for text in project.proposal.warnings)
    assert [(body.name, body.has_shape) for body in project.bodies] == [("Sand", False)]
    model = build(project)
    assert model.observed().share == 1.0
    (sand,) = intervals_of(model, "Sand", 100, 100)
    assert (sand.top, sand.bottom) == pytest.approx((42, 38))
    assert not intervals_of(model, "Sand", 0, 0)


def test_a_lens_of_a_unit_that_is_also_a_bed_has_a_name_of_its_own(tmp_path):
    lens = [("Soil", 2), ("Sand", 5), ("Clay", 6), ("Sand", 3), ("Clay", 9), ("Rock", 20)]
    project = proposed(tmp_path, [*[PLAIN] * 4, lens, *[PLAIN] * 4])
    assert project.proposal.order == ["Rock", "Clay", "Sand", "Soil"]
    assert [body.name for body in project.bodies] == ["Sand lens"]
    sand = next(s for s in project.rocks[0].surfaces if s.block == "Sand")
    assert project.bodies[0].property == sand.property
    assert len(intervals_of(build(project), "Sand lens", 100, 100)) == 1


def test_lenses_of_one_unit_far_apart_have_meshes(tmp_path):
    plain = [("Soil", 2), ("Clay", 18), ("Rock", 20)]
    first, last = ([("Soil", 2), ("Clay", 6), ("Sand", t), ("Clay", 12 - t), ("Rock", 20)] for t in (4, 3))
    project = proposed(tmp_path, [first, *[plain] * 7, last])
    names = ["Sand lens 1", "Sand lens 2"]
    assert [(body.name, body.has_shape) for body in project.bodies] == [(name, True) for name in names]
    assert any(f"'{names[0]}': one interval shows no dip" in text for text in project.proposal.warnings)
    project.save(tmp_path / "out")
    model = build(load_project(tmp_path / "out/project.toml"))
    (first,), (last,) = (intervals_of(model, name, x, x) for name, x in zip(names, (0, 200), strict=True))
    assert (first.top, first.bottom, last.top, last.bottom) == pytest.approx((42, 38, 42, 39))


@pytest.mark.parametrize(
    ("hole", "in_reverse"),
    [
        ([("Soil", 2), ("Sand", 5), ("Clay", 8), ("Rock", 9), ("Clay", 7), ("Sand", 4)], True),
        ([("Soil", 2), ("Sand", 15), ("Clay", 8), ("Rock", 9), ("Sand", 5), ("Clay", 8)], False),
    ],
)
def test_several_units_that_come_again_are_no_lenses(tmp_path, hole, in_reverse):
    proposal = proposed(tmp_path, [*[PLAIN] * 4, hole, *[PLAIN] * 4]).proposal
    assert not proposal.lenses
    (repeat,) = proposal.repeats
    assert (repeat.hole, repeat.in_reverse) == ("H4", in_reverse)
    assert any("H4" in text and "come again" in text for text in proposal.warnings)


def test_a_surface_that_truncates_older_beds_cuts(tmp_path):
    plan = [(x, y) for y in (0.0, 100.0, 200.0) for x in (0.0, 60.0, 120.0, 180.0, 240.0)]
    holes = []
    for x, _ in plan:  # beds fall to the east below a level unconformity at 10
        tops = {"B": 5 + 0.15 * x, "C": 15 + 0.15 * x, "D": 40 + 0.15 * x, "E": 90.0}
        depth, hole = 0.0, [("Cover", 10.0)]
        depth = 10.0
        for unit, bottom in tops.items():
            if bottom > depth:
                hole.append((unit, bottom - depth))
                depth = bottom
        holes.append(hole)
    project = proposed(tmp_path, holes, plan=plan)
    assert project.proposal.order == ["E", "D", "C", "B", "Cover"]
    rules = {choice.unit: choice for choice in project.proposal.rules}
    model = build(project)
    assert model.observed().share == 1.0
    assert rules["B"].rule == "erosional" or rules["C"].rule == "erosional"
    assert all("%" in choice.reason for choice in rules.values() if "absent" in choice.reason)


def test_beds_that_end_against_a_high_do_not_cut_it(tmp_path):
    plan = [(x, y) for y in (0.0, 60.0, 120.0, 180.0) for x in (0.0, 60.0, 120.0, 180.0, 240.0)]
    holes = []
    for x, y in plan:  # a high in the middle, with level beds around it
        high = 50 - 45 * np.exp(-((x - 120) ** 2 + (y - 90) ** 2) / 80.0**2)
        hole, depth = [], 0.0
        for unit, bottom in (("Young", 10.0), ("Middle", 20.0), ("Old", 32.0)):
            bottom = min(bottom, high)
            if bottom > depth:
                hole.append((unit, bottom - depth))
                depth = bottom
        holes.append([*hole, ("High", 90.0 - depth)])
    rules = {c.unit: c.rule for c in proposed(tmp_path, holes, plan=plan).proposal.rules}
    assert set(rules.values()) == {"conformable"}


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.data())
def test_where_superposition_decides_the_order_is_the_truth(data):
    count = data.draw(st.integers(2, 16))
    names = data.draw(st.permutations([f"unit {n}" for n in range(count)]))  # youngest first
    columns = [
        [(name, 1.0) for name in names if data.draw(st.booleans())]
        for _ in range(data.draw(st.integers(0, 6)))
    ]
    columns += [[(upper, 1.0), (lower, 2.0)] for upper, lower in pairwise(names)]
    found = find_order(evidence_of(names, columns))
    assert found.order == list(reversed(names))
    assert not found.alternatives


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.data())
def test_an_order_contradicts_no_more_than_any_exchange_of_neighbors(data):
    names = [f"u{n}" for n in range(data.draw(st.integers(2, 7)))]
    columns = [
        [(name, 1.0) for name in data.draw(st.permutations(names))[: data.draw(st.integers(1, 4))]]
        for _ in range(data.draw(st.integers(1, 8)))
    ]
    evidence = evidence_of(names, columns)
    downward = [names.index(unit) for unit in reversed(find_order(evidence).order)]
    for upper, lower in pairwise(downward):
        assert evidence.over[upper, lower] >= evidence.over[lower, upper] - 1e-9


def test_the_order_of_rows_changes_nothing(tmp_path):
    draw = np.random.default_rng(63)
    holes = [[(u, t + draw.integers(0, 4)) for u, t in PLAIN if draw.random() < 0.8] for _ in range(9)]
    first = proposed(tmp_path, holes)
    for seed in range(3):
        (tmp_path / str(seed)).mkdir()
        other = proposed(tmp_path / str(seed), holes, rows_in=np.random.default_rng(seed))
        assert other.proposal == first.proposal
        assert np.array_equal(other.rocks[0].region, first.rocks[0].region)


@pytest.mark.parametrize("names", [("Löß, gelb", "Ton (O-17)"), ("ground", "ground top"), ('a "b"', "7")])
def test_any_names_of_units(tmp_path, names):
    holes = [[(f'"{n}"' if "," in n else n.replace('"', "'"), 5 + k) for n in names] for k in range(5)]
    project = proposed(tmp_path, holes)
    project.save(tmp_path / "out")
    again = load_project(tmp_path / "out/project.toml")
    assert shares(build(again)) == shares(build(project))


def test_spellings_of_one_unit_are_one(tmp_path):
    holes = [PLAIN] * 4 + [[("soil", 2), ("SAND", 5), ("Clay", 18), ("rock", 20)]]
    assert proposed(tmp_path, holes).proposal.order == ["Rock", "Clay", "Sand", "Soil"]


def test_codes_mean_what_names_say(tmp_path):
    hole = [("S1", 2), ("LC", 1), ("Qal-2", 3), ("Qal old", 2), ("k7", 18), ("Rock", 20)]
    tables = write_tables(tmp_path, [hole] * 9)
    names = {"Qal*": "Alluvium", "/^k[0-9]$/": "Chalk", "S1": "Soil", "LC": "", "X*": "not there"}
    project = propose_project(boreholes=tables, names=names)
    assert project.proposal.order == ["Rock", "Chalk", "Alluvium", "Soil"]
    assert "X*" not in project.rocks[0].names
    assert build(project).observed().share == 1.0
    saved = load_project(project.save(tmp_path / "saved"))
    assert saved.rocks[0].names == project.rocks[0].names
    assert build(saved).observed().share == 1.0
    with pytest.raises(InputRefused, match="no regular expression"):
        propose_project(boreholes=tables, names={"/(/": "Chalk"})


@pytest.mark.parametrize(
    "text",
    [
        "Qal*,Alluvium\nS1,Soil\n/^k[0-9]$/,Chalk\nLC,\n",
        "code;unit\nQal*;Alluvium\nS1;Soil\n/^k[0-9]$/;Chalk\nLC;\nX9;not there\n",
        "ID\tUnit\tCode\n1\tAlluvium\tQal*\n2\tSoil\tS1\n3\tChalk\tk7\n4\t\tLC\n",
    ],
)
def test_meanings_of_codes_from_a_table(tmp_path, text):
    hole = [("S1", 2), ("LC", 1), ("Qal-2", 3), ("Qal old", 2), ("k7", 18), ("Rock", 20)]
    tables = write_tables(tmp_path, [hole] * 9)
    (tmp_path / "codes.csv").write_text(text)
    options = [f"--{kind}={file}" for kind, file in tables.items()]
    assert run_new(*options, f"--names={tmp_path / 'codes.csv'}", f"--out={tmp_path / 'out'}").returncode == 0
    order = json.loads((tmp_path / "out/proposal.json").read_text())["order"]
    assert order == ["Rock", "Chalk", "Alluvium", "Soil"]
    assert build(load_project(tmp_path / "out/project.toml")).observed().share == 1.0


def test_a_workbook_makes_a_project_that_builds(tmp_path):
    tables = write_tables(tmp_path, [PLAIN] * 9)
    sheets = {kind: list(csv.reader(Path(file).read_text().splitlines())) for kind, file in tables.items()}
    file = workbook(tmp_path / "site.xlsx", Notes=[["drilled in May"]], **sheets)
    assert run_new(file, "--out", tmp_path / "out").returncode == 0
    assert build(load_project(tmp_path / "out/project.toml")).observed().share == 1.0


@pytest.mark.parametrize(
    ("text", "said"), [("S1\n", "a code and a unit"), ("a,B\na,C\n", "'a' means 'B' and 'C'")]
)
def test_tables_of_codes_that_are_refused(tmp_path, text, said):
    tables = write_tables(tmp_path, [PLAIN] * 9)
    (tmp_path / "codes.csv").write_text(text)
    with pytest.raises(InputRefused, match=said):
        propose_project(boreholes=tables, names=tmp_path / "codes.csv")


def test_boreholes_are_given_in_one_way(tmp_path):
    tables = write_tables(tmp_path, [PLAIN] * 9)
    assert len(read_boreholes(tables).collars) == len(read_boreholes(**tables).collars) == 9
    given = Boreholes(**tables)
    assert len(read_boreholes(given).intervals) == len(propose_project(boreholes=given).rocks[0].surfaces) * 9
    for wrong in ({"collar": "c.csv"}, {"collars": 3}):
        for reader in (read_boreholes, lambda tables: propose_project(boreholes=tables)):
            with pytest.raises(UsageError):
                reader(wrong)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_holes_and_holes_in_a_line_make_a_model(tmp_path, count):
    model = build(proposed(tmp_path, [PLAIN] * count))
    assert len(model.blocks) == 4


def test_the_folder_has_the_tables_the_reasons_and_what_was_found(tmp_path):
    project = proposed(tmp_path, [PLAIN] * 9)
    assert project.save(tmp_path / "out") == tmp_path / "out/project.toml"
    names = {"project.toml", "library.toml", "proposal.json", "collars.csv", "intervals.csv", "ground.csv"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names
    text = (tmp_path / "out/project.toml").read_text(encoding="utf-8")
    for word in ("oldest first", "convex hull", "edge length", "base", "collar"):
        assert word in text
    said = json.loads((tmp_path / "out/proposal.json").read_text(encoding="utf-8"))
    assert said["order"] == project.proposal.order
    assert {"alternatives", "conflicts", "rules", "reasons", "warnings"} <= said.keys()
    assert (tmp_path / "out/intervals.csv").read_bytes() == (tmp_path / "intervals.csv").read_bytes()
    with pytest.raises(OutputFailed, match="exists"):
        project.save(tmp_path / "out")


def test_a_folder_appears_whole_or_not_at_all(tmp_path):
    project = proposed(tmp_path, [PLAIN] * 9)
    (tmp_path / "intervals.csv").unlink()
    with pytest.raises(OutputFailed):
        project.save(tmp_path / "out")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["collars.csv"]


def test_picks_alone_are_surfaces(tmp_path):
    (tmp_path / "c.csv").write_text("hole,x,y,z\nA,0,0,10\nB,50,0,10\nC,0,50,10\nD,50,50,11\n")
    rows = [f"{hole},{name},{depth}" for hole in "ABCD" for name, depth in (("lower", 8), ("upper", 3))]
    (tmp_path / "p.csv").write_text("\n".join(["hole,surface,depth", *rows, ""]))
    project = propose_project(boreholes={"collars": tmp_path / "c.csv", "picks": tmp_path / "p.csv"})
    assert [s.name for s in project.rocks[0].surfaces] == ["lower", "upper"]
    assert build(project).volume > 0


def test_logs_without_order_make_a_project_all_the_same(tmp_path):
    draw = np.random.default_rng(5)
    holes = [[(f"u{draw.integers(8)}", float(draw.uniform(1, 4))) for _ in range(8)] for _ in range(12)]
    plan = [(100.0 * (n % 4), 100.0 * (n // 4)) for n in range(12)]
    project = proposed(tmp_path, holes, plan=plan)
    assert len(project.bodies) <= 30
    assert project.proposal.conflicts
    project.save(tmp_path / "out")
    load_project(tmp_path / "out/project.toml")


def test_one_unit_alone_is_a_model(tmp_path):
    project = proposed(tmp_path, [[("Sand", 10)]] * 3)
    project.save(tmp_path / "out")
    assert [block.name for block in build(load_project(tmp_path / "out/project.toml")).blocks] == ["Sand"]


def test_a_lens_in_a_unit_whose_surface_is_called_otherwise(tmp_path):
    plain = [("Clay", 18), ("Clay top", 5), ("Rock", 20)]
    lens = [("Clay", 18), ("Clay top", 2), ("Sand", 1), ("Clay top", 2), ("Rock", 20)]
    project = proposed(tmp_path, [*[plain] * 4, lens, *[plain] * 4])
    assert {lens.host for lens in project.proposal.lenses} == {"Clay top"}
    assert build(project).observed().share == 1.0


def test_nothing_to_propose_from_is_refused(tmp_path):
    with pytest.raises(UsageError, match="boreholes or a map"):
        propose_project()
    with pytest.raises(UsageError, match="there is no key 'log'"):
        propose_project(boreholes={"log": "x.csv"})
    tables = write_tables(tmp_path, [PLAIN])
    with pytest.raises(UsageError, match="by their files"):
        propose_project(boreholes=read_boreholes(**tables))


def write_map(folder, features, ground=None):
    """A GeoJSON map of strips along x, each (unit, from, to, other attributes), on a level ground."""
    entries = []
    for unit, low, high, more in features:
        ring = [[low, 0], [high, 0], [high, 100], [low, 100], [low, 0]]
        shape = {"type": "Polygon", "coordinates": [ring]}
        entries.append({"type": "Feature", "properties": {"FORMATION": unit, **more}, "geometry": shape})
    text = json.dumps({"type": "FeatureCollection", "features": entries})
    (folder / "map.geojson").write_text(text, encoding="utf-8")
    rows = [" ".join(["100"] * 32)] * 12
    head = "ncols 32\nnrows 12\nxllcorner -10\nyllcorner -10\ncellsize 10\n"
    (folder / "dem.asc").write_text(head + "\n".join(rows) + "\n")
    return {"map": folder / "map.geojson", "ground": folder / "dem.asc"}


STRIPS = [("A", 0, 100, {}), ("B", 100, 200, {}), ("C", 200, 300, {})]


@pytest.mark.parametrize("said", ["urn:ogc:def:crs:EPSG::27700", "EPSG:27700"])
def test_the_system_of_a_map_is_the_projects(tmp_path, said):
    given_map = write_map(tmp_path, STRIPS)
    head = f'"crs": {{"properties": {{"name": "{said}"}}}}, "features"'
    given_map["map"].write_text(given_map["map"].read_text().replace('"features"', head))
    assert propose_project(**given_map).crs == "EPSG:27700"
    assert propose_project(**given_map, crs="EPSG:2154").crs == "EPSG:2154"
    for part in ("map", "ground"):
        given_map[part] = (
            {"file": given_map[part], "units": "ft"}
            if part == "map"
            else PointFile(given_map[part], units="ft")
        )
    assert propose_project(**given_map, units="ft").crs is None


def test_a_unit_that_dips_beneath_another_is_older(tmp_path):
    given_map = write_map(tmp_path, STRIPS)
    rows = ["90,50,30,90,A", "190,30,30,90,B", "210,60,35,90,C"]
    (tmp_path / "dips.csv").write_text("\n".join(["x,y,dip,dip_direction,formation", *rows, ""]))
    project = propose_project(**given_map, dips=tmp_path / "dips.csv")
    assert project.proposal.order == ["A", "B", "C"]
    assert not project.proposal.alternatives
    assert {block.name for block in build(project).blocks} == {"A", "B", "C"}
    project.save(tmp_path / "out")
    assert {b.name for b in build(load_project(tmp_path / "out/project.toml")).blocks} == {"A", "B", "C"}


@pytest.mark.parametrize("ages", [(40, 250, 90), ("Eocene", "Permian", "Lower Cretaceous")])
def test_ages_of_a_map_decide(tmp_path, ages):
    strips = [(*strip[:3], {"AGE": age}) for strip, age in zip(STRIPS, ages, strict=True)]
    proposal = propose_project(**write_map(tmp_path, strips)).proposal
    assert proposal.order == ["B", "C", "A"]


def test_a_map_whose_units_are_not_clear_names_the_key(tmp_path):
    given_map = write_map(tmp_path, STRIPS)
    text = given_map["map"].read_text().replace('"FORMATION"', '"FOO"').replace('"A"', '"A", "BAR": "x"')
    given_map["map"].write_text(text)
    with pytest.raises(InputRefused, match="block"):
        propose_project(**given_map)
    assert propose_project(map={"file": given_map["map"], "block": "FOO"}, ground=given_map["ground"])


@pytest.mark.parametrize("unit", ["m", "ft"])
def test_a_file_with_all_tables_is_enough(tmp_path, unit):
    file = tmp_path / "site.ags"
    file.write_text(ags4(unit, 1.0 if unit == "m" else 1 / 0.3048), encoding="utf-8")
    project = propose_project(boreholes=file)
    assert project.proposal.order == ["C", "B", "A"]
    project.save(tmp_path / "out")
    model = build(load_project(tmp_path / "out/project.toml"))
    assert shares(model) == shares(build(project))
    assert (tmp_path / "out/site.ags").read_bytes() == file.read_bytes()
    bottom = intervals_of(model, "A", 50, 50)[0].bottom
    assert bottom == pytest.approx(-10, abs=1e-6)


@pytest.mark.parametrize("kind", ["array", "file"])
def test_a_region_that_is_given(tmp_path, kind):
    ring = [[-50, -50], [300, -50], [300, 250], [-50, 250]]
    shape = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
    (tmp_path / "region.geojson").write_text(json.dumps(shape))
    region = np.array(ring, float) if kind == "array" else tmp_path / "region.geojson"
    project = propose_project(boreholes=write_tables(tmp_path, [PLAIN] * 9), region=region)
    project.save(tmp_path / "out")
    model = build(load_project(tmp_path / "out/project.toml"))
    assert np.allclose(model.vertices[:, :2].min(axis=0), (-50, -50))
    assert np.allclose(model.vertices[:, :2].max(axis=0), (300, 250))


def test_inclined_holes(tmp_path):
    keys = write_tables(tmp_path, [[("Sand", 10), ("Clay", 15), ("Rock", 20)]] * 9)
    (tmp_path / "survey.csv").write_text(
        "hole,depth,azimuth,dip\n" + "".join(f"H{n},0,{40 * n},-60\n" for n in range(9))
    )
    project = propose_project(boreholes={**keys, "survey": tmp_path / "survey.csv"})
    assert project.proposal.order == ["Rock", "Clay", "Sand"]
    project.save(tmp_path / "out")
    assert build(load_project(tmp_path / "out/project.toml")).observed().share == 1.0


def test_a_raster_is_the_ground_and_bounds_the_region(tmp_path):
    keys = write_tables(tmp_path, [PLAIN] * 9)
    head = "ncols 26\nnrows 26\nxllcorner -15\nyllcorner -15\ncellsize 10\n"
    (tmp_path / "dem.asc").write_text(head + "\n".join([" ".join(["50"] * 26)] * 26) + "\n")
    project = propose_project(boreholes=keys, ground=tmp_path / "dem.asc")
    model = build(project)
    assert np.allclose(model.vertices[:, 2].max(), 50)
    assert model.vertices[:, :2].min() >= -15


def run_new(*arguments):
    command = [sys.executable, str(ROOT / "build_model.py"), "new", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_command_writes_a_project_and_builds_it(tmp_path):
    tables = write_tables(tmp_path, [PLAIN] * 9)
    options = ["--collars", tables["collars"], "--intervals", tables["intervals"], "--out", tmp_path / "out"]
    done = run_new(*options, "--export", tmp_path / "m.npz")
    assert done.returncode == 0, done.stderr
    assert "Rock, Clay, Sand, Soil" in done.stdout
    assert (tmp_path / "m.npz").is_file()
    again = run_new(*options)
    assert again.returncode == 1
    assert "choose a new folder" in again.stderr
    assert run_new("--out", tmp_path / "other").returncode == 2
    assert not (tmp_path / "other").exists()
