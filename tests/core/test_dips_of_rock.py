# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips of a whole rock mass: which surfaces each counts for, from file to model."""

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import (
    DipFile,
    Dips,
    InputRefused,
    MapFile,
    Model,
    ObservationFile,
    Project,
    Rock,
    Surface,
    build,
    load_project,
)
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import UnitNames, read_dips, read_dips_of_rock, read_observed_places
from realmodel.core.readers.tables.dips import read_space_dips
from realmodel.core.settings.rules import RULES
from realmodel.core.surfaces.observed.dip_surfaces import beside_blocks, blocks_at, runs_of_blocks

REGION = np.array([[0.0, 0], [100, 0], [100, 100], [0, 100]])
CONFORMABLE = ["conformable"] * 3


def points_at(height, slope=0.0, count=12, seed=1):
    plan = np.random.default_rng(seed).uniform(0, 100, (count, 2))
    return np.column_stack([plan, height + slope * plan[:, 0]])


def rock_of(rules, dips=None, method="spline", base=-100.0, **more):
    surfaces = [
        Surface(f"S{k}", points=points_at(10.0 * k, seed=k), method=method, rule=rule, block=f"B{k}")
        for k, rule in enumerate(rules)
    ]
    return Rock("R", surfaces, REGION, edge_length=20.0, base_elevation=base, dips=dips, **more)


def counted(rock, **more):
    """For each dip the names of the surfaces that it counts for, and the texts of the warnings."""
    model = build(Project("p", [rock], **more))
    entry = model.rock_inputs[0]
    read = entry.rock
    found = [[] for _ in range(len(read.dips))]
    for surface, data in zip(read.surfaces, entry.data, strict=True):
        for position in [] if data.dips is None else data.dips.positions:
            for row in np.flatnonzero((read.dips.positions == position).all(axis=1)):
                found[row].append(surface.name)
    return found, [str(each) for each in model.warnings]


def dips_of(blocks=None, surfaces=None, z=None, count=None):
    count = count or len(blocks or surfaces)
    positions = np.column_stack([np.linspace(10, 90, count), np.linspace(20, 80, count)])
    return Dips(positions, np.tile([0.1, 0.0], (count, 1)), z, surfaces, blocks)


def test_a_block_lies_parallel_to_its_base_and_to_a_top_that_does_not_cut_it():
    rules = ["erosional", "conformable", "erosional", "conformable", "base", "discontinuous"]
    found = [np.flatnonzero(row).tolist() for row in beside_blocks(rules)]
    assert found == [[], [0, 1], [1], [2, 3], [3, 4], [4]]
    found = [np.flatnonzero(row).tolist() for row in runs_of_blocks(rules)]
    assert found == [[], [0, 1], [0, 1], [2, 3, 4], [2, 3, 4], [2, 3, 4]]


def test_the_ground_has_no_dips():
    assert np.flatnonzero(beside_blocks(CONFORMABLE, ground=2)[2]).tolist() == [1]
    assert not runs_of_blocks(CONFORMABLE, ground=2)[:, 2].any()
    assert runs_of_blocks(CONFORMABLE, ground=2)[2].tolist() == [True, True, False]


@pytest.mark.parametrize("rules", itertools.product(RULES, repeat=3))
def test_the_block_of_a_place_is_that_of_the_replay(rules):
    random = np.random.default_rng(7)
    heights = random.integers(0, 6, (3, 300)) + 0.1 * random.random((3, 300))
    heights[1, :40] = np.nan
    z = random.uniform(-1, 6, 300)
    blocks = blocks_at(rules, heights, z)
    for number in range(300):
        layers, top, firm = [], -np.inf, -np.inf
        for k, rule in enumerate(rules):
            if np.isnan(heights[k, number]):
                continue
            own = heights[k, number] if RULES[rule].cuts else max(heights[k, number], top)
            own = max(own, firm)
            layers = [(name, low, min(high, own)) for name, low, high in layers]
            layers.append((k, top, own))
            top, firm = own, own if RULES[rule].protects else firm
        inside = [name for name, low, high in layers if low < z[number] < high]
        if inside:
            assert blocks[number] == inside[0]
    at_top = blocks_at(rules, heights, np.full(300, np.nan))
    assert (at_top == blocks_at(rules, heights, tops(rules, heights) - 1e-9)).all()


def tops(rules, heights):
    top, firm = np.full(heights.shape[1], -np.inf), np.full(heights.shape[1], -np.inf)
    for rule, height in zip(rules, heights, strict=True):
        own = np.maximum(height if RULES[rule].cuts else np.fmax(height, top), firm)
        top = np.where(np.isnan(height), top, own)
        firm = np.where(RULES[rule].protects & ~np.isnan(height), own, firm)
    return top


def test_dips_of_blocks_and_surfaces_count_for_these():
    rules = ["erosional", "conformable", "conformable", "erosional"]
    dips = dips_of(["B0", "B1", "S2", "B3", ""], ["", "", "", "", "S3"])
    found, warnings = counted(rock_of(rules, dips))
    assert found == [[], ["S0", "S1"], ["S1", "S2"], ["S2"], ["S3"]]
    assert any("dips count for no surface" in text and "'B0'" in text for text in warnings)


def test_surfaces_have_the_slopes_of_the_dips():
    dips = dips_of(count=8)
    model = build(Project("p", [rock_of(CONFORMABLE, dips)]))
    for surface in range(3):
        vertices = model.surface(surface)[0]
        x = np.column_stack([vertices[:, :2], np.ones(len(vertices))])
        slope = np.linalg.lstsq(x, vertices[:, 2], rcond=None)[0][0]
        assert slope > 0.01, "the points alone are level"


def test_a_dip_without_a_name_counts_as_far_as_no_unconformity_parts_it():
    rules = ["erosional", "conformable", "erosional", "conformable"]
    z = np.array([5.0, 15.0, 25.0, np.nan, -20.0])
    found, _ = counted(rock_of(rules, dips_of(z=z, count=5)))
    assert found == [["S0", "S1"], ["S0", "S1"], ["S2", "S3"], ["S2", "S3"], []]


def test_where_each_surface_cuts_a_warning_says_what_dips_count_for():
    found, warnings = counted(rock_of(["erosional"] * 3, dips_of(z=np.array([5.0, 15.0]), count=2)))
    assert found == [["S0", "S1"], ["S0", "S1"]], "all but the youngest, which may be the ground"
    assert any("2 dips of blocks count for unconformities, too" in text for text in warnings)


def test_the_map_shows_the_block_of_a_dip_without_a_name(tmp_path):
    left, right = [[0, 0], [50, 0], [50, 100], [0, 100]], [[50, 0], [100, 0], [100, 100], [50, 100]]
    ring = [[*corners, corners[0]] for corners in (left, right)]
    polygons = [
        {
            "type": "Feature",
            "properties": {"unit": f"B{k}"},
            "geometry": {"type": "Polygon", "coordinates": [ring[k - 1]]},
        }
        for k in (1, 2)
    ]
    file = tmp_path / "map.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": polygons}))
    rules = ["erosional", "conformable", "erosional", "conformable"]
    rock = rock_of(rules, dips_of(count=2), map=MapFile(file, "unit"))
    rock.surfaces[2].rule = "erosional"
    found, _ = counted(rock)
    assert found == [["S0", "S1"], ["S0", "S1"]], "block 2 lies on S1, and S2 cuts it"


def test_methods_without_dips():
    rock = rock_of(CONFORMABLE, dips_of(["B1"]))
    rock.surfaces[1].method = "tin"
    found, warnings = counted(rock)
    assert found == [["S0"]]
    assert any("surface 'S1': 1 dips of blocks of the rock mass would count for it" in t for t in warnings)
    rock = replace(rock, dips=dips_of(surfaces=["S1"]))
    with pytest.raises(InputRefused, match="name it, but method 'tin' does not use dips"):
        counted(rock)


def test_dips_of_nothing_that_is_there_are_listed():
    _, warnings = counted(rock_of(CONFORMABLE, dips_of(["B9", "B1"])))
    assert any("dips are of no surface or block" in text and "'B9'" in text for text in warnings)


UNITS = UnitNames(["S0", "S1"], ["B0", "B1"], ["dike"], {"sst": "B1", "top": "S1", "water": ""})
TABLE = """x,y,z,dip,strike,surface,unit
1,2,3,30,0,S1,
1,3,3,30,0,,sst
1,4,3,30,0,top,sst
1,5,3,30,0,B0,
1,6,3,30,0,,
1,7,3,30,0,water,
1,8,3,30,0,,marl
1,9,3,30,0,,dike
"""


def test_names_in_a_table_of_dips(tmp_path):
    file = tmp_path / "dips.csv"
    file.write_text(TABLE)
    dips, left_out = read_dips_of_rock(DipFile(file), UNITS)
    assert dips.positions[:, 1].tolist() == [2, 3, 4, 5, 6]
    assert dips.surfaces.tolist() == ["S1", "", "S1", "", ""]
    assert dips.blocks.tolist() == ["", "S1", "", "S0", ""]
    assert [each.text for each in left_out] == ["line 8, 'marl'", "line 9, 'dike'"]


PROJECT = """format = 1
name = "p"
[[rock]]
name = "R"
region = [[0, 0], [100, 0], [100, 100], [0, 100]]
edge_length = 20
base_elevation = -50
dips = {dips}
names = {{ sst = "sand" }}
[[rock.surface]]
name = "S0"
points = "p0.csv"
method = "spline"
[[rock.surface]]
name = "S1"
points = "p1.csv"
method = "spline"
rule = "conformable"
block = "sand"
"""


def test_a_project_with_dips_of_its_rock_mass(tmp_path):
    for k in (0, 1):
        rows = "\n".join(",".join(map(repr, row)) for row in points_at(10.0 * k, seed=k).tolist())
        (tmp_path / f"p{k}.csv").write_text("x,y,z (ft)\n" + rows + "\n")
    (tmp_path / "dips.csv").write_text("x (ft),y,z,dip,strike,unit\n20,20,5,10,0,sst\n60,70,,12,0,sst\n")
    file = tmp_path / "p.toml"
    file.write_text(PROJECT.format(dips='"dips.csv"'))
    project = load_project(file)
    assert tmp_path / "dips.csv" in project.input_files()
    model = build(project)
    assert [len(data.dips) for data in model.rock_inputs[0].data] == [2, 2]
    said = [str(warning) for warning in model.warnings if "the header says ft for" in str(warning)]
    assert [file in text for file, text in zip(("dips.csv", "p0.csv", "p1.csv"), sorted(said), strict=True)]
    save_project(model.project, tmp_path / "again.toml")
    again = build(load_project(tmp_path / "again.toml"))
    model.save(tmp_path / "model.npz")
    loaded = build(Model.load(tmp_path / "model.npz").project)
    for other in (again, loaded):
        for number in (0, 1):
            assert np.array_equal(other.surface(number)[0], model.surface(number)[0])
    (tmp_path / "dips.csv").write_text("x,y,z,dip,strike,unit\n20,20,5,10,0,sst\n60,70,,95,0,sst\n")
    with pytest.raises(InputRefused, match="the dip 95 is overturned") as refused:
        build(project)
    assert refused.value.line == 3
    assert refused.value.file == tmp_path / "dips.csv"
    for dips, said in (('"none.csv"', "file not found"), ("7", "'dips' must be a file or a table")):
        file.write_text(PROJECT.format(dips=dips))
        with pytest.raises(InputRefused, match=said) as refused:
            load_project(file)
        assert refused.value.line == 8


def test_units_in_the_header_of_observations_and_dips_are_obeyed(tmp_path):
    """Each column in any unit that its header says; an unknown one is refused."""
    units = UnitNames(["sst"], ["sst"])
    (file := tmp_path / "o.csv").write_text(
        "X_ft,y (km),Z [ft],depth (ft),height_error,block\n10,2,30,5,1,sst\n"
    )
    observed, _ = read_observed_places(ObservationFile(file), units)
    np.testing.assert_allclose(observed.places, [[3.048, 2000.0, 9.144]])
    np.testing.assert_allclose([observed.depths[0], observed.errors[0]], [1.524, 0.3048])
    (file := tmp_path / "d.csv").write_text("X_ft,y,Z (ft),dip,azimuth\n10,2,30,5,1\n")
    dips = read_dips(DipFile(file), "km")
    np.testing.assert_allclose([*dips.positions[0], dips.z[0]], [0.003048, 2.0, 0.009144])
    file.write_text("x (fathoms),y,z,dip,azimuth\n10,2,30,5,1\n")
    with pytest.raises(InputRefused, match="set units"):
        read_dips(DipFile(file))


def test_names_signs_and_nulls_of_the_trade(tmp_path):
    file = tmp_path / "d.csv"
    for names in (
        "Fallen;Fallrichtung",
        "buzamiento;dirección de buzamiento",
        "pendage;direction de pendage",
    ):
        file.write_text(f"X;Y;Z;{names}\n0;0;5,5;30,0°;90°\n;;;;\n", encoding="utf-8")
        dips = read_space_dips(DipFile(file))
        np.testing.assert_allclose(dips.normals, [[0.5, 0, np.sqrt(0.75)]])
    file.write_text("x,y,z,dip,dip_direction\n0,0,5,30,90\n1,0,5,-9999,-9999\n")
    with pytest.raises(InputRefused, match="it has no dip; fill it in"):
        read_space_dips(DipFile(file))


def test_elevations_that_stand_for_none_are_none(tmp_path):
    (file := tmp_path / "o.csv").write_text("x,y,z,block\n0,0,5,a\n1,0,-9999,a\n2,0,9,a\n")
    seen, left_out = read_observed_places(ObservationFile(file), UnitNames(["a"], ["a"]))
    assert seen.places[:, 2].tolist() == [5, 9]
    assert [(entry.kind, "line 3" in entry.text) for entry in left_out] == [("no_depth", True)]
    file.write_text("x,y,z,block\n0,0,-9990,a\n1,0,-9999,a\n2,0,-10010,a\n")  # deep, and all of them real
    assert len(read_observed_places(ObservationFile(file), UnitNames(["a"], ["a"]))[0]) == 3
