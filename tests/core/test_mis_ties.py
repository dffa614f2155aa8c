# SPDX-License-Identifier: GPL-3.0-or-later
"""Points at one place: what becomes of them, in memory, in files, and of many."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from realmodel.core.base.mapped_arrays import MappedArrays, in_memory
from realmodel.core.heights import mis_ties
from realmodel.core.heights.mis_ties import each_place_once, without_mis_ties


def as_they_are(points, is_once):
    """Place by place, in plain Python."""
    tolerated = 0.05 * np.ptp(points[:, 2])
    places = {}
    for number, (x, y, _) in enumerate(points.tolist()):
        places.setdefault((x, y), []).append(number)
    left, merged = {}, []
    for place, numbers in places.items():
        z = points[numbers, 2]
        apart = np.ptp(z)
        if apart > tolerated or (apart == 0 and not is_once):
            seen = set()  # of equal ones the first
            for number in numbers:
                if not is_once or points[number, 2] not in seen:
                    left[number] = points[number, 2]
                seen.add(points[number, 2])
            continue
        left[numbers[0]] = z[0]
        if apart > 0:
            left[numbers[0]] = sum(z.tolist()) / len(z)
            merged.append((-apart, *place))
    numbers = sorted(left)
    found = np.column_stack([points[numbers, :2], [left[number] for number in numbers]])
    return found, len(merged), min(merged, default=None)


coordinates = st.sampled_from([0.0, -0.0, 1.0, 2.5, -3.0, 4e5, 5e6])
heights = st.sampled_from([0.0, 0.25, 1.0, 0.1, 60.0, 100.0])


@given(points=st.lists(st.tuples(coordinates, coordinates, heights), min_size=1, max_size=40))
def test_many_are_settled_as_few(points):
    points = np.array(points)
    for is_once in (False, True):
        expected, count, worst = as_they_are(points, is_once)
        for at_once in (1 << 18, 4):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(mis_ties, "_AT_ONCE", at_once)
                if is_once:
                    found, warning, are_apart = each_place_once(points, np.zeros, in_memory)
                    assert are_apart == (len(np.unique(found[:, :2] + 0.0, axis=0)) == len(found))
                else:
                    found, warning = without_mis_ties(points)
            assert found.tobytes() == expected.tobytes()
            assert (warning is None) == (count == 0)
            if count:
                assert warning.startswith("1 position has" if count == 1 else f"{count} positions have")
                assert f"up to {-worst[0]:.6g} apart" in warning


def test_the_same_in_files(tmp_path, monkeypatch):
    random = np.random.default_rng(1)
    points = np.column_stack([random.integers(0, 400, (200_000, 2)) * 2.5, random.random(200_000)])
    points[::2, 2] = 7.0
    points[5] = 0.0, 0.0, 100.0
    monkeypatch.setattr(mis_ties, "_AT_ONCE", 10_000)
    with MappedArrays(tmp_path / "arrays") as arrays:
        kept = arrays.keep(points)
        found, warning = without_mis_ties(kept, arrays.zeros, arrays.gather)
        once, warning_of_once, are_apart = each_place_once(kept, arrays.zeros, arrays.gather)
        in_files = [np.array(found), np.array(once)]
    monkeypatch.undo()
    expected = without_mis_ties(points)
    assert in_files[0].tobytes() == expected[0].tobytes()
    assert warning == warning_of_once == expected[1]
    assert in_files[1].tobytes() == each_place_once(points, np.zeros, in_memory)[0].tobytes()
    assert not are_apart and len(in_files[1]) < len(in_files[0]) < len(points)


def test_what_is_apart_is_left_alone():
    points = np.random.default_rng(2).random((100, 3))
    assert without_mis_ties(points)[0] is points
    found, warning, are_apart = each_place_once(points, np.zeros, in_memory)
    assert found is points and warning is None and are_apart
