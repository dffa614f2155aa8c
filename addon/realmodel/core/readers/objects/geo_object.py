# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of an object in a file of objects, in any format; and files that are read as a whole."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...base.text import Step, no_step
from ...base.units import stated_units
from ...settings.data_files import MeshFile, PointFile

POINTS, LINES, SURFACE, HOLE = "points", "lines", "surface", "borehole"
STICK = "stick"  # the column with the number of the line that a vertex of lines is of


@dataclass(frozen=True)
class ObjectName:
    """An object in a file: its name and what it is: POINTS, LINES, SURFACE, HOLE. key: by which the library
    finds it. is_part: of an object that is listed, too."""

    name: str
    kind: str
    key: Any = None
    is_part: bool = False


@dataclass(frozen=True, eq=False)
class Values:
    """places (N, 3): points, or the beginnings of intervals along lines, which end at `ends` (N, 3). columns:
    (N,) texts or numbers by name; what is not known is "" or NaN. depths (N, 2): of the ends of intervals;
    None: by their lengths, one after another."""

    places: np.ndarray
    columns: dict[str, np.ndarray]
    ends: np.ndarray | None = None
    depths: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class GeoObject:
    """vertices (V, 3) float64, z up; triangles (T, 3) of a surface; values: of its points and its intervals;
    collar (3,): of a borehole that says it. face_of_triangle, unit, said_unit, warnings: as of a
    TriangleMesh."""

    name: str
    kind: str
    vertices: np.ndarray
    triangles: np.ndarray | None = None
    values: list[Values] = field(default_factory=list)
    collar: np.ndarray | None = None
    face_of_triangle: np.ndarray | None = None
    unit: str | Mapping | None = None
    said_unit: str | None = None
    warnings: tuple[str, ...] = ()

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """What is known of its vertices."""
        return next((values.columns for values in self.values if values.ends is None), {})

    def scaled(self, scale: np.ndarray) -> GeoObject:
        """The same with all places times a scale (3,), depths times that of z."""
        if (scale == 1.0).all():
            return self
        values = [
            replace(
                some,
                places=some.places * scale,
                ends=None if some.ends is None else some.ends * scale,
                depths=None if some.depths is None else some.depths * scale[2],
            )
            for some in self.values
        ]
        collar = None if self.collar is None else self.collar * scale
        return replace(self, vertices=self.vertices * scale, values=values, collar=collar)


class OpenFile(Protocol):
    """A file of objects that is open. Its methods may raise anything that the library does."""

    def names(self) -> list[ObjectName]:
        """The objects that are read."""

    def read(self, wanted: ObjectName) -> GeoObject:
        """One of them, in the coordinates of the file."""


class ReadObjects:
    """An OpenFile of objects that were read together; the key of each is a function that makes it. Those of
    one name and kind are pieces of one object; one without a name is called by its number."""

    def __init__(self, objects: Iterable[ObjectName]):
        self._pieces: dict[tuple[str, str], list[ObjectName]] = {}
        for number, obj in enumerate(objects, 1):
            named = obj if obj.name else replace(obj, name=f"object {number}")
            self._pieces.setdefault((named.name, named.kind), []).append(named)

    def names(self) -> list[ObjectName]:
        """As OpenFile."""
        return [pieces[0] for pieces in self._pieces.values()]

    def read(self, wanted: ObjectName) -> GeoObject:
        """As OpenFile."""
        pieces = [obj.key() for obj in self._pieces[wanted.name, wanted.kind]]
        return replace(pieces[0] if len(pieces) == 1 else _joined(pieces), name=wanted.name)


def _joined(pieces: list[GeoObject]) -> GeoObject:
    """Pieces of one object, one after another. Raises ValueError where they have different units."""
    first = pieces[0]
    if any((piece.unit, piece.said_unit) != (first.unit, first.said_unit) for piece in pieces):
        raise ValueError(f"the pieces of '{first.name}' have different units")
    vertices = np.concatenate([piece.vertices for piece in pieces])
    warnings = tuple(dict.fromkeys(text for piece in pieces for text in piece.warnings))
    names = [name for name in first.columns if all(name in piece.columns for piece in pieces)]
    columns = {name: np.concatenate([piece.columns[name] for piece in pieces]) for name in names}
    joined = replace(first, vertices=vertices, values=[Values(vertices, columns)], warnings=warnings)
    if first.kind != SURFACE:
        return joined
    triangles, faces, vertex, face = [], [], 0, 0
    for piece in pieces:
        assert piece.triangles is not None
        of_file = piece.face_of_triangle
        of_file = np.arange(len(piece.triangles)) if of_file is None else of_file
        triangles.append(piece.triangles + np.int32(vertex))
        faces.append(of_file + face)
        vertex, face = vertex + len(piece.vertices), face + int(of_file[-1]) + 1
    is_whole = all(piece.face_of_triangle is None for piece in pieces)
    owners = None if is_whole else np.concatenate(faces)
    return replace(joined, triangles=np.concatenate(triangles), face_of_triangle=owners)


def stated_text(unit: str | None) -> str | None:
    """The text by which a file names a unit; None where it names none."""
    plain = (unit or "").strip()
    return None if plain.lower() in ("", "none", "unknown", "unitless", "undefined") else plain


class WithUnit(Protocol):
    """A GeoObject or a TriangleMesh, whose file may say a unit."""

    @property
    def unit(self) -> str | Mapping | None: ...
    @property
    def said_unit(self) -> str | None: ...


def object_units(
    given: PointFile | MeshFile, obj: WithUnit, model_unit: str
) -> tuple[tuple[str | None, str | None], list[str]]:
    """The units of x and y, and of z, in which an object or a mesh is read, None for that of the model, and
    warnings. Raises InputRefused where it states one that is not known."""
    of_key = given.units if isinstance(given.units, Mapping) else {"xy": given.units, "z": given.units}
    file, plan, height = Path(given.file), of_key.get("xy"), of_key.get("z")
    if obj.unit is None:
        if given.units is not None or obj.said_unit in (None, model_unit):
            return (plan, height), []
        what = f"its header says {obj.said_unit}; it is read in the unit of the model, {model_unit}"
        return (None, None), [f'{file}: {what}: write units = "{obj.said_unit}" if the header is right']
    texts = obj.unit if isinstance(obj.unit, Mapping) else {"xy": obj.unit, "z": obj.unit}
    coordinates = [("x and y", texts.get("xy") or "", plan), ("z", texts.get("z") or "", height)]
    (plan, height), warnings = stated_units(file, coordinates, model_unit)
    return (plan, height), warnings


def as_a_whole(read: Callable[[Path, Step], Iterable[ObjectName]]) -> Callable:
    """What opens a file that `read` reads as a whole."""

    @contextmanager
    def opened(file: Path, step: Step = no_step) -> Iterator[OpenFile]:
        yield ReadObjects(read(file, step))

    return opened


def point_object(
    name: str, vertices: ArrayLike, kind: str = POINTS, columns: dict | None = None, **more: Any
) -> ObjectName:
    """Points, or lines by their vertices (V, 3). columns: what is known of these. more: as of a GeoObject."""

    def made() -> GeoObject:
        places = np.array(vertices, np.float64).reshape(-1, 3)
        return GeoObject(name, kind, places, values=[Values(places, columns or {})], **more)

    return ObjectName(name, kind, made)


def texts(numbers: np.ndarray, names: dict[int, str]) -> np.ndarray:
    """(N,) str: the names of numbers, "" for those that have none."""
    unique, index = np.unique(np.asarray(numbers, np.int64), return_inverse=True)
    named = np.array([str(names.get(number, "")) for number in unique.tolist()] or [""], object)
    return named[index.ravel()]
