# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects by their names in files."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..base.errors import InputRefused, RealModelError
from .formats import OBJECTS, FileFormat, format_of
from .objects.geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject, ObjectName, OpenFile
from .tables.table_layout import names_shown

_PLURALS = {POINTS: "sets of points", LINES: "lines", SURFACE: "surfaces", HOLE: "boreholes"}


def is_object_file(file: Path) -> bool:
    """Whether a file is one of objects. Raises InputRefused where it cannot be read."""
    return format_of(file, OBJECTS) is not None


def objects_in(file: Path) -> list[ObjectName]:
    """The objects of a file that are read; none of another file. Raises InputRefused, UsageError where the
    library is missing."""
    file_format = format_of(file, OBJECTS)
    if file_format is None:
        return []
    with _opened(file, file_format) as opened:
        return opened.names()


def read_object(file: Path, layer: str | None, kinds: Collection[str]) -> GeoObject:
    """The object of this name, or the only one of these kinds. Raises InputRefused, UsageError where the
    library is missing."""
    (geo_object,) = read_objects(file, layer, kinds, several=False)
    return geo_object


def read_objects(
    file: Path, layer: str | None, kinds: Collection[str], several: bool = True
) -> list[GeoObject]:
    """The object of this name, or those of these kinds, if there may be several. Raises as read_object."""
    file_format = format_of(file, OBJECTS)
    assert file_format is not None
    with _opened(file, file_format) as opened:
        return [opened.read(obj) for obj in _chosen(file, opened.names(), layer, kinds, several)]


def _chosen(
    file: Path, objects: list[ObjectName], layer: str | None, kinds: Collection[str], several: bool
) -> list[ObjectName]:
    fitting = [obj for obj in objects if obj.kind in kinds]
    said = " or ".join(_PLURALS[kind] for kind in kinds)
    listed = f"it has {names_shown([obj.name for obj in objects])}" if objects else None
    if layer is not None:
        named = [obj for obj in objects if obj.name == layer]
        named = named or [obj for obj in objects if obj.name.lower() == layer.lower()]
        if not named:
            raise InputRefused(f"it has no object '{layer}'", file=file, advice=listed)
        fitting = [obj for obj in named if obj.kind in kinds]
        if not fitting:
            what = f"'{layer}' is of the kind {named[0].kind}, and {said} are needed"
            raise InputRefused(what, file=file)
        if len(fitting) > 1:
            advice = "give each object another name"
            raise InputRefused(f"it has {len(fitting)} objects '{layer}'", file=file, advice=advice)
    if not fitting:
        raise InputRefused(f"it has no {said}", file=file, advice=listed)
    if len(fitting) > 1 and not several:
        advice = f'say which: layer = "..."; it has {names_shown([obj.name for obj in fitting])}'
        raise InputRefused(f"it has {len(fitting)} {said}", file=file, advice=advice)
    return fitting


@contextmanager
def _opened(file: Path, file_format: FileFormat) -> Iterator[OpenFile]:
    """Raises InputRefused in the place of whatever a library raises for a damaged file."""
    try:
        with file_format.read(file) as opened:
            yield opened
    except RealModelError:
        raise
    except Exception as error:
        what = f"not a file of {file_format.label} that can be read: {error or type(error).__name__}"
        raise InputRefused(what, file=file) from error
