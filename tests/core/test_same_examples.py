# SPDX-License-Identifier: GPL-3.0-or-later
"""What Hypothesis draws does not depend on what is imported, nor on chance."""

import sys
import types

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.internal.conjecture import providers

CONSTANTS = "\n".join(f"C{k} = {5_000_000 + 7919 * k}" for k in range(50))


def drawn():
    """Some two thousand numbers of one test; each could be a constant of some module."""
    numbers = []

    @settings(max_examples=100)
    @given(st.lists(st.integers(0, 10_000_000), min_size=20, max_size=20), st.randoms(use_true_random=False))
    def look(several, rng):
        numbers.extend([*several, rng.randint(0, 9_000_000), rng.random()])

    look()
    return numbers


@pytest.fixture
def module(tmp_path):
    """A module of the project's, so it seems, that is imported between two tests."""
    file = tmp_path / "constants.py"
    file.write_text(CONSTANTS)
    found = types.ModuleType("constants_of_same_examples")
    found.__file__ = str(file)
    exec(CONSTANTS, found.__dict__)
    return found


def drawn_before_and_after(module):
    before = drawn()
    sys.modules[module.__name__] = module
    try:
        return before, drawn()
    finally:
        del sys.modules[module.__name__]


def test_the_same_whatever_is_imported(module):
    before, after = drawn_before_and_after(module)
    assert before == after


def test_otherwise_it_would_not_be(module, monkeypatch):
    """That the test above can fail: the constants of the module would be among what is drawn."""
    monkeypatch.setattr(
        providers.HypothesisProvider, "_local_constants", property(lambda _: providers._get_local_constants())
    )
    providers.CONSTANTS_CACHE.cache.clear()
    try:
        before, after = drawn_before_and_after(module)
    finally:
        providers.CONSTANTS_CACHE.cache.clear()
    constants = {value for name, value in vars(module).items() if name.startswith("C")}
    assert not constants & set(before)
    assert constants & set(after)


def test_no_chance_and_no_clock():
    assert settings().derandomize
    assert settings().deadline is None
    assert settings().database is None
