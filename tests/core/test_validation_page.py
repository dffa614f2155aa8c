# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/validation.md, its figures, and what other documents cite of it are what docs/validation.json says."""

import re
import sys
from pathlib import Path

import histories
import pytest
from realmodel import _native  # noqa: F401  (before SciPy, which may take the room of its libraries)

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

from validation import page, programs  # noqa: E402

DATA = page.read()
TEXT = page.PAGE.read_text(encoding="utf-8")
CITING = [path for path in page.documents() if "<!-- value " in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", CITING, ids=lambda path: str(path.relative_to(ROOT)))
def test_numbers_are_those_of_the_data(path):
    text = path.read_text(encoding="utf-8")
    assert page.written(text, DATA) == text, "run scripts/validate.sh"


@pytest.mark.parametrize("name", ["RealModel", "SciPy RBF"])
def test_a_history_has_the_share_of_the_data(name):
    """The programs that the tests have, on one history."""
    pytest.importorskip("scipy")
    history = histories.rough(1)
    beds = programs.Beds(history.data, 0 * history.size, history.size, history.levels)
    share = history._share(programs.PROGRAMS[name](beds).blocks(history._places()))
    assert share == pytest.approx(DATA["parts"]["rough"]["programs"][name]["shares"][1], abs=0.001)


def test_figures_are_those_of_the_data():
    figures = page.figures(DATA)
    assert {path.name for path in page.IMAGES.iterdir()} == figures.keys()
    for name, svg in figures.items():
        assert (page.IMAGES / name).read_text(encoding="utf-8") == svg, f"{name}: run scripts/validate.sh"
        assert f"images/validation/{name}" in TEXT


def test_all_tables_are_shown():
    assert {name for _, name, _ in page._TABLE.findall(TEXT)} == page.TABLES.keys()


def test_no_result_is_typed_by_hand():
    """Outside of tables and values there are no percentages but those that are asked for."""
    rest = page._VALUE.sub("", page._TABLE.sub("", TEXT))
    assert set(re.findall(r"\d+(?:\.\d+)? %", rest)) <= {"80 %", "50 %"}


@pytest.mark.parametrize("path", CITING, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_line_begins_with_a_comment_that_hides_it(path):
    """A line that begins with a comment is HTML: its links and emphasis are not read."""
    assert not re.search(r"^<!-- value ", path.read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.parametrize("name", page.TABLES)
def test_a_changed_number_is_noticed(name):
    (table,) = re.findall(rf"<!-- validation: {name} -->\n(.*?)<!-- end -->", TEXT, re.DOTALL)
    digits = [match.start() for match in re.finditer(r"\d", table)]
    at = digits[-1]
    changed = table[:at] + str((int(table[at]) + 1) % 10) + table[at + 1 :]
    text = TEXT.replace(table, changed, 1)
    assert text != TEXT
    assert page.written(text, DATA) == TEXT
