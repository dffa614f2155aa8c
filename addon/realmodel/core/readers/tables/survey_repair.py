# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds faults in the stations of surveys, repairs them or leaves them out, and lists them."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable

import numpy as np

from .hole_data import HoleTables
from .hole_problems import LEFT_OUT, REPAIRED, USED, ProblemList
from .hole_tables import Row
from .holes import Direction, direction, dogleg_angles, end_of

_SHARP = 45.0  # degrees between two stations: holes do not bend so
_OPPOSITE = 179.9
_SLIPS = 0.25  # the greatest share of dips whose sign may be a slip


def repair_survey(tables: HoleTables, problems: ProblemList) -> list[Row]:
    """The stations that make sense. Those that none does stay as they are: their reader refuses them."""
    rows = tables.survey or []
    if not rows or "depth" not in rows[0].columns:
        return rows
    angle = "inclination" if "inclination" in rows[0].columns else "dip"
    if angle not in rows[0].columns:
        return rows
    rows = _turned(_with_signs(rows, angle, problems), problems)
    wrong = {n: what for n, row in enumerate(rows) if (what := _wrong(row, angle))}
    if 2 * len(wrong) > len(rows):
        return rows
    for n, what in wrong.items():
        depth = rows[n].number("depth") if rows[n].has("depth") else None
        said = problems.taken(rows[n], "depth", angle, "azimuth")
        problems.note("station", LEFT_OUT, rows[n], said or what, depth)
    rows = [row for n, row in enumerate(rows) if n not in wrong]
    by_hole: dict[str, list[Row]] = {}
    for row in rows:
        by_hole.setdefault(row.text("hole"), []).append(row)
    sign = _downward(tables, rows, angle)
    can_slip = _can_slip(rows, angle, sign)
    ends = {row.text("hole"): end_of(row) for row in tables.collars or ()}
    repaired = []
    for hole, stations in by_hole.items():
        stations = _in_order(stations, problems)
        if can_slip:
            stations = _without_slips(stations, angle, sign, problems)
        stations = _one_each(stations, angle, sign, problems)
        for row in stations:
            if row.number("depth") > ends.get(hole, np.inf) * (1 + 1e-6):
                what = f"the hole ends at {ends[hole]:g}"
                problems.note("below_end", USED, row, what, row.number("depth"))
        repaired += stations
    return repaired


def _with_signs(rows: list[Row], angle: str, problems: ProblemList) -> list[Row]:
    """Inclinations that a minus sign has slipped into are without it."""
    slips = [
        n for n, row in enumerate(rows) if angle == "inclination" and row.has(angle) and row.number(angle) < 0
    ]
    if 4 * len(slips) > len(rows):
        return rows
    rows = list(rows)
    for n in slips:
        value = rows[n].number(angle)
        problems.note("dip_sign", REPAIRED, rows[n], f"inclination is {value:g}", rows[n].number("depth"))
        rows[n] = rows[n].with_values({angle: -value})
    return rows


def _turned(rows: list[Row], problems: ProblemList) -> list[Row]:
    """Azimuths between 0 and 360."""
    turned = []
    for row in rows:
        azimuth = row.number("azimuth") if row.has("azimuth") else 0.0
        if (azimuth < 0 or azimuth > 360) and abs(azimuth) <= 720:
            problems.note("azimuth", REPAIRED, row, f"azimuth is {azimuth:g}", _depth(row))
            row = row.with_values({"azimuth": azimuth % 360.0})
        turned.append(row)
    return turned


def _depth(row: Row) -> float | None:
    return row.number("depth") if row.has("depth") else None


def _wrong(row: Row, angle: str) -> str:
    """Why a station makes no sense; "" where it does."""
    for name in ("depth", angle):
        if not row.has(name):
            return f"it has no {name}"
    depth, value = row.number("depth"), row.number(angle)
    low, high = (0, 180) if angle == "inclination" else (-90, 90)
    if depth < 0:
        return f"depth is {depth:g}"
    if not low <= value <= high:
        return f"{angle} is {value:g}"
    if not row.has("azimuth") and value not in ((0, 180) if angle == "inclination" else (90, -90)):
        return f"the azimuth is missing where {angle} is {value:g}"
    if row.has("azimuth") and abs(row.number("azimuth")) > 720:
        return f"azimuth is {row.number('azimuth'):g}"
    return ""


def _downward(tables: HoleTables, rows: list[Row], angle: str) -> float:
    """The sign of downward dips: as given, or that of most."""
    if tables.boreholes.downward_dip is not None:
        return -1.0 if tables.boreholes.downward_dip == "negative" else 1.0
    dips = np.array([row.number("dip") for row in rows]) if angle == "dip" else np.zeros(1)
    return -1.0 if (dips < 0).sum() > (dips > 0).sum() else 1.0


def _in_order(stations: list[Row], problems: ProblemList) -> list[Row]:
    """The stations of a hole downward; those that stand out of the order are listed. From below upward is an
    order, too."""
    depths = [row.number("depth") for row in stations]
    if depths == sorted(depths) or depths == sorted(depths, reverse=True):
        return sorted(stations, key=lambda row: row.number("depth"))
    in_order = _longest_rise(depths)
    for n, row in enumerate(stations):
        if n not in in_order:
            problems.note("order", REPAIRED, row, "it stands out of the order of depths", depths[n])
    return sorted(stations, key=lambda row: row.number("depth"))


def _longest_rise(values: list[float]) -> set[int]:
    """The numbers of the most values that rise, in their order."""
    tails: list[float] = []
    ends: list[int] = []
    before: list[int] = []
    for n, value in enumerate(values):
        at = bisect_right(tails, value)
        before.append(ends[at - 1] if at else -1)
        tails[at:], ends[at:] = [value, *tails[at + 1 :]], [n, *ends[at + 1 :]]
    rising, last = set(), ends[-1]
    while last >= 0:
        rising.add(last)
        last = before[last]
    return rising


def _towards(row: Row, angle: str, sign: float) -> Direction:
    azimuth = row.number("azimuth") if row.has("azimuth") else 0.0
    value = row.number(angle)
    return direction(value if angle == "inclination" else 90.0 - sign * value, azimuth)


def _bends(row: Row, others: list[Row], towards: Callable[[Row], Direction]) -> float:
    """The greatest angle, in degrees, between a station and others."""
    return max(
        (float(np.degrees(dogleg_angles(towards(row), towards(other)))) for other in others), default=0.0
    )


def _beside(stations: list[Row], n: int) -> list[Row]:
    """The nearest stations above and below one at other depths."""
    depth = stations[n].number("depth")
    above = [row for row in stations[:n] if row.number("depth") < depth][-1:]
    below = [row for row in stations[n + 1 :] if row.number("depth") > depth][:1]
    return above + below


def _can_slip(rows: list[Row], angle: str, sign: float) -> bool:
    """Whether so few dips point upward that they may have the wrong sign."""
    return angle == "dip" and sum(sign * row.number("dip") < 0 for row in rows) <= _SLIPS * len(rows)


def _without_slips(stations: list[Row], angle: str, sign: float, problems: ProblemList) -> list[Row]:
    """Stations whose dips have the sign of those beside them, where the other one would be a sharp bend."""

    def towards(row: Row) -> Direction:
        return _towards(row, angle, sign)

    stations = list(stations)
    for n, row in enumerate(stations):
        dip = row.number("dip")
        if sign * dip >= 0 or not row.has("azimuth"):
            continue
        beside = _beside(stations, n)
        dips = [other.number("dip") for other in beside]
        mended = row.with_values({"dip": -dip})
        bends = [_bends(station, beside, towards) for station in (row, mended)]
        if dips and max(sign * dip for dip in dips) > 0 and bends[0] > _SHARP and bends[1] < 0.5 * bends[0]:
            problems.note(
                "dip_sign", REPAIRED, row, f"dip is {dip:g}, and {dips[0]:g} beside it", row.number("depth")
            )
            stations[n] = mended
    return stations


def _one_each(stations: list[Row], angle: str, sign: float, problems: ProblemList) -> list[Row]:
    """One station at each depth, and none that turns back."""

    def towards(row: Row) -> Direction:
        return _towards(row, angle, sign)

    single: list[Row] = []
    alike: dict[float, list[Row]] = {}
    for row in stations:
        alike.setdefault(row.number("depth"), []).append(row)
    for depth, rows in alike.items():
        best = rows[0]
        if len(rows) > 1:
            beside = _beside(stations, stations.index(best))
            best = min(rows, key=lambda row: _bends(row, beside, towards))
        single.append(best)
        for row in rows:
            if row is best:
                continue
            if _bends(row, [best], towards) > 1e-6:
                what = f"another direction than in {best.place}, which is used"
                problems.note("two_directions", LEFT_OUT, row, what, depth)
            else:
                problems.note("double", REPAIRED, row, f"the station of {best.place} again", depth)
    while len(single) > 1:
        ways = np.array([towards(row) for row in single])
        turns = np.flatnonzero(np.degrees(dogleg_angles(ways[:-1], ways[1:])) > _OPPOSITE)
        if not len(turns):
            break
        n = int(turns[0]) + 1
        if n == 1 and len(single) > 2 and _bends(single[1], single[2:3], towards) < _SHARP:
            n = 0  # the others continue
        depth = single[n].number("depth")
        problems.note("station", LEFT_OUT, single[n], "the hole would turn back here", depth)
        del single[n]
    return single
