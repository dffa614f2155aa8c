# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of random histories with errors: nothing is refused, and no field is much worse than planes."""

import pytest
from histories import folded, near_flat

NODES = 6000  # enough for dips to say how a field runs between surfaces


@pytest.mark.parametrize("first", range(0, 70, 10))
def test_near_flat_histories_are_no_worse_than_planes(first):
    """Fields that fell beyond the data, or were refused since they rise the other way: 25 of these."""
    for seed in range(first, first + 10):
        history = near_flat(seed)
        assert history.share_right(NODES) > history.share_of_planes() - 0.05, seed


@pytest.mark.parametrize("first", range(0, 30, 10))
def test_folded_histories_are_no_worse_than_planes(first):
    """Two of these were refused."""
    for seed in range(first, first + 10):
        if (history := folded(seed)) is not None:
            assert history.share_right(NODES) > history.share_of_planes() - 0.05, seed
