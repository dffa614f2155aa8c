# SPDX-License-Identifier: GPL-3.0-or-later
"""Wells of GOCAD and SKUA: a reference place (WREF), a path of depths along the well, heights and offsets
from it (PATH), or of places (VRTX), and markers by their depth along the well (MRKR).

Layout: Paradigm, *GOCAD* manual, part "ASCII file formats", object Well.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.algebra import norm
from ...base.errors import InputRefused
from ...base.text import BOM, read_text
from ..tables.hole_tables import Sheet

_NAMES = ("hole", "x", "y", "z", "surface")


@dataclass
class _Well:
    name: str = ""
    unit: str = ""
    unit_of_z: str = ""
    sign: float = 1.0
    place: np.ndarray | None = None
    depths: list[float] = field(default_factory=list)
    places: list[np.ndarray] = field(default_factory=list)
    markers: list[tuple[int, str, float]] = field(default_factory=list)


def begins_as_gocad_well(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so has wells of GOCAD."""
    return head.removeprefix(BOM).lstrip().upper().startswith(b"GOCAD WELL")


def read_gocad_wells(file: Path) -> dict[str, Sheet]:
    """The markers of all wells of a file as picks at their places. Raises InputRefused naming the line."""
    wells: list[_Well] = []
    for line, text in enumerate(read_text(file).split("\n"), 1):
        words = text.split()
        if not words:
            continue
        if words[0].upper() == "GOCAD":
            wells.append(_Well())
        elif wells:
            try:
                _read(wells[-1], line, text, words)
            except (ValueError, IndexError) as error:
                what = f"not a line of a well: '{text.strip():.40}'"
                raise InputRefused(what, file=file, line=line) from error
    rows = [row for well in wells for row in _rows(file, well)]
    if not rows:
        raise InputRefused("its wells have no markers", file=file)
    first = wells[0]
    return {"picks": Sheet(_NAMES, rows, 1, ("", first.unit, first.unit, first.unit_of_z, ""))}


def _read(well: _Well, line: int, text: str, words: list[str]) -> None:
    key = words[0].upper()
    if key.startswith("NAME:") and not well.name:
        well.name = text.partition(":")[2].strip().strip('"')
    elif key == "ZPOSITIVE":
        well.sign = -1.0 if words[1].lower() == "depth" else 1.0
    elif key == "AXIS_UNIT":
        well.unit, well.unit_of_z = words[1].strip('"'), words[3].strip('"')
    elif key == "WREF":
        well.place = np.array(words[1:4], float)
    elif key == "PATH":
        depth, height, east, north = map(float, words[1:5])
        assert well.place is not None
        well.depths.append(depth)
        well.places.append(np.array((well.place[0] + east, well.place[1] + north, height)))
    elif key == "VRTX" and well.place is not None:
        place = np.array(words[1:4], float)
        before = well.places[-1] if well.places else well.place
        well.depths.append((well.depths[-1] if well.depths else 0.0) + float(norm(place - before)))
        well.places.append(place)
    elif key == "MRKR":
        numbers = [word for word in words[2:] if word.lstrip("-").replace(".", "", 1).isdigit()]
        well.markers.append(
            (line, words[1].strip('"'), float(numbers[1] if len(numbers) > 1 else numbers[0]))
        )


def _rows(file: Path, well: _Well) -> list[tuple[int, list[str]]]:
    """The markers of a well: on straight ways between the places of its path, without one straight down."""
    if well.place is None:
        raise InputRefused("it has no line WREF", file=file, item=f"well '{well.name}'")
    rows = []
    for line, name, depth in well.markers:
        if well.depths:
            path = np.array(well.places)
            place = np.array([np.interp(depth, well.depths, column) for column in path.T])
            if depth > well.depths[-1] and len(path) > 1 and well.depths[-1] > well.depths[-2]:
                way = (path[-1] - path[-2]) / (well.depths[-1] - well.depths[-2])
                place = path[-1] + (depth - well.depths[-1]) * way
            height = well.sign * place[2]
        else:
            place, height = well.place, well.sign * well.place[2] - depth
        rows.append(
            (line, [well.name, repr(float(place[0])), repr(float(place[1])), repr(float(height)), name])
        )
    return rows
