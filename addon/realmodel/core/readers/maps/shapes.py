# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of files of outlines, lines and points, in any format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused
from ...settings.data_files import list_of
from ..tables.table_layout import names_shown


@dataclass(frozen=True)
class Polygon:
    """Rings (N, 2) float64, their first corner not repeated. item: its name in messages, "" for the only one.

    has_roles: the first ring is the outline, the others are holes in it. Otherwise the even-odd rule applies,
    as for shapefiles, where outlines and holes differ only in direction.
    """

    item: str
    rings: list[np.ndarray]
    has_roles: bool = True


@dataclass
class Shapes:
    """The shapes of one file: polygons, lines (N, 2) and points (2,), the latter two with their names in
    messages. Read with heights, positions have three numbers, the third NaN where the file gives none.
    attributes: of features, by their names in messages, where they are wanted. system: their coordinate
    system, from the reader, "" if other files have it."""

    polygons: list[Polygon] = field(default_factory=list)
    lines: list[tuple[str, np.ndarray]] = field(default_factory=list)
    points: list[tuple[str, np.ndarray]] = field(default_factory=list)
    has_heights: bool = False
    attributes: dict[str, Mapping] | None = None
    system: str = ""

    @classmethod
    def wanted(cls, heights: Heights | None) -> Shapes:
        """Without anything yet, for shapes that are read so."""
        keeps = heights is not None and heights.with_attributes
        return cls(has_heights=heights is not None, attributes={} if keeps else None)

    @property
    def ordinates(self) -> int:
        """The number of coordinates of a position."""
        return 3 if self.has_heights else 2

    def counts(self) -> tuple[int, int, int]:
        """The numbers of polygons, lines and points."""
        return len(self.polygons), len(self.lines), len(self.points)

    def set_height(self, since: tuple[int, int, int], height: float) -> None:
        """Sets the height of all positions added after these counts."""
        rings = [ring for polygon in self.polygons[since[0] :] for ring in polygon.rings]
        lines = [line for _, line in self.lines[since[1] :]]
        for places in [*rings, *lines, *(point for _, point in self.points[since[2] :])]:
            places[..., 2] = height

    def add_polygon(self, item: str, rings: Sequence[np.ndarray], has_roles: bool = True) -> None:
        open_rings = [
            ring[:-1] if len(ring) > 1 and (ring[0, :2] == ring[-1, :2]).all() else ring for ring in rings
        ]
        if open_rings:
            self.polygons.append(Polygon(item, open_rings, has_roles))

    def scaled(self, scale: float) -> Shapes:
        """The shapes in another unit."""
        if scale == 1.0:
            return self
        return replace(
            self,
            polygons=[
                Polygon(p.item, [ring * scale for ring in p.rings], p.has_roles) for p in self.polygons
            ],
            lines=[(feature, line * scale) for feature, line in self.lines],
            points=[(feature, point * scale) for feature, point in self.points],
        )

    def without_area(self, file: Path) -> list[str]:
        """Warnings about lines and points, which bound no region."""
        said = [(name, "LineString") for name, _ in self.lines] + [(name, "Point") for name, _ in self.points]
        items = dict.fromkeys(said)
        return [f"{file}: {name or 'it'} is a {kind}, which bounds no area: left out" for name, kind in items]


@dataclass(frozen=True)
class Heights:
    """The heights to read: those of the positions, or one for each feature, by its attribute.
    with_attributes: keep all attributes of the features, too."""

    attribute: str | None = None
    with_attributes: bool = False


class NothingSelected(InputRefused):
    """No feature matches. names: of the attributes; values: of the first requested one."""

    names: Sequence[str] = ()
    values: Sequence[str] = ()


class Selection:
    """Selects features by their attributes; records the attributes and values for error messages."""

    def __init__(self, file: Path, where: Mapping, layer: str | None = None):
        self.file, self.where = file, where
        self.item = f"layer '{layer}'" if layer else None
        self.known: dict[str, None] = {}
        self.seen: dict[str, dict[str, None]] = {name: {} for name in where}
        self.features = self.taken = 0

    def height(self, attributes: Mapping, name: str, item: str) -> float:
        """The height that an attribute of a feature holds; NaN where it holds nothing."""
        key = of_name(name, attributes)
        if key is None:
            attribute_names = names_shown(list(attributes)) if attributes else "no attributes"
            raise self._no_height(f"it has no attribute '{name}'", item, f"it has {attribute_names}")
        value = attributes[key]
        if value is None or (isinstance(value, str) and not value.strip()):
            return float("nan")
        try:
            if isinstance(value, bool):
                raise ValueError
            return float(value)
        except (TypeError, ValueError) as error:
            raise self._no_height(f"its attribute '{key}' is not a number: {value!r:.40}", item) from error

    def _no_height(self, what: str, feature: str, advice: str | None = None) -> InputRefused:
        return InputRefused(what, file=self.file, item=feature or self.item, advice=advice)

    def takes(self, attributes: Mapping) -> bool:
        self.features += 1
        if not self.where:
            self.taken += 1
            return True
        self.known.update(dict.fromkeys(attributes))
        matches = True
        for name, wanted in self.where.items():
            key = of_name(name, attributes)
            value = attributes.get(key)
            if key is not None:
                self.seen[name][str(value)] = None
            matches = matches and key is not None and any(_equal(value, w) for w in list_of(wanted))
        self.taken += matches
        return matches

    def require_some(self) -> None:
        """Refuses a selection without features; the error lists the values that there are."""
        if self.taken or not self.features:
            return
        for name, values in self.seen.items():
            if not values:
                raise self._nothing(
                    f"its features have no attribute '{name}'",
                    file=self.file,
                    item=self.item,
                    advice=f"they have {names_shown(list(self.known))}" if self.known else None,
                )
        said = ", ".join(f"{name} = {value!r}" for name, value in self.where.items())
        advice = "; ".join(f"{name} is {names_shown(list(values))}" for name, values in self.seen.items())
        raise self._nothing(f"no feature has {said}", file=self.file, item=self.item, advice=advice)

    def _nothing(self, what: str, **where: Any) -> NothingSelected:
        error = NothingSelected(what, **where)
        error.names, error.values = list(self.known), list(next(iter(self.seen.values())))
        return error


def of_name(name: str, attributes: Mapping) -> str | None:
    """The attribute of this name, else one that differs from it in upper and lower case; None: there is
    none."""
    if name in attributes:
        return name
    return next((key for key in attributes if str(key).lower() == name.lower()), None)


def _equal(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, str):
        return str(value).strip() == wanted.strip()
    if value is None or isinstance(value, bool):
        return False
    try:
        return float(value) == float(wanted)
    except (TypeError, ValueError):
        return False
