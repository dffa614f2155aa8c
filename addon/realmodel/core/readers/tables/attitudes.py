# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips as people write them: a strike N30E, a dip 45SE, both in one column as 030/45SE, a direction ESE."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from ...base.errors import number_list
from .hole_tables import Row, TableHeader, column_key
from .table_layout import is_number

_POINTS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
_COMPASS = {point: 22.5 * n for n, point in enumerate(_POINTS)}
_REACH = {1: 90.0, 2: 45.0, 3: 22.5}  # SE is a quadrant, S a half circle
_SURE = 5.0  # degrees by which the angles of one row may differ
_BEARING = re.compile(r"([NS])(\d+(?:\.\d*)?)([EW])")
_WITH_SIDE = re.compile(r"(\d+(?:\.\d*)?)([NESW]{1,3})")
_BOTH = re.compile(r"([^/;|]+)[/;|]([^/;|]+)")
_JOINED = re.compile(r"([NS]\d+(?:\.\d*)?[EW])(\d.*)")  # N30E 45SE
_ANGLES = ("strike", "dip", "dip_direction")
_EITHER = ("attitude", "orientation", "bedding", "measurement", "s0")  # strike or direction
# Names of columns with a dip and its direction, by the angle that is written first.
COMBINED = {
    "strike": ("strike/dip", "strike and dip", *_EITHER),
    "dip_direction": ("dip direction/dip", "dip dir/dip", "dip azimuth/dip", "azimuth/dip", "dd/dip", "Clar"),
    "dip": ("dip/dip direction", "dip/dip dir", "dip/dip azimuth", "dip/azimuth", "dip/dd"),
}
_COMBINED_KEYS = frozenset(column_key(name) for names in COMBINED.values() for name in names)
_EITHER_KEYS = frozenset(map(column_key, _EITHER))


def is_combined(name: str) -> bool:
    """Whether a column of this name has a dip and its direction."""
    return column_key(name) in _COMBINED_KEYS


@dataclass
class DoubtfulDips:
    """contradicting: rows whose angles do not fit one another. without_side: rows of strikes that are
    bearings, of which nothing says to which side they dip."""

    contradicting: list[Row] = field(default_factory=list)
    without_side: list[Row] = field(default_factory=list)

    def warnings(self) -> list[str]:
        """Sentences with the lines of the rows."""
        said = (
            (
                self.contradicting,
                "the dip direction is not at right angles to the strike, or to the other side than in most "
                "rows; it is used, the strike is not",
                "correct it, or set columns = { dip_direction = false }",
            ),
            (
                self.without_side,
                "the strike is a bearing, and nothing says to which side the bed dips: 90 degrees clockwise "
                "from it, by the right-hand rule",
                "write the side behind the dip, as in 45SE",
            ),
        )
        return [
            f"{rows[0].file}: {rows[0].header.row_name}{'s' if len(rows) > 1 else ''} "
            f"{number_list([row.line for row in rows])}: {what}; if that is wrong, {advice}"
            for rows, what, advice in said
            if rows
        ]


@dataclass
class _Attitude:
    """The angles of a row, degrees. line: the azimuth of the strike, to either side if is_bearing. side: the
    direction of a point of the compass, and how far dips to that side are from it at most."""

    dip: float | None = None
    direction: float | None = None
    line: float | None = None
    is_bearing: bool = False
    side: tuple[float, float] | None = None

    def settled(self) -> tuple[float | None, bool]:
        """The dip direction, and whether something in the row contradicts it."""
        if self.direction is not None:
            off = 0.0 if self.side is None else _apart(self.direction, self.side[0]) - self.side[1]
            return self.direction, off > _SURE
        if self.side is None:
            return (None if self.line is None else self.line + 90.0), False
        azimuth, reach = self.side
        if self.line is None:
            return azimuth, False
        nearest = min((self.line + 90.0, self.line - 90.0), key=lambda one: _apart(one, azimuth))
        return nearest, _apart(nearest, azimuth) > reach + _SURE


def with_numbers(rows: Sequence[Row], named: Collection[str] = ()) -> tuple[list[Row], DoubtfulDips]:
    """Rows of dips with their angles as numbers. named: the meanings of columns that the user named. Raises
    InputRefused where it is not clear whether a number is a strike or a dip direction."""
    doubtful, converted, headers = DoubtfulDips(), list[Row](), dict[int, TableHeader]()
    turned: list[tuple[Row, float, bool]] = []
    for row in rows:
        texts = {name: _plain(row.text(name)) for name in _ANGLES if row.has(name)}
        attitude = _Attitude()
        for name, text in texts.items():
            if not _read(attitude, name, text, row, named):
                entry = row.text(name)
                raise row.refuse(
                    f"{name} is not a number: '{entry:.40}'", "write 030 or N30E, and 45 or 45SE"
                )
        if attitude.line is not None and attitude.direction is not None and attitude.dip not in (0.0, 90.0):
            turn = attitude.direction - attitude.line
            turned.append((row, turn, attitude.is_bearing))
        is_whole = texts or not any(is_combined(row.called(name)) for name in _ANGLES if name in row.columns)
        if is_whole and all(row.number_of(name) is not None for name in texts):
            converted.append(row)
        else:
            converted.append(_written(row, attitude, headers, doubtful))
    doubtful.contradicting += _other_strikes(turned)
    doubtful.contradicting.sort(key=lambda row: row.line)
    return converted, doubtful


def _plain(text: str) -> str:
    return re.sub(r"[\s°º]", "", text).upper().replace(",", ".")


def _apart(one: float, other: float) -> float:
    """The angle between two azimuths, degrees."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


def _read(attitude: _Attitude, name: str, text: str, row: Row, named: Collection[str]) -> bool:
    """Adds what a column says to an attitude; False where it cannot be understood."""
    both = _BOTH.fullmatch(text) or _JOINED.fullmatch(text)
    may_be_either = (
        name == "strike" and "strike" not in named and column_key(row.called("strike")) in _EITHER_KEYS
    )
    if both is not None and may_be_either and is_number(both[1]) and is_number(both[2]):
        column = row.called("strike")
        raise row.refuse(
            f"'{text}' is a strike and a dip, or a dip direction and a dip",
            f'say which: columns = {{ strike = "{column}" }} or {{ dip_direction = "{column}" }}',
        )
    if both is None:
        return _read_one(attitude, name, text)
    return _read_one(attitude, name, both[1]) and _read_one(
        attitude, "dip_direction" if name == "dip" else "dip", both[2]
    )


def _read_one(attitude: _Attitude, name: str, text: str) -> bool:
    bearing, with_side = _BEARING.fullmatch(text), _WITH_SIDE.fullmatch(text)
    if name == "dip":
        if with_side is not None and with_side[2] in _COMPASS:
            attitude.side = _COMPASS[with_side[2]], _REACH[len(with_side[2])]
            text = with_side[1]
        attitude.dip = float(text) if is_number(text) else None
        return attitude.dip is not None
    ends = text.split("-") if name == "strike" else [text]  # NE-SW
    if is_number(text):
        azimuth = float(text)
    elif bearing is not None and float(bearing[2]) <= 90:
        angle = float(bearing[2]) * (1 if bearing[1] + bearing[3] in ("NE", "SW") else -1)
        azimuth = (angle + (0.0 if bearing[1] == "N" else 180.0)) % 360.0
    elif len(ends) < 3 and all(end in _COMPASS for end in ends):
        azimuth = _COMPASS[ends[0]]
        if name == "dip_direction":
            attitude.side = azimuth, _REACH[len(text)]
            return True
    else:
        return False
    if name == "strike":
        attitude.line, attitude.is_bearing = azimuth, not is_number(text)
    else:
        attitude.direction = azimuth
    return True


def _written(row: Row, attitude: _Attitude, headers: dict[int, TableHeader], doubtful: DoubtfulDips) -> Row:
    """A row with its dip and dip direction in columns of their own, after all others."""
    direction, is_contradicting = attitude.settled()
    if is_contradicting:
        doubtful.contradicting.append(row)
    elif attitude.is_bearing and attitude.side is None and attitude.direction is None and attitude.dip:
        doubtful.without_side.append(row)
    count = max(len(row.entries), len(row.header.names))
    if count not in headers:
        columns = {name: at for name, at in row.columns.items() if name not in _ANGLES}
        headers[count] = replace(row.header, columns={**columns, "dip": count, "dip_direction": count + 1})
    entries = [*row.entries, *[""] * (count - len(row.entries)), "", ""]
    angles = {"dip": attitude.dip, "dip_direction": direction}
    return replace(row, header=headers[count], entries=entries).with_values(
        {name: angle for name, angle in angles.items() if angle is not None}
    )


def _other_strikes(turned: Sequence[tuple[Row, float, bool]]) -> list[Row]:
    """Rows whose dip direction is not 90 degrees clockwise from the strike, or counterclockwise where that is
    so in most rows. turned: rows, how far the direction is clockwise from the strike, and whether this is a
    bearing, which has no side."""
    numbers = [turn for _, turn, is_bearing in turned if not is_bearing]
    counter = sum(_apart(turn, -90.0) <= _SURE for turn in numbers)
    usual = -90.0 if counter > sum(_apart(turn, 90.0) <= _SURE for turn in numbers) else 90.0
    return [
        row
        for row, turn, is_bearing in turned
        if min(_apart(turn, usual), _apart(turn, -usual if is_bearing else usual)) > _SURE
    ]
