# SPDX-License-Identifier: GPL-3.0-or-later
"""Repairs of tables of boreholes are refused row by row: `unrepaired` and `left_out`."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import InputRefused, UsageError, load_project, read_boreholes

_FAULTS = {  # what becomes of (from, to, block) of an interval
    "reversed": lambda a, b, c: (b, a, c),
    "minus": lambda a, b, c: (-a, -b, c),
    "gap": lambda a, b, c: (a + 0.004, b, c),
    "overlap": lambda a, b, c: (a, b + 0.004, c),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("holes")


def _write(folder, faults):
    """Four holes of five intervals; faults: {row: kind}."""
    (folder / "c.csv").write_text("hole,x,y,z\n" + "".join(f"B{n},{n},{n % 2},10\n" for n in range(4)))
    rows = []
    for n in range(20):
        row = 2.0 * (n % 5), 2.0 * (n % 5) + 2.0, f"U{n % 5}"
        row = _FAULTS[faults[n]](*row) if n in faults else row
        rows.append(f"B{n // 5},{row[0]},{row[1]},{row[2]}")
    (folder / "i.csv").write_text("hole,from,to,block\n" + "\n".join(rows) + "\n")
    return {"collars": folder / "c.csv", "intervals": folder / "i.csv"}


def _rows(holes):
    return list(
        zip(*(holes.intervals[name].tolist() for name in ("hole", "from", "to", "block")), strict=True)
    )


@given(faults=st.dictionaries(st.integers(0, 19), st.sampled_from(sorted(_FAULTS)), min_size=1, max_size=4))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_each_repaired_row_can_be_used_as_written_or_left_out(folder, faults):
    files = _write(folder, faults)
    repaired = read_boreholes(**files)
    for line in {problem.line for problem in repaired.problems}:
        name = f"i.csv:{line}"
        as_written = read_boreholes(**files, unrepaired=[name])
        hole, begin, end, block = (folder / "i.csv").read_text().splitlines()[line - 1].split(",")
        assert (hole, float(begin), float(end), block) in _rows(as_written)
        without = read_boreholes(**files, left_out=[name])
        assert len(without.intervals) == 19
        for holes, kind in ((as_written, "unrepaired"), (without, "switched_off")):
            assert [p.line for p in holes.problems if p.kind == kind] == [line]
            assert not any(f"line {line}," in text for text in holes.warnings)


def test_rows_that_are_right_are_not_touched_by_decisions(folder):
    files = _write(folder, {})
    names = [f"i.csv:{line}" for line in (2, 9)]
    assert sorted(_rows(read_boreholes(**files, unrepaired=names))) == sorted(_rows(read_boreholes(**files)))


def test_decisions_that_make_no_sense(folder):
    files = _write(folder, {})
    with pytest.raises(InputRefused, match=r"there is no row 'i\.csv:99'"):
        read_boreholes(**files, left_out=["i.csv:99"])
    for rows in (["i.csv"], [3], "i.csv"):
        with pytest.raises(UsageError, match="'unrepaired' must be rows of tables"):
            read_boreholes(**files, unrepaired=rows)


def test_they_are_keys_of_a_project(folder):
    _write(folder, {4: "reversed"})
    (folder / "p.toml").write_text(
        'format = 1\nname = "p"\n[[rock]]\nname = "r"\nregion = [[0, 0], [9, 0], [9, 9]]\nedge_length = 2\n'
        '[rock.boreholes]\ncollars = "c.csv"\nintervals = "i.csv"\nunrepaired = ["i.csv:6"]\n'
        'left_out = ["i.csv:7"]\n'
        '[[rock.surface]]\nname = "U1"\n'
    )
    project = load_project(folder / "p.toml")
    boreholes = project.rocks[0].boreholes
    assert (boreholes.unrepaired, boreholes.left_out) == (["i.csv:6"], ["i.csv:7"])
