# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips of a surface from a table of text."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...base.elementary import cos, sin
from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...base.units import MODEL_UNIT, factors
from ...settings.dips import DipFile, Dips
from ...settings.directions import unit_vector
from .hole_tables import Row, rows
from .points import AXES

DIPS = {
    **AXES,
    "dip": ("dip", "dip_angle", "dipangle", "inclination", "incl", "plunge"),
    "dip_direction": (
        *("dip_direction", "dipdirection", "dip direction", "dip_dir", "dipdir", "dip dir", "dip_azimuth"),
        *("dip azimuth", "dipazimuth", "azimuth", "azi"),
    ),
    "strike": ("strike", "strike_rhr", "strike rhr", "strike_rh"),
    "polarity": ("polarity", "younging", "facing"),
    "slope_x": ("slope_x", "dz_dx"),
    "slope_y": ("slope_y", "dz_dy"),
    "use": ("use",),
}
_SHEET = "a sheet has one height at each position"


def gradient_of(dip: float, dip_direction: float) -> np.ndarray:
    """(2,) the slope along x and y of a plane that dips so many degrees, below 90, in a direction in degrees
    clockwise from north (+y)."""
    angle = math.radians(dip)
    return -(sin(angle) / cos(angle)) * unit_vector(dip_direction) + 0.0  # no -0


def read_dips(given: DipFile, model_unit: str = MODEL_UNIT, step: Step = no_step) -> Dips:
    """The dips of a table, in the model's unit. Raises InputRefused naming file and line."""
    file = Path(given.file)
    plan, height = factors(given.units, model_unit)
    places, gradients, z, used = [], [], [], []
    for row in rows(given, file, DIPS, ("x", "y"), step):
        places.append((plan * row.number("x"), plan * row.number("y")))
        z.append(height * row.number("z") if row.has("z") else math.nan)
        gradients.append(_gradient(row))
        used.append(row.is_used)
    if not places:
        raise InputRefused("there are no dips in it", file=file)
    return Dips(np.array(places), np.array(gradients), np.array(z), None if all(used) else np.array(used))


def _gradient(row: Row) -> np.ndarray:
    if {"slope_x", "slope_y"} <= row.columns.keys():
        return np.array([row.number("slope_x"), row.number("slope_y")])
    if "dip" not in row.columns:
        raise _no_column(row, "dip")
    dip = row.number("dip")
    if row.has("polarity") and row.number("polarity") < 0:
        raise row.refuse(f"the dip is overturned: {_SHEET}", "leave the row out, or turn its polarity")
    if not 0 <= dip < 90:
        what = "vertical" if dip == 90 else "overturned" if 90 < dip <= 180 else "not from 0 to 90 degrees"
        raise row.refuse(f"the dip {dip:g} is {what}: {_SHEET}", "leave the row out")
    if row.has("dip_direction"):
        return gradient_of(dip, row.number("dip_direction"))
    if row.has("strike"):
        return gradient_of(dip, row.number("strike") + 90.0)
    if dip == 0:
        return np.zeros(2)
    if not {"dip_direction", "strike"}.intersection(row.columns):
        raise _no_column(row, "dip_direction", " or strike")
    raise row.refuse("the dip has no direction", "give its dip_direction or its strike")


def _no_column(row: Row, column: str, others: str = "") -> InputRefused:
    return InputRefused(
        f"the header has no column {column}{others}",
        file=row.table.file,
        line=row.table.layout.name_line or 1,
        advice=f'name it: columns = {{ {column} = "..." }}',
    )
