# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a model in tiles while it is built, and the table of its tiles."""

from __future__ import annotations

import json
import math
import secrets
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..core import BuildFailed, OutputFailed, UsageError
from ..core.base.atomic import Outputs
from ..core.base.mapped_arrays import MappedArrays
from ..core.base.work import Work, wait_for_stopped
from ..core.cells.blocks import Block
from ..core.exporters.encodings.vtk_xml import write_pieces
from ..core.exporters.model_arrays import write_arrays
from ..core.exporters.solvers.vtu import write_vtu
from ..core.model.model import Model
from ..core.simulation import PolyhedralMesh
from ..core.tiles.catalog import CATALOG, INDEX, TILES, Catalog, TileEntry, read_catalog, write_catalog
from ..core.tiles.grid import Box
from ..core.tiles.tile_model import Frame, Name, write_model
from ..core.tiles.tiled_model import TiledModel, file_digest, tiled_model
from ..core.tiles.windows import Window, Windows
from ..core.validation.validation import PLACES_OF_REPORT
from .packing import unpacked

RUN = "run"  # what only a run needs, in the folder
_DIGEST = "digest"  # in there: of all that the result depends on
_LEAST_PLACES = 100  # of a tile that are compared with the closed form


def require_own(folder: Path) -> None:
    """Raises UsageError where a folder holds something else than a model in tiles."""
    try:
        if (folder / CATALOG).exists() or (folder / RUN / _DIGEST).exists() or not folder.exists():
            return
        if any(path.name not in (RUN, TILES) for path in folder.iterdir()):
            raise UsageError(f"{folder}: a folder with other content; choose a new one")
    except OSError as error:
        raise OutputFailed(f"{folder}: {error.strerror or error}") from error


def stem(name: Name) -> str:
    return f"{name[0]:04d}-{name[1]:04d}"


@contextmanager
def mapped_arrays(folder: Path) -> Iterator[MappedArrays]:
    """Where arrays are kept until the tiles have them: on the disk of the result, unless this is finished."""
    if (folder / CATALOG).exists():
        run_folder, made = Path(tempfile.gettempdir()), []
    else:
        run_folder = folder / RUN
        made = [path for path in (run_folder, folder) if not path.exists()]
    try:
        with MappedArrays(run_folder / f"inputs-{secrets.token_hex(8)}") as arrays:
            try:
                yield arrays
            finally:
                wait_for_stopped()  # what reads surfaces writes here, and uses the workers
    finally:
        for path in made:
            with suppress(OSError):
                path.rmdir()  # where nothing else came


class Store:
    """The files of a run, in the folder of the result; each is whole or not there."""

    def __init__(self, folder: Path, digest: str):
        self.folder = folder
        try:
            self._run.mkdir(parents=True, exist_ok=True)
            (folder / TILES).mkdir(exist_ok=True)
            of = self._run / _DIGEST
            if of.exists() and of.read_text() != digest:
                raise another(folder)
            with Outputs() as outputs, outputs.file(of) as file:
                file.write(digest.encode())
        except OutputFailed:
            raise
        except OSError as error:
            raise OutputFailed(f"{folder}: {error.strerror or error}") from error

    @property
    def _run(self) -> Path:
        return self.folder / RUN

    def file(self, kind: str, name: Name) -> Path:
        """kind: built, the model of a tile; sides, what its borders are; joined, its model
        with its neighbors' vertices; patches, what its borders are then."""
        folder = self.folder / TILES if kind == "joined" else self._run
        prefix = "" if kind == "joined" else f"{kind}-"
        ending = "arrays" if kind == "built" else "npz"
        return folder / f"{prefix}{stem(name)}.{ending}"

    def record(self, kind: str, name: Name) -> Path:
        return self._run / f"{kind}-{stem(name)}.json"

    def has(self, kind: str, name: Name) -> bool:
        """Whether a step is done: its record comes last."""
        return self.record(kind, name).exists()

    def done(self, kind: str, name: Name, **record: Any) -> None:
        with Outputs() as outputs, outputs.file(self.record(kind, name)) as file:
            file.write(json.dumps(record).encode())

    def read_record(self, kind: str, name: Name) -> dict:
        try:
            return json.loads(self.record(kind, name).read_text())
        except (OSError, ValueError) as error:
            text = f"{self.record(kind, name)}: cannot be read; delete {self._run} and start again"
            raise BuildFailed(text) from error

    def write(self, path: Path, arrays: dict[str, np.ndarray]) -> None:
        with Outputs() as outputs, outputs.file(path) as file:
            write_arrays(arrays, file)

    def remove(self) -> None:
        shutil.rmtree(self._run, ignore_errors=True)


@dataclass(frozen=True)
class Shared:
    """What all tasks get. inputs: the folder of MappedArrays; windows: packed there. names: of all tiles."""

    store: Store
    frame: Frame
    inputs: Path
    windows: bytes
    names: frozenset[Name]

    def window(self, work: Work, name: Name, farther: int | None = 0) -> Window:
        """As Windows.window."""
        windows: Windows = unpacked(self.windows, self.inputs)
        return windows.window(work, name, farther)


def another(folder: Path) -> UsageError:
    return UsageError(
        f"{folder}: it holds a model of another project, tile size or kind of cells; "
        "choose another folder, or delete this one"
    )


def finished(folder: Path, digest: str) -> TiledModel:
    catalog = read_catalog(folder)
    if catalog.digest != digest:
        raise another(folder)
    return tiled_model(catalog, folder)


def write_tile(store: Store, name: Name, model: Model, **more: Any) -> None:
    """Writes a tile's model, and the record that it is done. more: what else that says."""
    file = store.file("joined", name)
    write_model(model, file)
    mesh = PolyhedralMesh.of_model(model)
    with Outputs() as outputs, outputs.file(file.with_suffix(".vtu")) as out:
        write_vtu(mesh, out, lambda _share: None)
    low, high = _extent(model.vertices)
    store.done(
        "joined",
        name,
        sha256=file_digest(file),
        cells=np.bincount(model.cell_block, minlength=len(model.blocks)).tolist(),
        faces=len(model.face_surface),
        vertices=len(model.vertices),
        low=low,
        high=high,
        blocks=[asdict(block) for block in model.blocks],
        **more,
    )


def _extent(vertices: np.ndarray) -> tuple[list[float], list[float]]:
    """The lowest and highest coordinates, 0 where there is no vertex."""
    axes = vertices.T if len(vertices) else np.zeros((3, 1))  # min(axis=0) would take ten times as long
    return [float(axis.min()) for axis in axes], [float(axis.max()) for axis in axes]


def places_of(frame: Frame, box: Box) -> int:
    """How many positions of a tile are compared with the closed form: its share of the whole's by area."""
    low_x, low_y, high_x, high_y = frame.grid.whole
    share = (box[2] - box[0]) / (high_x - low_x) * ((box[3] - box[1]) / (high_y - low_y))
    return max(_LEAST_PLACES, math.ceil(PLACES_OF_REPORT * share))


class Parts:
    """The connected components of blocks over all tiles, by sets that are joined."""

    def __init__(self) -> None:
        self._parent: dict[tuple, tuple] = {}
        self._block: dict[tuple, int] = {}

    def add(self, part: tuple, block: int) -> None:
        self._parent[part], self._block[part] = part, block

    def root(self, part: tuple) -> tuple:
        while self._parent[part] != part:
            self._parent[part] = part = self._parent[self._parent[part]]
        return part

    def join(self, one: tuple, other: tuple) -> None:
        self._parent[self.root(one)] = self.root(other)

    def count(self, blocks: int) -> np.ndarray:
        """(B,) how many parts each block has."""
        roots = [self._block[part] for part, parent in self._parent.items() if part == parent]
        return np.bincount(np.array(roots, np.int64), minlength=blocks)


def blocks_of(frame: Frame, records: list[dict], parts: Parts, whole_cells: Parts) -> list[Block]:
    """The blocks of the whole. records: of tiles; parts: the connected components; whole_cells: the cells
    of whole blocks."""
    if not records:
        return []
    of_tiles = [[Block(**block) for block in record["blocks"]] for record in records]
    components, of_blocks = (connected.count(len(of_tiles[0])) for connected in (parts, whole_cells))
    blocks = []
    for number, block in enumerate(of_tiles[0]):
        volume = math.fsum(blocks_[number].volume for blocks_ in of_tiles)
        cells = sum(record["cells"][number] for record in records)
        if frame.cell_kind == "blocks":
            cells = int(of_blocks[number])
        blocks.append(replace(block, volume=volume, cells=cells, components=int(components[number])))
    return blocks


def entry_of(name: Name, record: dict) -> TileEntry:
    return TileEntry(
        *name,
        stem(name),
        record["sha256"],
        sum(record["cells"]),
        record["faces"],
        record["vertices"],
        record["low"],
        record["high"],
        [block["volume"] for block in record["blocks"]],
    )


def finish(store: Store, catalog: Catalog) -> TiledModel:
    """Writes the file that opens all tiles in ParaView, and the table of the whole, and removes what only the
    run needed."""
    with Outputs() as outputs, outputs.file(store.folder / INDEX) as file:
        write_pieces(file, [f"{TILES}/{tile.name}.vtu" for tile in catalog.tiles])
    write_catalog(catalog, store.folder)
    store.remove()
    return tiled_model(catalog, store.folder)
