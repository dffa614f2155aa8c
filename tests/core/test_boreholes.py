# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of boreholes: points for all surfaces of a rock mass at once."""

import numpy as np
import pytest
from realmodel.core import (
    Boreholes,
    InputRefused,
    Project,
    Rock,
    Surface,
    build,
    load_project,
    read_boreholes,
)
from realmodel.core.readers import read_picks
from test_point_formats import workbook

COLLARS = "hole,x,y,z\nB1,0,0,10\nB2,4,0,11\nB3,4,4,12\nB4,0,4,11\nB5,2,2,11\n"
PICKS = "hole,surface,depth\nB1,clay,4\nB2,clay,5\nB3,clay,6\nB1,sand,1\nB3,sand,\nB4,sand,2\n"
CLAY, SAND = [[0, 0, 6], [4, 0, 6], [4, 4, 6]], [[0, 0, 9], [0, 4, 9]]


@pytest.mark.parametrize(
    ("collars", "picks", "keys"),
    [
        (COLLARS, PICKS, {}),
        (COLLARS.replace(",", ";"), PICKS.replace(",", "\t"), {}),
        (
            COLLARS.replace("hole,x,y,z", "BHID,EAST (m),NORTH (m),RL"),
            PICKS.replace("hole,surface,depth", "Well,Horizon,MD"),
            {},
        ),
        (
            "id;who;xc;yc;top of casing\n"
            + "".join(f"9;{r}\n" for r in COLLARS.replace(",", ";").split()[1:]),
            PICKS.replace("hole,surface,depth", "who,bed,below"),
            {"columns": {"hole": "who", "x": "xc", "y": "yc", "z": 5, "surface": "bed", "depth": "below"}},
        ),
        (
            COLLARS,
            "hole,surface,elevation\nB1,clay,6\nB2,clay,6\nB3,clay,6\nB1,sand,9\nB3,sand,\nB4,sand,9\n",
            {},
        ),
        (
            None,
            "hole,x,y,z,surface,depth\nB1,0,0,10,clay,4\nB2,4,0,11,clay,5\nB3,4,4,12,clay,6\n"
            "B1,0,0,10,sand,1\nB3,4,4,12,sand,\nB4,0,4,11,sand,2\n",
            {},
        ),
        (
            None,
            "hole,x,y,z,surface\nB1,0,0,6,clay\nB2,4,0,6,clay\nB3,4,4,6,clay\nB1,0,0,9,sand\nB4,0,4,9,sand\n",
            {},
        ),
        (
            COLLARS.replace(",", ";").replace(";10", ";10,0"),
            PICKS.replace(",", ";").replace(";4", ";4,0"),
            {},
        ),
        (COLLARS, "# drilled\n\n" + PICKS.replace("\n", "\r\n"), {}),
    ],
)
def test_tables(write, collars, picks, keys):
    files = {"picks": write("p.csv", picks), "collars": collars and write("c.csv", collars)}
    met = read_picks(Boreholes(**files, **keys))
    assert list(met.points) == ["clay", "sand"]
    assert met.points["clay"].tolist() == CLAY
    assert met.points["sand"].tolist() == SAND
    assert any("left out: 1 pick without a depth" in text for text in met.warnings) == (
        ",sand,\n" in picks or "sand,\r" in picks or ";sand;\n" in picks or "sand\t\n" in picks
    )
    if collars and "B5" in collars:
        assert any("no picks for B5" in text for text in met.warnings)


@pytest.mark.parametrize("entry", ["-", "NA", "n/a", "NR", "NaN", "null"])
def test_words_for_a_surface_that_was_not_reached(write, entry):
    files = {
        "picks": write("p.csv", PICKS.replace("B3,sand,", f"B3,sand,{entry}")),
        "collars": write("c.csv", COLLARS),
    }
    met = read_picks(Boreholes(**files))
    assert met.points["sand"].tolist() == SAND
    assert any("left out: 1 pick without a depth" in text for text in met.warnings)


def test_each_point_keeps_its_hole_and_depth(write):
    """Also of holes at one place, of inclined ones, and of those at whose place the surface has a point."""
    collars = write("c.csv", "hole,x,y,z,azimuth,dip\nB1,1,1,10,0,90\nB2,1,1,12,0,90\nB3,1,0,10,0,45\n")
    picks = write("p.csv", "hole,surface,depth\nB2,clay,6\nB1,clay,4\nB3,clay,2\n")
    points = np.array([[3.0, 3, 7], [1, 1, 6], [3, 1, 7]])
    clay, square = Surface("clay", points=points), [[0, 0], [4, 0], [4, 4], [0, 4]]
    rock = Rock(
        "r", [clay], square, edge_length=1, base_elevation=0, boreholes=Boreholes(picks, collars=collars)
    )
    first = build(Project("p", [rock]))
    for model in (first, build(first.project)):
        (data,) = model.rock_inputs[0].data
        found = {source.hole: source for (source,) in data.sources.values()}
        assert sorted(found) == ["B1", "B2", "B3"]
        assert (found["B1"].depth, found["B2"].depth) == (4, 6)
        assert len(data.points) == 6
    rows = {source.hole: source for (source,) in first.rock_inputs[0].data[0].sources.values()}
    assert rows["B3"] == ("B3", 2.0, picks, 4) and rows["B2"].line == 2


def test_inclined_holes_are_a_warning(write):
    lines = COLLARS.split()
    angles = ["Dip", "-90", "-60", "90", "", "-75"]
    collars = "\n".join(f"{line},{angle}" for line, angle in zip(lines, angles, strict=True))
    met = read_picks(Boreholes(picks=write("p.csv", PICKS), collars=write("c.csv", collars)))
    assert met.points["clay"].tolist() == CLAY
    assert [text for text in met.warnings if "B2 and B5 are not vertical" in text]
    # Elevations need no direction.
    rows = "hole,x,y,elevation,surface,dip\nB1,0,0,6,clay,-60\nB2,4,0,6,clay,-60\n"
    assert not read_picks(Boreholes(picks=write("q.csv", rows))).warnings


def test_units(write):
    files = {"picks": write("p.csv", PICKS), "collars": write("c.csv", COLLARS)}
    met = read_picks(Boreholes(**files, units={"z": "ft"}))
    np.testing.assert_allclose(met.points["clay"], np.array(CLAY) * [1, 1, 0.3048])


@pytest.mark.parametrize(
    ("units", "said"),
    [
        (
            {},
            {
                "c.csv": "ft for 'Z (FT)', converted to m",
                "p.csv": "ft for 'depth [feet]', converted to m",
            },
        ),
        ({"units": {"z": "ft"}}, {}),
        ({"units": {"z": "us-ft"}}, {}),
        ({"units": "ft"}, {"c.csv": "m for 'X (m)', but the unit is ft"}),
    ],
)
def test_units_in_headers_are_obeyed_unless_the_user_says_others(write, units, said):
    collars = COLLARS.replace("x,y,z", "X (m),y (plan),Z (FT)")
    files = {
        "picks": write("p.csv", PICKS.replace("depth", "depth [feet]")),
        "collars": write("c.csv", collars),
    }
    met = read_picks(Boreholes(**files, **units))
    in_feet = 1 if units.get("units") == "ft" else [1, 1, 0.3048]
    np.testing.assert_allclose(
        met.points["clay"], np.array(CLAY) * in_feet * (0.3048 if in_feet == 1 else 1), rtol=1e-5
    )
    warnings = [text for text in met.warnings if "the header says" in text]
    assert len(warnings) == len(said)
    for text, (file, words) in zip(warnings, said.items(), strict=True):
        assert file in text and f"the header says {words}" in text


@pytest.mark.parametrize(
    ("collars", "picks", "file", "line", "words"),
    [
        (COLLARS, PICKS.replace("B", "C"), "p.csv", 2, "no hole of it has a collar in"),
        ("hole,x,y,z\nB1,0,,1\n", PICKS, "c.csv", None, "line 2 of"),
        (
            COLLARS.replace("z", "q"),
            PICKS,
            "c.csv",
            1,
            'no column z; name it: columns = { z = "..." }',
        ),
        (COLLARS, PICKS.replace("surface", "what"), "p.csv", 1, "no column surface"),
        (COLLARS, PICKS.replace("depth", "deep"), "p.csv", 2, "neither a column for depth nor"),
        (None, PICKS, "p.csv", 2, "no column x"),
        (COLLARS, "hole,surface,depth\n", "p.csv", None, "no picks"),
        (COLLARS, "hole,surface,depth\nB1,clay,inf\n", "p.csv", 2, "not a finite"),
    ],
)
def test_tables_refused(write, collars, picks, file, line, words):
    files = {"picks": write("p.csv", picks), "collars": collars and write("c.csv", collars)}
    with pytest.raises(InputRefused) as raised:
        read_picks(Boreholes(**files))
    assert words in str(raised.value)
    assert (raised.value.file.name, raised.value.line) == (file, line)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("B9,clay,3\n", "line 8, hole 'B9' at 3, 'clay': it has no collar in"),
        ("B5,clay,3\n", "line 8, hole 'B5' at 3, 'clay': line 6 of"),
    ],
)
def test_a_pick_of_a_hole_without_a_collar_is_listed(write, more, words):
    collars = write("c.csv", COLLARS.replace("B5,2,2,11", "B5,2,,11"))
    met = read_picks(Boreholes(write("p.csv", PICKS), collars))
    assert met.points["sand"].tolist() == SAND
    assert met.warnings[0] == (
        f"{collars}: holes are without x, y or z, and are not used (1): line 6, hole 'B5': it has no y"
    )
    met = read_picks(Boreholes(write("p.csv", PICKS + more), collars))
    assert met.points["sand"].tolist() == SAND
    (entry,) = met.left_out
    assert entry.kind == "no_collar" and entry.text.startswith(words)
    off = write("p.csv", PICKS.replace("depth\n", "depth,use\n") + more.replace("\n", ",0\n"))
    assert not read_picks(Boreholes(off, collars)).left_out


def test_holes_are_found_however_they_are_written(write):
    collars = COLLARS.replace("B1,", "DH-1,").replace("B2,", "DH 2,").replace("B5,", "dh_2,")
    picks = PICKS.replace("B1,", "dh 1,").replace("B2,", "DH 2,").replace("B3,", "b3,")
    survey = write("s.csv", "hole,depth,azimuth,inclination\nDh 1,0,90,90\n")
    met = read_picks(Boreholes(write("p.csv", picks), write("c.csv", collars), survey=survey))
    # 'DH-1' is horizontal
    np.testing.assert_allclose(met.points["clay"], [[4, 0, 10], CLAY[1], CLAY[2]], atol=1e-12)
    assert set(met.holes) == {"DH-1", "DH 2", "B3", "B4"}
    assert any(
        "are matched with those with collars: 'dh 1' for 'DH-1' and 'b3' for 'B3'" in t for t in met.warnings
    )
    # 'DH_2' may be 'DH 2' or 'dh_2', at another place
    met = read_picks(Boreholes(write("p.csv", picks.replace("DH 2,", "DH_2,")), write("c.csv", collars)))
    assert [(entry.kind, entry.hole) for entry in met.left_out] == [("no_collar", "DH_2")]


PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [4, 0], [4, 4], [0, 4]]
edge_length = 1
base_elevation = 0
boreholes = {boreholes}
[[rock.surface]]
name = "clay"
method = "plane"
[[rock.surface]]
name = "sand"
points = "sand.csv"
method = "plane"
"""
GIVEN = '{ collars = "c.csv", picks = "p.csv" }'


def test_a_project_of_boreholes(write, tmp_path):
    """A surface without points of its own has those of the holes; one with points has both."""
    write("c.csv", COLLARS)
    write("p.csv", PICKS + "B5,gravel,1\n")
    write("sand.csv", "4 0 9\n4 4 9\n")
    project = load_project(write("p.toml", PROJECT.format(boreholes=GIVEN)))
    assert {tmp_path / "c.csv", tmp_path / "p.csv"} <= set(project.input_files())
    model = build(project)
    assert model.volume == pytest.approx(16 * 9)
    assert [len(surface.points) for surface in model.project.rocks[0].surfaces] == [3, 4]
    assert any("picks of gravel, which no surface" in str(warning) for warning in model.warnings)
    assert build(model.project).volume == model.volume


@pytest.mark.parametrize(
    ("boreholes", "line", "words"),
    [
        ("3", 8, "must be a file or a table"),
        ('{ collars = "c.csv" }', 8, "neither picks nor intervals"),
        ('{ collars = "no.csv", picks = "p.csv" }', 8, "file not found"),
        ('{ pick = "p.csv" }', 8, "did you mean 'picks'?"),
        ('{ picks = "p.csv", columns = { deep = "x" } }', 8, "unknown column 'deep'"),
        ('{ picks = "p.csv", columns = { depth = true } }', 8, "a name or a number"),
        ('{ picks = "p.csv", units = "feet" }', 8, "unknown unit"),
    ],
)
def test_keys_that_make_no_sense(write, boreholes, line, words):
    for name, text in (("c.csv", COLLARS), ("p.csv", PICKS), ("sand.csv", "4 0 9\n")):
        write(name, text)
    path = write("p.toml", PROJECT.format(boreholes=boreholes))
    with pytest.raises(InputRefused) as raised:
        load_project(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_a_surface_that_no_hole_met(write):
    files = Boreholes(write("p.csv", PICKS), write("c.csv", COLLARS))
    square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    rock = Rock("r", [Surface("silt")], square, edge_length=1.0, base_elevation=0.0, boreholes=files)
    with pytest.raises(InputRefused, match="surface 'silt': no points, boreholes or observations constrain"):
        build(Project("x", [rock]))
    rock.boreholes = None
    with pytest.raises(InputRefused, match="neither points nor a mesh"):
        build(Project("x", [rock]))


def test_a_point_in_another_column_is_no_decimal_comma(tmp_path):
    """Entries are told apart by the separator, as the numbers are read."""
    file = tmp_path / "picks.csv"
    file.write_text("hole;x;y;z;surface;depth\nB1;100,5;200,5;7,25;Top 1.5;1,5\n")
    found = read_picks(Boreholes(picks=file))
    assert found.points["Top 1.5"].tolist() == [[100.5, 200.5, 5.75]]
    file.write_text("hole;x;y;z;surface;depth\nB1;100.5;200.5;7;Top;1,5\n")
    with pytest.raises(InputRefused, match="depth is not a number: '1,5'"):  # as all that there are
        read_picks(Boreholes(picks=file))


@pytest.mark.parametrize("meaning", ["z", "surface"])
def test_a_column_that_is_not_to_be_read(tmp_path, meaning):
    """It is as if the table had none, whatever it holds."""
    columns = {"hole": "B1", "x": "0", "y": "0", "z": "7", "surface": "Top", "depth": "2"}
    whole, without = tmp_path / "whole.csv", tmp_path / "without.csv"
    for file, left in ((whole, ()), (without, (meaning,))):
        shown = {name: text for name, text in columns.items() if name not in left}
        file.write_text(f"{','.join(shown)}\n{','.join(shown.values())}\n")
    assert read_picks(Boreholes(picks=whole)).points["Top"].tolist() == [[0, 0, 5]]
    said = []
    for file, named in ((whole, {meaning: False}), (without, {})):
        with pytest.raises(InputRefused) as refused:
            read_picks(Boreholes(picks=file, columns=named))
        said.append(refused.value.what)
    assert said[0] == said[1]


def test_a_workbook_holds_all_tables(tmp_path):
    sheets = {
        "Notes": [["made by", "somebody"], ["on", "monday"]],
        "Collars": [["Hole ID", "Easting", "Northing", "RL"], ["A", 0, 0, 10], ["B", 90, 0, 12]],
        "Survey": [["Hole ID", "Depth", "Azimuth", "Dip"], ["A", 0, 90, -60], ["B", 0, 0, -90]],
        "Lithology": [["Hole ID", "From", "To", "Lithology"], ["A", 0, 4, "sand"], ["B", 0, 5, "sand"]],
        "Tops": [["Hole ID", "Surface", "MD"], ["A", "top", 0]],
    }
    file = workbook(tmp_path / "site.xlsx", **sheets)
    read = read_boreholes(file)
    assert [len(table) for table in (read.collars, read.survey, read.intervals, read.picks)] == [2, 2, 2, 1]
    np.testing.assert_array_equal(read.intervals["to"], [4, 5])
    other = tmp_path / "other.csv"
    other.write_text("hole,from,to,block\nA,0,7,clay\n")
    assert read_boreholes(file, intervals=other).intervals["block"].tolist() == ["clay"]
    twice = workbook(tmp_path / "twice.xlsx", **sheets, More=sheets["Lithology"])
    with pytest.raises(InputRefused, match="'Lithology' and 'More' both have intervals"):
        read_boreholes(twice)
    with pytest.raises(InputRefused, match="no sheet has the columns"):
        read_boreholes(workbook(tmp_path / "none.xlsx", Notes=sheets["Notes"]))
    chosen = ";".join(name for name in sheets if name != "Notes")
    assert len(read_boreholes(twice, layer=chosen).intervals) == len(read_boreholes(file).intervals)
    with pytest.raises(InputRefused, match="no sheet 'Nothing'"):
        read_boreholes(twice, layer="Nothing")


@pytest.mark.parametrize(("of_collars", "of_log"), [("1", "1.0"), ("007", "7"), ("12", "0012"), ("7.0", "7")])
def test_holes_whose_names_are_numbers(tmp_path, of_collars, of_log):
    (collars := tmp_path / "c.csv").write_text(f"hole,x,y,z\n{of_collars},0,0,10\nB7,5,5,10\n")
    (intervals := tmp_path / "i.csv").write_text(f"hole,from,to,block\n{of_log},0,4,sand\nB7,0,4,sand\n")
    read = read_boreholes(collars=collars, intervals=intervals)
    assert read.intervals["hole"].tolist() == [of_collars, "B7"]
    assert [problem.kind for problem in read.problems] == ["hole_name"]


def test_columns_with_one_name_are_said(tmp_path):
    (collars := tmp_path / "c.csv").write_text("hole,x,y,z,Z\nA,0,0,10,99\n")
    (intervals := tmp_path / "i.csv").write_text("hole,from,to,block\nA,0,4,sand\n,,,\n")
    read = read_boreholes(collars=collars, intervals=intervals)
    (said,) = read.warnings
    assert "2 columns are named 'z'" in said and "columns = { z = 5 }" in said
    other = read_boreholes(collars=collars, intervals=intervals, columns={"z": 5})
    assert (other.collars["z"][0], other.warnings, other.problems) == (99, [], [])


def test_decimal_commas_in_quotes_between_commas(tmp_path):
    (collars := tmp_path / "c.csv").write_text('hole,x,y,z\nA,0,0,"10,5"\n')
    (intervals := tmp_path / "i.csv").write_text('hole,from,to,block\nA,0,"4,25",sand\n')
    read = read_boreholes(collars=collars, intervals=intervals)
    assert (read.collars["z"][0], read.intervals["to"][0]) == (10.5, 4.25)
