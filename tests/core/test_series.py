# SPDX-License-Identifier: GPL-3.0-or-later
"""Series in project files: read, written, and refused where they make no sense."""

import math

import numpy as np
import pytest
from realmodel.core import DipFile, InputRefused, Project, Rock, Series, SpaceDips, Surface, load_project
from realmodel.core.project.project_checks import check_project
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import read_space_dips
from realmodel.core.structures.series_data import SeriesData
from realmodel.core.surfaces.rock_input import RockInput

SQUARE = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]
FOLDED = """
format = 1
name = "folded"

[[rock]]
name = "r"
region = [[0, 0], [10, 0], [10, 10], [0, 10]]
base_elevation = 0
{rock}

[[rock.series]]
name = "A"
dips = "dips.csv"
resolution = 2.5
{series}

[[rock.surface]]
name = "A1"
series = "A"
points = "a1.csv"
{first}

[[rock.surface]]
name = "between"
{between}

[[rock.surface]]
name = "ground"
mesh = "ground.off"
"""


def project_file(folder, **extra):
    (folder / "dips.csv").write_text("x,y,z,dip,dip_direction,polarity\n5,5,5,30,90,1\n")
    (folder / "a1.csv").write_text("x,y,z\n5,5,5\n")
    (folder / "ground.off").write_text("OFF\n3 1 0\n0 0 9\n10 0 9\n0 10 9\n3 0 1 2\n")
    given = {"rock": "", "series": "", "first": "", "between": 'series = "A"\npoints = "a1.csv"'} | extra
    path = folder / "project.toml"
    path.write_text(FOLDED.format(**given))
    return path


def test_a_series_is_read_with_its_surfaces(tmp_path):
    rock = load_project(project_file(tmp_path)).rocks[0]
    (series,) = rock.series
    assert (series.name, series.kind, series.resolution) == ("A", "field", 2.5)
    assert series.dip_file == DipFile(tmp_path / "dips.csv")
    assert [surface.series for surface in rock.surfaces] == ["A", "A", None]
    assert [rock.is_level_set(surface) for surface in rock.surfaces] == [True, True, False]
    assert not rock.interpolates  # no planar mesh is needed


@pytest.mark.parametrize(
    ("extra", "line", "what"),
    [
        ({"first": 'method = "kriging"'}, 21, "'method' has no effect"),
        ({"first": "neighbours = 3"}, 21, "'neighbours' has no effect"),
        ({"first": 'dips = "dips.csv"'}, 21, "'dips' has no effect"),
        ({"between": 'series = "A"\npoints = "a1.csv"\nminimum_thickness = 1'}, 27, "'minimum_thickness'"),
        ({"between": 'series = "A"\nmesh = "ground.off"'}, 26, "'mesh' has no effect"),
        ({"between": 'series = "B"\npoints = "a1.csv"'}, 25, "has no series 'B'"),
        ({"series": 'kind = "sheet"'}, 15, "kind"),
        ({"series": 'kind = "sheets"'}, 14, "'resolution' has no effect"),
        ({"series": 'thickness = "even"'}, 15, "thickness"),
        ({"series": "bedding = 3"}, 15, "unknown key 'bedding'"),
        ({"rock": "[[rock.series]]\nname = 'B'"}, 10, "no surface belongs to it"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_line(tmp_path, extra, line, what):
    with pytest.raises(InputRefused, match=what) as refused:
        load_project(project_file(tmp_path, **extra))
    assert refused.value.line == line


def test_surfaces_of_a_series_are_consecutive():
    points = np.array([[5.0, 5.0, 5.0]])
    surfaces = [Surface(name, points=points, series="A") for name in ("a", "b")]
    sheet = Surface("sheet", vertices=[[0, 0, 1], [1, 0, 1], [0, 1, 1]], triangles=[[0, 1, 2]])
    rock = Rock("r", [surfaces[0], sheet, surfaces[1]], SQUARE, base_elevation=0.0, series=[Series("A")])
    with pytest.raises(InputRefused, match="not consecutive: 'sheet' is between them"):
        check_project(Project("p", [rock]))


@pytest.mark.parametrize(("key", "value"), [("region", None), ("base_elevation", None)])
def test_a_field_needs_an_end(key, value):
    given = {"region": SQUARE, "base_elevation": 0.0} | {key: value}
    rock = Rock("r", [Surface("a", series="A")], series=[Series("A")], **given)
    with pytest.raises(InputRefused, match=f"has no {key}"):
        check_project(Project("p", [rock]))


@pytest.mark.parametrize("used", [None, np.array([True, False, True, True])])
def test_a_written_series_is_the_same_when_it_is_read(tmp_path, used):
    generator = np.random.default_rng(7)
    dips = SpaceDips(generator.normal(size=(4, 3)), generator.normal(size=(4, 3)), used)
    surfaces = [Surface(name, points=generator.normal(size=(3, 3)), series="A") for name in ("a", "b")]
    rock = Rock(
        "r",
        surfaces,
        SQUARE,
        base_elevation=0.0,
        series=[Series("A", dips=dips, resolution=0.3, thickness="parallel")],
    )
    save_project(Project("p", [rock]), tmp_path / "p.toml")
    (series,) = load_project(tmp_path / "p.toml").rocks[0].series
    read = read_space_dips(series.dip_file)
    assert (series.name, series.resolution, series.thickness) == ("A", 0.3, "parallel")
    np.testing.assert_array_equal(read.positions, dips.positions)
    np.testing.assert_array_equal(read.normals, dips.normals)
    assert (read.used is None) == (used is None)
    np.testing.assert_array_equal(read.in_use, dips.in_use)


def test_dips_that_are_switched_off_say_nothing():
    places, normals = np.arange(9.0).reshape(3, 3), np.eye(3)
    series = Series("A", dips=SpaceDips(places, normals, np.array([False, True, True])))
    rock = Rock("r", [Surface("a", series="A")], SQUARE, series=[series])
    data = SeriesData.of(RockInput(rock, [None]), series, [0])
    np.testing.assert_array_equal(data.dips, places[1:])
    assert data.item("dip", 0) == "dip 1"  # its row in the table


@pytest.mark.parametrize(
    ("row", "normal"),
    [
        ("30,90,1", (0.5, 0, math.sqrt(0.75))),
        ("30,90,-1", (-0.5, 0, -math.sqrt(0.75))),
        ("30,90,Overturned", (-0.5, 0, -math.sqrt(0.75))),
        ("0,,normal", (0, 0, 1)),
        ("150,270,1", (-0.5, 0, -math.sqrt(0.75))),  # overturned by its angle
        ("150,270,-1", (-0.5, 0, -math.sqrt(0.75))),
        ("90,0,1", (0, 1, 0)),
        ("0,,1", (0, 0, 1)),
        ("0,,-1", (0, 0, -1)),
    ],
)
def test_normals_point_toward_younger_rock(tmp_path, row, normal):
    (tmp_path / "dips.csv").write_text(f"x,y,z,dip,dip_direction,polarity\n1,2,3,{row}\n")
    dips = read_space_dips(DipFile(tmp_path / "dips.csv"))
    np.testing.assert_allclose(dips.normals, [normal], atol=1e-15)
    np.testing.assert_array_equal(dips.positions, [[1, 2, 3]])


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("x,y,dip,dip_direction\n1,2,30,40\n", "column z"),
        ("x,y,z,dip,dip_direction\n1,2,3,190,40\n", "not from 0 to 180"),
        ("x,y,z,dip,dip_direction,polarity\n1,2,3,30,40,0\n", "the polarity is 0"),
        ("x,y,z,dip,dip_direction,polarity\n1,2,3,30,40,east\n", "not a number.*; write 1 or upright"),
        ("x,y,z,normal_x,normal_y,normal_z\n1,2,3,0,0,0\n", "the normal is 0"),
        ("x,y,z,dip,dip_direction\n1,2,3,30,\n", "has no direction"),
    ],
)
def test_dips_that_say_nothing_are_refused(tmp_path, text, what):
    (tmp_path / "dips.csv").write_text(text)
    with pytest.raises(InputRefused, match=what):
        read_space_dips(DipFile(tmp_path / "dips.csv"))
