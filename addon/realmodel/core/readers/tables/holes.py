# SPDX-License-Identifier: GPL-3.0-or-later
"""The collars and the paths of boreholes: straight, surveyed, or along the trajectory of a deviated one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...base.algebra import atan2, cos, sin
from ...base.errors import InputRefused, number_list
from ...settings.data_files import Boreholes
from .hole_data import HoleTables
from .hole_tables import Row

Direction = tuple[float, float, float]  # of length 1: to the east, to the north, down
_STRAIGHT = 1e-12  # radians


def direction(inclination: float, azimuth: float) -> Direction:
    """inclination: degrees from the vertical, 0 straight down, 90 level, 180 straight up. azimuth: degrees
    clockwise from north (+y)."""
    tilt, turn = np.radians(inclination), np.radians(azimuth % 360.0)
    return sin(tilt) * sin(turn), sin(tilt) * cos(turn), cos(tilt)


class WellTrajectory:
    """A borehole by minimum curvature: between two stations, where its direction is known, it is the arc of a
    circle that has these directions at its ends; above the first and below the last it is straight.

    Taylor and Mason 1972, *A systematic approach to well surveying calculations*, SPE Journal 12; Sawaryn
    and Thorogood 2005, *A compendium of directional calculations based on the minimum curvature method*,
    SPE Drilling & Completion 20, section "Interpolation".
    """

    def __init__(self, depths: Sequence[float], directions: Sequence[Direction]):
        """depths (N,), N > 0: along the hole from its collar, each greater than the one before it.
        directions (N, 3): of length 1, no two neighbors opposite to each other."""
        self._depths = np.array(depths, float)
        self._directions = np.array(directions, float).reshape(-1, 3)
        begin, end = self._directions[:-1], self._directions[1:]
        self._doglegs = dogleg_angles(begin, end)
        self._doglegs[self._doglegs < _STRAIGHT] = 0.0
        across = end - (begin * end).sum(axis=1, keepdims=True) * begin
        length = np.linalg.norm(across, axis=1, keepdims=True)
        self._across = np.divide(across, length, out=np.zeros_like(across), where=length > _STRAIGHT)
        self._starts = np.empty_like(self._directions)  # from the collar to each station
        self._starts[0] = self._depths[0] * self._directions[0]
        for n, length in enumerate(np.diff(self._depths)):
            self._starts[n + 1] = self._starts[n] + self._along(n, length)

    @property
    def is_vertical(self) -> bool:
        """Whether the hole is vertical, up to the precision of survey tables."""
        return bool((np.abs(self._directions - (0.0, 0.0, 1.0)) < 1e-9).all())

    def offset(self, depth: float) -> np.ndarray:
        """(3,) how far to the east, to the north and down from the collar a depth along the hole is."""
        n = max(int(np.searchsorted(self._depths, depth, side="right")) - 1, 0)
        if n == len(self._depths) - 1 or depth <= self._depths[0]:
            return self._starts[n] + (depth - self._depths[n]) * self._directions[n]
        return self._starts[n] + self._along(n, depth - self._depths[n])

    def _along(self, n: int, length: float) -> np.ndarray:
        """The way of this length from station n toward the next one."""
        turned = self._doglegs[n] * length / (self._depths[n + 1] - self._depths[n])
        # (1 - cos t) / t = t / 2 (sin(t / 2) / (t / 2))^2
        sideways = turned / 2 * _sin_by(turned / 2) ** 2 * self._across[n]
        return length * (_sin_by(turned) * self._directions[n] + sideways)


class KnownLine:
    """A borehole whose ways (N, 3) from the collar are known by their depths (N,): straight between them."""

    def __init__(self, depths: np.ndarray, ways: np.ndarray):
        self._depths, first = np.unique(depths, return_index=True)
        self._ways = ways[first] * (1.0, 1.0, -1.0)
        self.is_vertical = not self._ways[:, :2].any()

    def offset(self, depth: float) -> np.ndarray:
        """(3,) as of a WellTrajectory."""
        return np.array([np.interp(depth, self._depths, way) for way in self._ways.T])


def _sin_by(x: float) -> float:
    """sin(x) / x."""
    return sin(x) / x if x else 1.0


def dogleg_angles(begin: ArrayLike, end: ArrayLike) -> np.ndarray:
    """(...) the angles in radians between directions (..., 3) of length 1; as exact for small ones as for
    large."""
    begin, end = np.asarray(begin, float), np.asarray(end, float)
    return 2 * atan2(np.linalg.norm(begin - end, axis=-1), np.linalg.norm(begin + end, axis=-1))


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
    def of_survey(cls, tables: HoleTables) -> HoleDirections:
        """The stations of a survey table. Raises InputRefused naming the line."""
        directions = cls(tables.boreholes)
        for row in tables.survey or ():
            depth = row.number("depth")
            if depth < 0:
                raise row.refuse(f"depth is {depth:g}", "depths count from the collar along the hole")
            directions.add(row, depth, row.text("hole"))
        if not directions._stations:
            raise InputRefused("there are no directions in it", file=tables.boreholes.survey)
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
                        f"dip is {station.angle:g}, and {first.angle:g} in {first.row.place}",
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
                    f"{station.row.file}: {station.row.place}: hole '{hole}' turns by {bend:.0f} "
                    f"degrees between depths {depths[-1]:g} and {station.depth:g}: check its angles"
                )
            depths.append(station.depth)
            directions.append(towards)
        return WellTrajectory(depths, directions)


def _direction(station: _Station, sign: float) -> Direction:
    if "inclination" in station.row.columns:
        return direction(station.angle, station.azimuth)
    return direction(90.0 - sign * station.angle, station.azimuth)


def end_of(collar: Row) -> float:
    """The depth at which the hole of a row of collars ends; NaN where it is not known."""
    name = next((name for name in ("end", "depth") if collar.has(name)), None)
    return float("nan") if name is None else collar.number(name)


def is_inclined(row: Row) -> bool:
    """Whether an angle of a row, in any convention, shows that the hole is not vertical."""
    for name in ("dip", "inclination"):
        if row.has(name):
            entry = row.text(name).replace(",", ".")
            try:
                return float(entry) not in _VERTICAL
            except ValueError:
                return False
    return False


class Holes:
    """The collars and the paths of holes, of tables that are repaired."""

    def __init__(self, tables: HoleTables):
        self.given = tables.boreholes
        self._inclined: dict[str, None] = {}  # holes that are not vertical, by an angle alone
        self._without_survey: dict[str, None] = {}
        self._paths: dict[str, WellTrajectory | KnownLine] = {}
        self._warnings: list[str] = []
        self._is_of_objects = tables.lines is not None
        self.ends: dict[str, float] = {}  # depths along holes, as far as the collars say
        self._collars = None if tables.collars is None else self._read_collars(tables.collars)
        said = {row.text("hole") for row in (*(tables.picks or ()), *(tables.intervals or ()))}
        self._unused = set(self._collars or ()) - said
        self._surveyed: set[str] = set()
        if tables.survey is not None:
            directions = HoleDirections.of_survey(tables)
            surveyed = directions.paths()
            self._warnings += directions.warnings
            self._surveyed = set(surveyed)
            self._paths |= surveyed
        for hole, (depths, places) in (tables.lines or {}).items():
            if self._collars is not None and hole in self._collars:
                self._paths[hole] = KnownLine(depths, places - self._collars[hole])

    def _read_collars(self, rows: list[Row]) -> dict[str, tuple[float, float, float]]:
        collars: dict[str, tuple[float, float, float]] = {}
        directions = HoleDirections(self.given)
        for row in rows:
            hole = row.text("hole")
            collars[hole] = (row.number("x"), row.number("y"), row.number("z"))
            if np.isfinite(end := end_of(row)):
                self.ends[hole] = end
            if row.has("azimuth") and (row.has("dip") or row.has("inclination")):
                directions.add(row, 0.0, hole)
            elif is_inclined(row):
                self._inclined[hole] = None
        self._paths |= directions.paths()
        return collars

    def place(self, row: Row, depth: float, scale: np.ndarray) -> np.ndarray:
        """(3,) the place at a depth along a row's hole. scale: (3,) to the unit of the model."""
        # Depths, and horizontal offsets along a hole, are in the unit of z.
        way = self.way_to(row, depth) * (1.0, 1.0, -1.0) * (scale[2] / scale)
        return (self.begin_of(row) + way) * scale

    def begin_of(self, row: Row) -> np.ndarray:
        """(3,) the collar of a row's hole, in the units of the tables; its height is NaN where it is not
        known."""
        if self._collars is not None:
            return np.array(self._collars[row.text("hole")])
        for column in ("x", "y"):
            if column not in row.columns:
                advice = "give the table of collars = ..., or the columns of x and y"
                raise row.refuse(f"the table has no column {column}", advice)
        has_depth = any(row.has(column) for column in ("depth", "from", "to"))
        z = row.number("z") if "z" in row.columns and has_depth else float("nan")
        if np.isnan(z) and has_depth:
            raise row.refuse("a depth needs the collar's elevation", "give a column z, or a table of collars")
        return np.array((row.number("x"), row.number("y"), z))

    def way_to(self, row: Row, depth: float) -> np.ndarray:
        """(3,) how far to the east, to the north and down from the collar a depth in a row's hole is."""
        hole = row.text("hole")
        path = self._paths.get(hole)
        if path is None:
            if self.given.survey is not None:
                self._without_survey[hole] = None
            elif is_inclined(row):
                self._inclined[hole] = None
            return np.array((0.0, 0.0, depth))
        column = "depth" if "depth" in row.columns else "from"
        if row.called(column) == "tvd" and not path.is_vertical:
            what = f"hole '{hole}' is not vertical, and TVD is a vertical depth"
            raise row.refuse(what, "give the depth along the hole (MD)")
        return path.offset(depth)

    def place_at(self, row: Row, column: str, scale: np.ndarray) -> tuple[np.ndarray, float]:
        """(3,) the place of a row with an elevation, and its depth, NaN where the height of the collar, or
        the way there, is not known. Refuses an elevation that does not determine the position in the hole."""
        begin = self.begin_of(row)
        if self._is_of_objects:
            return np.array([row.number(axis) for axis in "xyz"]) * scale, float("nan")
        self._refuse_deviated(row)
        place = np.array([begin[0], begin[1], row.number(column)]) * scale
        return place, float(begin[2] * scale[2] - place[2])

    def _refuse_deviated(self, row: Row) -> None:
        path = self._paths.get(row.text("hole"))
        if self._collars is not None and path is not None and not path.is_vertical:
            what = f"hole '{row.text('hole')}' is not vertical: an elevation does not say where the pick is"
            raise row.refuse(
                what, "give the depth along the hole, or x, y and elevation of each pick and no collars"
            )

    def warnings(self) -> list[str]:
        warnings = list(self._warnings)
        inclined = [hole for hole in self._inclined if hole not in self._paths]
        if inclined:
            warnings.append(
                f"{self.given.collars or self.given.files[-1]}: {number_list(inclined)} are not vertical, "
                "but are taken as vertical: add the azimuth, a survey, or x, y and elevation of each pick"
            )
        if self._without_survey:
            names = number_list(self._without_survey)
            warnings.append(f"{self.given.survey}: no direction for {names}: taken as vertical")
        if self._unused and (self.given.picks or self.given.intervals):
            what = "picks" if self.given.intervals is None else "picks or intervals"
            what = "intervals" if self.given.picks is None else what
            warnings.append(f"{self.given.collars}: no {what} for {number_list(sorted(self._unused))}")
        if self._collars is not None and (strangers := sorted(self._surveyed - set(self._collars))):
            warnings.append(
                f"{self.given.survey}: {number_list(strangers)} have no collar in {self.given.collars}"
            )
        return warnings
