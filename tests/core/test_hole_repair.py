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
    close = dict(rtol=0, atol=0.0051)
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
