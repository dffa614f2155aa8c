# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of surfaces from tables of boreholes: collars, the depths of picks, and logged intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...base.errors import InputRefused
from .hole_data import HoleTables
from .hole_problems import HoleProblem
from .hole_tables import Row
from .holes import Holes
from .interval_values import IntervalValues
from .intervals import read_intervals
from .observations import LeftOut, Observations, Origin, left_out_of
from .unit_names import UnitNames

Pick = tuple[Origin, np.ndarray]  # with its place (3,), model units


@dataclass
class Picks:
    """of_surfaces: where holes met surfaces, by the names of these; holes: of each hole by name its collar
    (3,), where it is known, and (surface, place (3,)) of its picks, and of the tops of its intervals, the
    highest first; warnings, sentences. ends: where holes end (3,), as far as their collars say. observations:
    of the blocks of intervals; left_out: intervals and picks that are not used. switched_off: as points,
    those of rows that are. problems: what was wrong with rows of tables. logs: the curves of LAS files, where
    there are any."""

    of_surfaces: dict[str, list[Pick]] = field(default_factory=dict)
    holes: dict[str, tuple[np.ndarray | None, list[tuple[str, np.ndarray]]]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    ends: dict[str, np.ndarray] = field(default_factory=dict)
    observations: list[Observations] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    switched_off: dict[str, np.ndarray] = field(default_factory=dict)
    logs: IntervalValues | None = None
    problems: list[HoleProblem] = field(default_factory=list)

    @property
    def points(self) -> dict[str, np.ndarray]:
        """(P, 3) float64 the points of each surface, by its name."""
        return {name: np.array([place for _, place in picks]) for name, picks in self.of_surfaces.items()}


def picks_of(holes: Mapping, surface: str) -> list[Pick]:
    """The picks of a surface among those of holes (Picks.holes), whose depths are known where they are
    vertical and have a collar."""
    surface_picks: list[Pick] = []
    for hole, (collar, picks) in holes.items():
        is_below = [collar is not None and tuple(collar[:2]) == tuple(place[:2]) for _, place in picks]
        surface_picks += [
            (Origin(hole, float(collar[2] - place[2]) if below else None), place)
            for (name, place), below in zip(picks, is_below, strict=True)
            if name == surface
        ]
    return surface_picks


def picks_of_tables(
    tables: HoleTables, scale: np.ndarray, units: UnitNames, plan_step: float | None
) -> Picks:
    """The points of every surface that the picks name, in the order of the table, and what intervals say.
    scale (3,): the factors to the model's unit.

    Holes of which a survey, or the table of collars, has the directions go their way by minimum curvature
    (WellTrajectory); all others are vertical, with a warning if a table has an angle. Rows without a depth
    are left out with a warning: the hole did not reach the surface. Intervals of holes without a collar are
    listed, and refused where no hole has one; picks of one are refused. units: what the names of the tables
    mean. plan_step: as of read_intervals. Raises InputRefused naming file and line.
    """
    holes = Holes(tables)
    picks = Picks() if tables.picks is None else _picks(tables.picks, holes, units, scale)
    if tables.intervals is not None:
        logged = read_intervals(tables.intervals, holes, units, scale, plan_step)
        picks.observations.append(logged.observations)
        picks.left_out += logged.left_out
        for name, (collar, tops) in logged.holes.items():
            picks.holes.setdefault(name, (collar, []))[1].extend(tops)
        picks.ends |= logged.ends
    for _, places in picks.holes.values():
        places.sort(key=lambda pick: (-pick[1][2], pick[0]))
    picks.of_surfaces = dict(sorted(picks.of_surfaces.items()))
    picks.ends = dict(sorted(picks.ends.items()))
    picks.holes = dict(sorted(picks.holes.items()))
    picks.problems = tables.problems
    picks.left_out = [*left_out_of(tables.problems), *picks.left_out]
    picks.warnings += [*tables.warnings, *holes.warnings()]
    return picks


def _picks(rows: list[Row], holes: Holes, units: UnitNames, scale: np.ndarray) -> Picks:
    boreholes = holes.given
    points: dict[str, list[Pick]] = {}
    off: dict[str, list[np.ndarray]] = {}
    met: dict[str, tuple] = {}
    ends: dict[str, np.ndarray] = {}
    for row in rows:
        name = units.surface(row.text("surface"))
        column = _depth_column(row)
        if not name or not row.has(column):
            continue
        begin = holes.begin_of(row)
        if column == "depth":
            depth = row.number("depth")
            place, depth = holes.place(row, depth, scale), depth * scale[2]
        else:
            place, depth = holes.place_at(row, column, scale)
        if not row.is_used:
            off.setdefault(name, []).append(place)
            continue
        collar = begin * scale if np.isfinite(begin).all() else None
        hole = row.text("hole")
        source = Origin.of(hole, depth, row.file, row.line)
        points.setdefault(name, []).append((source, place))
        met.setdefault(hole, (collar, []))[1].append((name, place))
        if hole in holes.ends and hole not in ends:
            ends[hole] = holes.place(row, holes.ends[hole], scale)
    if not (points or off):
        raise InputRefused("there are no picks in it", file=boreholes.picks)
    switched_off = {name: np.array(places) for name, places in off.items()}
    return Picks(points, met, ends=ends, switched_off=switched_off)


def _depth_column(row: Row) -> str:
    """The column with the position of a pick."""
    for column in ("depth", "elevation", "z"):
        if column in row.columns:
            return column
    raise row.refuse("the table has neither a column for depth nor one for elevation")
