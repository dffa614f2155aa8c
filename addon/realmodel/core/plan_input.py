# SPDX-License-Identifier: GPL-3.0-or-later
"""What a rock mass has in plan - its region - from arrays, text or files, to checked rings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from .errors import InputRefused
from .map_layer import MapLayer, is_wkt
from .point_file import ReadingRefused
from .readers import read_shapes
from .readers.map_input import map_companions, require_polygons
from .readers.shapes import Shapes
from .readers.wkt import parse_wkt
from .region_rings import NamedRing, checked_region, given_rings, is_several, rings_of_shapes
from .units import MODEL_UNIT

Refuse = Callable[..., InputRefused]


def map_layer(given) -> MapLayer | None:
    """The file that outlines, lines or points are read from; None for arrays and well-known text."""
    if isinstance(given, MapLayer):
        return given
    if isinstance(given, Path) or (isinstance(given, str) and not is_wkt(given)):
        return MapLayer(given)
    return None


def layer_files(given) -> list[Path]:
    """The files that are read for what is given in plan."""
    layer = map_layer(given)
    return [] if layer is None else [Path(layer.file), *map_companions(Path(layer.file))]


def check_layer(given, key: str, refuse: Refuse, is_file: Callable[[Path], bool]) -> None:
    """Refuses a file that is not there, and what is said of it that makes no sense."""
    layer = map_layer(given)
    if layer is None:
        return
    try:
        layer.check()
    except ReadingRefused as error:
        raise refuse(error.what, key, error.advice) from error
    if not is_file(Path(layer.file)):
        raise refuse(f"there is no file {layer.file}", key, "check the path")


def shapes_of(given, units: str = MODEL_UNIT) -> Shapes | None:
    """What a file or a well-known text holds; None where arrays are given."""
    layer = map_layer(given)
    if layer is not None:
        return read_shapes(layer, units)
    return parse_wkt(given) if isinstance(given, str) else None


def read_rings(
    region, holes=(), units: str = MODEL_UNIT, call: Callable | None = None
) -> tuple[object, list[np.ndarray], list[str]]:
    """The region and the holes of a rock mass as checked arrays, and sentences about what was left out.

    The region is one outline (N, 2) with holes in it, or a list of rings that count even-odd, without. Raises
    InputRefused; its cause is a native InputError where the rings do not fit together. call: Work.native,
    where the caller may stop it.
    """
    shapes = shapes_of(region, units)
    if shapes is None:
        rings = given_rings(region, holes)
        return *_as_given(rings, checked_region(rings, call), is_several(region)), []
    layer = map_layer(region)
    file = None if layer is None else Path(layer.file)
    require_polygons(shapes, file)
    rings = rings_of_shapes(shapes)
    told = shapes.without_area(file or Path("region"))
    return *_as_given(rings, checked_region(rings, call), False), told


def _as_given(
    rings: list[NamedRing], checked: list[np.ndarray], several: bool
) -> tuple[object, list[np.ndarray]]:
    outlines = sum(not ring.hole for ring in rings)
    if outlines == 1 and not several and len(checked) == len(rings):
        return checked[0], checked[1:]
    return checked, []


def ring_path(region, items) -> tuple:
    """Where in a project file the corner stands that a native refusal names first: (key, numbers...)."""
    if not items or isinstance(region, (str, Path, MapLayer)):
        return ("region",)
    ring, corner = (*items, 0)[:2]
    outlines = len(region) if is_several(region) else 1
    if ring >= outlines:
        return ("holes", ring - outlines, corner)
    return ("region", ring, corner) if is_several(region) else ("region", corner)
