# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips of a surface, of a whole rock mass or of a series from a table of text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...base.units import MODEL_UNIT, factors
from ...settings.dips import NORMAL, DipFile, Dips, SpaceDips
from ...settings.directions import gradient_of, normal_of
from .attitudes import COMBINED, DoubtfulDips, with_numbers
from .hole_tables import OBSERVED, Columns, Row, rows, rows_in_one_unit, unit_warnings
from .observations import LeftOut
from .points import AXES
from .unit_names import UnitNames

DIPS = {
    **AXES,
    "dip": (
        *("dip", "dip_angle", "dipangle", "inclination", "incl", "plunge"),
        *("Fallen", "Einfallen", "Fallwinkel", "Einfallwinkel"),
        *("pendage", "buzamiento", "inclinación", "helling", "hellingshoek", *COMBINED["dip"]),
    ),
    "dip_direction": (
        *("dip_direction", "dipdirection", "dip direction", "dip_dir", "dipdir", "dip dir", "dip_azimuth"),
        *("dip azimuth", "dipazimuth", "azimuth", "azi"),
        *("Fallrichtung", "Einfallrichtung", "Einfallsrichtung"),
        *("Azimut", "direction_pendage", "direction de pendage", "azimut de pendage", "Acimut"),
        *("direccion_buzamiento", "dirección de buzamiento", "hellingsrichting"),
        *COMBINED["dip_direction"],
    ),
    "strike": (
        *("strike", "strike_rhr", "strike rhr", "strike_rh", "Streichen", "rumbo", "strekking"),
        *COMBINED["strike"],
    ),
    "polarity": ("polarity", "younging", "facing"),
    "slope_x": ("slope_x", "dz_dx"),
    "slope_y": ("slope_y", "dz_dy"),
    "use": ("use",),
    **{name: (name, f"g_{name[-1]}") for name in NORMAL},  # of GemPy
}
# "formation" and "unit" are blocks where there are dips, which are measured within the beds
NAMED = {"surface": ("surface", "horizon", "top", "marker", "pick"), "block": OBSERVED["block"]}
_POLARITY = {
    **dict.fromkeys(("upright", "normal", "up", "u", "n"), 1.0),
    **dict.fromkeys(("overturned", "inverted", "reversed", "down", "o", "i", "r"), -1.0),
}
_SHEET = "a sheet has one elevation at each position"
_SAY_POLARITY = "write 1 or upright, -1 or overturned"
_ELSEWHERE = 'leave the row out: steep folds belong in a series with kind = "field"'


def read_dips(given: DipFile, model_unit: str = MODEL_UNIT, step: Step = no_step) -> Dips:
    """The dips of a table, all of one surface, in the model's unit. Raises InputRefused naming file and
    line."""
    return _dips(given, _rows(given, DIPS, ("x", "y"), step, model_unit)[0], model_unit)


def dip_warnings(given: DipFile, model_unit: str = MODEL_UNIT) -> list[str]:
    """The warnings about the units and the angles of a table of dips. Raises InputRefused naming file and
    line."""
    doubtful = _rows(given, DIPS, ("x", "y"), no_step, model_unit)[1]
    return [*unit_warnings(given, Path(given.file), DIPS, model_unit), *doubtful.warnings()]


def _rows(
    given: DipFile, known: Columns, needed: Sequence[str], step: Step, model_unit: str
) -> tuple[list[Row], DoubtfulDips]:
    """The rows of a table with their angles as numbers, and which of these are doubtful."""
    every = list(rows_in_one_unit(given, Path(given.file), known, needed, step, model_unit))
    return with_numbers(every, [name for name, column in given.columns.items() if column is not False])


def read_dips_of_rock(
    given: DipFile, units: UnitNames, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> tuple[Dips, list[LeftOut]]:
    """The dips of a table with the surfaces and blocks that they name, in the model's unit, and those that
    are of nothing that the rock mass has. Raises InputRefused naming file and line."""
    chosen_rows, surfaces, blocks = [], [], []
    left_out: list[LeftOut] = []
    known = {**DIPS, **NAMED}
    every, _ = _rows(given, known, ("x", "y"), step, model_unit)
    for row in every:
        code = next((row.text(key) for key in NAMED if row.has(key)), "")
        surface = block = ""
        if code and not units.says_nothing(code):
            over = units.block(code)
            if row.has("surface") and units.is_surface(code):
                surface = units.surface(code)
            elif over is not None and over in units.surfaces:
                block = over
            else:
                left_out.append(LeftOut("dip_unit", f"line {row.line}, '{code}'", code))
                continue
        elif units.means_nothing(code):
            continue
        chosen_rows.append(row)
        surfaces.append(surface)
        blocks.append(block)
    dips = _dips(given, chosen_rows, model_unit, may_be_none=bool(every))
    return replace(dips, surfaces=np.array(surfaces, str), blocks=np.array(blocks, str)), left_out


def names_units(given: DipFile, step: Step = no_step) -> bool:
    """Whether a table of dips names surfaces or blocks, in any row. Raises InputRefused."""
    every = rows(given, Path(given.file), {**DIPS, **NAMED}, ("x", "y"), step)
    return any(row.has(key) for row in every for key in NAMED)


def _dips(dip_file: DipFile, table_rows: list[Row], model_unit: str, may_be_none: bool = False) -> Dips:
    """The dips of rows of a table."""
    plan, height = factors(dip_file.units, model_unit)
    places, gradients, z, used = [], [], [], []
    for row in table_rows:
        places.append((plan * row.number("x"), plan * row.number("y")))
        z.append(height * row.number("z") if row.has("z") else math.nan)
        gradients.append(_gradient(row))
        used.append(row.is_used)
    if not (places or may_be_none):
        raise InputRefused("there are no dips in it", file=dip_file.file)
    shape = (-1, 2)
    in_use = None if all(used) else np.array(used)
    arrays = np.array(places).reshape(shape), np.array(gradients).reshape(shape), np.array(z)
    return Dips(*arrays, used=in_use)


def read_space_dips(given: DipFile, model_unit: str = MODEL_UNIT, step: Step = no_step) -> SpaceDips:
    """The dips in space of a table, in the model's unit. Raises InputRefused naming file and line."""
    file = Path(given.file)
    plan, height = factors(given.units, model_unit)
    places, normals, used = [], [], []
    for row in _rows(given, DIPS, ("x", "y", "z"), step, model_unit)[0]:
        places.append((plan * row.number("x"), plan * row.number("y"), height * row.number("z")))
        normals.append(_normal(row))
        used.append(row.is_used)
    if not places:
        raise InputRefused("there are no dips in it", file=file)
    return SpaceDips(np.array(places), np.array(normals), None if all(used) else np.array(used))


def _normal(row: Row) -> np.ndarray:
    """(3,) the normal of the bedding, toward younger rock."""
    if row.columns.keys() >= set(NORMAL):
        normal = np.array([row.number(name) for name in NORMAL])
        if not normal.any():
            raise row.refuse("the normal is 0", "leave the row out")
        return normal
    polarity = _polarity(row)
    if {"slope_x", "slope_y"} <= row.columns.keys():
        upright = np.array([-row.number("slope_x"), -row.number("slope_y"), 1.0])
        return upright if polarity > 0 else -upright
    if "dip" not in row.columns:
        raise _no_column(row, "dip")
    dip = _angle(row)
    if not 0 <= dip <= 180:
        raise row.refuse(f"the dip {dip:g} is not from 0 to 180 degrees", "leave the row out")
    return normal_of(dip, 0.0 if dip in (0, 180) else _direction_of(row), polarity < 0)


def _angle(row: Row) -> float:
    if not row.has("dip"):
        raise row.refuse("it has no dip", "fill it in, or leave the row out")
    return row.number("dip")


def _polarity(row: Row) -> float:
    """Above 0 where the bedding of a row is upright, below it where it is overturned."""
    if not row.has("polarity"):
        return 1.0
    word = row.text("polarity").lower()
    polarity = _POLARITY[word] if word in _POLARITY else row.number("polarity", _SAY_POLARITY)
    if polarity == 0:
        raise row.refuse("the polarity is 0", _SAY_POLARITY)
    return polarity


def _direction_of(row: Row) -> float:
    """The dip direction of a row, in degrees clockwise from north."""
    if row.has("dip_direction"):
        return row.azimuth("dip_direction")
    if row.has("strike"):
        return row.azimuth("strike") + 90.0
    if not {"dip_direction", "strike"}.intersection(row.columns):
        raise _no_column(row, "dip_direction", " or strike")
    raise row.refuse("the dip has no direction", "give its dip_direction or its strike")


def _gradient(row: Row) -> np.ndarray:
    if {"slope_x", "slope_y"} <= row.columns.keys():
        return np.array([row.number("slope_x"), row.number("slope_y")])
    if "dip" not in row.columns:
        raise _no_column(row, "dip")
    dip = _angle(row)
    if _polarity(row) < 0:
        raise row.refuse(f"the dip is overturned: {_SHEET}", _ELSEWHERE)
    if not 0 <= dip < 90:
        what = "vertical" if dip == 90 else "overturned" if 90 < dip <= 180 else "not from 0 to 90 degrees"
        raise row.refuse(f"the dip {dip:g} is {what}: {_SHEET}", _ELSEWHERE)
    if dip == 0:
        return np.zeros(2)
    return gradient_of(dip, _direction_of(row))


def _no_column(row: Row, column: str, others: str = "") -> InputRefused:
    return InputRefused(
        f"the header has no column {column}{others}",
        file=row.file,
        line=row.header.line,
        advice=f'name it: columns = {{ {column} = "..." }}',
    )
