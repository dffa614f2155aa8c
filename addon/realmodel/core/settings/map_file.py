# SPDX-License-Identifier: GPL-3.0-or-later
"""A geological map: polygons of blocks on the ground, with what lies beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .map_layer import MapLayer
from .method_options import OptionRefused
from .point_file import MeshFile, PointFile


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

    file: str | Path
    block: str
    layer: str | None = None
    where: Mapping = field(default_factory=dict)
    units: str | None = None
    ground: str | Path | PointFile | MeshFile | None = None
    faults: str | Path | MapLayer | None = None
    accuracy: float | None = None

    @property
    def polygons(self) -> MapLayer:
        """The layer of the polygons."""
        return MapLayer(self.file, self.layer, self.where, self.units)

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        if not (isinstance(self.block, str) and self.block.strip()):
            advice = 'write block = "FORMATION"'
            raise OptionRefused(f"'block' must name an attribute, not {self.block!r}", "block", advice)
        if self.accuracy is not None and not 0 <= self.accuracy < math.inf:
            advice = "give how far its lines may be off, or 0 where they are exact"
            raise OptionRefused(f"'accuracy' must be 0 or more, not {self.accuracy!r}", "accuracy", advice)
        self.polygons.check()
        if isinstance(self.ground, (PointFile, MeshFile)):
            self.ground.check()
