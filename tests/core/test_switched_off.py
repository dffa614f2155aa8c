# SPDX-License-Identifier: GPL-3.0-or-later
"""Data that are switched off: kept with the project, and not used."""

import numpy as np
import pytest
from realmodel.core import Dips, InputRefused, Observations, Project, Rock, Surface, build, load_project
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import read_dips, read_observed_places
from realmodel.core.readers.tables.unit_names import UnitNames
from realmodel.core.settings.data_files import ObservationFile
from realmodel.core.settings.dips import DipFile

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]
LOW = np.array([[1.0, 1, 2], [9, 1, 2], [9, 9, 2], [1, 9, 2], [5, 5, 4]])


def project(observations=None, left_out=None, dips=None):
    base = Surface("base", points=LOW, method="dsi", left_out=left_out, dips=dips)
    top = Surface("top", method="constant", options={"value": 8.0})
    rock = Rock("rock", [base, top], SQUARE, edge_length=2.0, base_elevation=0.0, observations=observations)
    return Project("off", [rock])


def heights(model):
    return model.surface(0)[0][:, 2]


def test_points_that_are_left_out_are_not_used():
    without = project(left_out=LOW[4:])
    model = build(without)
    assert np.allclose(heights(model), 2.0, atol=1e-6)
    assert heights(build(project())).max() > 3.0
    assert model.rock_inputs[0].data[0].points.tolist() == sorted(LOW[:4].tolist())
    assert np.array_equal(model.project.rocks[0].surfaces[0].left_out, LOW[4:])


def test_points_of_a_file_are_left_out(tmp_path):
    rows = "".join(f"{x},{y},{z}\n" for x, y, z in LOW)
    (tmp_path / "points.csv").write_text("x,y,z\n" + rows)
    given = project(left_out=LOW[4:])
    given.rocks[0].surfaces[0].points = tmp_path / "points.csv"
    assert np.array_equal(heights(build(given)), heights(build(project(left_out=LOW[4:]))))
    given.rocks[0].surfaces[0].left_out = LOW
    with pytest.raises(InputRefused, match="no points"):
        build(given)


def test_observations_that_are_switched_off_say_nothing():
    seen = Observations([[5, 5, 6], [2, 2, 7]], ["base", "top"], used=[False, True])
    model = build(project(seen))
    assert np.array_equal(heights(model), heights(build(project(seen.some([1])))))
    found = model.observed()
    assert [each.kind for _, each in found.left_out] == ["switched_off"]
    assert "(5, 5, 6), 'base': it is switched off" in found.left_out[0][1].text
    assert sum(each.observations for each in found.blocks) == 1
    assert not [w for w in model.warnings if w.kind == "switched_off"]
    # used, it lifts the surface
    assert build(project(Observations(seen.places, seen.blocks))).observed().bounds > found.bounds


def test_a_part_of_a_hole_that_is_switched_off():
    places = [(5, 5, z) for z in (8, 6, 6, 3, 3, 0)]
    given = Observations(places, ["top", "top", "base", "base", "top", "top"], ["B1"] * 6)
    off = Observations(given.places, given.blocks, given.holes, used=[True] * 4 + [False] * 2)
    kinds = [each.kind for _, each in build(project(off, LOW[4:])).observed().left_out]
    assert kinds == ["switched_off"], "the two rows of one interval; without it the hole is in order"
    assert [each.kind for _, each in build(project(given, LOW[4:])).observed().left_out] == ["wrong_order"]


def test_dips_that_are_switched_off_are_not_used():
    dips = Dips([[5.0, 5.0], [2.0, 2.0]], [[1.0, 0.0], [0.0, 0.0]], used=[False, True]).checked()
    model = build(project(dips=dips))
    assert np.array_equal(heights(model), heights(build(project(dips=dips.some(dips.used)))))
    assert len(model.project.rocks[0].surfaces[0].dips) == 2, "it is kept"
    none = Dips(dips.positions, dips.gradients, used=[False, False])
    assert np.array_equal(heights(build(project(dips=none))), heights(build(project())))


def test_they_are_written_and_read_again(tmp_path):
    seen = Observations([[5, 5, 6], [2, 2, 7]], ["base", "top"], used=[False, True])
    dips = Dips([[5.0, 5.0], [2.0, 2.0]], [[1.0, 0.0], [0.25, 0.5]], used=[True, False]).checked()
    save_project(build(project(seen, LOW[4:], dips)).project, tmp_path / "p.toml")
    again = build(load_project(tmp_path / "p.toml")).project.rocks[0]
    assert again.observed.blocks[again.observed.in_use].tolist() == ["top"]
    assert again.surfaces[0].dips.used.tolist() == dips.used.tolist()
    assert again.surfaces[0].dips.gradients.tolist() == dips.gradients.tolist()
    assert again.surfaces[0].left_out.tolist() == LOW[4:].tolist()
    assert again.surfaces[0].points.tolist() == sorted(LOW[:4].tolist())


def test_tables_say_what_is_used(tmp_path):
    words = ["0", "1", "no", "YES", "false", "True", "off", "on"]
    table = tmp_path / "seen.csv"
    table.write_text(
        "x,y,z,block,use\n" + "".join(f"1,2,3,clay,{word}\n" for word in words) + "1,2,3,clay,\n"
    )
    found, _ = read_observed_places(ObservationFile(table), UnitNames(["clay"], ["clay"]))
    assert found.used.tolist() == [False, True] * 4 + [True]
    table.write_text("x,y,dip,strike,use\n1,2,10,0,0\n1,2,10,0,1\n")
    assert read_dips(DipFile(table)).used.tolist() == [False, True]


def test_wrong_arrays_are_refused():
    with pytest.raises(InputRefused, match="2 places have 1 of 'used'"):
        Observations([[0, 0, 1], [0, 0, 2]], ["a", "a"], used=[True])
    with pytest.raises(InputRefused, match="'used'"):
        Dips([[0.0, 0.0]], [[0.0, 0.0]], used=[True, False]).checked()


@pytest.mark.parametrize("text", ['"x"', "[1, 2, 3]", "[[1, 2]]", '[[1, 2, "z"]]'])
def test_wrong_points_in_a_project_file_are_refused(tmp_path, text):
    lines = ["format = 1", 'name = "p"', "[[rock]]", 'name = "r"', "region = [[0, 0], [1, 0], [1, 1]]"]
    lines += ["edge_length = 1", "[[rock.surface]]", 'name = "s"', 'method = "constant"', "value = 1"]
    (tmp_path / "p.toml").write_text("\n".join([*lines, f"left_out = {text}"]))
    with pytest.raises(InputRefused, match="'left_out' must be a list of points"):
        load_project(tmp_path / "p.toml")


def hole_project(tmp_path, boreholes, **tables):
    for name, text in tables.items():
        (tmp_path / f"{name}.csv").write_text(text)
    file = tmp_path / "p.toml"
    file.write_text(
        f"""format = 1
name = "off"
[[rock]]
name = "rock"
region = [[0, 0], [10, 0], [10, 10], [0, 10]]
edge_length = 2
base_elevation = 0
boreholes = {boreholes}
[[rock.surface]]
name = "base"
method = "dsi"
[[rock.surface]]
name = "top"
method = "constant"
value = 8
"""
    )
    return file


def test_picks_that_are_switched_off(tmp_path):
    """They stay with the project as points that are left out."""
    rows = "".join(f"B{k},base,{x},{y},{z},{int(z == 2)}\n" for k, (x, y, z) in enumerate(LOW))
    picks = "hole,surface,x,y,elevation,use\n" + rows
    file = hole_project(tmp_path, '{ picks = "picks.csv" }', picks=picks)
    model = build(load_project(file))
    assert np.array_equal(heights(model), heights(build(project(left_out=LOW[4:]))))
    surface = model.project.rocks[0].surfaces[0]
    assert surface.points.tolist() == sorted(LOW[:4].tolist())
    assert np.array_equal(surface.left_out, LOW[4:])
    assert "B4" not in model.project.rocks[0].hole_picks
    save_project(model.project, tmp_path / "again.toml")
    again = load_project(tmp_path / "again.toml")
    assert np.array_equal(heights(build(again)), heights(model))
    assert np.array_equal(again.rocks[0].surfaces[0].left_out, LOW[4:])


def test_intervals_that_are_switched_off(tmp_path):
    """Of two logs of one hole the second is used; a third part is kept where there is no other."""
    collars = "hole,x,y,z\nA,2,2,8\nB,8,8,8\nC,5,5,8\n"
    log = (
        "hole,from,to,block,use\nA,0,6,top,\nA,6,8,base,\nB,0,6,top,yes\nB,6,8,base,1\n"
        "C,0,2,top,0\nC,2,7,base,0\nC,7,8,top,no\nC,0,4,top,1\n"
    )
    file = hole_project(
        tmp_path, '{ collars = "collars.csv", intervals = "log.csv" }', collars=collars, log=log
    )
    model = build(load_project(file))
    observed = model.project.rocks[0].observed
    own = observed.some(observed.holes == "C")
    assert own.depths.tolist() == [0, 4, 4, 7, 7, 8]
    assert own.blocks.tolist() == ["top", "top", "base", "base", "top", "top"]
    assert own.in_use.tolist() == [True, True, False, False, False, False]
    kinds = [each.kind for _, each in model.observed().left_out]
    assert kinds == ["switched_off"] * 2
    without = log.splitlines(keepends=True)
    (tmp_path / "log.csv").write_text("".join(without[:5] + without[-1:]))
    assert np.array_equal(heights(build(load_project(file))), heights(model))
    save_project(model.project, tmp_path / "again.toml")
    again = build(load_project(tmp_path / "again.toml"))
    assert np.array_equal(heights(again), heights(model))
    assert [each.kind for _, each in again.observed().left_out] == kinds
    (tmp_path / "log.csv").write_text(
        log.replace(",1\n", ",\n").replace(",0\n", ",\n").replace(",no\n", ",\n")
    )
    assert "overlap" in {each.kind for _, each in build(load_project(file)).observed().left_out}
