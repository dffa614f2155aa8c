# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects by their names in files: one registry of formats (docs/dev/extending.md). The format is detected
from the content."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputRefused, RealModelError
from ..tables.table_layout import names_shown
from .geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject, ObjectName, OpenFile
from .geoh5_file import begins_as_geoh5, open_geoh5
from .omf_file import begins_as_omf, open_omf

_MAGIC_SIZE = 8
_PLURALS = {POINTS: "sets of points", LINES: "lines", SURFACE: "surfaces", HOLE: "boreholes"}


@dataclass(frozen=True)
class ObjectFormat:
    """begins(head): whether a file that begins with these bytes is of this format. open(file): a context, in
    which it may raise anything that its library does."""

    name: str
    endings: tuple[str, ...]
    begins: Callable[[bytes], bool]
    open: Callable[[Path], AbstractContextManager[OpenFile]]


OBJECT_FORMATS = (
    ObjectFormat("OMF", (".omf",), begins_as_omf, open_omf),
    ObjectFormat("geoh5", (".geoh5",), begins_as_geoh5, open_geoh5),
)
OBJECT_NAMES = tuple(known.name for known in OBJECT_FORMATS)
OBJECT_ENDINGS = tuple(ending for known in OBJECT_FORMATS for ending in known.endings)


def object_format(head: bytes) -> ObjectFormat | None:
    """The format of a file that begins so; None of others."""
    return next((known for known in OBJECT_FORMATS if known.begins(head)), None)


def is_object_file(file: Path) -> bool:
    """Whether a file is one of objects. Raises InputRefused where it cannot be read."""
    return _format_of(file) is not None


def objects_in(file: Path) -> list[ObjectName]:
    """The objects of a file that are read; none of another file. Raises InputRefused, UsageError where the
    library is missing."""
    known = _format_of(file)
    if known is None:
        return []
    with _opened(file, known) as opened:
        return opened.names()


def read_object(file: Path, layer: str | None, kinds: Collection[str]) -> GeoObject:
    """The object of this name, or the only one of these kinds. Raises InputRefused, UsageError where the
    library is missing."""
    (found,) = read_objects(file, layer, kinds, several=False)
    return found


def read_objects(
    file: Path, layer: str | None, kinds: Collection[str], several: bool = True
) -> list[GeoObject]:
    """The object of this name, or those of these kinds, if there may be several. Raises as read_object."""
    known = _format_of(file)
    assert known is not None
    with _opened(file, known) as opened:
        return [opened.read(each) for each in _chosen(file, opened.names(), layer, kinds, several)]


def _chosen(
    file: Path, found: list[ObjectName], layer: str | None, kinds: Collection[str], several: bool
) -> list[ObjectName]:
    fitting = [each for each in found if each.kind in kinds]
    said = " or ".join(_PLURALS[kind] for kind in kinds)
    there = f"it has {names_shown([each.name for each in found])}" if found else None
    if layer is not None:
        named = [each for each in found if each.name == layer]
        named = named or [each for each in found if each.name.lower() == layer.lower()]
        if not named:
            raise InputRefused(f"it has no object '{layer}'", file=file, advice=there)
        fitting = [each for each in named if each.kind in kinds]
        if not fitting:
            what = f"'{layer}' is of the kind {named[0].kind}, and {said} are needed"
            raise InputRefused(what, file=file)
        if len(fitting) > 1:
            advice = "give each object another name"
            raise InputRefused(f"it has {len(fitting)} objects '{layer}'", file=file, advice=advice)
    if not fitting:
        raise InputRefused(f"it has no {said}", file=file, advice=there)
    if len(fitting) > 1 and not several:
        advice = f'say which: layer = "..."; it has {names_shown([each.name for each in fitting])}'
        raise InputRefused(f"it has {len(fitting)} {said}", file=file, advice=advice)
    return fitting


def _format_of(file: Path) -> ObjectFormat | None:
    try:
        with file.open("rb") as opened:
            return object_format(opened.read(_MAGIC_SIZE))
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error


@contextmanager
def _opened(file: Path, known: ObjectFormat) -> Iterator[OpenFile]:
    """Raises InputRefused in the place of whatever a library raises for a damaged file."""
    try:
        with known.open(file) as opened:
            yield opened
    except RealModelError:
        raise
    except Exception as error:
        what = f"not a file of {known.name} that can be read: {error or type(error).__name__}"
        raise InputRefused(what, file=file) from error
