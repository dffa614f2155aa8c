# SPDX-License-Identifier: GPL-3.0-or-later
"""Every stack that was once built wrongly, kept as a small file in tests/data/stacks/."""

import pytest
from stacks import places
from stacks.case import load_stack, save_stack
from stacks.judge import exact_volumes, failures_of

FILES = sorted(places.CORPUS.glob("*.json"))


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_stack_is_built_right(path):
    assert failures_of(load_stack(path)) == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_file_is_small_and_survives_rewriting(path, tmp_path):
    stack = load_stack(path)
    assert path.stat().st_size < 20_000
    save_stack(stack, tmp_path / "again.json")
    again = load_stack(tmp_path / "again.json")
    assert exact_volumes(stack) == exact_volumes(again)
