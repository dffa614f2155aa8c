# SPDX-License-Identifier: GPL-3.0-or-later
"""Points at one place: what becomes of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from realmodel.core.heights.mis_ties import without_mis_ties


def as_they_are(points):
    """Place by place, in plain Python."""
    tolerated = 0.05 * np.ptp(points[:, 2])
    places = {}
    for number, (x, y, _) in enumerate(points.tolist()):
        places.setdefault((x, y), []).append(number)
    left, merged = {}, []
    for place, numbers in places.items():
        z = points[numbers, 2]
        apart = np.ptp(z)
        if apart > tolerated or apart == 0:
            left |= {number: points[number, 2] for number in numbers}
            continue
        left[numbers[0]] = sum(z.tolist()) / len(z)
        merged.append((-apart, *place))
    numbers = sorted(left)
    found = np.column_stack([points[numbers, :2], [left[number] for number in numbers]])
    return found, len(merged), min(merged, default=None)


coordinates = st.sampled_from([0.0, -0.0, 1.0, 2.5, -3.0, 4e5, 5e6])
heights = st.sampled_from([0.0, 0.25, 1.0, 0.1, 60.0, 100.0])


@given(points=st.lists(st.tuples(coordinates, coordinates, heights), min_size=1, max_size=40))
def test_heights_that_are_nearly_equal_are_one(points):
    points = np.array(points)
    expected, count, worst = as_they_are(points)
    found, warning = without_mis_ties(points)
    assert found.tobytes() == expected.tobytes()
    assert (warning is None) == (count == 0)
    if count:
        assert warning.startswith("1 position has" if count == 1 else f"{count} positions have")
        assert f"up to {-worst[0]:.6g} apart" in warning


def test_what_is_apart_is_left_alone():
    points = np.random.default_rng(2).random((100, 3))
    assert without_mis_ties(points)[0] is points
