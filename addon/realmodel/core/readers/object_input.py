# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects by their names in files, and the picks and logged intervals of boreholes among them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..base.algebra import norm
from ..base.errors import InputRefused, RealModelError, counted, number_list
from ..base.text import Step, no_step
from ..base.units import factor
from ..settings.data_files import Boreholes, MeshFile
from .formats import HOLES, OBJECTS, FileFormat, format_of
from .objects.geo_object import (
    HOLE,
    LINES,
    POINTS,
    SURFACE,
    GeoObject,
    ObjectName,
    OpenFile,
    Values,
    object_units,
)
from .tables.boreholes import Pick, Picks
from .tables.hole_tables import INTERVALS, PICKS, RawTable
from .tables.intervals import known_interval, observed_intervals, plan_step_of, tops_of
from .tables.observations import Observations, Origin
from .tables.table_layout import names_shown, plain_name
from .tables.unit_names import UnitNames

_NAMES_LISTED = 60
_PLURALS = {POINTS: "sets of points", LINES: "lines", SURFACE: "surfaces", HOLE: "boreholes"}


def is_object_file(file: Path) -> bool:
    """Whether a file is one of objects. Raises InputRefused where it cannot be read."""
    file_format = format_of(file, HOLES, OBJECTS)
    return file_format is not None and file_format.holds == OBJECTS


def objects_in(file: Path) -> list[ObjectName]:
    """The objects of a file that are read; none of another file. Raises InputRefused, UsageError where the
    library is missing."""
    file_format = format_of(file, OBJECTS)
    if file_format is None:
        return []
    with _opened(file, file_format) as opened:
        return opened.names()


def read_object(file: Path, layer: str | None, kinds: Collection[str], step: Step = no_step) -> GeoObject:
    """The object of this name, or the only one of these kinds. Raises InputRefused, UsageError where the
    library is missing."""
    (geo_object,) = read_objects(file, layer, kinds, False, step)
    return geo_object


def read_objects(
    file: Path, layer: str | None, kinds: Collection[str], several: bool = True, step: Step = no_step
) -> list[GeoObject]:
    """The object of this name, or those of these kinds, if there may be several. Raises as read_object."""
    file_format = format_of(file, OBJECTS)
    assert file_format is not None
    with _opened(file, file_format, step) as opened:
        return [opened.read(obj) for obj in _chosen(file, opened.names(), layer, kinds, several)]


def _chosen(
    file: Path, objects: list[ObjectName], layer: str | None, kinds: Collection[str], several: bool
) -> list[ObjectName]:
    """The objects of some kinds, or those of a name: as it is written, or else in any case. Where one name
    has several kinds the first of `kinds` counts."""
    said = " or ".join(_PLURALS[kind] for kind in kinds)
    listed = f"it has {_listed(objects)}" if objects else None
    if layer is None:
        fitting = [obj for obj in objects if obj.kind in kinds and not obj.is_part]
    else:
        named = [obj for obj in objects if obj.name == layer]
        named = named or [obj for obj in objects if obj.name.casefold() == layer.casefold()]
        if not named:
            raise InputRefused(f"it has no object '{layer}'", file=file, advice=listed)
        fitting = [obj for obj in named if obj.kind in kinds]
        if not fitting:
            what = f"'{layer}' is of the kind {named[0].kind}, and {said} are needed"
            raise InputRefused(what, file=file)
    if not fitting and objects and tuple(kinds) == (SURFACE,):
        advice = f"if it holds points, read it as points: {listed}"
        raise InputRefused("it has no faces", file=file, advice=advice)
    if not fitting:
        raise InputRefused(f"it has no {said}", file=file, advice=listed)
    if several or len(fitting) == 1:
        return fitting
    kinds_there = [kind for kind in kinds if kind in {obj.kind for obj in fitting}]
    if len({obj.name for obj in fitting}) == 1 and len(kinds_there) == len(fitting):
        return [next(obj for obj in fitting if obj.kind == kinds_there[0])]
    if layer is not None:
        what, advice = f"it has {len(fitting)} objects '{layer}'", "give each object another name"
        raise InputRefused(what, file=file, advice=advice)
    advice = f'say which: layer = "..."; it has {_listed([obj for obj in objects if obj.kind in kinds])}'
    raise InputRefused(f"it has {len(fitting)} {said}", file=file, advice=advice)


def _listed(objects: list[ObjectName]) -> str:
    """The names of objects, for messages."""
    names = [f"{name:.60}" for name in dict.fromkeys(obj.name for obj in objects)]
    return number_list(names, _NAMES_LISTED) if len(names) > _NAMES_LISTED else ", ".join(names)


@contextmanager
def _opened(file: Path, file_format: FileFormat, step: Step = no_step) -> Iterator[OpenFile]:
    """Raises InputRefused in the place of whatever a library raises for a damaged file."""
    try:
        with file_format.read(file, step) as opened:
            yield opened
    except RealModelError:
        raise
    except Exception as error:
        what = f"not a file of {file_format.label} that can be read: {error or type(error).__name__}"
        raise InputRefused(what, file=file) from error


_KINDS = (HOLE, LINES, POINTS)


def _read_holes(boreholes: Boreholes, file: Path, model_unit: str) -> tuple[list[GeoObject], list[str]]:
    """The boreholes of a file, or its object `layer`, in the model's unit, and warnings, sentences. Raises
    InputRefused for a unit that is not known."""
    objects, warnings = [], []
    for obj in read_objects(file, boreholes.layer, (HOLE,) if boreholes.layer is None else _KINDS):
        of_axes, said = object_units(MeshFile(file, boreholes.units), obj, model_unit)
        plan, height = (factor(unit, model_unit) for unit in of_axes)
        objects.append(obj.scaled(np.array([plan, plan, height])))
        warnings += [text for text in said if text not in warnings]
    return objects, warnings


def read_hole_objects(given: Boreholes, model_unit: str, units: UnitNames, plan_step: float | None) -> Picks:
    """What the boreholes of a file say, or the object `layer`, in the model's unit. units: what the names in
    it mean. plan_step: as of read_intervals.

    Picks are points whose data name a surface, and tops of intervals that name one where the interval above
    has another name. `hole` among the data names the hole, else the object's name does. Raises InputRefused
    naming the file and the object.
    """
    picks = Picks()
    for file in dict.fromkeys(given.files):
        objects, warnings = _read_holes(given, file, model_unit)
        picks.warnings += warnings
        if given.picks is not None and Path(given.picks) == file:
            _add_picks(picks, objects, given, units)
        if given.intervals is not None and Path(given.intervals) == file:
            _add_intervals(picks, objects, given, (units, plan_step))
    for _, places in picks.holes.values():
        places.sort(key=lambda pick: -pick[1][2])
    return picks


def hole_sheets(boreholes: Boreholes, file: Path, model_unit: str) -> tuple[dict[str, RawTable], list[str]]:
    """The boreholes of a file of objects, or its object `layer`, as tables of collars, intervals and picks,
    those that it has, in the model's unit; and warnings, sentences. Raises as read_object."""
    rows: dict[str, list[tuple[int, list[str]]]] = {"collars": [], "intervals": [], "picks": []}
    objects, warnings = _read_holes(boreholes, file, model_unit)
    for obj in objects:
        collar = np.full(3, np.nan) if obj.collar is None else obj.collar
        if np.isfinite(collar).all():
            rows["collars"].append((0, [obj.name, *map(repr, collar.tolist())]))
        for values in obj.values:
            meaning, aliases = ("surface", (*PICKS["surface"], *INTERVALS["block"]))
            if values.ends is not None:
                meaning, aliases = ("block", INTERVALS["block"])
            column = _column(values, boreholes.columns.get(meaning), aliases)
            if column is None:
                continue
            names, holes = _texts(values.columns[column]), _holes(obj, values, boreholes)
            numbers = values.places
            if values.ends is not None:
                along = values.depths
                numbers = _depths(values.places, values.ends, holes) if along is None else along
            kind = "picks" if values.ends is None else "intervals"
            rows[kind] += [
                (0, [hole, *map(repr, row), name])
                for hole, row, name in zip(holes, numbers.tolist(), names, strict=True)
            ]
    columns = {
        "collars": ("hole", "x", "y", "z"),
        "intervals": ("hole", "from", "to", "block"),
        "picks": ("hole", "x", "y", "z", "surface"),
    }
    sheets = {kind: RawTable(columns[kind], table_rows) for kind, table_rows in rows.items() if table_rows}
    return sheets, warnings


def _add_picks(picks: Picks, objects: list[GeoObject], boreholes: Boreholes, units: UnitNames) -> None:
    points: dict[str, list[Pick]] = {}
    missing = 0
    for obj in objects:
        for code, hole, place in _picks_of(obj, boreholes):
            surface = units.surface(code)
            if units.says_nothing(code) or not surface:
                continue
            if not np.isfinite(place).all():
                missing += 1
                continue
            points.setdefault(surface, []).append((Origin(hole), place))
            picks.holes.setdefault(hole, (obj.collar, []))[1].append((surface, place))
    picks.of_surfaces |= points
    if not points:
        raise InputRefused("there are no picks in it", file=boreholes.picks)
    if missing:
        picks.warnings.append(f"{boreholes.picks}: left out: {counted(missing, 'pick')} without a place")


def _picks_of(obj: GeoObject, boreholes: Boreholes) -> Iterator[tuple[str, str, np.ndarray]]:
    """The name of the surface, the hole and the place (3,) of each pick of an object."""
    aliases = (*PICKS["surface"], *INTERVALS["block"])
    values, column = _table(obj, obj.values, boreholes, "surface", aliases)
    names, holes = _texts(values.columns[column]), _holes(obj, values, boreholes)
    before = ("", "")
    for name, hole, place in zip(names, holes, values.places, strict=True):
        repeats = values.ends is not None and (name, hole) == before
        before = (name, hole)
        if not repeats:
            yield name, hole, place


@dataclass
class _Log:
    """The intervals of a hole: where their ends are, by depth, and (from, to, block)."""

    collar: np.ndarray | None
    depths: list[float] = field(default_factory=list)
    places: list[np.ndarray] = field(default_factory=list)
    intervals: list[tuple[float, float, str]] = field(default_factory=list)

    def place(self, depth: float) -> np.ndarray:
        """(3,) the place of a depth, on straight lines between the known ones."""
        depths, first = np.unique(self.depths, return_index=True)
        places = np.array(self.places)[first]
        return np.array([np.interp(depth, depths, column) for column in places.T])


def _add_intervals(
    picks: Picks,
    objects: list[GeoObject],
    boreholes: Boreholes,
    meaning: tuple[UnitNames, float | None],
) -> None:
    units, plan_step = meaning
    logs: dict[str, _Log] = {}
    for obj in objects:
        _read_log(logs, picks, obj, boreholes, units)
    if not logs:
        raise InputRefused("there are no intervals in it", file=boreholes.intervals)
    if plan_step is None:
        plan_step = plan_step_of(np.array([log.places[0][:2] for log in logs.values()]))
    parts = []
    for hole, log in logs.items():
        parts.append(observed_intervals(hole, log.intervals, log.place, plan_step, picks.left_out))
        picks.holes.setdefault(hole, (log.collar, []))[1].extend(tops_of(parts[-1]))
    picks.observations.append(Observations.joined(parts))


def _read_log(
    logs: dict[str, _Log],
    picks: Picks,
    obj: GeoObject,
    boreholes: Boreholes,
    units: UnitNames,
) -> None:
    tables = [values for values in obj.values if values.ends is not None]
    values, column = _table(obj, tables, boreholes, "block", INTERVALS["block"])
    names, holes = _texts(values.columns[column]), _holes(obj, values, boreholes)
    assert values.ends is not None
    begins, ends = values.places, values.ends
    depths = _depths(begins, ends, holes) if values.depths is None else values.depths
    for code, hole, (low, high), begin, end in zip(names, holes, depths.tolist(), begins, ends, strict=True):
        log = logs.setdefault(hole, _Log(obj.collar))
        if not (np.isfinite(begin).all() and np.isfinite(end).all()):
            what = f"an interval of hole '{hole}' has no place"
            raise InputRefused(what, file=boreholes.intervals, item=f"object '{obj.name}'")
        log.depths += [low, high]
        log.places += [begin, end]
        where = f"object '{obj.name}', hole '{hole}' at {low:.9g}, '{code}'"
        if not units.says_nothing(code):
            interval = known_interval((low, high, code), hole, where, units, picks.left_out)
            log.intervals += [] if interval is None else [interval]


def _depths(begins: np.ndarray, ends: np.ndarray, holes: list[str]) -> np.ndarray:
    """(N, 2) the depths of the ends of intervals that follow one another along each hole, from 0."""
    last: dict[str, tuple[float, np.ndarray]] = {}
    depths = []
    for hole, begin, end in zip(holes, begins, ends, strict=True):
        depth, place = last.get(hole, (0.0, begin))
        depth += float(norm(begin - place))
        depths.append((depth, depth + float(norm(end - begin))))
        last[hole] = depths[-1][1], end
    return np.array(depths).reshape(-1, 2)


def _table(
    obj: GeoObject, tables: list[Values], boreholes: Boreholes, meaning: str, aliases: Iterable[str]
) -> tuple[Values, str]:
    """The data of an object that name surfaces or blocks, and under which name."""
    said = boreholes.columns.get(meaning)
    for values in tables:
        column = _column(values, said, aliases)
        if column is not None:
            return values, column
    names = [name for values in tables for name in values.columns]
    what = f"it has no data '{said or meaning}'"
    advice = f"it has {names_shown(names)}: " if names else ""
    advice += f'name it: columns = {{ {meaning} = "..." }}'
    raise InputRefused(what, file=boreholes.files[-1], item=f"object '{obj.name}'", advice=advice)


def _column(values: Values, said: object, aliases: Iterable[str]) -> str | None:
    """The name of a column: the one that the user says, or the first that is called as usual."""
    if said is not None:
        return next((name for name in values.columns if name.lower() == str(said).strip().lower()), None)
    plain = {plain_name(name): name for name in reversed(values.columns)}
    return next((plain[alias] for alias in aliases if alias in plain), None)


def _holes(obj: GeoObject, values: Values, boreholes: Boreholes) -> list[str]:
    column = _column(values, boreholes.columns.get("hole"), PICKS["hole"])
    return [obj.name] * len(values.places) if column is None else _texts(values.columns[column])


def _texts(column: np.ndarray) -> list[str]:
    return [value.strip() if isinstance(value, str) else f"{value:g}" for value in column.tolist()]
