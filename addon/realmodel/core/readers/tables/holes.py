# SPDX-License-Identifier: GPL-3.0-or-later
"""The collars and the paths of boreholes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.text import no_step
from ...settings.boreholes import Boreholes
from .hole_directions import HoleDirections, is_inclined
from .hole_tables import COLLARS, Row, joined, rows
from .observations import LeftOut
from .well_trajectory import WellTrajectory


class Holes:
    """The collars and the paths of holes."""

    def __init__(self, given: Boreholes):
        self.given = given
        self._inclined: dict[str, None] = {}  # holes that are not vertical, by an angle alone
        self._without_survey: dict[str, None] = {}
        self._paths: dict[str, WellTrajectory] = {}
        self._warnings: list[str] = []
        self._incomplete: dict[str, str] = {}  # holes whose collars are without a number: what they lack
        self._written: dict[
            str, dict[str, None]
        ] = {}  # names of holes with collars that are alike if `joined`
        self._taken: dict[tuple[str, str, str], None] = {}  # (file, name in it, the hole that it means)
        self.ends: dict[str, float] = {}  # depths along holes, as far as the collars say
        self._collars = None if given.collars is None else self._read_collars()
        for hole in self._collars or ():
            self._written.setdefault(joined(hole), {})[hole] = None
        self._unused = set(self._collars or ())
        self._surveyed: set[str] = set()
        if given.survey is not None:
            directions = HoleDirections.of_survey(given, self.hole_of)
            surveyed = directions.paths()
            self._warnings += directions.warnings
            self._surveyed = set(surveyed)
            self._paths |= surveyed

    def _read_collars(self) -> dict[str, tuple[float, float, float]]:
        collars: dict[str, tuple[float, float, float]] = {}
        directions = HoleDirections(self.given)
        assert self.given.collars is not None
        for row in rows(self.given, Path(self.given.collars), COLLARS, ("hole", "x", "y", "z"), no_step):
            hole = row.text("hole")
            lacking = [axis for axis in "xyz" if not row.has(axis)]
            if lacking:
                self._incomplete[hole] = f"line {row.line} of {self.given.collars} has no {lacking[0]}"
                continue
            place = (row.number("x"), row.number("y"), row.number("z"))
            is_repeated = hole in collars
            end = next((name for name in ("end", "depth") if row.has(name)), None)
            if end is not None:
                self.ends[hole] = row.number(end)
            if collars.setdefault(hole, place) != place:
                raise row.refuse(f"hole '{hole}' has two collars", "give each hole one")
            if row.has("azimuth") and (row.has("dip") or row.has("inclination")):
                directions.add(row, 0.0, hole)
            elif is_inclined(row) and not is_repeated:
                self._inclined[hole] = None
        if not collars:
            what = next(iter(self._incomplete.values()), "there are no holes in it")
            raise InputRefused(what, file=self.given.collars)
        self._paths |= directions.paths()
        return collars

    def hole_of(self, row: Row) -> str:
        """The name of a row's hole, as the collars have it where it is one of theirs: they may write it with
        other capitals, spaces, hyphens or underscores."""
        hole = row.text("hole")
        if self._collars is None or hole in self._collars:
            return hole
        alike = list(self._written.get(joined(hole), ()))
        if len({self._collars[name] for name in alike}) != 1:
            return hole
        self._taken[str(row.table.file), hole, alike[0]] = None
        return alike[0]

    def lacks_collar(self, row: Row) -> str:
        """Why the place of a row's hole is not known; "" where it is."""
        hole = self.hole_of(row)
        self._unused.discard(hole)
        if self._collars is None or hole in self._collars:
            return ""
        return self._incomplete.get(hole, f"it has no collar in {self.given.collars}")

    def without_collar(self, row: Row, depth: float | None, code: str) -> LeftOut | None:
        """What a row says, where its hole has no collar; None where it has one. depth, code: of the row."""
        if not (lacks := self.lacks_collar(row)):
            return None
        hole, at = self.hole_of(row), "" if depth is None else f" at {depth:.9g}"
        text = f"line {row.line}, hole '{hole}'{at}, '{code}': {lacks}"
        return LeftOut("no_collar", text, code, hole, depth)

    def refuse_all(self, row: Row) -> InputRefused:
        """That of a table no hole has a collar. row: its first."""
        what = f"no hole of it has a collar in {self.given.collars}, as hole '{row.text('hole')}'"
        return row.refuse(what, "check how holes are written")

    def place(self, row: Row, depth: float, scale: np.ndarray) -> np.ndarray:
        """(3,) the place at a depth along a row's hole. scale: (3,) to the unit of the model."""
        # Depths, and horizontal offsets along a hole, are in the unit of z.
        way = self.way_to(row, depth) * (1.0, 1.0, -1.0) * (scale[2] / scale)
        return (self.begin_of(row) + way) * scale

    def begin_of(self, row: Row) -> np.ndarray:
        """(3,) the collar of a row's hole, in the units of the tables; its height is NaN where it is not
        known."""
        if self._collars is not None:
            return np.array(self._collars[self.hole_of(row)])
        for column in ("x", "y"):
            if column not in row.columns:
                advice = "give the table of collars = ..., or the columns of x and y"
                raise row.refuse(f"the table has no column {column}", advice)
        has_depth = any(row.has(column) for column in ("depth", "from", "to"))
        z = row.number("z") if "z" in row.columns and has_depth else float("nan")
        if np.isnan(z) and has_depth:
            raise row.refuse("a depth needs the collar's height", "give a column z, or a table of collars")
        return np.array((row.number("x"), row.number("y"), z))

    def way_to(self, row: Row, depth: float) -> np.ndarray:
        """(3,) how far to the east, to the north and down from the collar a depth in a row's hole is."""
        hole = self.hole_of(row)
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

    def refuse_deviated(self, row: Row) -> None:
        """Refuses an elevation that does not determine the position in the hole."""
        path = self._paths.get(self.hole_of(row))
        if self._collars is not None and path is not None and not path.is_vertical:
            what = f"hole '{row.text('hole')}' is not vertical: an elevation does not say where the pick is"
            raise row.refuse(
                what, "give the depth along the hole, or x, y and elevation of each pick and no collars"
            )

    def warnings(self) -> list[str]:
        warnings = list(self._warnings)
        for file in dict.fromkeys(file for file, _, _ in self._taken):
            taken = [f"'{name}' for '{hole}'" for path, name, hole in self._taken if path == file]
            warnings.append(f"{file}: holes are taken for those with collars: {number_list(taken)}")
        if incomplete := [hole for hole in self._incomplete if hole not in (self._collars or ())]:
            names = number_list(incomplete)
            warnings.append(f"{self.given.collars}: holes without x, y or z, which are not used: {names}")
        inclined = [hole for hole in self._inclined if hole not in self._paths]
        if inclined:
            warnings.append(
                f"{self.given.collars or self.given.files[-1]}: {number_list(inclined)} are not vertical, "
                "but are taken as vertical: add the azimuth, a survey, or x, y and elevation of each pick"
            )
        if self._without_survey:
            names = number_list(self._without_survey)
            warnings.append(f"{self.given.survey}: no direction for {names}: taken as vertical")
        if self._unused:
            what = "picks" if self.given.intervals is None else "picks or intervals"
            what = "intervals" if self.given.picks is None else what
            warnings.append(f"{self.given.collars}: no {what} for {number_list(sorted(self._unused))}")
        if self._collars is not None and (strangers := sorted(self._surveyed - set(self._collars))):
            warnings.append(
                f"{self.given.survey}: {number_list(strangers)} have no collar in {self.given.collars}"
            )
        return warnings
