# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of boreholes with faults come back right, with each fault listed and nothing else touched."""

import numpy as np
import pytest
from realmodel.core import read_boreholes

UNITS = ("sand", "clay", "gravel", "till", "rock")
COLUMNS = {
    "collars": ("hole", "x", "y", "z", "end"),
    "survey": ("hole", "depth", "azimuth", "dip"),
    "intervals": ("hole", "from", "to", "block"),
    "picks": ("hole", "surface", "depth"),
}
DROPPED, CHANGED = "dropped", "changed"  # what becomes of a row


def right_tables(rng):
    """Tables of random holes without a fault: rows of texts."""
    tables = {kind: [] for kind in COLUMNS}
    for number in range(int(rng.integers(12, 20))):
        hole = f"DH-{number:02}"
        thicknesses = rng.uniform(2.0, 20.0, int(rng.integers(3, 6)))
        depths = np.round(np.concatenate([[0.0], np.cumsum(thicknesses)]), 2)
        x, y, z = np.round(rng.uniform((1000, 2000, 300), (1500, 2500, 340)), 2)
        tables["collars"].append([hole, f"{x}", f"{y}", f"{z}", f"{depths[-1]}"])
        azimuth, dip = rng.uniform(20, 340), rng.uniform(-80, -60)
        for depth in np.arange(0.0, depths[-1], 10.0):
            tables["survey"].append(
                [hole, f"{depth}", f"{azimuth + depth / 20:.1f}", f"{dip + depth / 20:.1f}"]
            )
        for unit, begin, end in zip(UNITS, depths, depths[1:], strict=False):
            tables["intervals"].append([hole, f"{begin}", f"{end}", unit])
            if end < depths[-1]:
                tables["picks"].append([hole, UNITS[UNITS.index(unit) + 1], f"{end}"])
    return tables


def some_row(rng, rows, fits=lambda rows, n: True):
    able = [n for n in range(1, len(rows) - 1) if len(rows[n]) > 2 and fits(rows, n)]
    return able[int(rng.integers(len(able)))]


def inside(rows, n):
    """Whether a row is of the same hole as those beside it."""
    return rows[n - 1][0] == rows[n][0] == rows[n + 1][0]


NULLS = ("-999", "-999.25", "-9999", "1e30", "n/a", "unknown depth")


def null_of(table, column):
    def poison(rng, tables):
        n = some_row(rng, tables[table])
        tables[table][n][column] = NULLS[int(rng.integers(len(NULLS)))]
        return table, n, DROPPED

    return poison


def changed(table, column, change, fits=inside, becomes=CHANGED):
    def poison(rng, tables):
        n = some_row(rng, tables[table], fits)
        tables[table][n][column] = change(tables[table][n][column], rng)
        return table, n, becomes

    return poison


def again(table):
    def poison(rng, tables):
        n = some_row(rng, tables[table])
        tables[table].insert(n + 1, list(tables[table][n]))
        return table, n + 1, DROPPED

    return poison


def added(table, make):
    def poison(rng, tables):
        n = some_row(rng, tables[table])
        tables[table].insert(n, make(tables[table], n))
        return table, n, DROPPED

    return poison


def reversed_interval(rng, tables):
    n = some_row(rng, tables["intervals"], inside)
    row = tables["intervals"][n]
    row[1], row[2] = row[2], row[1]
    return "intervals", n, CHANGED


def moved_station(rng, tables):
    rows = tables["survey"]
    n = some_row(rng, rows, lambda rows, n: n > 1 and rows[n - 2][0] == rows[n][0] and inside(rows, n))
    rows.insert(n - 2, rows.pop(n))
    return "survey", n - 2, CHANGED


def as_heights(rng, tables):
    """All intervals of a hole."""
    n = some_row(rng, tables["intervals"])
    hole = tables["intervals"][n][0]
    (height,) = (float(row[3]) for row in tables["collars"] if row[0] == hole)
    for row in tables["intervals"]:
        if row[0] == hole and len(row) > 2:
            row[1], row[2] = (f"{height - float(depth):.2f}" for depth in row[1:3])
    return "intervals", n, CHANGED


def with_minus(rng, tables):
    n = some_row(rng, tables["intervals"])
    hole = tables["intervals"][n][0]
    for row in tables["intervals"]:
        if row[0] == hole and len(row) > 2:
            row[1], row[2] = (f"{-float(depth)}" for depth in row[1:3])
    return "intervals", n, CHANGED


def number(by):
    return lambda text, rng: repr(float(text) + by(rng))


KINDS = {
    "pick null": null_of("picks", 2),
    "interval null": null_of("intervals", 2),
    "collar null": null_of("collars", 1),
    "depth of a station null": null_of("survey", 1),
    "dip null": null_of("survey", 3),
    "pick again": again("picks"),
    "interval again": again("intervals"),
    "station again": again("survey"),
    "collar again": again("collars"),
    "header again": added("intervals", lambda rows, n: list(COLUMNS["intervals"])),
    "total": added("intervals", lambda rows, n: ["Total", "0", "12", "m"]),
    "short row": added("picks", lambda rows, n: rows[n][:2]),
    "short interval": added("intervals", lambda rows, n: rows[n][:1]),
    "hole without collar": added("intervals", lambda rows, n: ["X7", "0", "5", "clay"]),
    "two collars": added("collars", lambda rows, n: [rows[n - 1][0], "9", "9", "9", "5"]),
    "gap": changed("intervals", 2, number(lambda rng: -0.004)),
    "overlap": changed("intervals", 2, number(lambda rng: 0.004)),
    "reversed": reversed_interval,
    "heights": as_heights,
    "minus signs": with_minus,
    "minus sign of a pick": changed("picks", 2, lambda text, rng: f"-{text}"),
    "azimuth": changed("survey", 2, number(lambda rng: 360.0 if rng.random() < 0.5 else -360.0)),
    "sign of a dip": changed("survey", 3, lambda text, rng: text.strip("-")),
    "order": moved_station,
    "name of a hole": changed("intervals", 0, lambda text, rng: text.lower().replace("-", " ")),
    "comma": changed("picks", 2, lambda text, rng: text.replace(".", ",")),
    "below the end": changed("collars", 4, lambda text, rng: "1.5", lambda rows, n: True),
}


def read(write, tables, **keys):
    files = {}
    for kind, rows in tables.items():
        lines = ["\t".join(COLUMNS[kind]), *("\t".join(row) for row in rows)]
        files[kind] = write(f"{kind}.txt", "\n".join(lines) + "\n")
    return read_boreholes(**files, **keys)


def by_place(table, *columns):
    return sorted(zip(*(table[column].tolist() for column in columns), strict=True))


def assert_right(found, right, dropped):
    """What is read is what the right tables say, but for rows that are dropped: {kind: holes and numbers}."""
    close = {"rtol": 0, "atol": 0.0051}
    for kind, keys, values in (
        ("collars", ("hole",), ("x", "y", "z")),
        ("survey", ("hole", "depth"), ("azimuth", "dip")),
        ("intervals", ("hole", "block"), ("from", "to")),
        ("picks", ("hole", "surface"), ("depth",)),
    ):
        read, wanted = getattr(found, kind), getattr(right, kind)
        named = {
            key: row
            for *row, key in zip(*(wanted[c].tolist() for c in values), by_keys(wanted, keys), strict=True)
        }
        rows = {
            key: row
            for *row, key in zip(*(read[c].tolist() for c in values), by_keys(read, keys), strict=True)
        }
        assert len(rows) == len(read), kind
        assert rows.keys() <= named.keys(), kind
        assert len(named) - len(rows) <= dropped.get(kind, 0), kind
        for key, row in rows.items():
            np.testing.assert_allclose(row, named[key], **close, err_msg=f"{kind} {key}")


def by_keys(table, keys):
    return list(zip(*(table[key].tolist() for key in keys), strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_a_poisoned_table_comes_back_right(write, kind):
    for seed in range(8):
        rng = np.random.default_rng(seed)
        tables = right_tables(rng)
        right = read(write, tables)
        assert not right.problems and not right.warnings
        table, n, becomes = KINDS[kind](rng, tables)
        found = read(write, tables)
        lines = {(problem.file.stem, problem.line) for problem in found.problems}
        if kind != "below the end":
            assert (table, n + 2) in lines, (seed, found.problems)
        hole = tables[table][n][0]
        if kind not in ("gap", "overlap", "collar null", "below the end"):
            alone = {(stem, line) for stem, line in lines if tables[stem][line - 2][0] != hole}
            assert not alone, found.problems
        gone = {kind: len(rows) for kind, rows in tables.items()} if kind == "collar null" else {table: 1}
        assert_right(found, right, gone if becomes == DROPPED else {})


@pytest.mark.parametrize("seed", range(12))
def test_all_faults_together(write, seed):
    """The same of three faults of each kind at once: rows that none of them is in are as they were."""
    rng = np.random.default_rng(100 + seed)
    tables = right_tables(rng)
    right = read(write, tables)
    order = rng.permutation(len(KINDS)).tolist()
    marks = []
    for number in order:
        table, n, _ = list(KINDS.values())[number](rng, tables)
        marks.append(tables[table][n][0])
    found = read(write, tables)
    touched = {mark.lower().replace("-", " ") for mark in marks}
    for kind, keys in (
        ("intervals", ("hole", "from", "to", "block")),
        ("picks", ("hole", "surface", "depth")),
    ):
        untouched = [
            row
            for row in by_place(getattr(right, kind), *keys)
            if row[0].lower().replace("-", " ") not in touched
        ]
        assert set(untouched) <= set(by_place(getattr(found, kind), *keys))
    problems = {problem.hole.lower().replace("-", " ") for problem in found.problems}
    assert problems <= touched | {""} | {"total", "x7", "hole"}


SURVEY = "hole,depth,azimuth,{angle}\n"


def stations(write, rows, angle="dip", **keys):
    """The survey of one hole, and its problems. rows: depth, azimuth and angle."""
    table = SURVEY.format(angle=angle) + "".join(f"A,{row}\n" for row in rows)
    found = read_boreholes(
        collars=write("c.csv", "hole,x,y,z,end\nA,0,0,0,100\n"),
        survey=write("s.csv", table),
        picks=write("p.csv", "hole,surface,depth\nA,clay,3\n"),
        **keys,
    )
    rows = zip(*(found.survey[name].tolist() for name in ("depth", "azimuth", angle)), strict=True)
    return [",".join(f"{value:g}" for value in row) for row in rows], found.problems


@pytest.mark.parametrize(
    ("rows", "angle", "wanted", "kind"),
    [
        (["0,9,-60", "9,9,-61", "9,9,10", "20,9,-62", "30,9,-62"], "dip", [0, 1, 3, 4], "two_directions"),
        (["0,9,-60", "9,9,-10", "9,9,-61", "20,9,-62"], "dip", [0, 2, 3], "two_directions"),
        (["0,9,-60", "9,9,-60", "9,9,-60"], "dip", [0, 1], "double"),
        (["0,9,90", "9,189,90", "20,9,90"], "inclination", [0, 2], "station"),
        (["0,189,90", "9,9,90", "20,9,90"], "inclination", [1, 2], "station"),
        (["0,9,5", "9,9,6", "20,9,200"], "inclination", [0, 1], "station"),
        (["0,9,5", "-9,9,6", "20,9,9"], "inclination", [0, 2], "station"),
        (["0,9,5", "9,,6", "20,9,9"], "inclination", [0, 2], "station"),
        (["0,9,5", "9,9,-999", "20,9,9"], "inclination", [0, 2], "station"),
        (["0,9,5", "9,9,6", "120,9,9"], "inclination", [0, 1, 2], "below_end"),
    ],
)
def test_stations_that_make_no_sense(write, rows, angle, wanted, kind):
    found, problems = stations(write, rows, angle)
    assert found == [rows[n] for n in wanted]
    assert [problem.kind for problem in problems] == [kind]


def test_stations_that_are_mended(write):
    found, problems = stations(write, ["30,-5,-60", "0,365,-61", "10,5,62", "20,5,-60", "40,5,-60"])
    assert found == ["0,5,-61", "10,5,-62", "20,5,-60", "30,355,-60", "40,5,-60"]
    assert sorted(problem.kind for problem in problems) == ["azimuth", "azimuth", "dip_sign", "order"]
    found, problems = stations(write, ["0,5,5", "10,5,-6", "20,5,7", "30,5,8"], "inclination")
    assert found == ["0,5,5", "10,5,6", "20,5,7", "30,5,8"]
    # from below upward is an order, and holes that go up are right
    assert not stations(write, ["30,5,-60", "20,5,-60", "0,5,-61"])[1]
    assert not stations(write, ["0,5,60", "20,5,61"], downward_dip="negative")[1]


def test_the_collar_that_fits_is_used(write):
    table = "hole,x,y,z,end\nA,900,2,3,50\nB,1,2,3,20\nB,1,2,4,50\nC,0,0,0,50\nA,3,2,3,50\nD,9,9,9,50\n"
    found = read_boreholes(
        collars=write("c.csv", table), intervals=write("i.csv", "hole,from,to,block\nB,0,40,x\n")
    )
    assert found.collars["x"].tolist() == [3, 1, 0, 9] and found.collars["z"].tolist() == [3, 4, 0, 9]
    assert [(problem.line, problem.action) for problem in found.problems] == [
        (2, "left out"),
        (3, "left out"),
    ]


def test_heights_that_others_surround_are_heights(write):
    """-999 is a height in a field whose tops are there, -999.25 and 1e30 are none."""
    rows = [f"B{n},{n},{n},{-900 - 20 * n},top" for n in range(8)]
    rows += ["B8,8,8,-999,top", "B9,9,9,-999.25,top", "C0,9,9,1e30,top"]
    found = read_boreholes(picks=write("p.csv", "hole,x,y,z,surface\n" + "\n".join(rows) + "\n"))
    assert len(found.picks) == 9 and -999 in found.picks["elevation"]
    assert [problem.hole for problem in found.problems] == ["B9", "C0"]


def test_picks_in_an_order_that_no_other_hole_has(write):
    rows = [f"H{n},{name},{depth}" for n in range(5) for name, depth in (("sand", 5), ("clay", 9))]
    rows += ["X,clay,4", "X,sand,8"]
    places = "hole,x,y,z\n" + "".join(
        f"{hole},{n},0,0\n" for n, hole in enumerate(("H0", "H1", "H2", "H3", "H4", "X"))
    )
    found = read_boreholes(
        collars=write("c.csv", places), picks=write("p.csv", "hole,surface,depth\n" + "\n".join(rows) + "\n")
    )
    (problem,) = found.problems
    assert (problem.kind, problem.hole, problem.line, problem.action) == ("order", "X", 12, "used")
    assert len(found.picks) == 12
