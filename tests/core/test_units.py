# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of length in texts and in names of columns, in the spellings of many programs."""

import pytest
from realmodel.core.base.units import METERS, unit_of, unit_text_of_column, unknown_unit

SPELLED = {
    "m": "m M meter Meters metre METRES [m] (m) m. masl",
    "ft": "ft FT Feet foot (ft) [feet] ift",
    "us-ft": "us-ft ftUS US_ft usft US-Survey-Feet us_survey_foot Foot_US",
    "km": "km Kilometers kilometre",
    "in": "inch Inches",
    "mm": "mm millimetres",
}


@pytest.mark.parametrize("unit", SPELLED)
def test_units_in_every_spelling(unit):
    for text in SPELLED[unit].split():
        assert unit_of(text) == unit, text
    for text in ("US survey feet", "foot (US survey)", "U.S. Survey Feet"):
        assert unit_of(text) == "us-ft"
    assert unit_of("m a.s.l.") == unit_of("m+NAP") == "m"
    assert all(unit_of(name) == name for name in METERS)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Elevation_ft", "ft"),
        ("Depth (m)", "m"),
        ('"Z [ftUS]"', "us-ft"),
        ("Höhe [m ü. NHN]", "m"),
        ("ElevFt", "ft"),
        ("Elev US ft", "us-ft"),
        ("Depth, ft", "ft"),
        ("Top in", None),
        ("Z (depth)", None),
        ("X UTM", None),
        ("x", None),
        ("m", None),
    ],
)
def test_units_of_columns(name, unit):
    assert unit_of(unit_text_of_column(name)) == unit


def test_units_without_a_factor():
    assert all(unknown_unit(text) for text in ("fathoms", "(deg)", "Degrees", "ms", "[chains]"))
    assert not any(unknown_unit(text) for text in ("m", "UTM32", "depth", "NAVD88", ""))
