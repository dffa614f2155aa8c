# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of length, and the factors between them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from .errors import number_list

MODEL_UNIT = "m"  # of a project without units
# Metres in each, exactly. Coordinates of old surveys in the United States are in survey feet.
METERS = {
    "mm": Fraction(1, 1000),
    "cm": Fraction(1, 100),
    "m": Fraction(1),
    "km": Fraction(1000),
    "in": Fraction(254, 10_000),
    "ft": Fraction(3048, 10_000),
    "us-ft": Fraction(1200, 3937),
    "yd": Fraction(9144, 10_000),
    "mi": Fraction(1_609_344, 1000),
}
UNIT_NAMES = {
    "mm": "Millimeters",
    "cm": "Centimeters",
    "m": "Meters",
    "km": "Kilometers",
    "in": "Inches",
    "ft": "Feet (international)",
    "us-ft": "US survey feet",
    "yd": "Yards",
    "mi": "Miles",
}


_WRITTEN = {
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("feet", "foot", "us-ft", "us ft", "ftus", "us survey feet"), "ft"),
    **dict.fromkeys(("inch", "inches"), "in"),
}


def unit_of_column(name: str) -> str | None:
    """The unit of length that stands behind the name of a column in brackets; None where there is none."""
    match = re.search(r"[\[(]\s*([^\])]*?)\s*[\])]\s*\"?\s*$", name.lower())
    unit = None if match is None else _WRITTEN.get(match[1], match[1])
    return unit if unit in METERS else None


def other_units(file: Path, columns: Mapping[str, str | None], model_unit: str = MODEL_UNIT) -> list[str]:
    """A warning for each unit that names of columns of a table say, and in which they are not read. columns:
    the unit of each by its name, None for that of the model."""
    names_by_unit: dict[tuple[str, str], list[str]] = {}
    for name, unit in columns.items():
        said, read = unit_of_column(name), unit or model_unit
        if said is not None and said != ("ft" if read == "us-ft" else read):
            names_by_unit.setdefault((said, read), []).append(f"'{name.strip()}'")
    return [
        f"{file}: the header says {said} for {number_list(names)}, but the unit is {read}: set units of this "
        "table or of the project, or correct the header"
        for (said, read), names in names_by_unit.items()
    ]


def factor(unit: str | None, model_unit: str = MODEL_UNIT) -> float:
    """The factor from a unit to the model's unit; 1 where none is given."""
    return 1.0 if unit is None else float(METERS[unit] / METERS[model_unit])


def factors(units: str | Mapping | None, model_unit: str = MODEL_UNIT) -> tuple[float, float]:
    """Of plan coordinates and of heights, whose units are the same, or {"xy": ..., "z": ...}."""
    units = units if isinstance(units, Mapping) else {"xy": units, "z": units}
    return factor(units.get("xy"), model_unit), factor(units.get("z"), model_unit)


def number_text(value: float) -> str:
    """A number of four digits, or of all before the point: "86,820"."""
    return f"{value:,.0f}" if 1000.0 <= abs(value) < 1e15 else f"{value:.4g}"


def length_text(value: float, unit: str) -> str:
    """A length in a unit for a person: "3,430 km"."""
    long = "mi" if unit in ("in", "ft", "us-ft", "yd", "mi") else "km"
    if value * float(METERS[unit]) >= 10_000.0:
        value, unit = value * factor(unit, long), long
    return f"{value:,.0f} {unit}" if value >= 100.0 else f"{value:.3g} {unit}"
