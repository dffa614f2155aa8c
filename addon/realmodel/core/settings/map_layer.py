# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of outlines, lines or points in plan, and what of it counts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from .method_options import check_fields
from .point_file import FILE, checked_name, checked_unit, checked_where
from .setting import Setting, described

_WKT = re.compile(
    r"\s*(?:SRID\s*=\s*\d+\s*;\s*)?(?:MULTI)?(?:POLYGON|LINESTRING|POINT|GEOMETRYCOLLECTION)(?:ZM?|M)?\b",
    re.IGNORECASE,
)


def begins_as_wkt(text: str) -> bool:
    """Whether a text begins with the name of a geometry."""
    return bool(_WKT.match(text))


def is_wkt(text: str) -> bool:
    """Whether a text is well-known text rather than the path of a file."""
    return begins_as_wkt(text) and ("(" in text or text.rstrip().upper().endswith("EMPTY"))


LAYER = Setting(kind="line", check=checked_name)
WHERE = Setting(kind="where", check=checked_where)
UNIT = Setting(kind="unit", check=checked_unit)


@dataclass(frozen=True)
class MapLayer:
    """GeoJSON, well-known text, a shapefile, or a layer of a GeoPackage.

    layer: its name, needed where a GeoPackage has several. where: {attribute: value, or a list of them}; only
    features that hold it count. units: of the file's coordinates; None: those of the model.
    """

    file: str | Path = described(FILE, is_needed=True)
    layer: str | None = described(LAYER)
    where: Mapping = described(WHERE, factory=dict)
    units: str | None = described(UNIT)

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_fields(self)
