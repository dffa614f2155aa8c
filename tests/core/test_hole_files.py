# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold all tables of boreholes: AGS and others, by small reconstructions."""

import csv
import re

import numpy as np
import pytest
from realmodel.core import Boreholes, InputRefused, UsageError, build, load_project, read_boreholes
from realmodel.core.readers import read_picks, table_contents, table_kind
from realmodel.core.readers.hole_values import read_interval_values
from realmodel.core.readers.tables.table_layout import is_number
from test_reported_boreholes import LOG, PLACES, assert_layers

PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [100, 0], [100, 100], [0, 100]]
edge_length = 10
base_elevation = -60
boreholes = {boreholes}
"""
for _name in "CBA":
    PROJECT += f'[[rock.surface]]\nname = "{_name}"\nblock = "{_name}"\nmethod = "tin"\n'


def quoted(*rows):
    return "".join(",".join(f'"{entry}"' for entry in row) + "\r\n" for row in rows)


def ags4(unit="m", by=1.0):
    locations = [("DATA", hole, x * by, y * by, 0, 40 * by) for hole, (x, y) in PLACES.items()]
    layers = [
        ("DATA", hole, begin * by, end * by, 'Soft ""organic"" CLAY, sandy', code)
        for hole in PLACES
        for begin, end, code in LOG
    ]
    return quoted(
        ("GROUP", "PROJ"),
        ("HEADING", "PROJ_ID"),
        ("UNIT", ""),
        ("TYPE", "ID"),
        ("DATA", "Löß"),
        ("GROUP", "LOCA"),
        ("HEADING", "LOCA_ID", "LOCA_NATE", "LOCA_NATN", "LOCA_GL", "LOCA_FDEP"),
        ("UNIT", "", unit, unit, unit, unit),
        ("TYPE", "ID", "2DP", "2DP", "2DP", "2DP"),
        *locations,
        ("GROUP", "GEOL"),
        ("HEADING", "LOCA_ID", "GEOL_TOP", "GEOL_BASE", "GEOL_DESC", "GEOL_LEG"),
        ("UNIT", "", unit, unit, "", ""),
        ("TYPE", "ID", "2DP", "2DP", "X", "PA"),
        *layers,
    )


def ags3():
    locations = [(hole, x, y, 0, 40) for hole, (x, y) in PLACES.items()]
    layers = [(hole, begin, end, "Soft CL", code) for hole in PLACES for begin, end, code in LOG]
    with_more = [row for layer in layers for row in (layer, ("<CONT>", "", "", "AY", ""))]
    return quoted(
        ("**PROJ",),
        ("*PROJ_ID", "*?PROJ_NAME"),
        ("<UNITS>", ""),
        ("1", "x"),
        ("**HOLE",),
        ("*HOLE_ID", "*HOLE_NATE", "*HOLE_NATN"),
        ("*HOLE_GL", "*HOLE_FDEP"),
        ("<UNITS>", "m", "m", "m", "m"),
        *locations,
        ("**GEOL",),
        ("*HOLE_ID", "*GEOL_TOP", "*GEOL_BASE", "*?GEOL_DESC", "*GEOL_GEOL"),
        ("<UNITS>", "m", "m", "", ""),
        *with_more,
    )


@pytest.mark.parametrize(
    "content", [b"\xef\xbb\xbf" + ags4().encode(), ags4().encode("cp1252"), ags3().encode()]
)
def test_ags(write, content):
    """A20."""
    path = write("site.ags", content)
    for boreholes in ('"site.ags"', '{ file = "site.ags" }', '{ intervals = "site.ags" }'):
        assert_layers(build(load_project(write("p.toml", PROJECT.format(boreholes=boreholes)))))
    found = read_boreholes(path)
    assert list(found.collars) == ["hole", "x", "y", "z", "end"] and len(found.collars) == 5
    assert list(found.intervals) == ["hole", "from", "to", "block"] and len(found.intervals) == 15
    assert len(found.picks) == len(found.survey) == len(found.problems) == len(found.warnings) == 0


def rewritten(text, separator, decimal, quotes):
    """AGS as a spreadsheet saves it that was opened as a table."""
    lines = []
    for row in csv.reader(text.splitlines()):
        entries = [entry.replace(".", decimal) if is_number(entry) else entry for entry in row]
        mark = '"' if quotes else ""
        lines.append(separator.join(f"{mark}{entry.replace(chr(34), '')}{mark}" for entry in entries))
    longest = max(map(len, csv.reader(text.splitlines())))
    return "\r\n".join(line + separator * (longest - 1 - line.count(separator)) for line in lines)


@pytest.mark.parametrize("quotes", [False, True])
@pytest.mark.parametrize("signs", [";,", "|.", ";.", "\t,", "\t.", ",."])
@pytest.mark.parametrize("content", [ags4(by=1.2345), ags3()])
def test_ags_of_a_spreadsheet(write, content, signs, quotes):
    plain = content.replace("CLAY, sandy", "CLAY sandy")
    wanted = read_boreholes(write("site.ags", plain))
    found = read_boreholes(write("site.ags", rewritten(plain, *signs, quotes)))
    for table in ("collars", "intervals"):
        for name, column in getattr(wanted, table).items():
            np.testing.assert_array_equal(getattr(found, table)[name], column)
    assert found.problems == []


def test_spaces_count_where_a_text_of_ags_goes_on(write):
    """Texts are cut at a width, also behind a space: 'completely ' and 'decomposed' are two words."""
    cut = ags3().replace('"Soft CL"', '" Soft "').replace('"AY"', '"CLAY "')
    found = read_boreholes(write("site.ags", cut), columns={"block": "GEOL_DESC"})
    assert set(found.intervals["block"]) == {"Soft CLAY"}


def test_units_of_ags_are_obeyed(write):
    found = read_boreholes(write("site.ags", ags4("ft", 1 / 0.3048)))
    np.testing.assert_allclose(found.collars["end"], 40)
    np.testing.assert_allclose(found.intervals["to"], [10, 25, 40] * 5)
    assert "the header says ft for 'LOCA_NATE', 'LOCA_NATN', 'LOCA_GL' and 'LOCA_FDEP'" in found.warnings[0]


def test_inclined_holes_of_ags(write):
    survey = quoted(
        ("GROUP", "HORN"),
        ("HEADING", "LOCA_ID", "HORN_TOP", "HORN_BASE", "HORN_ORNT", "HORN_INCL"),
        ("UNIT", "", "m", "m", "deg", "deg"),
        ("TYPE", "ID", "2DP", "2DP", "0DP", "0DP"),
        ("DATA", "H0", "0", "40", "90", "60"),
    )
    found = read_boreholes(write("site.ags", ags4() + survey))
    assert found.survey["dip"].tolist() == [60.0]
    write("p.toml", PROJECT.format(boreholes='"site.ags"'))
    model = build(load_project(write("p.toml", PROJECT.format(boreholes='"site.ags"'))))
    places = model.rock_inputs[0].rock.observations
    low = places.places[places.holes == "H0"][-1]
    np.testing.assert_allclose(low, [10 + 20, 10, -40 * 3**0.5 / 2], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (quoted(("GROUP", "PROJ"), ("HEADING", "PROJ_ID"), ("DATA", "1")), "it has no rows of LOCA or HOLE"),
        (
            ags4().replace("GEOL_TOP", "GEOL_TOPP").replace("GEOL_BASE", "BASED"),
            "the header has no column from",
        ),
        (ags3().replace('"H0","10","10"', '"<CONT>","10","10"'), "<CONT> continues no row"),
    ],
)
def test_damaged_ags(write, text, words):
    with pytest.raises(InputRefused, match=words):
        read_boreholes(write("site.ags", text))


def test_what_files_that_hold_all_tables_are(write):
    """As the panel asks it."""
    path = write("site.ags", ags4())
    columns, codes = table_contents(path)
    assert table_kind(path) == "intervals" and codes == ["A", "B", "C"] and columns["block"] == "GEOL_LEG"
    assert table_kind(write("a.txt", well_tops())) == "picks"
    curves = LAS.format(
        version="2.0", wrap="NO", well="W1 :", rows="\n".join(ROWS), unit="M", start=10, stop=14, step=2
    )
    assert table_kind(write("a.las", curves)) == "assays"


def test_holes_without_layers(write):
    """They can be looked at, but no model follows from them."""
    assert len(read_boreholes(write("site.ags", ags4().split('"GROUP","GEOL"')[0])).collars) == 5
    project = load_project(write("p.toml", PROJECT.format(boreholes='"site.ags"')))
    with pytest.raises(InputRefused, match="it has neither picks nor intervals of blocks"):
        build(project)


def test_two_columns_that_name_units_are_a_warning(write):
    text = (
        ags3()
        .replace('"*GEOL_GEOL"', '"*GEOL_GEOL","*GEOL_LEG"')
        .replace('"Soft CL","A"', '"Soft CL","A","101"')
    )
    (warning,) = read_boreholes(write("site.ags", text)).warnings
    assert 'columns = { block = "GEOL_LEG" }' in warning
    found = read_boreholes(write("site.ags", text), columns={"block": "GEOL_LEG"})
    assert set(found.intervals["block"].tolist()) == {"101", ""} and not found.warnings


def test_places_in_degrees_are_refused(write):
    table = write("c.csv", "HoleId,Longitude,Latitude,Elevation\nA,119.6,-32.4,379\n")
    with pytest.raises(InputRefused, match="places are longitude and latitude; give x and y in a projected"):
        read_boreholes(collars=table, picks=write("p.csv", "hole,surface,depth\nA,clay,3\n"))


def test_a_file_that_holds_no_boreholes(write):
    with pytest.raises(InputRefused, match="it does not contain all tables of boreholes"):
        read_boreholes(write("a.csv", "hole,from,to,block\nA,0,1,x\n"))


TOPS = """# Petrel well tops
# Unit in X and Y direction: m
# Unit in depth: {unit}
VERSION 2
BEGIN HEADER
X
Y
Z
TWT picked
MD
FLOAT,Dip angle
Type
Surface
Well
END HEADER
"""


def well_tops(unit="m", by=1.0, with_places=True):
    rows = []
    for hole, (x, y) in PLACES.items():
        for name, depth in (("Top C", 25), ("B", 10)):
            place = f"{x} {y} {-depth * by}" if with_places else "-999 -999 -999"
            rows.append(f'{place} -999 {depth * by} -999 Horizon "{name}" "Well {hole}"')
    rows.append('10 10 -999.000000 -999 -999 -999 Horizon "B" "Well H9"')
    return TOPS.format(unit=unit) + "\n".join(rows) + "\n"


@pytest.mark.parametrize(("unit", "by"), [("m", 1.0), ("ft", 1 / 0.3048)])
def test_well_tops_of_petrel(write, unit, by):
    path = write("tops.txt", well_tops(unit, by))
    found = read_boreholes(path)
    assert set(found.picks["surface"].tolist()) == {"Top C", "B"} and len(found.picks) == 10
    assert set(found.picks["hole"].tolist()) == {f"Well {hole}" for hole in PLACES}
    np.testing.assert_allclose(found.picks["elevation"], [-25, -10] * 5)
    (problem,) = found.problems
    assert (problem.kind, problem.line, problem.action) == ("no_depth", 26, "left out")
    write("p.toml", PROJECT.format(boreholes='"tops.txt"\nnames = { "Top C" = "C" }'))
    model = build(
        load_project(
            write(
                "q.toml",
                PROJECT.format(boreholes='"tops.txt"\nnames = { "Top C" = "C" }').partition(
                    '[[rock.surface]]\nname = "A"'
                )[0],
            )
        )
    )
    volumes = {block.name: block.volume for block in model.blocks}
    assert volumes == pytest.approx({"C": 350_000.0, "B": 150_000.0})


def test_well_tops_by_depth_take_collars_beside_them(write):
    path = write("tops.txt", well_tops(with_places=False))
    table = "hole,x,y,z\n" + "".join(f"Well {hole},{x},{y},5\n" for hole, (x, y) in PLACES.items())
    found = read_boreholes(path, collars=write("c.csv", table))
    assert found.picks["depth"].tolist() == [25, 10] * 5
    assert [problem.kind for problem in found.problems] == ["no_collar"]


WELL = """GOCAD Well 1
HEADER {{
name:{name}
}}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
AXIS_NAME "X" "Y" "Z"
AXIS_UNIT "m" "m" "{unit}"
ZPOSITIVE {sense}
END_ORIGINAL_COORDINATE_SYSTEM
WREF 100 200 {top}
{path}MRKR sand 1 50
NO_FEATURE
MRKR clay 1 150
NORM 0 0 1
END
"""


@pytest.mark.parametrize(
    ("sense", "top", "path", "wanted"),
    [
        ("Elevation", "10", "", [[100, 200, -40], [100, 200, -140]]),
        ("Depth", "-10", "", [[100, 200, -40], [100, 200, -140]]),
        ("Elevation", "0", "PATH 0 10 0 0\nPATH 100 -70 60 0\n", [[130, 200, -30], [190, 200, -110]]),
        ("Depth", "0", "PATH 0 -10 0 0\nPATH 200 150 120 0\n", [[130, 200, -30], [190, 200, -110]]),
        ("Elevation", "10", "VRTX 160 200 -70\n", [[130, 200, -30], [190, 200, -110]]),
    ],
)
def test_wells_of_gocad(write, sense, top, path, wanted):
    text = WELL.format(
        name="W 1", unit="m", sense=sense, top=top, path=path.replace("VRTX", "VRTX 100 200 10\nVRTX")
    )
    found = read_boreholes(write("wells.wl", text + text.replace("W 1", "W2")))
    assert found.picks["hole"].tolist() == ["W 1", "W 1", "W2", "W2"]
    assert found.picks["surface"].tolist() == ["sand", "clay"] * 2
    assert found.collars["x"].tolist() == [100, 100]
    np.testing.assert_allclose(found.picks["elevation"], [z for *_, z in wanted] * 2)


def test_units_of_wells_of_gocad_are_obeyed(write):
    text = WELL.format(name="W", unit="ft", sense="Depth", top="-10", path="").replace('"m" "m"', '"ft" "ft"')
    path = write("w.wl", text)
    assert read_boreholes(path).picks["elevation"].tolist() == pytest.approx([-40 * 0.3048, -140 * 0.3048])
    assert read_picks(Boreholes(picks=path)).points["clay"].tolist()[0] == pytest.approx(
        [30.48, 60.96, -140 * 0.3048]
    )
    assert read_boreholes(path, file_units="m").picks["elevation"].tolist() == pytest.approx([-40, -140])


LAS = """~VERSION INFORMATION
 VERS.   {version} : CWLS LOG ASCII STANDARD
 WRAP.   {wrap} : ONE LINE PER DEPTH STEP
~WELL INFORMATION
 STRT.{unit}  {start} : START DEPTH
 STOP.{unit}  {stop} : STOP DEPTH
 STEP.{unit}  {step} : STEP
 NULL.  -999.25 : NULL VALUE
 WELL.  {well}
~CURVE INFORMATION
 DEPT.{unit} : 1 DEPTH
 GR.GAPI : 2 GAMMA RAY
 DT.US/M : 3 SONIC
~A  DEPTH GR DT
{rows}
"""
ROWS = ["10.0 50 1", "12.0 -999.25 2", "14.0 70 3"]


@pytest.mark.parametrize(
    ("version", "wrap", "well", "rows"),
    [
        ("2.0", "NO", "W1 : WELL", "\n".join(ROWS)),
        ("1.2", "NO", "WELL : W1", "\n".join(ROWS)),
        ("2.0", "YES", "W1 : WELL", "\n".join(ROWS).replace(" ", "\n")),
        ("2.0", "NO", "W1 : WELL", "\n".join(reversed(ROWS))),
        ("2.0", "NO", "W1 : WELL", "10.0 50.0 1\n12.0-999.25 2\n14.0 70 3"),
    ],
)
@pytest.mark.parametrize(("unit", "by"), [("M", 1), ("FT", 0.3048), ("F", 0.3048)])
def test_curves_of_las(write, version, wrap, well, rows, unit, by):
    """Each value counts halfway to the next ones."""
    text = LAS.format(version=version, wrap=wrap, well=well, rows=rows, unit=unit, start=10, stop=14, step=2)
    boreholes = Boreholes(intervals=write("w1.las", text), collars=write("c.csv", "hole,x,y,z\nW1,1,2,100\n"))
    found = read_interval_values(boreholes)
    assert found.holes.tolist() == ["W1"] * 3 and list(found.columns) == ["GR", "DT"]
    np.testing.assert_array_equal(found.columns["GR"], [50, np.nan, 70])
    np.testing.assert_allclose(found.depths, np.array([[10, 11], [11, 13], [13, 14]]) * by)
    np.testing.assert_allclose(found.begins[:, 2], 100 - np.array([10, 11, 13]) * by)
    assert len(read_boreholes(boreholes.intervals).intervals) == 0  # curves name no blocks


LAS3 = """~Version
VERS. 3.0 : CWLS LOG ASCII STANDARD - VERSION 3.0
WRAP. NO :
DLM. COMMA :
~Well
STRT.M 0 :
STOP.M 2 :
STEP.M 1 :
NULL. -999.25 :
WELL. "A, 1" :
XCOORD.M 10 :
YCOORD.M 20 :
EKB.M 100 :
~Log_Definition
DEPT.M : Depth {F}
LITH. : Lithology {S}
~Log_Data | Log_Definition
0,"sand, fine"
1,clay
2,clay
~Inclinometry_Definition
MD.M : {F}
AZIM.DEG : {F}
DEVI.DEG : {F}
~Inclinometry_Data | Inclinometry_Definition
0,90,0
1,90,0
~Tops_Definition
TOPN. : {S}
TOPT.M : {F}
~Tops_Data | Tops_Definition
"Top, A",0.5
B,1.5
"""


def test_tops_directions_and_codes_of_las_3(write):
    found = read_boreholes(write("a.las", LAS3))
    assert found.picks["surface"].tolist() == ["Top, A", "B"] and found.picks["depth"].tolist() == [0.5, 1.5]
    assert found.collars["z"].tolist() == [100] and found.survey["depth"].tolist() == [0, 1]
    assert found.intervals["block"].tolist() == ["sand, fine", "clay", "clay"]
    from_sea = LAS3.replace("~Tops_Def", "~Tops_Parameter\nTOPDR. Subsea : {S}\n~Tops_Def")
    found = read_boreholes(write("b.las", from_sea.replace(",0.5", ",-50")))
    assert found.picks["elevation"].tolist() == [-50, 1.5]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (LAS3.replace("DEPT.M", "TIME.S"), "its first curve is 'TIME', which is no depth"),
        (LAS3.replace("1,clay", "1,clay,3"), "2 values are needed, there are 3"),
        (LAS3.replace("1,clay", "x,clay"), "the depth is not a number: 'x'"),
    ],
)
def test_damaged_las(write, text, words):
    with pytest.raises(InputRefused, match=words):
        read_boreholes(write("a.las", text))


DIGGS = """<?xml version="1.0" encoding="UTF-8"?>
<Diggs xmlns="http://diggsml.org/schemas/2.6" xmlns:gml="http://www.opengis.net/gml/3.2"
 xmlns:xlink="http://www.w3.org/1999/xlink">
{holes}{layers}</Diggs>
"""
HOLE = """<samplingFeature><Borehole gml:id="b{hole}"><gml:name>{hole}</gml:name>
<referencePoint><PointLocation gml:id="p{hole}" srsName="{crs}" uomLabels="m m m"><gml:pos>{x} {y} 0</gml:pos>
</PointLocation></referencePoint><totalMeasuredDepth uom="{unit}">{end}</totalMeasuredDepth>
</Borehole></samplingFeature>
"""
LAYER = """<observation><LithologySystem gml:id="s{hole}">
<samplingFeatureRef xlink:href="#b{hole}"/>{observed}
</LithologySystem></observation>
"""
OBSERVED = """<lithologyObservation><LithologyObservation><location><LinearExtent><gml:posList>{begin} {end}
</gml:posList></LinearExtent></location><primaryLithology><Lithology>
<lithDescription>some rock</lithDescription>
<classificationCode>{code}</classificationCode></Lithology></primaryLithology></LithologyObservation>
</lithologyObservation>"""


def diggs(unit="m", by=1.0, crs="urn:ogc:def:crs:EPSG::25832"):
    holes = [
        HOLE.format(hole=hole, x=x, y=y, unit=unit, end=40 * by, crs=crs) for hole, (x, y) in PLACES.items()
    ]
    observed = [OBSERVED.format(begin=begin * by, end=end * by, code=code) for begin, end, code in LOG]
    layers = [LAYER.format(hole=hole, observed="".join(observed)) for hole in PLACES]
    return DIGGS.format(holes="".join(holes), layers="".join(layers))


@pytest.mark.parametrize(("unit", "by"), [("m", 1.0), ("ft", 1 / 0.3048)])
def test_diggs(write, unit, by):
    text = diggs(unit, by)
    first = read_boreholes(write("site.xml", re.sub(' srsName="[^"]*"', "", text)))
    assert first.collars["x"].tolist() == read_boreholes(write("site.xml", text)).collars["x"].tolist()
    assert_layers(build(load_project(write("p.toml", PROJECT.format(boreholes='"site.xml"')))))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (diggs(crs="urn:ogc:def:crs:EPSG::4979"), "is placed by longitude and latitude"),
        (DIGGS.format(holes="", layers=""), "it has no boreholes"),
        (diggs().replace("LithologySystem", "LithologySystems"), "it has no layers"),
        (diggs()[:-5], "damaged XML"),
    ],
)
def test_damaged_diggs(write, text, words):
    with pytest.raises(InputRefused, match=words):
        read_boreholes(write("site.xml", text))


@pytest.mark.parametrize(
    ("keys", "words"), [({"units": "furlong"}, "unknown unit"), ({"colars": "c"}, "no key")]
)
def test_keys_of_a_call_are_checked_as_those_of_points(tmp_path, keys, words):
    with pytest.raises(UsageError, match=words):
        read_boreholes(tmp_path / "a.ags", **keys)
