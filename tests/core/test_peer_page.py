# SPDX-License-Identifier: GPL-3.0-or-later
"""The page for users of GemPy and LoopStructural: its data are those of its formula, its shares are right."""

import importlib.util
import re
import runpy
from pathlib import Path

import pytest

pd = pytest.importorskip("pandas", reason="pandas is not installed: scripts/requirements/test.txt")

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = runpy.run_path(str(ROOT / "scripts" / "compare_peers.py"))
PAGE = SCRIPT["PAGE"]
MISSING = [name for name in ("gempy", "LoopStructural") if importlib.util.find_spec(name) is None]


def written(name):
    return SCRIPT["_WRITTEN"][name].search(PAGE.read_text(encoding="utf-8"))[0]


@pytest.fixture(autouse=True)
def working_folder(monkeypatch):
    monkeypatch.chdir(Path.cwd())  # the code of the page changes it: this restores it


@pytest.mark.parametrize("name", ["points", "orientations", "loop"])
def test_tables_are_those_of_the_formula(name, tmp_path):
    SCRIPT["page_tables"]()[name].to_csv(tmp_path / name, index=False)
    assert (SCRIPT["TABLES"] / f"{name}.csv").read_text() == (tmp_path / name).read_text()


def test_the_page_counts_its_data():
    tables = SCRIPT["page_tables"]()
    counts = f"{len(tables['points'])} points and {len(tables['orientations'])} orientations"
    assert counts in PAGE.read_text(encoding="utf-8")
    assert f"{len(SCRIPT['page_places']()):,} random places" in PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize(("peer", "call"), [("GemPy", "from_gempy"), ("LoopStructural", "from_loop")])
def test_our_share_is_what_the_page_says(peer, call):
    units = SCRIPT["our_page_units"](f"import build, {call}")
    share = (units == SCRIPT["true_units"](SCRIPT["page_places"]())).mean()
    (row,) = (line for line in written("agreement").splitlines() if line.startswith(f"| {peer} "))
    assert row.endswith(f"| {100 * share:.1f} % |")


def test_the_solids_fill_the_box():
    of_gempy, of_loop = written("solids").split("\n\n")
    for solids in (of_gempy, of_loop):
        volumes = [float(volume) for volume in re.findall(r"([\d.]+) million", solids)]
        assert len(volumes) == solids.count("closed: True") == 3
        assert sum(volumes) == pytest.approx(970 * 770 * 600 / 1e6, abs=0.15)  # each is rounded to a tenth


@pytest.mark.skipif(bool(MISSING), reason=f"{' and '.join(MISSING)} not installed: scripts/compare_peers.py")
def test_the_page_has_what_the_programs_give():
    assert SCRIPT["agreement"]() == (written("agreement"), written("solids"))
