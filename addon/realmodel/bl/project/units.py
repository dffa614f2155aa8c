# SPDX-License-Identifier: GPL-3.0-or-later
"""Units: one unit of a scene is one unit of its model; quantities as text."""

import math

from ...core.base.units import METERS, UNIT_NAMES
from . import results

ITEMS = tuple((unit, unit, UNIT_NAMES[unit]) for unit in METERS)  # of a menu

# What Blender shows lengths in. It has no yards; of a survey foot it only knows the size.
_LENGTH_UNITS = {
    "mm": "MILLIMETERS",
    "cm": "CENTIMETERS",
    "m": "METERS",
    "km": "KILOMETERS",
    "in": "INCHES",
    "ft": "FEET",
    "us-ft": "FEET",
    "yd": "FEET",
    "mi": "MILES",
}
_IMPERIAL = frozenset(("in", "ft", "us-ft", "yd", "mi"))
_SYMBOLS = {"us-ft": "ft (US)"}
_POWERS = ("", "", "²", "³")
_LARGE = 1e10  # cubic meters: the list of blocks has no room for ten thousand millions


def set_up(scene, unit):
    """Makes one unit of a scene one unit of its model, so that Blender shows and reads lengths right. If it
    is so already, the user's choice of display units stays."""
    shown, scale = scene.unit_settings, float(METERS[unit])
    if math.isclose(shown.scale_length, scale, rel_tol=1e-6):
        return
    shown.scale_length = scale
    if shown.system != "NONE":
        shown.system = "IMPERIAL" if unit in _IMPERIAL else "METRIC"
        shown.length_unit = _LENGTH_UNITS[unit]


def length_text(scene, value):
    return _text(scene, value, 1)


def area_text(scene, value):
    return _text(scene, value, 2)


def volume_text(scene, row):
    """The volume of a row without its unit, which `unit_text` gives once for a whole column."""
    return number_text(results.volume(row) * _volume_unit(scene)[1])


def full_volume_text(scene, row):
    """The volume of a row with every cubic unit."""
    return _text(
        scene, results.volume(row), 3, lambda value: f"{value:,.{0 if abs(value) >= 1000.0 else 3}f}"
    )


def volume_amount_text(scene, value):
    unit, factor = _volume_unit(scene)
    return f"{number_text(value * factor)} {unit}"


def total_volume_text(scene):
    return volume_amount_text(scene, sum(results.volume(row) for row in scene.realmodel.results))


def number_text(value):
    """A number of four significant digits or more: thousands apart, millions as "38.9 M"."""
    size = abs(value)
    if size < 999.95:
        return f"{value:.4g}"
    if size < 999_999.5:
        return f"{value:,.0f}"
    millions = value / 1e6
    if size >= 1e15:
        return f"{value:.3e}"
    return f"{millions:.4g} M" if abs(millions) < 999.95 else f"{millions:,.0f} M"


def unit_text(scene, power):
    """The unit of lengths (power 1), areas or volumes, as it is shown."""
    return (_volume_unit(scene) if power == 3 else shown_unit(scene, power))[0]


def _volume_unit(scene):
    """As shown_unit; of a large model cubic kilometers in the place of cubic meters."""
    unit, factor = shown_unit(scene, 3)
    view = scene.realmodel.view
    box = math.prod(high - low for low, high in zip(view.bounds_low, view.bounds_high, strict=True))
    return ("km³", 1e-9 * factor) if unit == "m³" and box * factor > _LARGE else (unit, factor)


def _text(scene, value, power, number=number_text):
    unit, factor = shown_unit(scene, power)
    return f"{number(value * factor)} {unit}"


def shown_unit(scene, power):
    """The unit of the model, or where the scene is set to the other system its base unit; and the factor to
    it."""
    unit, system = scene.realmodel.units, scene.unit_settings.system
    shown = unit
    if system == "METRIC" and unit in _IMPERIAL:
        shown = "m"
    elif system == "IMPERIAL" and unit not in _IMPERIAL:
        shown = "ft"
    return f"{_SYMBOLS.get(shown, shown)}{_POWERS[power]}", float((METERS[unit] / METERS[shown]) ** power)
