# SPDX-License-Identifier: GPL-3.0-or-later
"""Hypothesis draws the same examples in every run.

Left to itself it draws at random and, one number in forty, a constant that stands in some module of the
project that is imported by then: with `derandomize` alone a test has other examples in a full run than
alone, and others again after a change of any constant anywhere. A test that may find something new in the
middle of a change to something else is of no use; looking further is what stacks.hunt and stacks.cut_hunt
are for.
"""

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture.providers import HypothesisProvider
from hypothesis.internal.constants_ast import Constants


def use():
    """For all tests from now on: what is drawn depends on the test alone, and not on load either."""
    # There is no setting for it, and other providers are not asked everywhere. Instead of a property that
    # looks through sys.modules (Hypothesis is pinned; test_same_examples tells whether this still does it).
    HypothesisProvider._local_constants = Constants()
    settings.register_profile(
        "same examples",
        derandomize=True,
        deadline=None,
        database=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.too_slow],
    )
    settings.load_profile("same examples")
