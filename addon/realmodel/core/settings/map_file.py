# SPDX-License-Identifier: GPL-3.0-or-later
"""A geological map: polygons of blocks on the ground, with what lies beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .map_layer import LAYER, UNIT, WHERE, MapLayer
from .method_options import OptionRefused, check_fields
from .point_file import FILE, MeshFile, PointFile
from .setting import declared, described


def _checked_attribute(key: str, name: Any) -> Any:
    if not (isinstance(name, str) and name.strip()):
        what = f"'{key}' must name an attribute, not {name!r}"
        raise OptionRefused(what, key, f'write {key} = "FORMATION"')
    return name


def _checked_accuracy(key: str, accuracy: Any) -> Any:
    if accuracy is not None and not 0 <= accuracy < math.inf:
        advice = "give how far its lines may be off, or 0 where they are exact"
        raise OptionRefused(f"'{key}' must be 0 or more, not {accuracy!r}", key, advice)
    return accuracy


@dataclass(frozen=True)
class MapFile:
    """file: polygons in plan (GeoJSON, a shapefile, a GeoPackage) whose attribute `block` names the block on
    the ground there. layer, where, units: as of a MapLayer.

    ground: the heights of the ground, a raster, points or a mesh, or the name of a surface of the rock mass;
    None: the youngest surface. If that has neither points nor a mesh, it is made from the file `ground`.
    faults: lines of faults, a file or a MapLayer of one, or well-known text: what these divide is no contact.
    accuracy: how far lines may lie from where they should be, as a standard deviation in model units; None: a
    two-hundredth of the diagonal of the region, but contacts are off by a tenth of the relief at most.
    """

    file: str | Path = described(FILE, is_needed=True)
    block: str = declared(kind="line", check=_checked_attribute, is_needed=True)
    layer: str | None = described(LAYER)
    where: Mapping = described(WHERE, factory=dict)
    units: str | None = described(UNIT)
    ground: str | Path | PointFile | MeshFile | None = declared(kind="ground")
    faults: str | Path | MapLayer | None = declared(kind="layer_file", of=MapLayer)
    accuracy: float | None = declared(kind="finite", check=_checked_accuracy)

    @property
    def polygons(self) -> MapLayer:
        """The layer of the polygons."""
        return MapLayer(self.file, self.layer, self.where, self.units)

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_fields(self)
        if isinstance(self.ground, (PointFile, MeshFile)):
            self.ground.check()
