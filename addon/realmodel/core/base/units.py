# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of length, and the factors between them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from .errors import InputRefused, number_list

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


# Spellings in small letters, without blanks, points, hyphens and underscores.
_SPELLINGS = {
    "mm": ("mm", "millimeter", "millimeters", "millimetre", "millimetres"),
    "cm": ("cm", "centimeter", "centimeters", "centimetre", "centimetres"),
    "m": (
        *("m", "mt", "mtr", "mtrs", "mts", "meter", "meters", "metre", "metres", "metro", "metros"),
        *("mètre", "mètres", "metri", "internationalmeter", "internationalmetre", "masl", "mamsl", "mbsl"),
        *("mnn", "mnhn", "münn", "münhn", "müm", "mnap", "mahd", "msnm"),
    ),
    "km": ("km", "kms", "kilometer", "kilometers", "kilometre", "kilometres"),
    "in": ("in", "inch", "inches", '"'),
    "ft": (
        *("ft", "fts", "foot", "feet", "ift", "intft", "ftint", "fti", "internationalfoot"),
        "footinternational",
        *("internationalfeet", "feetinternational", "pieds", "pies", "fuß", "'"),
    ),
    "us-ft": (
        *("usft", "ftus", "ussft", "sft", "usfoot", "usfeet", "footus", "feetus", "ussurveyfoot"),
        *("ussurveyfeet", "ussurveyft", "surveyfoot", "surveyfeet", "footussurvey", "feetussurvey"),
        *("ftussurvey", "surveyft", "usfootsurvey", "ftsurvey"),
    ),
    "yd": ("yd", "yds", "yard", "yards"),
    "mi": ("mi", "mile", "miles", "statutemile", "statutemiles"),
}
_UNIT_OF = {spelling: unit for unit, spellings in _SPELLINGS.items() for spelling in spellings}
# Units that a coordinate may be in, and which have no factor here.
_NO_FACTOR = frozenset(
    (
        *("dm", "decimeter", "decimeters", "decimetre", "decimetres", "fathom", "fathoms", "fm", "ftm"),
        *("chain", "chains", "ch", "link", "links", "rod", "rods", "furlong", "furlongs", "nmi"),
        *("nauticalmile", "nauticalmiles", "league", "leagues", "toise", "toises", "ms", "msec", "msecs"),
        *("millisecond", "milliseconds", "s", "sec", "second", "seconds", "twt", "deg", "degs", "degree"),
        *("degrees", "°", "dd", "decimaldegrees", "rad", "radian", "radians", "gon", "grad", "dms"),
        *("arcsec", "arcsecond", "arcseconds"),
    )
)
_SIGNS = r"[\s._(){}<>\[\]-]+"  # which spellings are without
# Of a name: what stands in brackets at its end, or else behind a sign or a change of capitals.
_IN_BRACKETS = re.compile(r"[\[({<]\s*([^\])}>]*?)\s*[\])}>][\"'\s]*$")
_LAST_WORD = re.compile(r"(?:[\s_.,:/-]+|(?<=[a-z])(?=[A-Z]))([^\s_.,:/-]+)\s*$")
_TWO_WORDS = re.compile(
    r"[\s_.,:/-]+((?:us|intl?|survey)[\s_.-]*(?:survey)?[\s_.-]*(?:ft|foot|feet))\s*$", re.IGNORECASE
)


def unit_of(text: str) -> str | None:
    """The unit of length, one of METERS, that a text names in any usual spelling, also in brackets or before
    what heights are above: "Feet", "[m]", "US survey feet", "m a.s.l."; None where it names none."""
    plain = text.strip().strip("[](){}<>").strip().lower()
    joined = re.sub(_SIGNS, "", plain)
    if joined in _UNIT_OF:
        return _UNIT_OF[joined]
    first = re.split(r"[\s,;/+]+", plain)
    return _UNIT_OF.get(first[0].strip("._-")) if len(first) > 1 else None


def unknown_unit(text: str) -> bool:
    """Whether a text names a unit that coordinates may have and that unit_of does not know: degrees, times,
    and rare lengths."""
    return re.sub(_SIGNS, "", text.lower()) in _NO_FACTOR


def unit_text_of_column(name: str) -> str:
    """The unit in the name of a column, as it is written, in brackets or as the last of several words:
    "Elevation_ft", "Depth (m)"; "" where there is none."""
    plain = name.strip().strip("\"'").strip()
    if bracket := _IN_BRACKETS.search(plain):
        return bracket[1] if unit_of(bracket[1]) or unknown_unit(bracket[1]) else ""
    word = _TWO_WORDS.search(plain) or _LAST_WORD.search(plain)
    # "in" and "mi" end names of other meanings
    is_unit = word is not None and (unit_of(word[1]) not in (None, "in", "mi") or unknown_unit(word[1]))
    return word[1] if word is not None and is_unit else ""


def stated_units(
    file: Path, coordinates: Sequence[tuple[str, str, str | None]], model_unit: str = MODEL_UNIT
) -> tuple[list[str | None], list[str]]:
    """The unit in which each coordinate or column of a file is read, None for that of the model, and
    warnings, sentences. coordinates: of each its name, the text of the file that names its unit ("":
    nothing), and its unit by the key `units` (None: the key is not given). The key decides; without it the
    file does, with a warning where that is another unit than the model's. Raises InputRefused where the
    unit of the file is not known."""
    units: list[str | None] = []
    names: dict[tuple[str, str | None], list[str]] = {}
    for name, text, unit in coordinates:
        said = unit_of(text)
        if text and said is None and unit is None:
            what = f"the unit '{text.strip()}' of '{name}' is not known"
            raise InputRefused(
                what, file=file, advice=f"set units, one of {', '.join(METERS)}, or convert it"
            )
        units.append(unit or said)
        read = unit or model_unit
        if said is not None and said != read and not (said == "ft" and unit == "us-ft"):
            names.setdefault((said, unit), []).append(f"'{name}'")
    warnings = []
    unsaid = [f"'{name}'" for (name, *_), unit in zip(coordinates, units, strict=True) if unit is None]
    if unsaid and any(unit is None for _, unit in names):
        warnings.append(
            f"{file}: it does not state the unit of {number_list(unsaid)}, read as {model_unit}: set units"
        )
    for (said, unit), listed in names.items():
        used = f"converted to {model_unit}" if unit is None else f"but the unit is {unit} by 'units'"
        other = "if that is wrong, set units" if unit is None else "correct one of them if it is wrong"
        warnings.append(f"{file}: the header says {said} for {number_list(listed)}, {used}: {other}")
    return units, warnings


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
