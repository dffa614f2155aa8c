# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads tables of boreholes, of observed blocks and of dips for a rock mass, each told by its columns."""

from dataclasses import dataclass, field
from pathlib import Path

from ..core import DipFile, Dips, InputRefused, ObservationFile, Observations
from ..core.readers import (
    MAP_ENDINGS,
    Picks,
    UnitNames,
    read_boreholes,
    read_dips,
    read_observed_places,
    table_kind,
)
from ..core.readers.objects.object_file import is_object_file
from ..core.readers.tables.hole_tables import OBSERVED, PICKS, columns_in
from ..core.readers.tables.interval_values import read_interval_values
from ..core.settings.boreholes import COLUMNS as OF_HOLES
from ..core.settings.boreholes import Boreholes, check_column_names
from ..core.settings.dips import COLUMNS as OF_DIPS
from ..core.settings.map_file import MapFile
from ..core.settings.observation_file import COLUMNS as OF_PLACES
from . import map_settings, observed_blocks, surface_dips

ALL_COLUMNS = tuple(dict.fromkeys((*OF_HOLES, *OF_PLACES, *OF_DIPS)))
_ONE_OF_EACH = ("collars", "survey", "picks", "intervals")


@dataclass
class FieldTables:
    """boreholes: None where there are none. assays: Boreholes whose intervals have no blocks. observations,
    dips: ObservationFile and DipFile. maps: MapFile, whose ground is a file or the name of a surface."""

    boreholes: Boreholes | None = None
    assays: list = field(default_factory=list)
    maps: list = field(default_factory=list)
    observations: list = field(default_factory=list)
    dips: list = field(default_factory=list)


@dataclass
class Found:
    """What tables say, in model units. picks: of boreholes. observations: of their intervals and of places.
    dips: None where there are none. new: units that no surface, block or body is called, to be added. values:
    IntervalValues of tables of intervals and assays. maps: DrapedMap of each map. warnings: sentences."""

    picks: Picks
    observations: Observations
    dips: Dips | None
    left_out: list
    new: list
    values: list
    maps: list = field(default_factory=list)
    warnings: list = field(default_factory=list)


def sorted_out(paths, columns, units=None, of_maps=None, **of_holes):
    """FieldTables of files. columns: names of those that are called otherwise, in any of the tables. of_maps:
    keys of MapFile beside its file, for all maps. of_holes: what else Boreholes have; tables given there are
    added to those of `paths`. Raises InputRefused, and OptionRefused."""
    check_column_names(columns, ALL_COLUMNS)
    tables = {kind: given for kind in _ONE_OF_EACH if (given := of_holes.pop(kind, None)) is not None}
    found, assays = FieldTables(), []
    for path in paths:
        if path in tables.values():
            continue
        if is_map(path):
            found.maps.append(_map_file(path, of_maps or {}, units))
            continue
        kind = "picks" if is_object_file(path) else table_kind(path, columns)
        if kind == "observations":
            found.observations.append(ObservationFile(path, _of(columns, OF_PLACES), units=units))
        elif kind == "dips":
            found.dips.append(DipFile(path, _of(columns, OF_DIPS), units=units))
        elif kind == "assays":
            assays.append(path)
        elif kind in tables:
            what = f"{tables[kind].name} and {path.name} both have {kind}"
            raise InputRefused(what, file=path, advice="choose one of them, or name columns that differ")
        else:
            tables[kind] = path
    of_holes |= {"columns": _of(columns, OF_HOLES), "units": units}
    if tables and not (assays and tables.keys() <= {"collars", "survey"}):
        found.boreholes = Boreholes(**tables, **of_holes)
        found.boreholes.check()
    for path in assays:
        found.assays.append(Boreholes(**tables | {"picks": None, "intervals": path}, **of_holes))
        found.assays[-1].check()
    return found


def is_map(path):
    """Whether a file has shapes in plan."""
    return path.suffix.lower() in MAP_ENDINGS


def _map_file(path, given, units):
    map_file = MapFile(path, units=units, **given)
    map_file.check()
    return map_file


def naming_column(given):
    """The column of a DipFile that names surfaces or blocks; None where there is none."""
    found = {}
    for known in (PICKS, OBSERVED):
        found |= columns_in(given, Path(given.file), known)
    return next((found[key] for key in ("surface", "block") if key in found), None)


def _of(columns, known):
    return {name: column for name, column in columns.items() if name in known}


def read(scene, rock, tables, names, add_surfaces):
    """What FieldTables say of a rock mass: its row, or None where there is none yet. names: what units are
    called in it, as of a project file. add_surfaces: units that nothing is called become surfaces. Raises
    InputRefused."""
    units = observed_blocks.units_of(scene, rock, names)
    found = _read(scene, rock, tables, units)
    if not add_surfaces:
        found.new = []
    elif new := found.new:
        own = [name for name in found.picks.points if name not in (*units.surfaces, *new)]
        units = UnitNames(
            (*units.surfaces, *own, *new), (*units.blocks, *own, *new), units.bodies, units.names
        )
        found = _read(scene, rock, tables, units)
        found.new = new
    return found


def _read(scene, rock, tables, units):
    unit = scene.realmodel.units
    step = rock.edge_length if rock is not None and rock.edge_length > 0.0 else None
    picks = Picks()
    logged = [*tables.assays]
    if tables.boreholes is not None:
        picks = read_boreholes(tables.boreholes, unit, units=units, plan_step=step)
        intervals = tables.boreholes.intervals
        logged += [tables.boreholes] if intervals is not None and not is_object_file(intervals) else []
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
    dips = [read_dips(file, unit) for file in tables.dips]
    known = {*units.surfaces, *units.blocks, *units.bodies}
    codes = [each.block for each in left_out if each.kind == "unknown_block"]
    meant = dict.fromkeys(units.names.get(code, code) for code in codes)
    return Found(
        picks,
        Observations.joined(seen),
        surface_dips.joined(dips) if dips else None,
        left_out,
        [name for name in meant if name not in known],
        [read_interval_values(each, unit) for each in logged],
        maps,
        warnings,
    )
