# SPDX-License-Identifier: GPL-3.0-or-later
"""The log of a borehole as a drawing."""

import numpy as np
import pytest
from realmodel.core.drawing.drawing import Drawing, FilledRings, Line, Text
from realmodel.core.readers.tables.interval_values import IntervalValues
from realmodel.core.results.hole_log import HoleLog, LogPart, draw_hole_log

SAND, CLAY = (0.9, 0.8, 0.2), (0.2, 0.3, 0.9)
DEPTHS = np.array([[0, 1], [1, 3], [5, 7], [7, 8]], float)


def values(**columns):
    places = np.zeros((4, 3))
    return IntervalValues(np.full(4, "B1"), places, places, DEPTHS, columns)


def drawn(log, box=(390.0, 20.0, 500.0)):
    drawing = Drawing(400.0, 600.0)
    draw_hole_log(drawing, log, box)
    return drawing.items


def of_color(items, color):
    return [item.rings[0] for item in items if isinstance(item, FilledRings) and item.fill == color]


def test_intervals_stand_at_their_depths():
    parts = [LogPart(0, 10, "Sand", SAND), LogPart(10, 40, "Clay", CLAY)]
    items = drawn(HoleLog("B1", "m", parts, [(10.0, "Top of clay")]))
    (sand,), (clay,) = of_color(items, SAND), of_color(items, CLAY)
    assert np.ptp(clay[:, 1]) == pytest.approx(3 * np.ptp(sand[:, 1]))
    assert clay[:, 1].max() == pytest.approx(sand[:, 1].min()) and clay[:, 1].min() < sand[:, 1].min()
    texts = {item.text: item for item in items if isinstance(item, Text)}
    assert {"B1 (m)", "Sand", "Clay", "Top of clay", "0", "40"} <= set(texts)
    scale = np.ptp(clay[:, 1]) / 30.0
    assert texts["0"].y - texts["40"].y == pytest.approx(40.0 * scale)
    pick = max((item for item in items if isinstance(item, Line)), key=lambda line: line.width)
    assert pick.points[:, 1] == pytest.approx(sand[:, 1].min())
    paper = items[0].rings[0]
    assert paper.max(axis=0).tolist() == [390.0, 520.0] and paper[:, 1].min() == 20.0
    for item in items[1:]:
        points = item.points if isinstance(item, Line) else None
        points = np.concatenate(item.rings) if isinstance(item, FilledRings) else points
        points = np.array([[item.x, item.y]]) if isinstance(item, Text) else points
        assert (points >= paper.min(axis=0)).all() and (points <= paper.max(axis=0)).all()


def test_curves_go_from_the_lowest_to_the_highest_and_stop_at_gaps():
    columns = {"GR (GAPI)": np.array([10.0, 20.0, 40.0, 50.0]), "lith": np.array(["a", "b", "c", "d"])}
    log = HoleLog("B1", "m", [LogPart(0, 8, "Sand", SAND)], values=values(**columns))
    assert log.curves() == ["GR (GAPI)"]
    lines = [item.points for item in drawn(log) if isinstance(item, Line) and item.width == 0.7]
    assert [len(line) for line in lines] == [4, 4]  # a gap from 3 to 5
    across = np.concatenate(lines)[:, 0][::2]
    assert (across - across[0]) / np.ptp(across) == pytest.approx([0.0, 0.25, 0.75, 1.0])
    first, last = lines[0][0, 1], lines[1][-1, 1]
    assert first - lines[0][-1, 1] == pytest.approx((first - last) * 3 / 8)


def test_a_log_of_curves_alone_and_of_nothing():
    assert drawn(HoleLog("B1", "m")) == []
    items = drawn(HoleLog("B1", "m", values=values(GR=np.array([1.0, np.nan, 3.0, 3.0]))))
    assert sum(isinstance(item, Line) and item.width == 0.7 for item in items) == 2
    many = {f"c{number}": np.arange(4.0) for number in range(9)}
    assert len(HoleLog("B1", "m", values=values(**many)).curves()) == 4
    same = drawn(HoleLog("B1", "m", values=values(GR=np.full(4, 2.0))))
    assert all(np.isfinite(item.points).all() for item in same if isinstance(item, Line))
