# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of outlines, lines and points hold, whatever their format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from ..point_file import list_of
from .table_layout import names_shown


@dataclass(frozen=True)
class Polygon:
    """Rings (N, 2) float64, their first corner not repeated. item: what to call it, "" for the only one.

    has_roles: the first ring is the outline, the others are holes in it; otherwise they count even-odd, as
    those of a shapefile, which only their direction tells apart.
    """

    item: str
    rings: list[np.ndarray]
    has_roles: bool = True


@dataclass
class Shapes:
    """What one file holds: polygons, lines (N, 2) and points (2,), the latter two with what to call them."""

    polygons: list[Polygon] = field(default_factory=list)
    lines: list[tuple[str, np.ndarray]] = field(default_factory=list)
    points: list[tuple[str, np.ndarray]] = field(default_factory=list)

    def add_polygon(self, item: str, rings: Sequence[np.ndarray], has_roles: bool = True) -> None:
        open_rings = [ring[:-1] if len(ring) > 1 and (ring[0] == ring[-1]).all() else ring for ring in rings]
        if open_rings:
            self.polygons.append(Polygon(item, open_rings, has_roles))

    def scaled(self, scale: float) -> Shapes:
        """All of it in another unit."""
        if scale == 1.0:
            return self
        return Shapes(
            [Polygon(p.item, [ring * scale for ring in p.rings], p.has_roles) for p in self.polygons],
            [(item, line * scale) for item, line in self.lines],
            [(item, point * scale) for item, point in self.points],
        )

    def without_area(self, file: Path) -> list[str]:
        """Sentences about the lines and points, which bound no region."""
        said = [(item, "LineString") for item, _ in self.lines] + [(item, "Point") for item, _ in self.points]
        items = dict.fromkeys(said)
        return [f"{file}: {item or 'it'} is a {kind}, which bounds no area: left out" for item, kind in items]


class Selection:
    """Which features count, by their attributes; remembers what there was for a refusal."""

    def __init__(self, file: Path, where: Mapping, layer: str | None = None):
        self.file, self.where = file, where
        self.item = f"layer '{layer}'" if layer else None
        self.known: dict[str, None] = {}
        self.seen: dict[str, dict[str, None]] = {name: {} for name in where}
        self.features = self.taken = 0

    def takes(self, attributes: Mapping) -> bool:
        self.features += 1
        if not self.where:
            self.taken += 1
            return True
        self.known.update(dict.fromkeys(attributes))
        matches = True
        for name, wanted in self.where.items():
            key = name if name in attributes else _same_name(name, attributes)
            value = attributes.get(key)
            if key is not None:
                self.seen[name][str(value)] = None
            matches = matches and key is not None and any(_equal(value, w) for w in list_of(wanted))
        self.taken += matches
        return matches

    def require_some(self) -> None:
        """Refuses what took nothing, saying what there is."""
        if self.taken or not self.features:
            return
        for name, values in self.seen.items():
            if not values:
                raise InputRefused(
                    f"its features have no attribute '{name}'",
                    file=self.file,
                    item=self.item,
                    advice=f"they have {names_shown(list(self.known))}" if self.known else None,
                )
        said = ", ".join(f"{name} = {value!r}" for name, value in self.where.items())
        there = "; ".join(f"{name} is {names_shown(list(values))}" for name, values in self.seen.items())
        raise InputRefused(f"no feature has {said}", file=self.file, item=self.item, advice=there)


def _same_name(name: str, attributes: Mapping) -> str | None:
    return next((key for key in attributes if str(key).lower() == name.lower()), None)


def _equal(value, wanted) -> bool:
    if isinstance(wanted, str):
        return str(value).strip() == wanted.strip()
    if value is None or isinstance(value, bool):
        return False
    try:
        return float(value) == float(wanted)
    except (TypeError, ValueError):
        return False
