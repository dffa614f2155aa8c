# SPDX-License-Identifier: GPL-3.0-or-later
"""The directions of boreholes, from a survey or from the table of collars."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...settings.boreholes import Boreholes
from .hole_tables import SURVEY, Row, rows
from .well_trajectory import Direction, WellTrajectory, direction, dogleg_angles

_VERTICAL = (0.0, 90.0, -90.0)  # dips and inclinations by one convention or another
_SHARP = 45.0  # degrees between two stations: holes do not bend so, tables with a slip do
_OPPOSITE = 179.9


@dataclass(frozen=True)
class _Station:
    row: Row
    depth: float
    angle: float  # from the vertical, or a dip, from the horizontal
    azimuth: float


class HoleDirections:
    """Survey stations of holes, gathered from the rows of one table.

    The sign of downward dips is known only when all rows are read.
    """

    def __init__(self, given: Boreholes):
        self._given = given
        self._stations: dict[str, list[_Station]] = {}
        self.warnings: list[str] = []

    @classmethod
    def of_survey(
        cls, given: Boreholes, hole_of: Callable[[Row], str], step: Step = no_step
    ) -> HoleDirections:
        """The stations of a survey table. hole_of: the hole of a row. Raises InputRefused naming the line."""
        directions = cls(given)
        assert given.survey is not None
        for row in rows(given, Path(given.survey), SURVEY, ("hole", "depth", "azimuth"), step):
            depth = row.number("depth")
            if depth < 0:
                raise row.refuse(f"depth is {depth:g}", "depths count from the collar along the hole")
            directions.add(row, depth, hole_of(row))
        if not directions._stations:
            raise InputRefused("there are no directions in it", file=given.survey)
        return directions

    def add(self, row: Row, depth: float, hole: str) -> None:
        """A row of a hole, with the columns azimuth, and dip or inclination."""
        name = "inclination" if "inclination" in row.columns else "dip"
        if name not in row.columns:
            raise row.refuse(
                "there is no column for dip (from the horizontal) or inclination (from the vertical)",
                'name it: columns = { dip = "..." }',
            )
        angle = row.number(name)
        if name == "dip" and not -90 <= angle <= 90:
            raise row.refuse(f"dip is {angle:g}", "dip is measured from the horizontal, from -90 to 90")
        if name == "inclination" and not 0 <= angle <= 180:
            raise row.refuse(
                f"inclination is {angle:g}",
                "it is measured from the vertical, 0 to 180; an angle from the horizontal is a dip: "
                f'columns = {{ dip = "{row.called(name)}" }}',
            )
        azimuth = 0.0
        if row.has("azimuth"):
            azimuth = row.azimuth("azimuth")
        elif angle not in ((0.0, 180.0) if name == "inclination" else (90.0, -90.0)):
            raise row.refuse(f"the azimuth is missing where {name} is {angle:g}")
        self._stations.setdefault(hole, []).append(_Station(row, depth, angle, azimuth))

    def paths(self) -> dict[str, WellTrajectory]:
        """The ways of the holes. Raises InputRefused naming the line."""
        sign = self._downward()
        return {hole: self._path(hole, stations, sign) for hole, stations in self._stations.items()}

    def _downward(self) -> float:
        """The sign of downward dips: as given, or that of all dips."""
        said = self._given.downward_dip
        if said is not None:
            return -1.0 if said == "negative" else 1.0
        first: _Station | None = None
        for stations in self._stations.values():
            for station in stations:
                if "inclination" in station.row.columns or station.angle == 0:
                    continue
                first = first or station
                if (station.angle < 0) != (first.angle < 0):
                    raise station.row.refuse(
                        f"dip is {station.angle:g}, and {first.angle:g} in line {first.row.line}",
                        'say which dips point down: downward_dip = "negative" or "positive"',
                    )
        return -1.0 if first is not None and first.angle < 0 else 1.0

    def _path(self, hole: str, stations: list[_Station], sign: float) -> WellTrajectory:
        depths: list[float] = []
        directions: list[Direction] = []
        for station in sorted(stations, key=lambda station: station.depth):
            towards = _direction(station, sign)
            bend = np.degrees(dogleg_angles(directions[-1], towards)) if directions else 0.0
            if depths and depths[-1] == station.depth:
                if bend > 1e-6:
                    what = f"hole '{hole}' has two directions at depth {station.depth:g}"
                    raise station.row.refuse(what, "give each depth once")
                continue
            if bend > _OPPOSITE:
                what = f"hole '{hole}' turns back between depths {depths[-1]:g} and {station.depth:g}"
                raise station.row.refuse(what, "check its angles")
            if bend > _SHARP:
                self.warnings.append(
                    f"{station.row.table.file}: line {station.row.line}: hole '{hole}' turns by {bend:.0f} "
                    f"degrees between depths {depths[-1]:g} and {station.depth:g}: check its angles"
                )
            depths.append(station.depth)
            directions.append(towards)
        return WellTrajectory(depths, directions)


def _direction(station: _Station, sign: float) -> Direction:
    if "inclination" in station.row.columns:
        return direction(station.angle, station.azimuth)
    return direction(90.0 - sign * station.angle, station.azimuth)


def is_inclined(row: Row) -> bool:
    """Whether a row says, by an angle of whatever convention, that the hole is not vertical."""
    for name in ("dip", "inclination"):
        if row.has(name):
            entry = row.text(name).replace(",", ".")
            try:
                return float(entry) not in _VERTICAL
            except ValueError:
                return False
    return False
