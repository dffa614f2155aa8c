# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of boreholes with one end of each interval, and with numbers as people write them."""

from itertools import chain

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import InputRefused, read_boreholes
from realmodel.core.readers import table_kind

PLACES = {"B1": (10.0, 20.0, 100.0), "B2": (90.0, 15.0, 103.0), "B3": (45.0, 80.0, 98.5)}
TOPS = (0.0, 4.5, 11.0, 30.0)
CODES = "DCBA"


def tables(folder, columns, row, end=40.0, places=PLACES):
    """The boreholes of a table of intervals. row(from, to, code, z of the collar): its entries."""
    collars = "".join(f"{hole},{x},{y},{z},{end}\n" for hole, (x, y, z) in places.items())
    (folder / "c.csv").write_text("hole,x,y,z,end\n" + collars)
    ends = (*TOPS[1:], 40.0)
    rows = [
        ",".join(map(str, (hole, *row(top, base, code, z))))
        for hole, (_, _, z) in places.items()
        for top, base, code in zip(TOPS, ends, CODES, strict=True)
    ]
    file = folder / "i.csv"
    file.write_text("\n".join([f"hole,{columns}", *rows, ""]), encoding="utf-8")
    return read_boreholes(collars=folder / "c.csv", intervals=file)


def assert_whole(found):
    np.testing.assert_allclose(found.intervals["from"], TOPS * 3)
    np.testing.assert_allclose(found.intervals["to"], (*TOPS[1:], 40.0) * 3)
    assert "".join(found.intervals["block"]) == CODES * 3


@pytest.mark.parametrize(
    ("columns", "row"),
    [
        ("from,lithology", lambda a, b, code, z: (a, code)),
        ("top,lith", lambda a, b, code, z: (a, code)),
        ("Untergrenze,Petro", lambda a, b, code, z: (b, code)),
        ("base,lith", lambda a, b, code, z: (b, code)),
        ("top_elev,lith", lambda a, b, code, z: (z - a, code)),
        ("bottom_elev,lith", lambda a, b, code, z: (z - b, code)),
        ("from,thickness,lith", lambda a, b, code, z: (a, b - a, code)),
        ("top_elev,thickness,lith", lambda a, b, code, z: (z - a, b - a, code)),
    ],
)
def test_the_other_end_follows_from_the_hole(tmp_path, columns, row):
    found = tables(tmp_path, columns, row)
    assert_whole(found)
    assert table_kind(tmp_path / "i.csv") == "intervals"
    assert "it has no column" in " ".join(found.warnings)


def test_a_last_interval_of_unknown_length_is_listed(tmp_path):
    found = tables(tmp_path, "top,lith", lambda a, b, code, z: (a, code), end="")
    assert "".join(found.intervals["block"]) == "DCB" * 3
    assert [problem.kind for problem in found.problems] == ["no_depth"] * 3
    assert "where it ends" in found.problems[0].text


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.randoms(use_true_random=False), st.booleans())
def test_the_order_of_rows_of_depths_changes_nothing(tmp_path_factory, random, of_tops):
    folder = tmp_path_factory.mktemp("t")
    tables(folder, "top,lith" if of_tops else "base,lith", lambda a, b, code, z: (a if of_tops else b, code))
    header, *rows = (folder / "i.csv").read_text().splitlines()
    by_hole = [rows[n : n + 4] for n in range(0, 12, 4)]
    for part in by_hole:
        random.shuffle(part)
        if [float(row.split(",")[1]) for row in part] == sorted(
            (float(row.split(",")[1]) for row in part), reverse=True
        ):
            part.reverse()  # as elevations
    (folder / "i.csv").write_text("\n".join([header, *chain.from_iterable(by_hole), ""]))
    found = read_boreholes(collars=folder / "c.csv", intervals=folder / "i.csv").intervals
    got = sorted(zip(found["hole"], found["from"], found["to"], found["block"], strict=True))
    ends = (*TOPS[1:], 40.0)
    assert got == sorted((h, a, b, c) for h in PLACES for a, b, c in zip(TOPS, ends, CODES, strict=True))


@pytest.mark.parametrize("write", ["{} m", "{}m", "{} M", "{:.2f} m"])
def test_lengths_with_their_unit(tmp_path, write):
    assert_whole(
        tables(tmp_path, "from,to,lith", lambda a, b, code, z: (write.format(a), write.format(b), code))
    )


def test_another_unit_in_the_cells_is_that_of_the_column(tmp_path):
    found = tables(
        tmp_path, "from,to,lith", lambda a, b, code, z: (f"{a / 0.3048!r} ft", f"{b / 0.3048!r} ft", code)
    )
    assert_whole(found)
    assert any("says ft" in text for text in found.warnings)


@pytest.mark.parametrize(
    "written", ["2'600'010.25", "2’600’010.25", "2 600 010.25", "2\u00a0600\u00a0010.25", '"2,600,010.25"']
)
def test_signs_between_thousands(tmp_path, written):
    found = tables(tmp_path, "from,to,lith", lambda a, b, code, z: (a, b, code))
    text = (tmp_path / "c.csv").read_text()
    (tmp_path / "c.csv").write_text(text.replace("10.0,20.0", f"{written},20.0"), encoding="utf-8")
    found = read_boreholes(collars=tmp_path / "c.csv", intervals=tmp_path / "i.csv")
    assert found.collars["x"][0] == 2600010.25


@pytest.mark.parametrize(
    ("collars", "columns"),
    [
        ("BHID,XCOLLAR,YCOLLAR,ZCOLLAR,LENGTH", "BHID,FROM,TO,ROCK"),
        ("DHID,EASTING,NORTHING,ELEV,TD", "DHID,FROM,TO,GEOCOD"),
        ("HoleID,NAT_East,NAT_North,NAT_RL,Depth", "HoleID,SampFrom,SampTo,Lith1_Code"),
        ("PointID,East,North,Elevation,HoleDepth", "PointID,Depth,Bottom,Graphic"),
        (
            "Bohrung,Rechtswert,Hochwert,Ansatzhöhe [m NHN],Endteufe",
            "Bohrung,Teufe von [m],Teufe bis [m],Gestein",
        ),
        ("ID_BSS,X_L93,Y_L93,Z_SOL,PROF_INVESTIGATION", "ID_BSS,PROF_TOIT,PROF_BASE,LITHOLOGIE"),
        ("Sondaggio,Est,Nord,Quota,Profondità finale", "Sondaggio,Da,A,Litologia"),
        ("Furo,X,Y,Cota,Profundidade", "Furo,De,Até,Litologia"),
        ("Otwór,X,Y,Rzędna,Głębokość", "Otwór,Strop,Spąg,Litologia"),
        ("Borrhål,E,N,Z,Slutdjup", "Borrhål,Från,Till,Jordart"),
        ("NAME,XCOORD,YCOORD,ZCOORDB,ENDTEUFE", "NAME,Obergrenze,UNTERGRENZE,PETRO"),
    ],
)
def test_columns_of_programs_and_countries(tmp_path, collars, columns):
    tables(tmp_path, "from,to,lith", lambda a, b, code, z: (a, b, code))
    for name, header in (("c.csv", collars), ("i.csv", columns)):
        _, *rows = (tmp_path / name).read_text().splitlines()
        (tmp_path / name).write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    found = read_boreholes(collars=tmp_path / "c.csv", intervals=tmp_path / "i.csv")
    assert_whole(found)
    assert found.collars["end"].tolist() == [40.0] * 3
    assert found.collars["z"].tolist() == [100.0, 103.0, 98.5]
    assert found.problems == found.warnings == []


def test_a_table_without_either_end_is_refused(tmp_path):
    with pytest.raises(InputRefused, match="no column from"):
        tables(tmp_path, "interval,lith", lambda a, b, code, z: (f"{a} - {b}", code))
