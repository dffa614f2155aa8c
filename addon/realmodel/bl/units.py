# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures as people read them, in the units that the scene is set to."""

import bpy

from ..core.units import METRES
from . import results

_DIGITS = 5
_NAMES = {
    "mm": "Millimetres",
    "cm": "Centimetres",
    "m": "Metres",
    "km": "Kilometres",
    "in": "Inches",
    "ft": "Feet (international)",
    "us-ft": "Survey feet of the United States",
    "yd": "Yards",
    "mi": "Miles",
}
ITEMS = tuple((unit, unit, _NAMES.get(unit, unit)) for unit in METRES)  # of a menu


def length_text(scene, value):
    return _text(scene, "LENGTH", value, 1)


def area_text(scene, value):
    return _text(scene, "AREA", value, 2)


def volume_text(scene, row):
    """The volume of a row of the results."""
    return _text(scene, "VOLUME", results.volume(row), 3)


def total_volume_text(scene):
    return _text(scene, "VOLUME", sum(results.volume(row) for row in scene.realmodel.results), 3)


def _text(scene, category, value, power):
    unit = scene.unit_settings
    if unit.system == "NONE":
        return f"{value:.{_DIGITS}g}"
    return bpy.utils.units.to_string(
        unit.system, category, value * unit.scale_length**power, precision=_DIGITS, compatible_unit=False
    )
