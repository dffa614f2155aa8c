# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of tables of boreholes and of dips, with columns found by their usual names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np

from ...base.errors import InputRefused
from ...base.no_value import NO_VALUE, OFTEN_NO_VALUE
from ...base.text import Step
from ...base.units import factor, stated_units, unit_of, unit_text_of_column
from .points import AXES, TextTable, head_rows, open_table
from .table_layout import (
    WITH_UNIT,
    Expected,
    TableLayout,
    column_number,
    fields,
    is_number,
    names_shown,
    plain_name,
)

# Names of columns of programs and surveys the world over, compared by column_key: English, German, French,
# Spanish and Dutch, and those of Leapfrog, Surpac, Datamine, Micromine, Vulcan, gINT, AGS, GSWA, DINO and
# swisstopo. A column has one meaning in a table; names stand in the order in which they are looked for.
_HOLE_NAMES = (
    *("hole", "hole_id", "bhid", "dhid", "borehole", "well", "well_id", "hole_name", "hole_no"),
    *("hole_number", "borehole_id", "borehole_name", "borehole_no", "bore", "bore_id", "drillhole"),
    *("drillhole_id", "ddh", "collar_id", "well_name", "well_identifier", "wellbore", "uwi", "dino_nr"),
    *("nitg_nr", "nitg", "Bohrung", "Bohrung Nr", "Bohrungsname", "Bohrungsnummer", "Bohrloch"),
    *("Bohrprofil", "Bohr_ID", "Sondage", "nom_sondage", "Forage", "nom_forage", "Sondeo", "Pozo"),
    *("Barreno", "Boring", "Boringnummer", "Boornummer", "Boorgat"),
    *("id_bss", "code_bss", "Sondaggio", "nome sondaggio", "Furo", "Otwór", "nazwa otworu", "Borrhål"),
    *("Borehull", "dhid", "drill_hole", "drillhole_name", "collar_name", "hole_number_id"),
)
PLACE_NAMES = ("location_id", "loca_id", "loc_id", "point_id", "site_id", "original_name", "name", "id")
_HOLE = (*_HOLE_NAMES, *PLACE_NAMES)
_HEIGHT = ("Höhe", "Hoehe", "Cota", "Cote", "Altitud", "Elevación", "Hoogte")
_DEPTH = ("Tiefe", "Teufe", "Profondeur", "Prof", "Profundidad", "Diepte")
PICKS = {
    "hole": _HOLE,
    "x": (
        *("x", "easting", "east", "loca_nate", "hole_nate", "national_grid_easting", "x_collar", "collar_x"),
        *("location_x", "x_coordinate", "x_coordinaat", "x_koordinate", "x_lambert", "xl", *AXES["x"]),
        *("xcoord", "x_utm", "utm_x", "utm_e", "x_l93", "nat_east", "nat_grid_east", "grid_east"),
        *("mine_east", "local_east", "hole_east", "collar_east", "coord_x", "Est"),
    ),
    "y": (
        *("y", "northing", "north", "loca_natn", "hole_natn", "national_grid_northing", "y_collar"),
        *("collar_y", "location_y", "y_coordinate", "y_coordinaat", "y_koordinate", "y_lambert", "yl"),
        *AXES["y"],
        *("ycoord", "y_utm", "utm_y", "utm_n", "y_l93", "nat_north", "nat_grid_north", "grid_north"),
        *("mine_north", "local_north", "hole_north", "collar_north", "coord_y", "Nord"),
    ),
    "z": (
        *("z", "collar", "elevation", "elev", "altitude", "rl", "kb", "height", "ground_level", "loca_gl"),
        *(
            "gse",
            "ground_surface_elevation",
            "land_surface_elevation",
            "hole_gl",
            "gl",
            "ground_elevation",
            "surface_elevation",
            "z_collar",
            "collar_z",
            "collar_rl",
        ),
        *("collar_elevation", "elevation_z", "location_z", "z_coordinate", "z_coordinaat", "z_koordinate"),
        *("Ansatzhöhe", "Ansatzhoehe", "Ansatzpunkt", "Geländehöhe", "Gelaendehoehe", "GOK"),
        *("Maaiveld", "Maaiveldhoogte", "Cota boca", *_HEIGHT, *AXES["z"]),
        *("zcoord", "zcoordb", "z_utm", "utm_z", "z_sol", "alti_sol", "nat_rl", "grid_rl", "mine_rl"),
        *("local_rl", "hole_rl", "Quota", "Rzędna", "coord_z", "surface_rl"),
    ),
    "surface": (
        *("surface", "horizon", "top", "marker", "formation", "unit", "pick", "surface_name", "horizon_name"),
        *("well_top", "Horizont", "Horizonte"),
    ),
    "depth": ("depth", "md", "tvd", "from", "measured_depth", *_DEPTH),
    "elevation": ("elevation", "elev", "z", "altitude", "rl", "height", *_HEIGHT),
}
DIRECTIONS = {
    "azimuth": (
        *("azimuth", "azi", "azim", "azm", "az", "bearing", "brg", "horn_ornt", "hdph_ornt", "true_azimuth"),
        *("azimuth_true", "azimuth_grid", "Azimut", "Acimut"),
    ),
    "dip": ("dip", "plunge", "horn_incl"),
    "inclination": ("inclination", "incl", "inc", "deviation"),
}
SURVEY = {
    "hole": _HOLE,
    "depth": (
        *("depth", "md", "measured_depth", "at", "distance", "dist", "survey_depth", "horn_top"),
        *("station_depth", *_DEPTH),
    ),
    **DIRECTIONS,
}
COLLARS = {
    **PICKS,
    **DIRECTIONS,
    "end": (
        *("end", "eoh", "end_of_hole", "end_depth", "total_depth", "td", "max_depth", "final_depth"),
        *("hole_depth", "hole_length", "length", "loca_fdep", "hole_fdep", "Endteufe", "Endtiefe"),
        *("Gesamttiefe", "Bohrtiefe", "Longueur", "Longitud", "Einddiepte", "Profondeur finale"),
        *("Profundidad final",),
        *("Profundidad total", "prof_investigation", "profondità finale", "profondità", "Profundidade"),
        *("Głębokość", "Slutdjup", "hole_td"),
    ),
    "use": ("use",),
}
_BLOCK = (
    *("block", "unit", "lithology", "litho", "lith", "lith_code", "simple_lith", "lith1", "lith_1", "rock"),
    *("rock_type", "rock_code", "formation", "strat", "stratigraphy", "geology", "geol", "geol_geol"),
    *("geology_code", "geol_leg", "legend_code", "code", "layer", "lithology_1", "Einheit", "Schicht"),
    *("Gestein", "Stratigraphie", "Lithologie", "Litología", "Unidad", "Formación", "Grondsoort"),
    *("Hoofdgrondsoort", "Eenheid", "Terrain", "Roche"),
    *(
        "Litologia",
        "lito",
        "Jordart",
        "Petro",
        "Petrographie",
        "geocod",
        "geocode",
        "geol_code",
        "lith1_code",
    ),
    *("lith_1_code", "major_lith", "main_lith", "primary_lith", "rock_name", "strat_unit", "strat_code"),
    *("unit_code", "unit_name", "graphic", "material", "soil", "soil_type", "domain", "stratum", "hsu"),
    *("geol_geo2", "lito"),
)
_THICKNESS = (
    "thickness",
    "thick",
    "length",
    "interval_length",
    "Mächtigkeit",
    "Épaisseur",
    "espesor",
    "dikte",
)
INTERVALS = {
    "hole": _HOLE,
    **{axis: PICKS[axis] for axis in "xyz"},
    "from": (
        *("from", "depth_from", "from_depth", "start", "begin", "top", "top_depth", "depth_top", "geol_top"),
        *("depth_to_top", "upper_depth", "start_depth", "depth_start", "interval_from", "md_from", "from_md"),
        *("Von", "Tiefe von", "von Tiefe", "Tiefe oben", "Desde", "prof_desde", "De", "Toit", "prof_toit"),
        *("prof_debut", "Profondeur toit", "Van", "Bovenkant", "Bovenkant laag", "diepte_van", "md", "tvd"),
        *(
            "samp_from",
            "geol_from",
            "lith_from",
            "interval_top",
            "top_md",
            "Teufe von",
            "Obergrenze",
            "Strop",
            "Från",
        ),
        *("top_elev", "top_elevation", "elev_top", "elevation_top", "z_top", "top_z", "from_z", "z_from"),
        *("Da", "Fra"),
        "depth",
    ),
    "to": (
        *("to", "depth_to", "to_depth", "end", "bottom", "base", "bottom_depth", "depth_bottom"),
        *("base_depth", "depth_base", "depth_to_base", "geol_base", "lower_depth", "end_depth"),
        *("depth_end", "interval_to", "md_to", "to_md", "Bis", "Tiefe bis", "bis Tiefe", "Tiefe unten"),
        *("Hasta", "prof_hasta", "à", "Mur", "prof_mur", "prof_fin", "Profondeur mur", "Tot", "Onderkant"),
        *("Onderkant laag", "diepte_tot", "Basis"),
        *("Untergrenze", "samp_to", "geol_to", "lith_to", "interval_bottom", "interval_base", "base_md"),
        *("bottom_md", "Teufe bis", "prof_base", "Spąg", "Till", "Até", "bottom_elev", "bottom_elevation"),
        *("elev_bottom", "base_elev", "base_elevation", "elevation_bottom", "z_bottom", "z_base"),
        *("bottom_z", "base_z", "to_z", "z_to", "Til", "A"),
    ),
    "block": _BLOCK,
    "thickness": _THICKNESS,
    **DIRECTIONS,
    "use": ("use",),
}
OBSERVED = {
    "x": PICKS["x"],
    "y": PICKS["y"],
    "z": ("z", "elevation", "elev", "altitude", "rl", "height"),
    "block": _BLOCK,
    "hole": _HOLE_NAMES,  # other names and ids are of the places
    "depth": ("depth", "md"),
    "use": ("use",),
    "on": ("seen_on",),
    "error": ("height_error",),
    "thickness": ("thickness", "true_thickness"),
}
_BESIDE = {"a": "da"}
_OTHER_END = {"from": "to", "to": "from"}  # of an interval: one follows from the others of its hole
_GEOGRAPHIC = ("longitude", "lon", "long", "latitude", "lat")
_OFF = frozenset(("0", "no", "false", "off"))  # in the column `use` of rows that are switched off
_STEP = 5000  # rows
# Of columns such as unit and material in tables of assays.
_NO_UNITS = frozenset(
    (
        *(
            "ppm",
            "ppb",
            "ppt",
            "%",
            "pct",
            "wt%",
            "g/t",
            "gpt",
            "oz/t",
            "mg/kg",
            "mg/l",
            "g/cm3",
            "kg/m3",
            "t/m3",
        ),
        *("m", "ft", "mm", "cm", "kpa", "mpa", "gpa", "m/s", "ohm.m", "api", "core", "half core"),
        *("quarter core", "whole core", "dd", "ddh", "diamond", "rc", "rab", "chips", "chip", "rc chips"),
        *("pulp", "pulps", "reject", "cuttings", "composite", "grab", "channel", "sample", "blank"),
        *("standard", "duplicate", "original", "assay", "trench"),
    )
)
_LOOKED_AT = 1000  # rows that tell the decimal sign, and which column names units
_SEPARATORS = ",;|\t "  # a row of these alone is empty, as Excel writes them
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+")
_MOST_TURNED = 720.0  # degrees
_ANGLES = frozenset(("azimuth", "dip", "inclination", "dip_direction", "strike"))
_DEGREES = {"rad": 180 / np.pi, "radian": 180 / np.pi, "radians": 180 / np.pi, "gon": 0.9, "grad": 0.9}
_WITH_NULLS = _ANGLES | {"z", "thickness", "error"}  # of observations and dips
LENGTHS = frozenset(("x", "y", "z", "depth", "elevation", "from", "to", "end", "thickness"))

Columns = Mapping[str, Sequence[str]]  # possible names of a column, by its meaning


class Reading(Protocol):
    """How tables are read: of Boreholes, of an ObservationFile, or of a DipFile."""

    @property
    def columns(self) -> Mapping: ...

    @property
    def separator(self) -> str | None: ...

    @property
    def decimal(self) -> str | None: ...

    @property
    def units(self) -> str | Mapping | None: ...


LINE = "line"


@dataclass(frozen=True)
class TableHeader:
    """names: of the columns as they are written, none without a header. line: its number, 1 without one.
    columns: the numbers of the columns from 0, by their meaning. units: of columns, as they are written, by
    their meaning. row_name: what a row is called before its number."""

    file: Path
    names: Sequence[str]
    line: int
    columns: dict[str, int]
    units: dict[str, str] = field(default_factory=dict)
    row_name: str = LINE


@dataclass(frozen=True)
class RawTable:
    """A table in a file that holds several: the names of its columns, the lines and entries of its rows, what
    units its columns have, as they are written, "" for none. choice: the column of blocks that was chosen
    among several, with a sentence about it. system: the coordinate system that the file names, by EPSG's code
    where that is known, "" where it names none. row_name: what a row is called before its number. is_log:
    whether it has the curves of a log."""

    names: Sequence[str]
    rows: Sequence[tuple[int, list[str]]]
    line: int = 1
    units: Sequence[str] = ()
    choice: tuple[str, str] | None = None
    system: str = ""
    row_name: str = LINE
    is_log: bool = False


@dataclass(frozen=True)
class Row:
    header: TableHeader
    line: int
    entries: list[str]
    decimal: str = "."

    @property
    def file(self) -> Path:
        return self.header.file

    @property
    def columns(self) -> dict[str, int]:
        return self.header.columns

    @property
    def place(self) -> str:
        """Which row of its file it is, for messages."""
        return f"{self.header.row_name} {self.line}"

    def refuse(self, what: str, advice: str | None = None) -> InputRefused:
        if self.header.row_name != LINE:
            return InputRefused(what, file=self.file, item=self.place, advice=advice)
        return InputRefused(what, file=self.file, line=self.line, advice=advice)

    def with_values(self, values: Mapping[str, float | str]) -> Row:
        """The same with other values in some of its columns, by their meaning."""
        entries = list(self.entries)
        for column, value in values.items():
            text = value if isinstance(value, str) else repr(float(value)).replace(".", self.decimal)
            entries[self.columns[column]] = text
        return replace(self, entries=entries)

    def scaled(self, factors: Mapping[str, float]) -> Row:
        """The same with the numbers of some columns times factors, by their meaning."""
        values = {
            column: self.number(column) * by
            for column, by in factors.items()
            if self.has(column) and is_number(self.entries[self.columns[column]], self.decimal)
        }
        return self.with_values(values)

    def text(self, column: str) -> str:
        at = self.header.columns[column]
        if at >= len(self.entries):
            raise self.refuse(f"{at + 1} values are needed, there are {len(self.entries)}")
        return self.entries[at]

    def has(self, column: str) -> bool:
        """Whether there is such a column, with a value in this row."""
        at = self.header.columns.get(column)
        return at is not None and at < len(self.entries) and self.entries[at].lower() not in NO_VALUE

    @property
    def is_used(self) -> bool:
        """Whether the row is not switched off in its column `use`."""
        return not self.has("use") or self.entries[self.columns["use"]].lower() not in _OFF

    def called(self, column: str) -> str:
        """The name of a column in the header, in small letters; empty without a header."""
        names, at = self.header.names, self.columns[column]
        return plain_name(names[at]) if at < len(names) else ""

    def number(self, column: str, advice: str | None = None) -> float:
        entry = self.text(column).removesuffix("°")
        if not is_number(entry, self.decimal):
            raise self.refuse(f"{column} is not a number: '{entry:.40}'", advice)
        value = float(entry.replace(",", "."))
        if not np.isfinite(value):
            raise self.refuse(f"{column} is {entry}, not a finite number")
        return value

    def number_of(self, column: str) -> float | None:
        """The number in a column; None where there is none."""
        if not self.has(column) or not is_number(self.text(column), self.decimal):
            return None
        return float(self.text(column).replace(",", "."))

    def azimuth(self, column: str) -> float:
        """An angle in plan, degrees: also one beyond 360, but none that stands for no value."""
        value = self.number(column)
        if abs(value) > _MOST_TURNED:
            raise self.refuse(f"{column} is {value:g}", "it is in degrees clockwise from north")
        return value


def rows(
    given: Reading, file: Path, known: Columns, needed: Sequence[str], step: Step, sheet: str | None = None
) -> Iterator[Row]:
    """The rows of a table as they are written, with those of the known columns that it has. Raises
    InputRefused where it lacks one that is needed. sheet: of a workbook; None: the only one with these."""
    table = _opened(given, file, known, needed, sheet)
    layout = table.layout
    header = _header(given, file, table, known)
    if sheet is not None:  # so that messages name the sheet of a line
        header = replace(header, file=file.with_name(f"{file.name}[{sheet}]"))
    _require(given, header, needed)
    separator = layout.separator
    body = table.raw[layout.body :].decode(table.encoding)
    decimal = given.decimal or _decimal(_parts(body, separator), separator)
    total = max(body.count("\n"), 1)
    for number, line in enumerate(body.split("\n")):
        if number % _STEP == 0:
            step(number / total)
        stripped = line.strip()
        if not stripped.strip(_SEPARATORS) or stripped.startswith("#"):
            continue
        yield Row(header, layout.body_line + number, layout.fields(line.rstrip("\r")), decimal)


def _decimal(entries: Iterable[str], separator: str) -> str:
    """The decimal sign of a table by some of its entries: a comma where numbers have one and none a point."""
    every = list(entries)
    has_points = any("." in entry and is_number(entry) for entry in every)
    of_commas = [entry for entry in every if "," in entry and is_number(entry, ",")]
    # in quotes between commas 1,234 may have a sign between thousands
    has_commas = any(separator != "," or not _GROUPED.fullmatch(entry) for entry in of_commas)
    return "," if has_commas and not has_points else "."


def _header(given: Reading, file: Path, table: TextTable, known: Columns) -> TableHeader:
    layout = table.layout
    names, columns = layout.names or (), _columns(given, file, layout, known, head_rows(table, _LOOKED_AT))
    written = {meaning: unit_text_of_column(names[at]) for meaning, at in columns.items() if at < len(names)}
    return TableHeader(file, names, layout.name_line or 1, columns, written)


def sheet_rows(
    given: Reading, file: Path, sheet: RawTable, known: Columns, needed: Sequence[str]
) -> list[Row]:
    """The same of a table in a file that holds several."""
    first = [row for _, row in sheet.rows[:_LOOKED_AT]]
    columns = _columns(given, file, TableLayout(",", tuple(sheet.names), 0, 0, sheet.line), known, first)
    units = {meaning: sheet.units[at] for meaning, at in columns.items() if at < len(sheet.units)}
    header = TableHeader(file, sheet.names, sheet.line, columns, units, sheet.row_name)
    _require(given, header, needed)
    entries = (row[at] for row in first for at in columns.values() if at < len(row))
    decimal = given.decimal or _decimal(entries, ",")
    return [Row(header, line, entries, decimal) for line, entries in sheet.rows]


def rows_in_one_unit(
    given: Reading, file: Path, known: Columns, needed: Sequence[str], step: Step, model_unit: str
) -> Iterator[Row]:
    """The same, in the unit of the key `units`, or else in that of the model."""
    every = _without_nulls(with_units_of_cells(list(rows(given, file, known, needed, step))))
    factors = header_factors(every[0].header, given.units, model_unit)[0] if every else {}
    for row in every:
        yield row.scaled(factors) if factors else row


def _without_nulls(every: list[Row]) -> list[Row]:
    """Rows without numbers that mean no value: angles and thicknesses of -9999, and elevations that are far
    from all others as well."""
    heights = [z for row in every if (z := row.number_of("z")) is not None and z not in OFTEN_NO_VALUE]
    low, high = min(heights, default=0.0), max(heights, default=0.0)

    def is_null(row: Row, column: str) -> bool:
        value = row.number_of(column)
        if value not in OFTEN_NO_VALUE:
            return False
        return column != "z" or not 2 * low - high <= value <= 2 * high - low

    nulls = [[c for c in row.columns if c in _WITH_NULLS and is_null(row, c)] for row in every]
    return [
        row.with_values(dict.fromkeys(columns, "")) if columns else row
        for row, columns in zip(every, nulls, strict=True)
    ]


def with_units_of_cells(every: list[Row]) -> list[Row]:
    """Rows in which lengths are numbers where each is written with its unit, as 12.5 m: it is that of the
    column then."""
    header = every[0].header if every else None
    if header is None:
        return every
    found: dict[str, set[str]] = {}
    for row in every[:_LOOKED_AT]:
        for meaning in LENGTHS & header.columns.keys():
            written = WITH_UNIT.fullmatch(row.text(meaning)) if row.has(meaning) else None
            if written is not None:
                found.setdefault(meaning, set()).add(written[2])
    units = {meaning: texts for meaning, texts in found.items() if len(set(map(unit_of, texts))) == 1}
    units = {meaning: texts for meaning, texts in units.items() if unit_of(next(iter(texts))) is not None}
    if not units:
        return every
    header = replace(
        header, units={**header.units, **{meaning: min(texts) for meaning, texts in units.items()}}
    )
    changed = []
    for row in every:
        cells = {meaning: WITH_UNIT.fullmatch(row.text(meaning)) for meaning in units if row.has(meaning)}
        plain = {m: cell[1] for m, cell in cells.items() if cell is not None and cell[2] in units[m]}
        changed.append(replace(row, header=header).with_values(plain))
    return changed


def header_factors(
    header: TableHeader, units: str | Mapping | None, model_unit: str
) -> tuple[dict[str, float], list[str]]:
    """The factors of columns to the unit in which they are read, that of the key `units` or else of the
    model, and degrees, by their meaning, where the header has another one; and warnings. Raises InputRefused
    for a unit of length that is not known."""
    of_key = units if isinstance(units, Mapping) else {"xy": units, "z": units}
    written = {
        meaning: (header.names[at].strip(), header.units.get(meaning, ""))
        for meaning, at in header.columns.items()
        if meaning in LENGTHS and at < len(header.names)
    }
    keys = {meaning: of_key.get("xy" if meaning in ("x", "y") else "z") for meaning in written}
    coordinates = [(*written[meaning], key) for meaning, key in keys.items()]
    stated, warnings = stated_units(header.file, coordinates, model_unit)
    factors = {
        meaning: factor(unit, model_unit)
        for (meaning, key), unit in zip(keys.items(), stated, strict=True)
        if key is None and unit not in (None, model_unit)
    }
    warnings += _doubled(header)
    if "z" in factors:
        factors["error"] = factors["z"]
    for meaning in _ANGLES & header.columns.keys():
        text = header.units.get(meaning, "").strip().lower()
        if text in _DEGREES:
            factors[meaning] = _DEGREES[text]
            name = header.names[header.columns[meaning]].strip()
            warnings.append(
                f"{header.file}: the header says {text} for '{name}', converted to degrees: correct the "
                "header if that is wrong"
            )
    return factors, warnings


def _doubled(header: TableHeader) -> list[str]:
    """Warnings about columns of which others have the name."""
    warnings = []
    for meaning, at in header.columns.items():
        name = header.names[at].strip() if at < len(header.names) else ""
        same = [n for n, other in enumerate(header.names) if name and column_key(other) == column_key(name)]
        if len(same) > 1 and at == same[0] and not set(same[1:]) & set(header.columns.values()):
            warnings.append(
                f"{header.file}:{header.line}: {len(same)} columns are named '{name}'; the first is used: if "
                f"another one is meant, set columns = {{ {meaning} = {same[1] + 1} }}"
            )
    return warnings


def unit_warnings(given: Reading, file: Path, known: Columns, model_unit: str) -> list[str]:
    """The warnings about units in the header of a table. Raises InputRefused for one that is not known."""
    header = _header(given, file, _opened(given, file, known), known)
    _, warnings = header_factors(header, given.units, model_unit)
    return warnings


def columns_in(given: Reading, file: Path, known: Columns, sheet: str | None = None) -> dict[str, str]:
    """The known columns that a table, or the sheet of a workbook, has, by their meaning: their names in the
    header, in small letters. Raises InputRefused if it is not a table."""
    table = _opened(given, file, known, sheet=sheet)
    written = table.layout.names or ()
    names = [plain_name(name) for name in written]
    columns = _columns(given, file, table.layout, known, head_rows(table, _LOOKED_AT))
    return {meaning: names[at] if at < len(names) else "" for meaning, at in columns.items()}


def _opened(
    reading: Reading, file: Path, meanings: Columns, needed: Sequence[str] = (), sheet: str | None = None
) -> TextTable:
    names = {column.lower() for column in reading.columns.values() if isinstance(column, str)}
    for aliases in meanings.values():
        names.update(*map(_spellings, aliases))

    def is_header(cells: list[str]) -> bool:
        columns = _columns(reading, file, TableLayout("\t", tuple(cells), 0, 0, None), meanings)
        return set(needed) <= columns.keys() and len(columns) > 2

    return open_table(file, Expected(reading.separator, (), names, 1, 2, is_header), sheet)


def _parts(body: str, separator: str) -> Iterator[str]:
    """Entries of the first lines."""
    for line in body[:20_000].split("\n"):
        yield from fields(line, separator)


@lru_cache(maxsize=1 << 16)
def normalized_name(name: str) -> str:
    """A name, for comparing, in small letters, and with one sign for the spaces, hyphens and underscores that
    may part its words."""
    return re.sub(r"[\s_-]+", "_", name.strip().lower())


@cache
def _spellings(name: str) -> tuple[str, ...]:
    """A name in small letters with each of the signs that may part its words."""
    return tuple(re.sub(r"[\s_]", sign, name.lower()) for sign in ("", "_", " ", "-"))


@cache
def column_key(name: str) -> str:
    """The name of a column, for comparing: small letters and digits, without accents, signs and what is in
    brackets: FromDepth, from-depth and "From depth (m)" are one."""
    letters = re.sub(r"[\W_]+", "", plain_name(name).casefold())
    if len(letters) < 2:  # à is no a
        return letters
    parts = unicodedata.normalize("NFKD", letters)
    return "".join(letter for letter in parts if not unicodedata.combining(letter))


def _named(names: Sequence[str], wanted: Sequence[str]) -> int | None:
    """The number of the column that is called so, by the first of several names that one has; a unit may
    stand behind it."""
    with_unit = [column_key(name) for name in names]
    without = [
        column_key(name.strip()[: -len(unit)] if (unit := unit_text_of_column(name)) else "")
        for name in names
    ]
    for keys in (with_unit, without):
        for key in map(column_key, wanted):
            if key in keys:
                return keys.index(key)
    return None


def may_name_units(values: Iterable[str]) -> bool:
    """Whether the values of a column may be names of units: measured numbers, units of measure and kinds of
    samples are not, nor is nothing."""
    texts = {text.lower() for text in values} - NO_VALUE
    if all(is_number(text) or is_number(text, ",") for text in texts):
        return bool(texts) and all(float(text.replace(",", ".")).is_integer() for text in texts)
    return not texts <= _NO_UNITS


def _columns(
    reading: Reading, file: Path, layout: TableLayout, meanings: Columns, first: Sequence[list[str]] = ()
) -> dict[str, int]:
    """The numbers of the columns of a table, by their meaning. first: rows, which decide between columns that
    are called as those of units are."""
    names = layout.names or ()
    as_written = [name.strip().lower() for name in names]
    columns: dict[str, int] = {}
    for column, called in reading.columns.items():  # first, so that no other column takes what they name
        if column not in meanings or called is False:
            continue
        if isinstance(called, int):
            columns[column] = called - 1
        elif called.strip().lower() in as_written:
            columns[column] = column_number(file, layout, called)
        elif (at := _named(names, [called])) is not None:
            columns[column] = at
    for column, aliases in meanings.items():
        # depths of picks are often called otherwise than a survey's
        called = reading.columns.get(column)
        if column in columns or called is False or (called is not None and meanings is not SURVEY):
            continue
        at = _named(names, aliases)
        if at is not None and first and column in ("block", "surface"):
            naming = [may_name_units(row[n] for row in first if n < len(row)) for n in range(len(names))]
            those = _named([name if has else "" for name, has in zip(names, naming, strict=True)], aliases)
            at = at if those is None else those
        if at is not None and at not in columns.values() and _is_beside(names[at], columns, names):
            columns[column] = at
    return columns


def _is_beside(name: str, columns: Mapping[str, int], names: Sequence[str]) -> bool:
    """Whether a name that means something only in its language stands beside the other one there: A, beside
    Da."""
    other = _BESIDE.get(name.strip().lower())
    return other is None or any(names[at].strip().lower() == other for at in columns.values())


def _require(reading: Reading, header: TableHeader, needed: Sequence[str]) -> None:
    for column in needed:
        if column not in header.columns and _OTHER_END.get(column) not in header.columns:
            called = reading.columns.get(column)
            what = f"the header has no column {called or column}"
            advice = f'name it: columns = {{ {column} = "..." }}'
            advice += f"; it has {names_shown(header.names)}" if header.names else ""
            if column in ("x", "y") and _named(header.names, _GEOGRAPHIC) is not None:
                what = "places are longitude and latitude"
                advice = "give x and y in a projected system, in meters or feet"
            raise InputRefused(what, file=header.file, line=header.line, advice=advice)
