# SPDX-License-Identifier: GPL-3.0-or-later
"""The region and the constraints of a rock mass in plan, from arrays, text or files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import begins_run
from ..base.errors import InputRefused, place_text
from ..base.units import MODEL_UNIT
from ..base.work import NativeError, refused_as
from ..readers import read_shapes
from ..readers.map_input import map_companions, require_polygons
from ..readers.maps.shapes import Shapes
from ..readers.maps.wkt import parse_wkt
from ..settings.data_files import MapLayer, is_wkt
from ..settings.meshers import AT_WORDS
from .entry import Refuse, check_file, errors_located


@dataclass(frozen=True)
class NamedRing:
    """A ring (N, 2) float64 of a polygon, and what to call it in messages."""

    name: str
    corners: np.ndarray
    polygon: int
    hole: bool


def numbered_ring(ring: ArrayLike, item: str) -> np.ndarray:
    """One ring as (N, 2) float64, all its corners kept, so that their numbers are those of the input. Raises
    InputRefused where it bounds nothing."""
    corners = _corners(ring, item)
    _require_corners(corners, item)
    return corners


def _corners(ring: ArrayLike, ring_name: str) -> np.ndarray:
    try:
        corners = np.array(ring, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("an outline must be corners [x, y]", item=ring_name) from error
    if corners.ndim != 2 or corners.shape[1] != 2:
        raise InputRefused(f"an outline must be an array (N, 2), not {corners.shape}", item=ring_name)
    return corners


def _require_corners(corners: np.ndarray, ring_name: str) -> None:
    finite = np.isfinite(corners)
    if not finite.all():
        bad = np.flatnonzero(~finite.all(axis=1))
        what = f"corner {bad[0]} is {place_text(corners[bad[0]])}, not finite"
        raise InputRefused(what, item=ring_name)
    if not _three_differ(corners):
        near = f", near {place_text(corners[0])}" if len(corners) else ""
        place = tuple(corners[0]) if len(corners) else None
        raise InputRefused(
            f"an outline needs at least three different corners{near}", item=ring_name, place=place
        )


def _three_differ(corners: np.ndarray) -> bool:
    """Whether there are three different places; quick for ten thousand holes."""
    x, y = corners.T
    others = corners[(x != x[:1]) | (y != y[:1])]
    return len(others) > 1 and bool((others != others[0]).any())


def _without_repetition(corners: np.ndarray) -> np.ndarray:
    return corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]


def is_several(outline: Any) -> bool:
    """Whether a given outline is a list of several."""
    if isinstance(outline, np.ndarray):
        return outline.ndim == 3
    try:
        return np.ndim(outline[0]) == 2
    except (TypeError, IndexError, KeyError, ValueError):
        return False


def given_rings(outline: Any, holes: Iterable = ()) -> list[NamedRing]:
    """Rings from arrays: one outline (N, 2) or several, which count even-odd, and holes in them."""
    if not is_several(outline):
        rings = [NamedRing("region", _corners(outline, "region"), 0, False)]
    else:
        names = [f"outline {number}" for number in range(1, len(outline) + 1)]
        pairs = zip(names, outline, strict=True)
        rings = [NamedRing(name, _corners(ring, name), 0, False) for name, ring in pairs]
    for number, hole in enumerate(holes, 1):
        rings.append(NamedRing(f"hole {number}", _corners(hole, f"hole {number}"), 0, True))
    return rings


def rings_of_shapes(shapes: Shapes) -> list[NamedRing]:
    """The rings of polygons that were read."""
    rings = []
    parts = Counter(shape.item for shape in shapes.polygons)
    part: Counter[str | None] = Counter()
    for polygon, shape in enumerate(shapes.polygons):
        polygon_name = shape.item or ("outline" if len(shapes.polygons) == 1 else f"polygon {polygon + 1}")
        part[shape.item] += 1
        if shape.item and parts[shape.item] > 1:
            polygon_name = f"{polygon_name}, polygon {part[shape.item]}"
        for number, corners in enumerate(shape.rings):
            hole = shape.has_roles and number > 0
            if hole:
                name = f"{polygon_name}, hole {number}"
            elif len(shape.rings) > 1 and not shape.has_roles:
                name = f"{polygon_name}, ring {number + 1}"
            else:
                name = polygon_name
            rings.append(NamedRing(name, corners, polygon, hole))
    return rings


def checked_region(
    rings: Sequence[NamedRing], call: Callable[..., list[np.ndarray]] | None = None
) -> list[np.ndarray]:
    """Rings that touch in points at most, count even-odd, and have no corner repeated in a row.

    Outlines may touch themselves and each other in points, go either way round, repeat corners; islands may
    lie in holes; polygons of their own may share borders, which vanish. Raises InputRefused with the place
    where outlines cross or run along each other, where a hole does not lie in its outline, and where a ring
    bounds nothing. call: Work.native, where the caller may stop it.
    """
    for ring in rings:
        _require_corners(ring.corners, ring.name)
    names, sizes = [ring.name for ring in rings], [len(ring.corners) for ring in rings]
    with refused_as(lambda error: refused_rings(error, names, sizes)) as native:
        corners = [ring.corners for ring in rings]
        roles = [ring.polygon for ring in rings], [ring.hole for ring in rings]
        checked = (call or _at_once)(native.check_region, corners, *roles)
    return [_without_repetition(ring) for ring in checked]


def _at_once(function: Callable, *arguments: Any) -> Any:
    return function(*arguments)


def region_rings(outline: Any, holes: Iterable = ()) -> list[np.ndarray]:
    """The checked rings of an outline (N, 2), or of several, with holes."""
    return checked_region(given_rings(outline, holes))


def refused_rings(error: NativeError, names: Sequence[str], counts: Sequence[int] = ()) -> InputRefused:
    """The error that the native module found in rings, in the user's terms. Corners count from 0."""
    place = tuple(error.place[:2]) if error.place is not None else None
    at = f" at {place_text(place)}" if place is not None else ""
    items = error.items
    if error.kind in ("outline_crosses", "outline_overlaps"):
        verb = "crosses" if error.kind == "outline_crosses" else "runs along"
        (ring, corner), (other, further) = sorted([tuple(items[:2]), tuple(items[2:])])
        whom = "itself" if ring == other else f"{_called(names[other])}"
        edges = (_edge(corner, counts, ring), _edge(further, counts, other))
        between = f"between corners {edges[0]} and {edges[1]}"
        if ring != other:
            between = f"between its corners {edges[0]} and the other's {edges[1]}"
        what = f"the outline {verb} {whom}{at} ({between})"
        advice = "outlines may touch in points, but not cross or share an edge"
        return InputRefused(what, item=names[ring], place=place, advice=advice)
    if error.kind == "hole_outside":
        what = f"this hole does not lie inside its outline{at}"
        advice = "move the hole into the outline, or make it a separate outline"
        return InputRefused(what, item=names[items[0]], place=place, advice=advice)
    if error.kind == "outline_degenerate":
        what = f"all corners of an outline lie on one line{at}"
        return InputRefused(what, item=names[items[0]], place=place)
    return InputRefused(str(error), item="region", place=place)


def _called(name: str) -> str:
    return "that of the region" if name == "region" else name


def _edge(corner: int, counts: Sequence[int], ring: int) -> str:
    """The corners at the ends of an edge."""
    following = corner + 1
    if ring < len(counts) and following == counts[ring]:
        following = 0
    return f"{corner} to {following}"


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
    with errors_located(refuse, key):
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
