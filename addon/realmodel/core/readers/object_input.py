# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects by their names in files, and the picks and logged intervals of boreholes among them."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
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
from .tables.hole_tables import INTERVALS, PICKS, RawTable
from .tables.table_layout import names_shown, plain_name

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
    """Raises InputRefused instead of all errors of a library for a damaged file."""
    try:
        with file_format.read(file, step) as opened:
            yield opened
    except RealModelError:
        raise
    except Exception as error:
        what = f"not a file of {file_format.label} that can be read: {error or type(error).__name__}"
        raise InputRefused(what, file=file) from error


_KINDS = (HOLE, LINES, POINTS)
_NAMES_OF_PICKS = (*PICKS["surface"], *INTERVALS["block"])
_SHEETS = {
    "collars": ("hole", "x", "y", "z"),
    "intervals": ("hole", "from", "to", "block"),
    "picks": ("hole", "x", "y", "z", "surface"),
}


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


def hole_sheets(
    boreholes: Boreholes, model_unit: str
) -> tuple[dict[str, RawTable], dict[str, tuple[np.ndarray, np.ndarray]], list[str]]:
    """The boreholes of files of objects, or their object `layer`, as tables of collars, intervals and picks,
    those that they have and that are requested, in the model's unit; their lines, as of HoleTables; and
    warnings, sentences.

    Picks are points whose data name a surface; where only picks are requested, the beginnings of intervals
    that name one, too, where the interval above has another name. `hole` among the data names the hole, else
    the object's name does. Raises InputRefused naming the file and the object.
    """
    holes = _HoleRows(boreholes)
    for file in dict.fromkeys(boreholes.files):
        objects, warnings = _read_holes(boreholes, file, model_unit)
        holes.warnings += warnings
        asked = {kind for kind in ("picks", "intervals") if _is_asked(boreholes, kind, file)}
        count = len(holes.picks), len(holes.intervals)
        for obj in objects:
            holes.add(obj, asked)
        if not boreholes.file and count == (len(holes.picks), len(holes.intervals)):
            raise _without_names(objects, boreholes, file, "block" if "intervals" in asked else "surface")
    return holes.sheets(), holes.lines, holes.warnings


class _HoleRows:
    """The rows of the tables of boreholes of objects, and the lines of the holes."""

    def __init__(self, boreholes: Boreholes):
        self._boreholes = boreholes
        self._collars: dict[str, np.ndarray] = {}
        self.intervals: list[list[str]] = []
        self.picks: list[list[str]] = []
        self.lines: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self.warnings: list[str] = []

    def add(self, obj: GeoObject, asked: set[str]) -> None:
        """Adds the data of an object for the requested kinds of tables."""
        if obj.collar is not None and np.isfinite(obj.collar).all():
            self._collars[obj.name] = obj.collar
        for values in obj.values:
            is_log = values.ends is not None and "intervals" in asked
            meaning, aliases = ("block", INTERVALS["block"]) if is_log else ("surface", _NAMES_OF_PICKS)
            column = _column(values, self._boreholes.columns.get(meaning), aliases)
            if column is None:
                continue
            names, holes = _texts(values.columns[column]), _holes(obj, values, self._boreholes)
            if is_log:
                self._add_intervals(obj, values, names, holes)
            elif "picks" in asked:
                self._add_picks(values, names, holes)
                if "intervals" not in asked:
                    break

    def _add_intervals(self, obj: GeoObject, values: Values, names: list[str], holes: list[str]) -> None:
        begins, ends = values.places, values.ends
        assert ends is not None
        lacking = ~(np.isfinite(begins).all(axis=1) & np.isfinite(ends).all(axis=1))
        if lacking.any():
            what = f"an interval of hole '{holes[int(lacking.argmax())]}' has no place"
            raise InputRefused(what, file=self._boreholes.files[-1], item=f"object '{obj.name}'")
        depths = _depths(begins, ends, holes) if values.depths is None else values.depths
        for hole in dict.fromkeys(holes):
            rows = np.array(holes) == hole
            known, places = self.lines.get(hole, (np.empty(0), np.empty((0, 3))))
            more = np.stack([begins[rows], ends[rows]], axis=1).reshape(-1, 3)
            self.lines[hole] = np.append(known, depths[rows]), np.concatenate([places, more])
        self.intervals += [
            [hole, *map(repr, row), name]
            for hole, row, name in zip(holes, depths.tolist(), names, strict=True)
        ]

    def _add_picks(self, values: Values, names: list[str], holes: list[str]) -> None:
        before = ("", "")
        missing = 0
        for name, hole, place in zip(names, holes, values.places, strict=True):
            repeats = values.ends is not None and (name, hole) == before
            before = (name, hole)
            if repeats or not name:
                continue
            if np.isfinite(place).all():
                self.picks.append([hole, *map(repr, place.tolist()), name])
            else:
                missing += 1
        if missing:
            file = self._boreholes.files[-1]
            self.warnings.append(f"{file}: left out: {counted(missing, 'pick')} without a place")

    def sheets(self) -> dict[str, RawTable]:
        """The tables. Where a collar is known, or depths are, all holes get one: the beginning of their line,
        or their highest pick."""
        collars = dict(self._collars)
        if self.lines or collars:
            collars |= {
                hole: places[int(depths.argmin())]
                for hole, (depths, places) in self.lines.items()
                if hole not in collars
            }
            for hole, *place, _ in sorted(self.picks, key=lambda row: -float(row[3])):
                collars.setdefault(hole, np.array(list(map(float, place))))
        rows = {
            "intervals": self.intervals,
            "picks": self.picks,
            "collars": [[hole, *map(repr, collar.tolist())] for hole, collar in collars.items()],
        }
        numbers = itertools.count(1)  # no two rows have one, as keys of a project name rows by them
        return {
            kind: RawTable(_SHEETS[kind], [(next(numbers), row) for row in of_kind], row_name="row")
            for kind, of_kind in rows.items()
            if of_kind
        }


def _is_asked(boreholes: Boreholes, kind: str, file: Path) -> bool:
    said = boreholes.file or getattr(boreholes, kind)
    return said is not None and Path(said) == file


def _without_names(objects: list[GeoObject], boreholes: Boreholes, file: Path, meaning: str) -> InputRefused:
    names = [name for obj in objects for values in obj.values for name in values.columns]
    what = f"it has no data '{boreholes.columns.get(meaning) or meaning}'"
    advice = f"it has {names_shown(list(dict.fromkeys(names)))}: " if names else ""
    advice += f'name it: columns = {{ {meaning} = "..." }}'
    return InputRefused(what, file=file, item=f"object '{objects[0].name}'", advice=advice)


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


def _column(values: Values, said: object, aliases: Iterable[str]) -> str | None:
    """The name of a column: the user's, or the first with a usual name."""
    if said is not None:
        return next((name for name in values.columns if name.lower() == str(said).strip().lower()), None)
    plain = {plain_name(name): name for name in reversed(values.columns)}
    return next((plain[alias] for alias in aliases if alias in plain), None)


def _holes(obj: GeoObject, values: Values, boreholes: Boreholes) -> list[str]:
    column = _column(values, boreholes.columns.get("hole"), PICKS["hole"])
    return [obj.name] * len(values.places) if column is None else _texts(values.columns[column])


def _texts(column: np.ndarray) -> list[str]:
    return [value.strip() if isinstance(value, str) else f"{value:g}" for value in column.tolist()]
