# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of surfaces from tables of boreholes: collars, and the depths of picks."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.text import Step, no_step
from ...settings.boreholes import Boreholes
from .hole_directions import HoleDirections, is_inclined
from .hole_tables import COLLARS, NO_VALUE, Row, rows
from .well_trajectory import WellTrajectory


@dataclass
class Picks:
    """points by surface name, (P, 3) float64; holes: of each hole by name its collar (3,), where it is known,
    and (surface, place (3,)) of its picks, the highest first; warnings, sentences."""

    points: dict[str, np.ndarray] = field(default_factory=dict)
    holes: dict[str, tuple[np.ndarray | None, list[tuple[str, np.ndarray]]]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def read_borehole_tables(given: Boreholes, step: Step, scale: np.ndarray) -> Picks:
    """The points of every surface that the picks name, in the order of the table. scale (3,): the factors to
    the model's unit.

    Holes of which a survey, or the table of collars, has the directions go their way by minimum curvature
    (WellTrajectory); all others are vertical, with a warning where a table says otherwise. Rows without a
    depth are left out with a warning: the hole did not reach the surface.
    Raises InputRefused naming file and line.
    """
    holes = _Holes(given)
    found: dict[str, list] = {}
    met: dict[str, tuple] = {}
    missing = 0
    for row in rows(given, Path(given.picks), COLLARS, ("hole", "surface"), step):
        begin = holes.begin_of(row)
        name = row.text("surface")
        if not name:
            raise row.refuse("the surface has no name")
        column = _depth_column(row)
        if row.text(column).lower() in NO_VALUE:
            missing += 1
            continue
        if column == "depth":
            # Depths, and horizontal offsets along a hole, are in the unit of z.
            way = holes.way_to(row) * (1.0, 1.0, -1.0) * (scale[2] / scale)
            place = (begin + way) * scale
        else:
            holes.refuse_deviated(row)
            place = (begin[0], begin[1], row.number(column)) * scale
        found.setdefault(name, []).append(place)
        collar = begin * scale if np.isfinite(begin).all() else None
        met.setdefault(row.text("hole"), (collar, []))[1].append((name, place))
    if not found:
        raise InputRefused("there are no picks in it", file=given.picks)
    picks = Picks({name: np.array(places) for name, places in found.items()}, met)
    for _, places in met.values():
        places.sort(key=lambda pick: -pick[1][2])
    if missing:
        picks.warnings.append(f"{given.picks}: {missing} picks have no depth and are left out")
    picks.warnings += holes.warnings()
    return picks


class _Holes:
    """The collars and the paths of holes."""

    def __init__(self, given: Boreholes):
        self._given = given
        self._inclined: dict[str, None] = {}  # holes that are not vertical, by an angle alone
        self._without_survey: dict[str, None] = {}
        self._paths: dict[str, WellTrajectory] = {}
        self._warnings: list[str] = []
        self._collars = None if given.collars is None else self._read_collars()
        self._unused = set(self._collars or ())
        self._surveyed: set[str] = set()
        if given.survey is not None:
            directions = HoleDirections.of_survey(given)
            surveyed = directions.paths()
            self._warnings += directions.warnings
            self._surveyed = set(surveyed)
            self._paths |= surveyed

    def _read_collars(self) -> dict[str, tuple[float, float, float]]:
        collars: dict[str, tuple[float, float, float]] = {}
        directions = HoleDirections(self._given)
        assert self._given.collars is not None
        for row in rows(self._given, Path(self._given.collars), COLLARS, ("hole", "x", "y", "z"), no_step):
            hole = row.text("hole")
            place = (row.number("x"), row.number("y"), row.number("z"))
            known = hole in collars
            if collars.setdefault(hole, place) != place:
                raise row.refuse(f"hole '{hole}' has two collars", "give each hole one")
            if row.has("azimuth") and (row.has("dip") or row.has("inclination")):
                directions.add(row, 0.0)
            elif is_inclined(row) and not known:
                self._inclined[hole] = None
        if not collars:
            raise InputRefused("there are no holes in it", file=self._given.collars)
        self._paths |= directions.paths()
        return collars

    def begin_of(self, row: Row) -> np.ndarray:
        """(3,) the collar of a row's hole, in the units of the tables; its height is NaN where it is not
        known."""
        hole = row.text("hole")
        self._unused.discard(hole)
        if self._collars is not None:
            if hole not in self._collars:
                what = f"hole '{hole}' has no collar in {self._given.collars}"
                raise row.refuse(what, "check how it is written")
            return np.array(self._collars[hole])
        for column in ("x", "y"):
            if column not in row.columns:
                advice = "give the table of collars = ..., or the columns of x and y"
                raise row.refuse(f"the table has no column {column}", advice)
        z = row.number("z") if "z" in row.columns and "depth" in row.columns else float("nan")
        if np.isnan(z) and row.has("depth"):
            raise row.refuse("a depth needs the collar's height", "give a column z, or a table of collars")
        return np.array((row.number("x"), row.number("y"), z))

    def way_to(self, row: Row) -> np.ndarray:
        """(3,) how far to the east, to the north and down from the collar the depth of a row is."""
        hole, depth = row.text("hole"), row.number("depth")
        path = self._paths.get(hole)
        if path is None:
            if self._given.survey is not None:
                self._without_survey[hole] = None
            elif is_inclined(row):
                self._inclined[hole] = None
            return np.array((0.0, 0.0, depth))
        if row.called("depth") == "tvd" and not path.is_vertical:
            what = f"hole '{hole}' is not vertical, and TVD is a vertical depth"
            raise row.refuse(what, "give the depth along the hole (MD)")
        return path.offset(depth)

    def refuse_deviated(self, row: Row) -> None:
        """Refuses an elevation that does not determine the position in the hole."""
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
                f"{self._given.collars or self._given.picks}: {number_list(inclined)} are not vertical, but "
                "are taken as vertical: add the azimuth, a survey, or x, y and elevation of "
                "each pick"
            )
        if self._without_survey:
            names = number_list(self._without_survey)
            warnings.append(f"{self._given.survey}: no direction for {names}: taken as vertical")
        if self._unused:
            warnings.append(f"{self._given.collars}: no picks for {number_list(sorted(self._unused))}")
        if self._collars is not None and (strangers := sorted(self._surveyed - set(self._collars))):
            warnings.append(
                f"{self._given.survey}: {number_list(strangers)} have no collar in {self._given.collars}"
            )
        return warnings


def _depth_column(row: Row) -> str:
    """The column with the position of a pick."""
    for column in ("depth", "elevation", "z"):
        if column in row.columns:
            return column
    raise row.refuse("the table has neither a column for depth nor one for elevation")
