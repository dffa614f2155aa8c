# SPDX-License-Identifier: GPL-3.0-or-later
"""A model in tiles, opened from its folder: the whole, of which only the tiles asked for are read."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import dot
from ..base.errors import BuildWarning, InputRefused, UsageError
from ..base.named import NamedList, keyword_only
from ..cells.blocks import Block, named_blocks
from ..fields import ScalarField
from ..model.cutting import Fence, Section
from ..model.model import Model
from ..notebook import ShortRepr
from ..project.project import Project
from ..results.layer_values import RockFields, field_of
from ..results.model_holes import Interval
from ..results.tables import block_table, borehole_table
from ..validation.closed_form import AIR, checked_places, grid_centers
from .catalog import TILES, Catalog, TileEntry, read_catalog
from .tile_fields import FIELDS, read_rock_fields
from .tile_model import read_model

_KEPT = 4  # models of tiles in memory
_OFF = 64  # units in the last place beside a border, farther than rounding moves vertices


@dataclass(eq=False, repr=False)
class Tile(ShortRepr):
    """One tile of a model, with its `name`. column, row: its place, from 0 in the southwest. box: low x, low
    y, high x, high y. cells, faces, vertices: how many it has. extent: (2, 3), the corners of the box around
    its vertices. volumes: (B,), of its part of each block. file: its .npz; beside it the same as .vtu."""

    column: int
    row: int
    name: str
    box: tuple[float, float, float, float]
    file: Path
    cells: int
    faces: int
    vertices: int
    extent: np.ndarray
    volumes: np.ndarray
    _entry: TileEntry = field(repr=False)
    _project: Project = field(repr=False)

    def model(self) -> Model:
        """The tile as a model, read anew. Raises InputRefused where its file is not the one that was
        written."""
        try:
            digest = file_digest(self.file)
        except OSError as error:
            raise InputRefused(f"cannot be read: {error.strerror}", file=self.file) from error
        if digest != self._entry.sha256:
            raise InputRefused("it has changed since it was written; build the model again", file=self.file)
        return read_model(self._project, self.file)


@dataclass(eq=False, repr=False)
class TiledModel(ShortRepr):
    """A model in tiles, over all tiles: `name`, `cell_kind`, `blocks` and `warnings` as of Model; cells of
    columns count those of the tiles, which borders divide. folder: where it is. x, y: the lines between
    tiles, model units. project: without shapes. patches: how many quadrilaterals of the borders between tiles
    were compared, double for double; unequal: those that one side alone has."""

    name: str
    folder: Path
    cell_kind: str
    blocks: NamedList[Block]
    tiles: list[Tile]
    x: np.ndarray
    y: np.ndarray
    project: Project
    patches: int
    unequal: int
    warnings: list[BuildWarning]

    def __post_init__(self) -> None:
        self._model = functools.lru_cache(_KEPT)(lambda number: self.tiles[number].model())

    @property
    def volume(self) -> float:
        """The volume of all blocks, model units cubed."""
        return float(sum(block.volume for block in self.blocks))

    @property
    def surface_names(self) -> list[str]:
        """As of Model: surfaces, faults, bodies."""
        surfaces = [surface.name for rock in self.project.rocks for surface in rock.surfaces]
        return surfaces + [structure.name for structure in (*self.project.faults, *self.project.bodies)]

    @keyword_only
    def section(
        self, point: Sequence[float] | np.ndarray, normal: Sequence[float] | np.ndarray, *, threads: int = 0
    ) -> Section:
        """As Model.section; cells count through the tiles in their order. A plane on a border between tiles
        is moved off it by a rounding."""
        point, normal = (np.asarray(vector, np.float64) for vector in (point, normal))
        if point.shape != (3,) or normal.shape != (3,) or not normal.any():
            raise UsageError("a plane is a point and a normal that is not zero, three numbers each")
        if np.count_nonzero(normal) == 1:
            point = self._off_borders(point[None])[0]

        def meets(tile: Tile) -> bool:
            away = dot(self._corners(tile) - point, normal)
            return away.min() <= 0 <= away.max()

        return self._joined(meets, lambda model: model.section(point, normal, threads=threads))

    @keyword_only
    def fence(self, polyline: ArrayLike, *, threads: int = 0) -> Fence:
        """As Model.fence; polygons come by tile."""
        line = np.asarray(polyline, np.float64)
        if line.ndim != 2 or line.shape[1:] != (2,) or len(line) < 2:
            raise UsageError(f"polyline must be an array (N, 2) with N > 1, not {line.shape}")
        line = self._off_borders(line)

        def meets(tile: Tile) -> bool:
            low = np.minimum(line[:-1], line[1:])
            high = np.maximum(line[:-1], line[1:])
            at = tile.extent[:, :2]
            return bool(((low <= at[1]) & (high >= at[0])).all(axis=1).any())

        return self._joined(meets, lambda model: model.fence(line, threads=threads))

    def borehole(self, x: float, y: float) -> list[Interval]:
        """As Model.borehole."""
        place = self._off_borders(np.array([[x, y]], np.float64))[0]
        intervals = []
        for number, tile in enumerate(self.tiles):
            low, high = tile.extent[:, :2]
            if (low <= place).all() and (place <= high).all():
                intervals += self._model(number).borehole(*place.tolist())
        return joined_intervals(intervals)

    @keyword_only
    def block_at(self, points: ArrayLike, *, threads: int = 0) -> np.ndarray:
        """As Model.block_at, tile by tile."""
        places = checked_places(points)
        blocks = np.full(len(places), AIR, np.int32)
        for number, tile in enumerate(self.tiles):
            low, high = np.array(tile.box[:2]), np.array(tile.box[2:])
            here = ((low <= places[:, :2]) & (places[:, :2] <= high)).all(axis=1) & (blocks == AIR)
            if here.any():
                blocks[here] = self._model(number).block_at(places[here], threads=threads)
        return blocks

    @keyword_only
    def grid(self, shape: Sequence[int], *, threads: int = 0) -> np.ndarray:
        """As Model.grid."""
        corners = np.array([tile.extent for tile in self.tiles]).reshape(-1, 2, 3)
        box = (
            np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
            if len(corners)
            else np.zeros((2, 3))
        )
        return self.block_at(grid_centers(box, shape), threads=threads).reshape(shape)

    def field(self, series: str, compartment: str | None = None) -> ScalarField:
        """As Model.field: it is the field of the undivided model. Raises InputRefused where the file of the
        fields is damaged, too."""
        return field_of(self.project, self.rock_fields(), series, compartment)

    def rock_fields(self) -> list[RockFields]:
        """The fields of the series of each rock mass; none where no rock mass has one."""
        file = self.folder / FIELDS
        return read_rock_fields(file) if file.exists() else []

    block_table = block_table
    borehole_table = borehole_table

    def _corners(self, tile: Tile) -> np.ndarray:
        """(8, 3) of the box around a tile's vertices."""
        choice = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
        return tile.extent[choice, [0, 1, 2]]

    def _off_borders(self, places: np.ndarray) -> np.ndarray:
        """Places (N, 2 or 3) with coordinates on no border between tiles: moved from there by a rounding."""
        places = places.copy()
        for axis, lines in enumerate((self.x, self.y)):
            on = np.isin(places[:, axis], lines)
            places[on, axis] += _OFF * np.spacing(np.abs(lines).max())
        return places

    def _joined(self, meets: Callable, cut: Callable) -> Any:
        """The sections of the tiles that a cutter meets as one."""
        numbers = [number for number, tile in enumerate(self.tiles) if meets(tile)]
        if not self.tiles:
            raise UsageError("the model has no cells")
        first_cell = np.cumsum([0, *(tile.cells for tile in self.tiles)])
        sections = []
        for number in numbers or [0]:
            tile_section = cut(self._model(number))
            cells = np.where(tile_section.cells >= 0, tile_section.cells + np.int32(first_cell[number]), -1)
            sections.append(replace(tile_section, cells=cells.astype(np.int32)))
        return joined_sections(sections)


def joined_intervals(found: list[Interval]) -> list[Interval]:
    """Intervals of one borehole in several tiles, from above downward; what one block has in two tiles
    becomes one."""
    joined: list[Interval] = []
    for interval in sorted(found, key=lambda interval: -interval.top):
        last = joined[-1] if joined else None
        off = _OFF * np.spacing(abs(interval.top))
        if last is not None and abs(last.bottom - interval.top) <= off and last.block == interval.block:
            joined[-1] = Interval(interval.block, last.top, interval.bottom)
        else:
            joined.append(interval)
    return joined


def joined_sections(sections: list[Section]) -> Section:
    """Sections of parts of a model as one; equal vertices become one."""
    first = np.cumsum([0, *(len(section.vertices) for section in sections)])
    vertices, number = np.unique(
        np.concatenate([section.vertices for section in sections]), axis=0, return_inverse=True
    )
    corners = [section.polygon_vertices + start for section, start in zip(sections, first[:-1], strict=True)]
    starts = np.cumsum([0, *(len(section.polygon_vertices) for section in sections)])
    offsets = [section.offsets[:-1] + start for section, start in zip(sections, starts[:-1], strict=True)]
    by_polygon = ["cells", "blocks", "block", "property", "compartment"]
    if isinstance(sections[0], Fence):
        by_polygon.append("panel")
    joined: dict[str, Any] = {  # dataclasses.replace takes fields of any type
        name: np.concatenate([getattr(section, name) for section in sections]) for name in by_polygon
    }
    return replace(
        sections[0],
        vertices=vertices,
        offsets=np.concatenate([*offsets, starts[-1:]]).astype(np.int64),
        polygon_vertices=number.reshape(-1)[np.concatenate(corners)].astype(np.int32),
        **joined,
    )


def file_digest(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def open_tiles(folder: str | Path) -> TiledModel:
    """Opens the folder of a model in tiles (realmodel.distributed.build); only its table is read.

    Raises InputRefused where it holds none, or one that is not finished.
    """
    folder = Path(folder)
    return tiled_model(read_catalog(folder), folder)


def tiled_model(catalog: Catalog, folder: Path) -> TiledModel:
    """The model that a table is of."""
    tiles = [
        Tile(
            entry.column,
            entry.row,
            entry.name,
            catalog.grid.box(entry.column, entry.row),
            folder / TILES / f"{entry.name}.npz",
            entry.cells,
            entry.faces,
            entry.vertices,
            np.array([entry.low, entry.high], np.float64),
            np.array(entry.volumes, np.float64),
            entry,
            catalog.project,
        )
        for entry in catalog.tiles
    ]
    return TiledModel(
        catalog.project.name,
        folder,
        catalog.cell_kind,
        named_blocks(catalog.blocks),
        tiles,
        catalog.grid.x,
        catalog.grid.y,
        catalog.project,
        catalog.patches,
        catalog.unequal,
        catalog.warnings,
    )
