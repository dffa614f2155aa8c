# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshers of regions, one registry (docs/dev/extending.md), and the edge lengths of their meshes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import is_number
from ..base.errors import InputRefused, UsageError
from .setting import Setting


@dataclass(frozen=True)
class Mesher:
    """label and tip: in the panel."""

    label: str
    tip: str


DEFAULT_MESHER = "delaunay"

MESHERS: dict[str, Mesher] = {
    "delaunay": Mesher("Delaunay", "Delaunay refinement: no angle below 25 degrees"),
    "frontal": Mesher("Frontal", "Advancing front: nearly equilateral triangles, slower"),
    "grid": Mesher("Grid", "Nodes of a regular grid, fitted to the outline"),
}


AUTO = "auto"  # an edge length by the density of points
AT_WORDS = ("outline", "constraints")
SIZE = {  # of an entry of `size`, beside where it is
    "length": Setting(kind="length", label="Length", tip="Edge length there", start=1.0, low=1e-6),
    "distance": Setting(
        kind="length",
        label="Influence Distance",
        tip="Distance within which edges are this short; beyond, they grow by a quarter of it",
        low=0.0,
    ),
}
_SIZE_KEYS = ("at", *SIZE)
_AT = "'outline', 'constraints', a place [x, y] or a line [[x, y], ...]"


def check_mesher(mesher: object) -> None:
    if mesher not in MESHERS:
        raise UsageError(f"mesher {mesher!r} is unknown; use {', '.join(map(repr, MESHERS))}")


def edge_length_fault(edge_length: Any) -> str | None:
    """The error in an edge length, "auto" included, or None."""
    if isinstance(edge_length, str) and edge_length == AUTO:
        return None
    if is_number(edge_length) and edge_length > 0:
        return None
    return f"edge_length must be a finite number above 0 or '{AUTO}', not {edge_length!r}"


def triangles_fault(triangles: Any) -> str | None:
    """The error in a number of triangles, or None."""
    whole = is_number(triangles) and float(triangles).is_integer()
    return None if whole and triangles >= 1 else f"triangles must be a whole number from 1, not {triangles!r}"


def size_of_edges(edge_length: Any, triangles: Any, points: Any) -> tuple[float, float, np.ndarray | None]:
    """(edge length or 0, number of triangles or 0, points (P, 2) whose density counts or None)."""
    if edge_length is None and triangles is None:
        raise InputRefused("edge_length or triangles must be given")
    fault = None if edge_length is None else edge_length_fault(edge_length)
    fault = fault or (None if triangles is None else triangles_fault(triangles))
    if fault:
        raise InputRefused(fault)
    wanted = 0.0 if triangles is None else float(triangles)
    if edge_length != AUTO:
        if triangles is not None and edge_length is not None:
            raise InputRefused("edge_length and triangles cannot both be given; remove one of them")
        return 0.0 if edge_length is None else float(edge_length), wanted, None
    if points is None:
        raise InputRefused(f"edge_length '{AUTO}' needs points, and there are none")
    return 0.0, wanted, places_of(points, "points", least=2)


def local_lengths(size: Iterable[Mapping], lines: list[np.ndarray], points: np.ndarray | None) -> list[tuple]:
    """The entries of `size` as (places (N, 2) or None for the outline, length, distance)."""
    entries = []
    if isinstance(size, Mapping):
        raise InputRefused('size must be a list of entries: [{"at": ..., "length": ..., "distance": ...}]')
    for number, entry in enumerate(size):
        for at in _places_at(entry, f"size {number}", lines, points):
            entries.append((at, float(entry["length"]), float(entry["distance"])))
    return entries


def _places_at(entry: Any, name: str, lines: list[np.ndarray], points: np.ndarray | None) -> list:
    if not isinstance(entry, Mapping) or set(entry) != set(_SIZE_KEYS):
        raise InputRefused(f"needs exactly {', '.join(_SIZE_KEYS)}, not {entry!r}", item=name)
    if not (is_number(entry["length"]) and entry["length"] > 0):
        raise InputRefused(f"length must be a finite number above 0, not {entry['length']!r}", item=name)
    if not (is_number(entry["distance"]) and entry["distance"] >= 0):
        raise InputRefused(f"distance must be a finite number from 0, not {entry['distance']!r}", item=name)
    at = entry["at"]
    if isinstance(at, str):
        if at == "outline":
            return [None]
        if at != "constraints":
            raise InputRefused(f"at must be {_AT}, not {at!r}", item=name)
        places = [*lines, *(points[:, None] if points is not None else [])]
        if not places:
            raise InputRefused("the rock mass has no constraints", item=name)
        return places
    is_one = np.ndim(np.asarray(at, object)) == 1
    return [places_of([at] if is_one else at, f"{name}, at")]


def places_of(places: ArrayLike, item: str, least: int = 1) -> np.ndarray:
    """(N, 2) float64 of places (N, 2) or (N, 3), N >= least. Raises InputRefused."""
    try:
        array = np.asarray(places, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("must be points [x, y]", item=item) from error
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise InputRefused(f"must be an array (N, 2), not {array.shape}", item=item)
    if len(array) < least:
        raise InputRefused(f"needs {least} place{'s' if least > 1 else ''} at least", item=item)
    bad = np.flatnonzero(~np.isfinite(array[:, :2]).all(axis=1))
    if len(bad):
        raise InputRefused(f"place {bad[0]} is not finite", item=item)
    return np.ascontiguousarray(array[:, :2])
