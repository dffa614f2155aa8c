# SPDX-License-Identifier: GPL-3.0-or-later
"""The region and the constraints of a rock mass in plan, from arrays, text or files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import begins_run
from ..base.errors import InputRefused, place_text
from ..base.units import MODEL_UNIT
from ..readers import read_shapes
from ..readers.map_input import map_companions, require_polygons
from ..readers.maps.shapes import Shapes
from ..readers.maps.wkt import parse_wkt
from ..settings.map_layer import MapLayer, is_wkt
from ..settings.mesh_sizes import AT_WORDS
from .entry import Refuse, check_file, refused_by
from .region_rings import NamedRing, checked_region, given_rings, is_several, rings_of_shapes


def map_layer(given: Any) -> MapLayer | None:
    """The file that outlines, lines or points are read from; None for arrays and well-known text."""
    if isinstance(given, MapLayer):
        return given
    if isinstance(given, Path) or (isinstance(given, str) and not is_wkt(given)):
        return MapLayer(given)
    return None


def layer_files(given: Any) -> list[Path]:
    """The files of a region, of constraints or of sizes."""
    layer = map_layer(given)
    return [] if layer is None else [Path(layer.file), *map_companions(Path(layer.file))]


def check_layer(given: Any, key: str, refuse: Refuse) -> None:
    """Refuses a file that does not exist, and invalid options of it."""
    layer = map_layer(given)
    if layer is None:
        return
    with refused_by(refuse, key):
        layer.check()
    check_file(layer.file, key, refuse)


def shapes_of(given: Any, units: str = MODEL_UNIT) -> Shapes | None:
    """The shapes of a file or a well-known text; None where arrays are given."""
    layer = map_layer(given)
    if layer is not None:
        return read_shapes(layer, units)
    return parse_wkt(given) if isinstance(given, str) else None


def read_rings(
    region: Any, holes: Any = (), units: str = MODEL_UNIT, call: Callable | None = None
) -> tuple[np.ndarray | list[np.ndarray], list[np.ndarray], list[str]]:
    """The region and the holes of a rock mass as checked arrays, and warnings about shapes that were left
    out.

    The region is one outline (N, 2) with holes, or a list of rings with the even-odd rule and no holes. call:
    Work.native, where the caller can cancel. Raises InputRefused; its cause is a native InputError where the
    rings do not fit together.
    """
    shapes = shapes_of(region, units)
    if shapes is None:
        rings = given_rings(region, holes)
        return *_as_given(rings, checked_region(rings, call), is_several(region)), []
    layer = map_layer(region)
    file = None if layer is None else Path(layer.file)
    require_polygons(shapes, file)
    rings = rings_of_shapes(shapes)
    warnings = shapes.without_area(file or Path("region"))
    return *_as_given(rings, checked_region(rings, call), False), warnings


def _as_given(
    rings: list[NamedRing], checked: list[np.ndarray], several: bool
) -> tuple[np.ndarray | list[np.ndarray], list[np.ndarray]]:
    outlines = sum(not ring.hole for ring in rings)
    if outlines == 1 and not several and len(checked) == len(rings):
        return checked[0], checked[1:]
    return checked, []


def read_constraints(given: Sequence, units: str = MODEL_UNIT) -> list[np.ndarray]:
    """Lines (N, 2) and points (1, 2) that the planar mesh is to contain, from arrays, files and text.

    Outlines of polygons in files are lines that return to where they began. Raises InputRefused.
    """
    lines: list[np.ndarray] = []
    for number, entry in enumerate(given, 1):
        try:
            shapes = shapes_of(entry, units)
            lines += [places_of_constraint(entry)] if shapes is None else _lines_of(shapes, map_layer(entry))
        except InputRefused as error:
            raise error.within(f"constraint {number}") from error
    return lines


def is_place_elsewhere(at: object) -> bool:
    """Whether the place of a local edge length is a file or well-known text."""
    return isinstance(at, (Path, MapLayer)) or (isinstance(at, str) and at not in AT_WORDS)


def files_of_sizes(sizes: Sequence[Mapping]) -> list[Path]:
    """The files that the places of local edge lengths are read from."""
    places = [entry.get("at") for entry in sizes if isinstance(entry, Mapping)]
    return [file for at in places if is_place_elsewhere(at) for file in layer_files(at)]


def read_sizes(sizes: Sequence[Mapping], units: str = MODEL_UNIT) -> list[Mapping]:
    """Entries of local edge lengths without files or text: one for each line, outline and point in them.
    Raises InputRefused."""
    entries: list[Mapping] = []
    for number, entry in enumerate(sizes):
        try:
            shapes = shapes_of(entry["at"], units) if is_place_elsewhere(entry["at"]) else None
            if shapes is None:
                entries.append(entry)
                continue
            lines = _lines_of(shapes, map_layer(entry["at"]))
        except InputRefused as error:
            raise error.within(f"size {number}") from error
        entries += [{**entry, "at": line.tolist() if len(line) > 1 else line[0].tolist()} for line in lines]
    return entries


def places_of_constraint(given: ArrayLike) -> np.ndarray:
    """(N, 2) places of a line, or (1, 2) of a point given as [x, y], none repeated in a row."""
    try:
        places = np.array(given, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("a constraint must be points [[x, y], ...] or one point [x, y]") from error
    places = places.reshape(1, -1) if places.ndim == 1 else places
    if places.ndim != 2 or places.shape[1] != 2 or not len(places):
        raise InputRefused(f"a constraint must be an array (N, 2), not {places.shape}")
    bad = np.flatnonzero(~np.isfinite(places).all(axis=1))
    if len(bad):
        raise InputRefused(f"place {bad[0]} is {place_text(places[bad[0]])}, not finite")
    return places[begins_run(places)]


def _lines_of(shapes: Shapes, layer: MapLayer | None) -> list[np.ndarray]:
    lines = [line for _, line in shapes.lines]
    lines += [np.concatenate([ring, ring[:1]]) for polygon in shapes.polygons for ring in polygon.rings]
    lines += [point.reshape(1, 2) for _, point in shapes.points]
    if not lines:
        raise InputRefused("there are no lines or points in it", file=None if layer is None else layer.file)
    return [line[begins_run(line)] for line in lines]


def ring_path(region: Any, items: Sequence[int]) -> tuple:
    """The key in the project file of the corner that a native error names first: (key, numbers...)."""
    if not items or isinstance(region, (str, Path, MapLayer)):
        return ("region",)
    ring, corner = (*items, 0)[:2]
    outlines = len(region) if is_several(region) else 1
    if ring >= outlines:
        return ("holes", ring - outlines, corner)
    return ("region", ring, corner) if is_several(region) else ("region", corner)
