# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads tables of boreholes, of observed blocks and of dips for a rock mass, each told by its columns."""

from dataclasses import dataclass, field, replace
from pathlib import Path

from ...core import DipFile, Dips, InputRefused, ObservationFile, Observations, SpaceDips
from ...core.readers import (
    Picks,
    UnitNames,
    dip_warnings,
    names_units,
    read_dips,
    read_dips_of_rock,
    read_observed_places,
    read_picks,
    read_space_dips,
    table_contents,
    table_kind,
)
from ...core.readers.formats import HOLES, SHAPES, endings, format_of
from ...core.readers.hole_values import is_log, read_interval_values
from ...core.readers.object_input import is_object_file
from ...core.readers.table_kind import sheet_kinds
from ...core.readers.tables.dialects.workbook import is_workbook, sheet_names
from ...core.readers.tables.hole_data import MEANINGS
from ...core.readers.tables.hole_tables import COLLARS, OBSERVED, columns_in, normalized_name
from ...core.readers.tables.table_layout import plain_name
from ...core.settings.data_files import HOLE_COLUMNS as OF_HOLES
from ...core.settings.data_files import OBSERVATION_COLUMNS as OF_PLACES
from ...core.settings.data_files import Boreholes, MapFile, check_column_names
from ...core.settings.dips import COLUMNS as OF_DIPS
from ..project import observed_blocks, surface_dips
from ..scene import borehole_points
from . import map_settings

ALL_COLUMNS = tuple(dict.fromkeys((*OF_HOLES, *OF_PLACES, *OF_DIPS)))
_ONE_OF_EACH = ("collars", "survey", "picks", "intervals", "file")


@dataclass
class FieldTables:
    """boreholes: None where there are none. assays: Boreholes whose intervals have no blocks. observations,
    dips: ObservationFile and DipFile. rock_dips: DipFiles that name surfaces or blocks; those of `dips` name
    none. series_dips: DipFiles of the field of a series. maps: MapFile, whose ground is a file or the name of
    a surface."""

    boreholes: Boreholes | None = None
    assays: list = field(default_factory=list)
    maps: list = field(default_factory=list)
    observations: list = field(default_factory=list)
    dips: list = field(default_factory=list)
    rock_dips: list = field(default_factory=list)
    series_dips: list = field(default_factory=list)

    @property
    def coded(self):
        """All that name surfaces or blocks."""
        holes = [] if self.boreholes is None else [self.boreholes]
        return [*holes, *self.observations, *self.rock_dips, *self.maps]

    def give_dips_to_series(self, every):
        """Dips are those of a field: all of them, or those that name neither surfaces nor blocks."""
        self.series_dips, self.dips = self.dips, []
        if every:
            self.series_dips, self.rock_dips = self.series_dips + self.rock_dips, []


@dataclass
class Found:
    """What tables say, in model units. picks: of boreholes. observations: of their intervals and of places.
    dips: of one surface, rock_dips: with their surfaces and blocks, series_dips: SpaceDips or, of
    sheets, Dips; None where there are none. new: units
    that no surface, block or body is called, to be added. values: IntervalValues of tables of intervals and
    assays. maps: DrapedMap of each map. warnings: sentences."""

    picks: Picks
    observations: Observations
    dips: Dips | None
    rock_dips: Dips | None
    series_dips: SpaceDips | Dips | None
    left_out: list
    new: list
    values: list
    maps: list = field(default_factory=list)
    warnings: list = field(default_factory=list)

    def give_dips_to_sheets(self):
        """All dips are those of a series of sheets, whose surfaces and blocks they may name."""
        parts = [part for part in (self.dips, self.rock_dips) if part is not None]
        self.series_dips = Dips.joined(parts) if parts else None
        self.dips = self.rock_dips = None


def sorted_out(paths, columns, units=None, of_maps=None, **of_holes):
    """FieldTables of files. columns: names of those that are called otherwise, in any of the tables. of_maps:
    keys of MapFile beside its file, for all maps. of_holes: what else Boreholes have; tables given there are
    added to those of `paths`. Raises InputRefused, and OptionRefused."""
    check_column_names(columns, ALL_COLUMNS)
    tables = {kind: file for kind in _ONE_OF_EACH if (file := of_holes.pop(kind, None)) is not None}
    sorted_tables, assays = FieldTables(), []
    logs = [path for path in paths if is_log(path)]
    if len(logs) == len(paths) == 1 and not tables:
        tables["file"] = logs[0]  # which may have its collar, and tops
    for path in paths:
        if path in tables.values() or path in logs:
            continue
        if is_map(path):
            sorted_tables.maps.append(_map_file(path, of_maps or {}, units))
            continue
        kind = "picks" if is_object_file(path) else "file" if has_holes(path) else table_kind(path, columns)
        if kind == "observations":
            sorted_tables.observations.append(ObservationFile(path, _of(columns, OF_PLACES), units=units))
        elif kind == "dips":
            file = DipFile(path, _of(columns, OF_DIPS), units=units)
            (sorted_tables.rock_dips if names_units(file) else sorted_tables.dips).append(file)
        elif kind == "assays":
            assays.append(path)
        elif kind in tables:
            what = f"{tables[kind].name} and {path.name} both have {kind}"
            raise InputRefused(what, file=path, advice="choose one of them, or name columns that differ")
        else:
            tables[kind] = path
    if logs:
        tables["logs"] = logs
    of_holes |= {"columns": _of(columns, OF_HOLES), "units": units}
    if tables and not (assays and tables.keys() <= {"collars", "survey"}):
        sorted_tables.boreholes = _boreholes(tables, of_holes)
    for path in assays:
        of_assays = tables | {"picks": None, "intervals": path, "logs": ()}
        sorted_tables.assays.append(_boreholes(of_assays, of_holes))
    return sorted_tables


def _boreholes(tables, of_holes):
    """Boreholes, with those of the rows that are named which their tables have. Raises OptionRefused."""
    names = {Path(file).name for kind in _ONE_OF_EACH if (file := tables.get(kind)) is not None}
    rows = {
        key: [row for row in of_holes.get(key, ()) if _file_of(row) in names]
        for key in ("unrepaired", "left_out")
    }
    boreholes = Boreholes(**tables, **of_holes | rows)
    boreholes.check()
    return boreholes


def _file_of(row):
    """The name of the file of a row such as collars.csv:17 or site.xlsx[Collars]:17."""
    return row.rpartition(":")[0].strip().partition("[")[0]


def is_map(path):
    """Whether a file has shapes in plan."""
    return path.suffix.lower() in endings(SHAPES)


def has_holes(path):
    """Whether a file has boreholes by its format, with all of their tables at once, or in several sheets."""
    return is_object_file(path) or format_of(path, HOLES) is not None or bool(hole_sheets(path))


def hole_sheets(path):
    """{sheet: kind} of a workbook with several, as far as they are tables of boreholes; empty for others."""
    try:
        if not is_workbook(path) or len(sheet_names(path)) < 2:
            return {}
        return {name: kind for name, kind in sheet_kinds(path).items() if kind in MEANINGS}
    except InputRefused:
        return {}


def columns_of(preview):
    """{meaning: column} of a TablePreview, by name, or by number from 1, as the table is understood without a
    word."""
    try:
        known, _ = table_contents(preview.file, sheet=preview.sheet)
    except InputRefused:
        places = {key: COLLARS[key] for key in ("hole", "x", "y", "z")}
        known = columns_in(Boreholes(), preview.file, places, preview.sheet)
    plain = [plain_name(name) for name in preview.names]
    numbered = {meaning: plain.index(name) for meaning, name in known.items() if name in plain}
    is_known = preview.has_header
    return {m: preview.names[at] for m, at in numbered.items() if is_known and m in ALL_COLUMNS}


def block_attribute(names):
    """The attribute of the features of a map that has a usual name for blocks, or the only one; None where it
    is not clear."""
    by_plain_name = {plain_name(str(name)): name for name in names}
    usual = (by_plain_name[name] for name in OBSERVED["block"] if name in by_plain_name)
    return next(usual, names[0] if len(names) == 1 else None)


def _map_file(path, keys, units):
    map_file = MapFile(path, units=units, **keys)
    map_file.check()
    return map_file


def _of(columns, names):
    return {name: column for name, column in columns.items() if name in names}


def read(scene, rock, tables, names, add_surfaces):
    """What FieldTables say of a rock mass: its row, or None where there is none yet. names: what units are
    called in it, as of a project file. add_surfaces: units that nothing is called become surfaces. Raises
    InputRefused."""
    units = observed_blocks.units_of(scene, rock, names)
    result = _read(scene, rock, tables, units)
    new = result.new
    picked = [name for name in result.picks.points if name not in (*units.surfaces, *new)]
    if not add_surfaces:
        result.new = []
    elif new or (picked and tables.rock_dips):
        units = UnitNames(
            (*units.surfaces, *picked, *new), (*units.blocks, *picked, *new), units.bodies, units.names
        )
        result = _read(scene, rock, tables, units)
        result.new = new
    return result


def forget(rock, data):
    """Removes what a rock mass has of the holes and of the places of dips that are imported again."""
    holes = data.picks.holes.keys()
    borehole_points.forget(rock, holes)
    observed_blocks.forget(rock, holes)
    if data.rock_dips is not None:
        surface_dips.forget(rock, data.rock_dips)


def _read(scene, rock, tables, units):
    unit = scene.realmodel.units
    step = rock.edge_length if rock is not None and rock.edge_length > 0.0 else None
    picks = Picks()
    logged = [*tables.assays]
    if tables.boreholes is not None:
        picks = read_picks(tables.boreholes, unit, units=units, plan_step=step)
        intervals = tables.boreholes.intervals
        has_values = intervals is not None and not is_object_file(intervals)
        logged += [replace(tables.boreholes, logs=())] if has_values else []
    seen, left_out = list(picks.observations), list(picks.left_out)
    for file in tables.observations:
        observed, not_used = read_observed_places(file, units, unit)
        seen.append(observed)
        left_out += not_used
    maps, warnings = [], []
    for file in tables.maps:
        observed, not_used, draped, said = map_settings.read(scene, rock, file, units)
        seen.append(observed)
        left_out += not_used
        maps.append(draped)
        warnings += [*said, *draped.warnings]
    dips, of_rock = [read_dips(file, unit) for file in tables.dips], []
    for file in tables.rock_dips:
        named, not_used = read_dips_of_rock(file, units, unit)
        of_rock.append(named)
        left_out += not_used
    of_series = [read_space_dips(file, unit) for file in tables.series_dips]
    for file in (*tables.dips, *tables.rock_dips, *tables.series_dips):
        warnings += dip_warnings(file, unit)
    known_names = {*units.surfaces, *units.blocks, *units.bodies}
    codes = [entry.block for entry in left_out if entry.kind == "unknown_block"]
    meant = {}
    for name in map(units.meaning, codes):
        meant.setdefault(normalized_name(name), name)  # of names that are written in several ways the first
    return Found(
        picks,
        Observations.joined(seen),
        Dips.joined(dips) if dips else None,
        Dips.joined(of_rock) if of_rock else None,
        SpaceDips.joined(of_series) if of_series else None,
        left_out,
        [name for name in meant.values() if name not in known_names],
        [
            *(read_interval_values(boreholes, unit) for boreholes in logged),
            *([picks.logs] if picks.logs else []),
        ],
        maps,
        warnings,
    )
