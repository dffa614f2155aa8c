# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of outlines, lines or points in plan, and what of it counts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..base.units import METERS
from .method_options import OptionRefused
from .point_file import check_name, check_where

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


@dataclass(frozen=True)
class MapLayer:
    """GeoJSON, well-known text, a shapefile, or a layer of a GeoPackage.

    layer: its name, needed where a GeoPackage has several. where: {attribute: value, or a list of them}; only
    features that hold it count. units: of the file's coordinates; None: those of the model.
    """

    file: str | Path
    layer: str | None = None
    where: Mapping = field(default_factory=dict)
    units: str | None = None

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_name("layer", self.layer)
        check_where(self.where)
        if self.units is not None and self.units not in METERS:
            raise OptionRefused(f"unknown unit {self.units!r}", "units", f"there are {', '.join(METERS)}")
