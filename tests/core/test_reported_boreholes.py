# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of boreholes that people reported, made by hand: what must come out of them."""

import math

import numpy as np
import pytest
from realmodel.core import Boreholes, Project, Rock, Surface, build, read_boreholes
from realmodel.core.readers.table_kind import table_kind

PLACES = {"H0": (10, 10), "H1": (90, 10), "H2": (90, 90), "H3": (10, 90), "H4": (50, 50)}
SQUARE = [[0, 0], [100, 0], [100, 100], [0, 100]]
LOG = ((0, 10, "A"), (10, 25, "B"), (25, 40, "C"))
VOLUMES = {"A": 100_000.0, "B": 150_000.0, "C": 350_000.0}


def collars(z=0, header="hole,x,y,z,end", end=40):
    return header + "\n" + "".join(f"{hole},{x},{y},{z},{end}\n" for hole, (x, y) in PLACES.items())


def intervals(log=LOG, header="hole,from,to,block"):
    rows = (f"{hole},{begin},{end},{code}\n" for hole in PLACES for begin, end, code in log)
    return header + "\n" + "".join(rows)


def model(boreholes, names=("C", "B", "A"), base=-60.0, **keys):
    surfaces = [Surface(name, block=name, method="tin") for name in names]
    rock = Rock("r", surfaces, SQUARE, edge_length=10, base_elevation=base, boreholes=boreholes, **keys)
    return build(Project("p", [rock]))


def files(write, log, **more):
    tables = {"collars": collars(), "intervals": log, **more}
    return Boreholes(**{kind: write(f"{kind}.csv", text) for kind, text in tables.items() if text})


def assert_layers(built):
    """The heights of blocks are those of the log, over the base."""
    found = {block.name: block.volume for block in built.blocks}
    assert found == pytest.approx(VOLUMES, rel=1e-6)


def said(built, words):
    """The warnings that have some words."""
    return [warning.text for warning in built.warnings if words in warning.text]


def test_overlaps_by_rounding_keep_their_contacts(write):
    """A21."""
    log = ((0, 10.005, "A"), (10, 25.005, "B"), (25, 40, "C"))
    built = model(files(write, intervals(log)))
    found = {block.name: block.volume for block in built.blocks}
    assert found == pytest.approx({"A": 100_025.0, "B": 150_000.0, "C": 349_975.0}, rel=1e-9)
    assert len(built.observed().contacts) == 10
    (notice,) = said(built, "overlap")
    assert "closed at their middle (10): line 2, hole 'H0' at 10.0025" in notice


@pytest.mark.parametrize(
    ("tolerance", "left"),
    [({}, 0), ({"tolerance": 0.01}, 0), ({"tolerance": 0.001}, 10), ({"tolerance": 0}, 10)],
)
def test_the_tolerance_decides(write, tolerance, left):
    log = ((0, 9.995, "A"), (10, 25.005, "B"), (25, 40, "C"))
    found = read_boreholes(
        collars=write("c.csv", collars()), intervals=write("i.csv", intervals(log)), **tolerance
    )
    kinds = [(problem.kind, problem.action) for problem in found.problems]
    assert kinds.count(("overlap", "left out")) == left / 2
    assert kinds.count(("gap", "repaired")) == kinds.count(("overlap", "repaired")) == (5 if not left else 0)
    thin = [(0, 10, "A"), (10, 10.05, "B"), (10.056, 40, "C")]  # more than a tenth of the thinner one
    found = read_boreholes(collars=write("c.csv", collars()), intervals=write("i.csv", intervals(thin)))
    assert not found.problems


def test_an_interval_without_thickness_has_no_effect(write):
    """A22."""
    assert_layers(model(files(write, intervals(((0, 10, "A"), (10, 10, "X"), *LOG[1:])))))


@pytest.mark.parametrize("ground", [500, 0, 30])
@pytest.mark.parametrize("kind", ["elevations", "minus_sign"])
def test_depths_that_are_heights_or_have_a_minus_sign(write, ground, kind):
    """A23."""
    top = ground if kind == "elevations" else 0
    log = intervals([(top - begin, top - end, code) for begin, end, code in LOG])
    boreholes = files(write, log, collars=collars(ground))
    built = model(boreholes, base=ground - 60.0)
    assert_layers(built)
    assert len(said(built, "(15): line 2, hole 'H0'")) == 1
    found = read_boreholes(collars=boreholes.collars, intervals=boreholes.intervals)
    assert {problem.kind for problem in found.problems} <= {kind, "minus_sign"}
    assert found.intervals["from"].tolist() == [0, 10, 25] * 5


@pytest.mark.parametrize("header", ["hole,surface,depth", "hole,surface,elevation", "hole,x,y,z,surface"])
def test_values_that_stand_for_none_are_no_picks(write, header):
    """A24."""
    rows = []
    for hole, (x, y) in PLACES.items():
        for name, depth, missing in (("C", 25, ("H0", "-999.25")), ("B", 10, ("H1", "-999"))):
            value = missing[1] if hole == missing[0] else depth if "depth" in header else -depth
            rows.append(f"{hole},{x},{y},{value},{name}" if ",x," in header else f"{hole},{name},{value}")
    table = "\n".join([header, *rows]) + "\n"
    built = model(files(write, None, collars=None if ",x," in header else collars(), picks=table), ("C", "B"))
    assert {block.name: block.volume for block in built.blocks} == pytest.approx(
        {"C": 350_000.0, "B": 150_000.0}
    )
    (text,) = said(built, "-999.25")
    assert "line 2, hole 'H0', 'C'" in text and "line 5, hole 'H1', 'B'" in text
    assert {(entry.hole, entry.block) for _, entry in built.observed().left_out} == {("H0", "C"), ("H1", "B")}


def test_a_german_table(write):
    """A25."""
    rows = [
        f"{hole};{begin:.2f};{end:.2f};{code}".replace(".", ",")
        for hole in PLACES
        for begin, end, code in ((0, 10.5, "Löß"), (10.5, 25, "B"), (25, 40, "C"))
    ]
    table = write("g.csv", "\r\n".join(["Bohrung;\tVon;Bis;Einheit", *rows, ""]).encode("cp1252"))
    header = "Bohrung,Rechtswert,Hochwert,Ansatzhöhe,Endteufe"
    boreholes = Boreholes(collars=write("c.csv", collars(header=header)), intervals=table)
    built = model(boreholes, ("C", "B", "Löß"))
    found = {block.name: block.volume for block in built.blocks}
    assert found == pytest.approx({"C": 350_000.0, "B": 145_000.0, "Löß": 105_000.0})


def test_a_log_below_the_end_of_its_hole_is_used_with_one_warning(write):
    """A27."""
    built = model(files(write, intervals(), collars=collars(end=30)))
    assert_layers(built)
    (text,) = said(built, "deeper than the hole")
    assert "(5): line 4, hole 'H0' at 25, 'C': to 40, and the hole ends at 30" in text


HEADERS = {
    "Leapfrog": ("LocationID,Easting,Northing,GroundLevel,FinalDepth", "LocationID,from,to,Simple_Lith"),
    "GSWA": ("HoleId,Easting,Northing,Elevation,MaxDepth", "HoleId,FromDepth,ToDepth,Lith1"),
    "AGS": ("LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL,LOCA_FDEP", "LOCA_ID,GEOL_TOP,GEOL_BASE,GEOL_GEOL"),
    "Surpac": ("hole_id,x,y,z,max_depth", "hole_id,depth_from,depth_to,lith_code"),
    "Datamine": ("BHID,XCOLLAR,YCOLLAR,ZCOLLAR,ENDDEPTH", "BHID,FROM,TO,ROCK"),
    "Micromine": ("HOLE,EAST,NORTH,RL,TD", "HOLE,FROM,TO,LITH"),
    "gINT": ("PointID,East,North,Elevation,HoleDepth", "PointID,Depth,Bottom,Geology_Code"),
    "DINO": (
        "NITG-nr,X-Coordinaat,Y-Coordinaat,Maaiveld (m),Einddiepte",
        "NITG-nr,Van (m),Tot (m),Grondsoort",
    ),
    "swisstopo": (
        "Bohrprofil,location_x,location_y,elevation_z,total_depth",
        "Bohrprofil,from_depth,to_depth,lithology",
    ),
    "German": (
        "Bohrung,Rechtswert,Hochwert,Ansatzhöhe,Endteufe",
        "Bohrung,Tiefe von (m),Tiefe bis (m),Schicht",
    ),
    "French": ("Sondage,X,Y,Cote,Longueur", "Sondage,de,à,Lithologie"),
    "French top": ("Forage,X,Y,Altitude,Profondeur finale", "Forage,Toit,Mur,Formation"),
    "Spanish": ("Sondeo,Este,Norte,Cota,Profundidad", "Sondeo,Desde,Hasta,Litología"),
    "units": ("Hole ID,X_m,Y_m,Z (m),Depth_m", "Hole ID,From (m),To_m,Lith Code"),
}


@pytest.mark.parametrize("program", HEADERS)
def test_usual_names_of_columns(write, program):
    """A25, A28."""
    of_collars, of_intervals = HEADERS[program]
    boreholes = files(write, intervals(header=of_intervals), collars=collars(header=of_collars))
    assert table_kind(boreholes.collars) == "collars" and table_kind(boreholes.intervals) == "intervals"
    assert_layers(model(boreholes))
    found = read_boreholes(collars=boreholes.collars, intervals=boreholes.intervals)
    assert found.collars["end"].tolist() == [40.0] * 5 and not found.problems and not found.warnings


def test_one_station(write):
    """A26: a hole with one station is straight."""
    survey = write("s.csv", "hole,depth,azimuth,inclination\nH0,50,90,30\n")
    picks = write("p.csv", "hole,surface,depth\nH0,C,135\n")
    table = write("c.csv", "hole,x,y,z\nH0,0,0,0\n")
    rock = Rock("r", [Surface("C", method="plane")], SQUARE, edge_length=50, base_elevation=-300)
    rock.boreholes = Boreholes(picks, table, survey=survey)
    points = build(Project("p", [rock])).project.rocks[0].surfaces[0].points
    np.testing.assert_allclose(points, [[67.5, 0, -135 * math.cos(math.pi / 6)]], atol=1e-9)
