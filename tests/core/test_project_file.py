# SPDX-License-Identifier: GPL-3.0-or-later
"""The project file: what is read from it, and what is refused with which line."""

import numpy as np
import pytest
from realmodel.core import (
    Boreholes,
    Dips,
    InputRefused,
    Model,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.project.project_writer import save_project

SURFACES = """\
[[rock.surface]]
name = "S0"
mesh = "s0.off"
[[rock.surface]]
name = "S1"
mesh = "s1.off"
"""
HEAD = 'format = 1\nname = "x"\n'


@pytest.fixture
def project(write):
    """project(text) writes a project file beside two meshes, points and a region."""
    write("s0.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    write("s1.off", "OFF\n3 1 0\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n")
    write("p.csv", "0,0,1\n1,0,2\n0,1,3\n")
    write("region.geojson", '{"type": "Polygon", "coordinates": [[[0,0],[1,0],[0,1],[0,0]]]}')
    return lambda text: write("p.toml", text)


def refused(path):
    with pytest.raises(InputRefused) as raised:
        load_project(path)
    message = str(raised.value)
    assert "\n" not in message
    return raised.value, message


def test_everything_that_a_project_may_say(project, write, tmp_path):
    write("library.toml", '[[property]]\nid = 3\nname = "Sandstone"\ncolor = "#b04030"\n')
    path = project(
        """
format = 1
name = "Haut-Barr"
library = "library.toml"
[[rock]]
name = "base"
region = "region.geojson"
edge_length = 2
mesher = "delaunay"
base_elevation = -400.0
[[rock.surface]]
name = "S0"
points = "p.csv"
method = "kriging"
neighbours = 8
variogram = {model = "spherical", range = 60, sill = 4}
anisotropy = {ratio = 2, azimuth = 30}
[[rock.surface]]
name = "S1"
points = "p.csv"
method = "idw"
power = 3
[[rock.surface]]
name = "S2"
mesh = "s1.off"
rule = "erosional"
property = 3
block = "Couches intermédiaires"
[[rock]]
name = "other"
region = [[0, 0], [4, 0],
          [0, 4]]
holes = [[[1, 1], [2, 1], [1, 2]]]
[[rock.surface]]
name = "S0"
mesh = "s0.off"
"""
    )
    read = load_project(path)
    assert (read.name, read.path, read.library.get(3).name) == ("Haut-Barr", path, "Sandstone")
    base, other = read.rocks
    assert (base.name, base.region, base.edge_length) == ("base", tmp_path / "region.geojson", 2.0)
    assert (base.mesher, base.base_elevation) == ("delaunay", -400.0)
    method, options = base.surfaces[0].method_options()
    assert method == "kriging"
    assert options["variogram"] == {"model": "spherical", "range": 60.0, "sill": 4.0, "nugget": 0.0}
    assert options["neighbours"] == 8
    assert options["anisotropy"] == {"ratio": 2.0, "azimuth": 30.0}
    method, options = base.surfaces[1].method_options()
    assert (method, options["neighbours"], options["power"]) == ("idw", 16, 3.0)
    assert base.surfaces[2].mesh == tmp_path / "s1.off"
    assert (base.surfaces[2].property, base.surfaces[2].block_name) == (3, "Couches intermédiaires")
    assert (base.surfaces[1].property, base.surfaces[1].block_name) == (0, "S1 block")
    assert other.region.tolist() == [[0, 0], [4, 0], [0, 4]]
    assert other.holes[0].tolist() == [[1, 1], [2, 1], [1, 2]]
    assert {p.name for p in read.input_files()} == {
        "p.toml", "library.toml", "region.geojson", "p.csv", "s0.off", "s1.off"
    }  # fmt: skip


ROCK = HEAD + '[[rock]]\nname = "r"\n'
POINTS = (
    ROCK + 'region = "region.geojson"\nedge_length = 1\n[[rock.surface]]\nname = "S0"\npoints = "p.csv"\n'
)

CASES = {
    "unknown key": (HEAD + "colour = 3\n[[rock]]", 3, "unknown key 'colour'"),
    "unknown key of a rock": (ROCK + "edge_lenght = 3\n" + SURFACES, 5, "did you mean 'edge_length'"),
    "unknown key of a surface": (ROCK + SURFACES + "reule = 3\n", 11, "did you mean 'rule'"),
    "unknown table": (ROCK + SURFACES + "[extra]\na = 1\n", 11, "unknown key 'extra'"),
    "no format": ('name = "x"\n', None, "'format' is missing"),
    "another format": ("format = 2\n", 1, "format 2"),
    "format as text": ('format = "1"\n', 1, "whole number"),
    "no name": ("format = 1\n", None, "'name' is missing"),
    "empty name": ('format = 1\nname = " "\n', 2, "empty"),
    "name a number": ("format = 1\nname = 3\n", 2, "text in quotes"),
    "name with a line break": ('format = 1\nname = "a\\nb"\n', 2, "line break"),
    "no rock": (HEAD, None, "[[rock]] is missing"),
    "rock is a table": (HEAD + '[rock]\nname = "r"\n', 3, "[[rock]]"),
    "rock is a number": (HEAD + "rock = 3\n", 3, "[[rock]]"),
    "rock without a name": (HEAD + "[[rock]]\n" + SURFACES, 3, "'name' is missing"),
    "no surface": (ROCK, 3, "[[rock.surface]] is missing"),
    "rock twice": (
        ROCK + SURFACES + '[[rock]]\nname = "r"\n' + SURFACES,
        12,
        "another rock mass has this name",
    ),
    "surface twice": (ROCK + SURFACES.replace("S1", "S0"), 9, "another surface has this name"),
    "surface without a name": (ROCK + "[[rock.surface]]\n", 5, "'name' is missing"),
    "neither points nor mesh": (ROCK + '[[rock.surface]]\nname = "S0"\n', 5, "neither points nor a mesh"),
    "both points and mesh": (POINTS + 'mesh = "s0.off"\n', 10, "both points and mesh"),
    "missing mesh": (ROCK + SURFACES.replace("s1.off", "s9.off"), 10, "file not found"),
    "missing points": (POINTS.replace("p.csv", "q.csv"), 9, "file not found"),
    "missing region": (POINTS.replace("region.geo", "noregion.geo"), 5, "file not found"),
    "missing library": (HEAD + 'library = "l.toml"\n', 3, "file not found"),
    "a folder for a file": (ROCK + SURFACES.replace("s1.off", "."), 10, "a folder, not a file"),
    "a folder for a library": (HEAD + 'library = "."\n', 3, "a folder, not a file"),
    "points without region": (POINTS.replace('region = "region.geojson"\n', ""), 8, "no region"),
    "points without edge_length": (POINTS.replace("edge_length = 1\n", ""), 8, "no edge_length"),
    "unknown rule": (ROCK + SURFACES + 'rule = "erosinal"\n', 11, "'rule' cannot be 'erosinal'"),
    "method misspelt": (POINTS + 'method = "sline"\n', 10, "did you mean 'spline'"),
    "unknown method": (POINTS + 'method = "krging"\n', 10, "unknown method"),
    "edge length in words": (ROCK + 'edge_length = "short"\n' + SURFACES, 5, "or 'auto'"),
    "length and number of triangles": (
        ROCK + "edge_length = 2\ntriangles = 90\n" + SURFACES,
        6,
        "cannot both be given",
    ),
    "no number of triangles": (ROCK + "triangles = 0\n" + SURFACES, 5, "whole number from 1"),
    "size without a distance": (
        ROCK + 'size = [{ at = "outline", length = 1 }]\n' + SURFACES,
        5,
        "needs exactly at, length, distance",
    ),
    "unknown mesher": (ROCK + 'mesher = "fast"\n' + SURFACES, 5, "'mesher' cannot be 'fast'"),
    "option of another method": (POINTS + "power = 2\n", 10, "belongs to idw"),
    "method of a ready mesh": (ROCK + SURFACES + 'method = "idw"\n', 11, "not interpolated"),
    "option of a ready mesh": (ROCK + SURFACES + "neighbours = 4\n", 11, "not interpolated"),
    "neighbours below 0": (POINTS + "neighbours = -1\n", 10, "neighbours"),
    "neighbours with decimals": (POINTS + "neighbours = 1.5\n", 10, "neighbours"),
    "variogram is no table": (POINTS + 'variogram = "spherical"\n', 10, "must be a table"),
    "variogram lacks sill": (POINTS + 'variogram = {model = "spherical", range = 2}\n', 10, "lacks 'sill'"),
    "variogram model": (
        POINTS + '[rock.surface.variogram]\nsill = 1\nrange = 1\nmodel = "x"\n',
        13,
        "cannot be 'x'",
    ),
    "variogram unknown key": (
        POINTS + '[rock.surface.variogram]\nsill = 1\nrnge = 1\nrange = 1\nmodel = "gaussian"\n',
        12,
        "'rnge'",
    ),
    "variogram range 0": (
        POINTS + '[rock.surface.variogram]\nmodel = "gaussian"\nsill = 1\nrange = 0\n',
        13,
        "range",
    ),
    "nugget above sill": (
        POINTS + 'variogram = {model = "gaussian", sill = 1, range = 1, nugget = 2}\n',
        10,
        "more than the sill",
    ),
    "nested variogram": (
        POINTS + 'variogram = {nugget = 1, structures = [\n{model = "cubic", range = 1, sill = 0}]}\n',
        10,
        "'sill' must be more than 0",
    ),
    "drift of ordinary kriging": (
        POINTS + 'method = "kriging"\ndrift = "linear"\n',
        11,
        "belongs to universal_kriging",
    ),
    "unknown drift": (POINTS + 'method = "universal_kriging"\ndrift = 2\n', 11, "'drift' cannot be 2"),
    "radius 0": (POINTS + "radius = 0\n", 10, "more than 0"),
    "octants with decimals": (POINTS + "octants = 1.5\n", 10, "whole number"),
    "unknown extrapolation": (POINTS + 'extrapolate = "maybe"\n', 10, "cannot be 'maybe'"),
    "anisotropy ratio 0": (POINTS + "anisotropy = {ratio = 0, azimuth = 0}\n", 10, "more than 0"),
    "edge_length 0": (ROCK + "edge_length = 0\n" + SURFACES, 5, "above 0"),
    "edge_length infinite": (ROCK + "edge_length = inf\n" + SURFACES, 5, "finite"),
    "edge_length true": (ROCK + "edge_length = true\n" + SURFACES, 5, "must be a finite number"),
    "base_elevation nan": (ROCK + "base_elevation = nan\n" + SURFACES, 5, "finite"),
    "property with decimals": (ROCK + SURFACES + "property = 1.5\n", 11, "whole number"),
    "property too large": (ROCK + SURFACES + "property = 3000000000\n", 11, "whole number"),
    "holes without region": (ROCK + "holes = [[[0,0],[1,0],[0,1]]]\n" + SURFACES, 5, "no region"),
    "holes beside a file": (
        ROCK + 'region = "region.geojson"\nholes = [[[0,0],[1,0],[0,1]]]\n' + SURFACES,
        6,
        "region given by coordinates",
    ),
    "region corner": (
        ROCK + "region = [\n[0, 0],\n[1, 0, 3],\n[0, 1]]\n" + SURFACES,
        7,
        "two finite numbers",
    ),
    "region corner nan": (
        ROCK + "region = [\n[0, 0],\n[1, nan],\n[0, 1]]\n" + SURFACES,
        7,
        "two finite numbers",
    ),
    "region is a number": (ROCK + "region = 3\n" + SURFACES, 5, "text in quotes"),
    "crs that is no code": (HEAD + 'crs = "25832"\n' + ROCK[len(HEAD) :] + SURFACES, 3, "must be a code"),
    "crs in degrees": (HEAD + 'crs = "EPSG:4326"\n' + ROCK[len(HEAD) :] + SURFACES, 3, "in degrees"),
    "crs of EPSG without a number": (HEAD + 'crs = "EPSG:x"\n' + ROCK[len(HEAD) :] + SURFACES, 3, "number"),
    "crs is a number": (HEAD + "crs = 25832\n" + ROCK[len(HEAD) :] + SURFACES, 3, "must be a code"),
    "broken TOML": (HEAD + "a = = 3\n", 3, "not valid TOML"),
    "unclosed text": (HEAD + 'a = "abc\n', 3, "not valid TOML"),
    "cut off in an array": (HEAD + "a = [1,\n2,", 4, "not valid TOML"),
    "key twice": (HEAD + 'name = "y"\n', 3, "not valid TOML"),
}


@pytest.mark.parametrize("name", CASES)
def test_refused_with_the_line(project, name):
    text, line, words = CASES[name]
    path = project(text)
    error, message = refused(path)
    assert words in message
    assert error.file == path
    assert error.line == line
    if line is not None:
        assert message.startswith(f"{path}:{line}: ")


def test_property_that_the_library_lacks(project, write):
    write("library.toml", '[[property]]\nid = 3\nname = "Sandstone"\n')
    path = project(HEAD + 'library = "library.toml"\n[[rock]]\nname = "r"\n' + SURFACES + "property = 4\n")
    error, message = refused(path)
    assert error.line == 12
    assert "no property 4" in message
    assert "surface 'S1'" in message


def test_lines_in_a_file_with_windows_line_ends(project):
    path = project((HEAD + 'text = """a\nb"""\n').replace("\n", "\r\n"))
    assert refused(path)[0].line == 3


def test_file_that_is_absent_or_not_text(tmp_path, write):
    assert "cannot be read" in refused(tmp_path / "none.toml")[1]
    assert "cannot be read" in refused(tmp_path)[1]
    error, message = refused(write("latin.toml", 'format = 1\nname = "é"\n'.encode("latin-1")))
    assert error.line == 2
    assert "UTF-8" in message


def test_byte_order_mark_is_no_matter(project):
    assert load_project(project("\ufeff" + ROCK + SURFACES)).name == "x"


TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]])


def from_arrays(**changes):
    given = {"name": "S0", "vertices": TRIANGLE[0], "triangles": TRIANGLE[1], **changes}
    return Project(name="x", rocks=[Rock(name="r", surfaces=[Surface(**given)])])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"name": ""}, "no name"),
        ({"triangles": None}, "together"),
        ({"vertices": None, "triangles": None}, "neither points nor a mesh"),
        ({"points": np.zeros((3, 3))}, "both points and vertices"),
        ({"rule": "onlap"}, "'rule' cannot be 'onlap'"),
        ({"property": "3"}, "whole number"),
        ({"vertices": np.zeros((3, 2))}, "(V, 3)"),
        ({"vertices": [["a", 0, 0]]}, "not an array of numbers"),
        ({"triangles": np.zeros((0, 3), int)}, "T > 0"),
        ({"triangles": np.array([[0.0, 1.0, 2.0]])}, "whole numbers"),
        ({"triangles": np.array([[0, 1, 3]])}, "triangle 0 names vertices [0, 1, 3]"),
        ({"triangles": np.array([[0, 1, 2], [0, 1, -1]])}, "triangle 1 names"),
        ({"vertices": np.array([[0, 0, 0], [1, 0, np.nan], [0, 1, 0]])}, "vertex 1"),
    ],
)
def test_arrays_are_checked_as_files_are(changes, words):
    with pytest.raises(InputRefused) as raised:
        build(from_arrays(**changes))
    assert words in str(raised.value)
    assert "rock 'r'" in str(raised.value)


@pytest.mark.parametrize(
    ("region", "words"),
    [
        (np.zeros((4, 2)), "three different corners"),
        ([[0, 0], [1, 0]], "three different corners"),
        ([[0, 0], [1, 0], [0, np.inf]], "corner 2"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "(N, 2)"),
        ([[0, "a"]], "corners [x, y]"),
    ],
)
def test_regions_are_checked(region, words):
    project = from_arrays()
    project.rocks[0].region = region
    with pytest.raises(InputRefused, match="rock 'r'") as raised:
        build(project)
    assert words in str(raised.value)


def test_the_coordinate_system_comes_back(project, tmp_path):
    path = project(HEAD + 'crs = "EPSG:25832"\n[[rock]]\nname = "r"\n' + SURFACES)
    model = build(load_project(path))
    assert model.project.crs == "EPSG:25832"
    save_project(model.project, tmp_path / "again.toml")
    assert load_project(tmp_path / "again.toml").crs == "EPSG:25832"
    model.save(tmp_path / "m.npz")
    assert Model.load(tmp_path / "m.npz").project.crs == "EPSG:25832"
    with pytest.raises(InputRefused, match="crs: 'crs' must be a code"):
        build(Project(name="x", rocks=from_arrays().rocks, crs="here"))


def test_projects_of_arrays_are_compared():
    def made(x=0.0):
        points = np.array([[x, 0.0, 1.0], [1.0, 1.0, 2.0]])
        dips = Dips([[0.0, 0.0]], [[0.1, 0.0]])
        return Project("p", [Rock("r", [Surface("A", points=points, dips=dips)], region=np.eye(3)[:, :2])])

    assert made() == made() != made(0.5)
    assert made().rocks.index(made().rocks[0]) == 0
    assert made().rocks[0] in [made(0.5).rocks[0], made().rocks[0]]
    assert made() != "p"


def test_what_is_not_read_is_not_left_out_when_it_is_saved(tmp_path):
    square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    surface = Surface("A", method="constant", options={"value": 1.0})
    (tmp_path / "picks.csv").write_text("hole,x,y,z,surface,depth\nB1,0,0,5,A,1\n")
    (tmp_path / "river.geojson").write_text('{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}')
    for key, given in (
        ("boreholes", Boreholes(picks=tmp_path / "picks.csv")),
        ("constraints", [tmp_path / "river.geojson"]),
        ("constraints", ["LINESTRING (0 0, 1 1)"]),
    ):
        rock = Rock("r", [surface], region=square, edge_length=1.0, **{key: given})
        with pytest.raises(UsageError, match=rf"{key} was not read yet"):
            save_project(Project("p", [rock]), tmp_path / "p.toml")
        assert not (tmp_path / "p.toml").exists()
