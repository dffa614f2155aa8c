# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with folds that were once built wrongly, kept as small files in tests/data/folds/, and some random
ones (scripts/fuzz.sh --folds looks further)."""

import numpy as np
import pytest
from faulted.minimize import changed
from folded.case import CORPUS, load_case, save_case
from folded.generate import Drawn, random_case
from folded.judge import failures_of
from folded.kind import smaller

FILES = sorted(CORPUS.glob("*.json"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_it_is_built_right(path):
    assert failures_of(load_case(path)) == []


@pytest.mark.parametrize("seed", [14, 18, 47])
def test_random_ones_are_built_right(seed):
    assert failures_of(random_case(seed)) == []


def test_a_case_survives_its_file(tmp_path):
    case = random_case(102)
    save_case(case, tmp_path / "case.json", "why")
    again = load_case(tmp_path / "case.json")
    one, other = Drawn(case), Drawn(again)
    assert len(case.faults) == 2
    for name, points in one.contacts.items():
        np.testing.assert_array_equal(other.contacts[name], points)
    np.testing.assert_array_equal(again.faults[0].vertices, case.faults[0].vertices)
    points = np.random.default_rng(1).uniform(0, 9, (500, 3))
    np.testing.assert_array_equal(again.blocks_at(points), case.blocks_at(points))


def test_smaller_cases_are_cases():
    case = random_case(136)
    for change in smaller(case):
        less = changed(case, change)
        assert set(less.names()) <= set(case.names())
        assert {fault.youngest for fault in less.faults} <= set(less.names())


def test_the_judge_finds_what_is_wrong(monkeypatch):
    """Contacts that are lower than they were seen, in the program alone."""
    case = random_case(14)
    assert failures_of(case) == []
    contacts = Drawn._contacts
    monkeypatch.setattr(Drawn, "_contacts", lambda *given: contacts(*given) - [0.0, 0.0, 1.5])
    monkeypatch.setattr(Drawn, "_dips", lambda *_: (np.empty((0, 3)), np.empty((0, 3))))
    assert any(failure.startswith("share") for failure in failures_of(case))
