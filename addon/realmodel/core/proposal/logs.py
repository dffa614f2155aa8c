# SPDX-License-Identifier: GPL-3.0-or-later
"""The units along boreholes, as the readers of projects give them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.errors import InputRefused, counted
from ..base.text import no_step
from ..base.units import MODEL_UNIT
from ..readers.borehole_input import read_picks, read_repaired
from ..readers.tables.hole_data import HoleTables
from ..readers.tables.hole_tables import Row, normalized_name
from ..readers.tables.observations import Observations
from ..readers.tables.unit_names import UnitNames, may_be_a_unit
from ..settings.data_files import Boreholes

_NONE: Mapping[str, str] = {}


@dataclass(frozen=True)
class LoggedPart:
    """A unit along a hole, from a place above to a place below (3,), model units, with the depths of these
    below the collar (NaN where they are not known)."""

    unit: str
    top: np.ndarray
    bottom: np.ndarray
    depth: float
    end: float

    @property
    def thickness(self) -> float:
        return float(self.top[2] - self.bottom[2])

    @property
    def middle(self) -> float:
        return float(self.top[2] + self.bottom[2]) / 2


@dataclass
class Log:
    """The parts of a hole, from above downward; no two in a row are of one unit. collar: (3,) or None."""

    hole: str
    parts: list[LoggedPart]
    collar: np.ndarray | None = None

    @property
    def plan(self) -> np.ndarray:
        """(2,) where the hole is in plan: its collar, or the top of what is known."""
        return (self.parts[0].top if self.collar is None else self.collar)[:2]


@dataclass
class HoleLogs:
    """logs: by name of the hole. boreholes: their source, with the choices made. picks: of each surface that
    picks name (N, 3). system: the coordinate system, as of HoleTables. is_in_its_unit: whether their places
    are in the unit of the file. warnings: sentences.
    """

    logs: list[Log]
    boreholes: Boreholes
    picks: dict[str, np.ndarray] = field(default_factory=dict)
    pick_orders: list[list[tuple[str, float]]] = field(default_factory=list)
    system: str = ""
    is_in_its_unit: bool = True
    warnings: list[str] = field(default_factory=list)

    @property
    def units(self) -> list[str]:
        """The units of the logs, by name."""
        return sorted({part.unit for log in self.logs for part in log.parts})

    @property
    def places(self) -> np.ndarray:
        """(N, 3) all ends of parts, picks and collars."""
        ends = [place for log in self.logs for part in log.parts for place in (part.top, part.bottom)]
        collars = [log.collar for log in self.logs if log.collar is not None]
        return np.vstack([np.array([*ends, *collars]).reshape(-1, 3), *self.picks.values()])


def read_logs(given: Boreholes, units: str = MODEL_UNIT, meanings: Mapping[str, str] = _NONE) -> HoleLogs:
    """The logs and picks of boreholes, read as a project reads them, in order of their names. meanings: as
    `names` of UnitNames. Raises InputRefused naming file and line."""
    tables = read_repaired(given, units)
    named = UnitNames(names=meanings)
    short_codes, warnings = _short_codes(tables.intervals or (), named)
    names = _unit_names(_codes(tables), UnitNames(tuple(short_codes), names=meanings))
    picks = read_picks(given, units, no_step, UnitNames(names, names, names=meanings))
    logs: list[Log] = []
    for observations in picks.observations:
        for hole in sorted(set(observations.holes.tolist())):
            chosen = np.flatnonzero((observations.holes == hole) & observations.in_use)
            collar = picks.holes.get(hole, (None, []))[0]
            if collar is not None and not np.isfinite(collar).all():
                collar = None
            parts = _parts(observations.some(chosen))
            if parts:
                logs.append(Log(hole, parts, collar))
    orders = [
        [(name, float(place[2])) for name, place in tops]
        for hole, (_, tops) in sorted(picks.holes.items())
        if not any(log.hole == hole for log in logs)
    ]
    if not logs and not picks.of_surfaces:
        advice = 'name the column of units: columns = { block = "..." }, or --block'
        raise InputRefused("no unit is known in any hole", file=given.files[-1], advice=advice)
    if tables.block_column:
        given = replace(given, columns={**given.columns, "block": tables.block_column})
    scale = tables.scale(units)[0] * tables.factors.get("collars", {}).get("x", 1.0)
    texts = [*picks.warnings, *warnings]
    return HoleLogs(logs, given, picks.points, orders, tables.system, scale == 1.0, texts)


def _short_codes(intervals: Iterable[Row], named: UnitNames) -> tuple[set[str], list[str]]:
    """Of the codes that may mean lost core or a unit those that are units: in half of the holes or more where
    they occur nothing else lies at the end, where there is no reason to log core that is not there. With
    warnings of how all of them are taken; but for those that are `named`."""
    last: dict[str, Row] = {}
    holes: dict[str, set[str]] = {}
    for row in intervals:
        hole, code = row.text("hole"), row.text("block")
        if hole not in last or row.number("to") > last[hole].number("to"):
            last[hole] = row
        if may_be_a_unit(code) and code not in named.names:
            holes.setdefault(code, set()).add(hole)
    units, warnings = set(), []
    for code, within in sorted(holes.items()):
        ends = sum(last[hole].text("block") == code for hole in within)
        if 2 * ends >= len(within):
            units.add(code)
            how = f"a unit: it is the lowest of {counted(ends, 'hole')}"
            advice = f'if it is lost core, write names = {{ {code} = "" }} and take its surface out'
        else:
            how = f"lost core in {counted(len(within), 'hole')}"
            advice = "if it is a unit, give it a surface with a block of this name"
        warnings.append(f"'{code}' is treated as {how}; {advice}")
    return units, warnings


def _codes(tables: HoleTables) -> list[str]:
    """What the tables write in the columns of units."""
    named = (
        *((row, "block") for row in tables.intervals or ()),
        *((row, "surface") for row in tables.picks or ()),
    )
    return [row.text(column) for row, column in named if row.has(column)]


def _unit_names(codes: Iterable[str], known: UnitNames) -> list[str]:
    """The names of units: of spellings that differ in capitals, spaces and hyphens alone the commonest.
    known: what codes mean that are not their own names."""
    count = Counter(known.meaning(code).strip() for code in codes if not known.says_nothing(code))
    names: dict[str, str] = {}
    meant = set(known.names.values())
    for code in sorted(count, key=lambda code: (code not in meant, -count[code], code)):
        names.setdefault(normalized_name(code), code)
    return sorted(names.values())


def _parts(observations: Observations) -> list[LoggedPart]:
    """The parts of one hole, of the places of its intervals. Those of one unit that touch are one."""
    parts: list[LoggedPart] = []
    for number in np.unique(observations.intervals):
        at = np.flatnonzero(observations.intervals == number)
        first, last = at[np.argmin(observations.depths[at])], at[np.argmax(observations.depths[at])]
        places, depths = observations.places, observations.depths
        unit = str(observations.blocks[first])
        parts.append(LoggedPart(unit, places[first], places[last], float(depths[first]), float(depths[last])))
    parts.sort(key=lambda part: part.depth)
    return merged(parts)


def merged(parts: Sequence[LoggedPart]) -> list[LoggedPart]:
    """Parts of which those of one unit that follow one another are one."""
    joined: list[LoggedPart] = []
    for part in parts:
        if joined and joined[-1].unit == part.unit:
            last = joined.pop()
            part = LoggedPart(part.unit, last.top, part.bottom, last.depth, part.end)
        joined.append(part)
    return joined
