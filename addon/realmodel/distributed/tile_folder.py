# SPDX-License-Identifier: GPL-3.0-or-later
"""A model built tile by tile into a folder (docs/dev/tiles.md): resumed where a run ended."""

from __future__ import annotations

import json
import math
import secrets
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from ..core import BuildFailed, BuildWarning, OutputFailed, UsageError
from ..core.atomic import Outputs
from ..core.blocks import Block
from ..core.build_options import check_cells
from ..core.errors import place_text
from ..core.exporters.npz import write_arrays
from ..core.exporters.vtk_xml import write_pieces
from ..core.exporters.vtu import write_vtu
from ..core.local_heights import PartHeights
from ..core.mapped_arrays import MappedArrays, read_mapped, write_mapped
from ..core.simulation import PolyhedralMesh
from ..core.tiles import TiledModel
from ..core.tiles.borders import (
    OPPOSITE,
    BorderEdges,
    Interfaces,
    Patches,
    interfaces_on,
    matched,
    patches_on,
    positions_on,
    sides_of,
    with_vertices_of,
)
from ..core.tiles.catalog import CATALOG, INDEX, TILES, Catalog, TileEntry, read_catalog, write_catalog
from ..core.tiles.grid import checked_size
from ..core.tiles.settling import BorderVertices, Box, settled
from ..core.tiles.tile_model import (
    Frame,
    Name,
    build_tile,
    model_of,
    read_arrays,
    tile_arrays,
    write_model,
)
from ..core.tiles.tiled_model import file_digest, tiled_model
from ..core.validation import PLACES_OF_REPORT
from ..core.work import run
from ..core.wrong_sides import WrongPoints
from .tile_inputs import Prepared, divided, prepared
from .workers import Workers, no_workers, workers_of

_RUN = "run"  # what only a run needs, in the folder
_DIGEST = "digest"  # in there: of all that the result depends on
_PREPARED, _JOINED = 0.25, 0.97  # of the time
_BUILT = 0.6  # of the time of a tile
_LEAST_PLACES = 100  # of a tile that are compared with the closed form


def build(
    project,
    folder: str | Path,
    tile_size: tuple[float, float],
    client=None,
    *,
    workers: int | None = None,
    cells: str = "columns",
    progress=None,
    cancel=None,
) -> TiledModel:
    """Builds a model in tiles on workers of Dask, and leaves it in a folder that core.open_tiles opens.

    tile_size: width and height in plan, model units; a line between tiles may be off by a sixteenth of this.
    client: of distributed; None: a LocalCluster of so many `workers`, None: one for each processor. All
    workers have to see the folder under the same path. cells: as of core.build. A run that was stopped goes
    on where it was when it is started again with the same arguments; a folder that is finished is opened.

    Each tile is validated, and its borders compared with its neighbors', before the result is there. Raises
    as core.build; UsageError where Dask is missing, or the folder holds another model; OutputFailed.
    """
    check_cells(cells)
    size = checked_size(tile_size)
    if project.faults or project.bodies:
        raise UsageError("models with faults or bodies are not built in tiles; build them as a whole")
    folder = Path(folder)
    told = progress or (lambda _share, _text: None)
    _require_own(folder)
    is_finished = (folder / CATALOG).exists()
    with no_workers() if is_finished else workers_of(client, workers) as done_by:
        with _mapped_arrays(folder) as arrays:
            found = prepared(
                project,
                size,
                cells,
                arrays,
                done_by,
                lambda share, text: told(_PREPARED * share, text),
                cancel,
            )
            if is_finished:
                return _finished(folder, found.digest)
            store = _Store(folder, found.digest)
            names = store.divided(found, arrays, done_by, cancel)
            found = found.let_go()
        _build_all(store, found.frame, names, done_by, told, cancel)
    catalog = _catalog(found, store, names)
    write_index(store, [f"{TILES}/{_stem(name)}.vtu" for name in names])
    write_catalog(catalog, folder)
    store.remove()
    return tiled_model(catalog, folder)


def _build_all(store: _Store, frame: Frame, names: list[Name], workers: Workers, told, cancel) -> None:
    """Builds all tiles, and joins each as soon as those around it are built."""
    everywhere = frozenset(names)
    built = {name for name in names if store.has("built", name)}
    joined = {name for name in names if store.has("joined", name)}

    def following(task: tuple[str, Name]) -> list[tuple[str, Name]]:
        kind, name = task
        if kind == "joined":
            return []
        near = _around(name, everywhere)
        return [("joined", other) for other in near if built.issuperset(_around(other, everywhere))]

    tasks = [("built", name) for name in names if name not in built]
    tasks += [
        ("joined", name)
        for name in names
        if name not in joined and built.issuperset(_around(name, everywhere))
    ]
    shared = (store, frame, everywhere)
    for (kind, name), _ in workers.in_any_order(_step, shared, tasks, cancel, following=following):
        (built if kind == "built" else joined).add(name)
        done = (_BUILT * len(built) + (1 - _BUILT) * len(joined)) / len(names)
        text = f"{len(built)} of {len(names)} tiles built, {len(joined)} joined"
        told(_PREPARED + (_JOINED - _PREPARED) * done, text)


def _step(shared: tuple[_Store, Frame, frozenset], task: tuple[str, Name]) -> None:
    kind, name = task
    (_build if kind == "built" else _join)(shared, name)


def _require_own(folder: Path) -> None:
    """Raises UsageError where a folder holds something else than a model in tiles."""
    try:
        if (folder / CATALOG).exists() or (folder / _RUN / _DIGEST).exists() or not folder.exists():
            return
        if any(each.name not in (_RUN, TILES) for each in folder.iterdir()):
            raise UsageError(f"{folder}: a folder with other content; choose a new one")
    except OSError as error:
        raise OutputFailed(f"{folder}: {error.strerror or error}") from error


@contextmanager
def _mapped_arrays(folder: Path) -> Iterator[MappedArrays]:
    """Where arrays are kept until the tiles have them: on the disk of the result, unless this is finished."""
    if (folder / CATALOG).exists():
        run_folder, made = Path(tempfile.gettempdir()), []
    else:
        run_folder = folder / _RUN
        made = [each for each in (run_folder, folder) if not each.exists()]
    try:
        with MappedArrays(run_folder / f"inputs-{secrets.token_hex(8)}") as arrays:
            yield arrays
    finally:
        for each in made:
            with suppress(OSError):
                each.rmdir()  # where nothing else came


def _stem(name: Name) -> str:
    return f"{name[0]:04d}-{name[1]:04d}"


class _Store:
    """The files of a run, in the folder of the result; each is whole or not there."""

    def __init__(self, folder: Path, digest: str):
        self.folder = folder
        try:
            self._run.mkdir(parents=True, exist_ok=True)
            (folder / TILES).mkdir(exist_ok=True)
            of = self._run / _DIGEST
            if of.exists() and of.read_text() != digest:
                raise _another(folder)
            with Outputs() as outputs, outputs.file(of) as file:
                file.write(digest.encode())
        except OSError as error:
            raise OutputFailed(f"{folder}: {error.strerror or error}") from error

    @property
    def _run(self) -> Path:
        return self.folder / _RUN

    def file(self, kind: str, name: Name) -> Path:
        """kind: built, the model of a tile; sides, what its borders are; joined, its model
        with its neighbors' vertices; patches, what its borders are then."""
        folder = self.folder / TILES if kind == "joined" else self._run
        prefix = "" if kind == "joined" else f"{kind}-"
        ending = "arrays" if kind == "built" else "npz"
        return folder / f"{prefix}{_stem(name)}.{ending}"

    def parts(self, name: Name) -> Path:
        """The folder with what a tile needs of each surface."""
        return self._run / f"parts-{_stem(name)}"

    def record(self, kind: str, name: Name) -> Path:
        return self._run / f"{kind}-{_stem(name)}.json"

    def has(self, kind: str, name: Name) -> bool:
        """Whether a step is done: its record comes last."""
        return self.record(kind, name).exists()

    def done(self, kind: str, name: Name, **record) -> None:
        with Outputs() as outputs, outputs.file(self.record(kind, name)) as file:
            file.write(json.dumps(record).encode())

    def told(self, kind: str, name: Name) -> dict:
        try:
            return json.loads(self.record(kind, name).read_text())
        except (OSError, ValueError) as error:
            text = f"{self.record(kind, name)}: cannot be read; delete {self._run} and start again"
            raise BuildFailed(text) from error

    def divided(self, found: Prepared, arrays: MappedArrays, workers: Workers, cancel) -> list[Name]:
        """Writes what each tile needs; the tiles that need something, in order of the grid."""
        listed = self._run / "parts.json"
        if not listed.exists():
            try:
                for name in found.frame.grid:
                    self.parts(name).mkdir(exist_ok=True)
            except OSError as error:
                raise OutputFailed(f"{self._run}: {error.strerror or error}") from error
            names = divided(found, arrays, workers, self.parts, cancel)
            with Outputs() as outputs, outputs.file(listed) as file:
                file.write(json.dumps(names).encode())
        return [tuple(name) for name in json.loads(listed.read_text())]

    def write(self, path: Path, arrays: dict[str, np.ndarray]) -> None:
        with Outputs() as outputs, outputs.file(path) as file:
            write_arrays(arrays, file)

    def remove(self) -> None:
        shutil.rmtree(self._run, ignore_errors=True)


def _another(folder: Path) -> UsageError:
    return UsageError(
        f"{folder}: it holds a model of another project, tile size or kind of cells; "
        "choose another folder, or delete this one"
    )


def _finished(folder: Path, digest: str) -> TiledModel:
    catalog = read_catalog(folder)
    if catalog.digest != digest:
        raise _another(folder)
    return tiled_model(catalog, folder)


def _neighbors(frame: Frame, name: Name, names: Iterable[Name]) -> list[tuple]:
    """The sides of a tile that it shares: (side, the other tile)."""
    shared = []
    for side in sides_of(frame.grid.box(*name)):
        other = (name[0] + side.step[0], name[1] + side.step[1])
        if other in names:
            shared.append((side, other))
    return shared


def _around(name: Name, names: frozenset) -> list[Name]:
    """A tile, then those that share its sides or corners."""
    near = ((name[0] + column, name[1] + row) for column in (-1, 0, 1) for row in (-1, 0, 1))
    return [name, *(other for other in near if other in names and other != name)]


def _build(shared: tuple[_Store, Frame, frozenset], name: Name) -> None:
    """On a worker: builds a tile, and writes what its neighbors have to know of it."""
    store, frame, names = shared
    box = frame.grid.box(*name)
    built = run(lambda work: build_tile(work, frame, box, store.parts(name), threads=1))
    model, sides = built.model, built.borders
    numbers = sides["numbers"]
    edges = BorderEdges.of(model, numbers)
    sides["faces"] = np.unique(edges.face)
    for side, _ in _neighbors(frame, name, names):
        found = interfaces_on(model, edges.on(model, side))
        ends = np.searchsorted(numbers, found.ends)
        sides |= {f"{side.name}_on": found.on, f"{side.name}_ends": ends}
    with Outputs() as outputs, outputs.file(store.file("built", name)) as file:
        write_mapped(tile_arrays(model), file)
    store.write(store.file("sides", name), sides)
    store.done(
        "built",
        name,
        warnings=[asdict(warning) for warning in model.warnings],
        below=[[*key, asdict(wrong)] for key, wrong in built.wrong.items()],
        above=[[*key, asdict(wrong)] for key, wrong in built.above.items()],
        heights=[[*key, asdict(of)] for key, of in built.heights.items()],
    )


def _join(shared: tuple[_Store, Frame, frozenset], name: Name) -> None:
    """On a worker: gives a tile its neighbors' vertices, proves it, and writes it."""
    store, frame, names = shared
    model = model_of(frame.project, read_mapped(store.file("built", name)))
    around, box = _around(name, names), frame.grid.box(*name)
    sides = {other: read_arrays(store.file("sides", other)) for other in around}
    faces = sides[name]["faces"]
    borders = {other: BorderVertices.of_arrays(arrays, box) for other, arrays in sides.items()}
    places = dict(zip(around, settled(box, borders.values()), strict=True))
    model.vertices[borders[name].numbers] = places[name]
    neighbors = []
    for side, other in _neighbors(frame, name, names):
        keys = (f"{OPPOSITE[side.name]}_{key}" for key in ("on", "ends"))
        neighbors.append((side, Interfaces(*(sides[other][key] for key in keys)), places[other]))
    numbers, own = borders[name].numbers, len(model.vertices)
    model = with_vertices_of(model, BorderEdges.of(model, numbers, faces), neighbors)
    numbers = np.concatenate([numbers, np.arange(own, len(model.vertices), dtype=numbers.dtype)])
    report = model.validate(_places(frame, box), threads=1)
    if not report.passed:
        raise BuildFailed(f"tile {name[0]}, {name[1]} is wrong: {report.failure()}")
    patches, border = {}, BorderEdges.of(model, numbers, faces)
    for side, *theirs in neighbors:
        edges = border.on(model, side)
        found = patches_on(model, side, edges, positions_on(model, side, edges, *theirs))
        part = model.cell_component[found.cell]
        patches |= {
            f"{side.name}_shape": found.shape,
            f"{side.name}_block": found.block,
            f"{side.name}_part": part,
            f"{side.name}_open": np.array(found.open),
        }
    parts = np.flatnonzero(model.cell_component == np.arange(len(model.cell_block)))  # their first cells
    patches |= {"parts": parts, "block_of_part": model.cell_block[parts]}
    file = store.file("joined", name)
    write_model(model, file)
    mesh = PolyhedralMesh.of_model(model)
    with Outputs() as outputs, outputs.file(file.with_suffix(".vtu")) as out:
        write_vtu(mesh, out, lambda _share: None)
    store.write(store.file("patches", name), patches)
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
    )
    del model, mesh  # what is mapped
    with suppress(OSError):  # on Windows as long as anything maps it; the folder goes at the end
        store.file("built", name).unlink()


def _extent(vertices: np.ndarray) -> tuple[list[float], list[float]]:
    """The lowest and highest coordinates, 0 where there is no vertex."""
    axes = vertices.T if len(vertices) else np.zeros((3, 1))  # min(axis=0) would take ten times as long
    return [float(axis.min()) for axis in axes], [float(axis.max()) for axis in axes]


def _places(frame: Frame, box: Box) -> int:
    """How many positions of a tile are compared with the closed form: its share of the whole's by area."""
    low_x, low_y, high_x, high_y = frame.grid.whole
    share = (box[2] - box[0]) / (high_x - low_x) * ((box[3] - box[1]) / (high_y - low_y))
    return max(_LEAST_PLACES, math.ceil(PLACES_OF_REPORT * share))


def _patches(arrays: dict, side: str) -> Patches:
    return Patches(
        *(arrays[f"{side}_{key}"] for key in ("shape", "block", "part")), int(arrays[f"{side}_open"])
    )


class _Parts:
    """The connected parts of blocks over all tiles, by sets that are joined."""

    def __init__(self):
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


def _catalog(found: Prepared, store: _Store, names: list[Name]) -> Catalog:
    """The table of the whole."""
    frame = found.frame
    parts, patches, warnings = _Parts(), np.zeros(2, np.int64), list(found.warnings)
    for name in names:
        arrays = read_arrays(store.file("patches", name))
        for part, block in zip(arrays["parts"].tolist(), arrays["block_of_part"].tolist(), strict=True):
            parts.add((*name, part), block)
    for name in names:
        own = read_arrays(store.file("patches", name))
        for side, other in _neighbors(frame, name, names):
            if side.name not in ("east", "north"):
                continue
            theirs = read_arrays(store.file("patches", other))
            match = matched(_patches(own, side.name), _patches(theirs, OPPOSITE[side.name]), side)
            if match.unequal:
                near = "" if match.place is None else f" near {place_text(match.place)}"
                text = (
                    f"tiles {name} and {other} differ at {match.unequal} places on their border"
                    f"{near}; the parts of blocks were joined by their areas there"
                )
                warnings.append(BuildWarning(text, "borders"))
            patches += [match.patches, match.unequal]
            for one, another in match.cells.tolist():
                parts.join((*name, one), (*other, another))
    told = [store.told("joined", name) for name in names]
    return Catalog(
        frame.project,
        frame.cell_kind,
        found.digest,
        frame.grid,
        _blocks(frame, told, parts),
        [_entry(name, record) for name, record in zip(names, told, strict=True)],
        *patches.tolist(),
        [*warnings, *_warnings(frame, store, names)],
    )


def _blocks(frame: Frame, told: list[dict], parts: _Parts) -> list[Block]:
    if not told:
        return []
    of_tiles = [[Block(**block) for block in record["blocks"]] for record in told]
    components = parts.count(len(of_tiles[0]))
    blocks = []
    for number, block in enumerate(of_tiles[0]):
        volume = math.fsum(blocks_[number].volume for blocks_ in of_tiles)
        cells = sum(record["cells"][number] for record in told)
        if frame.cell_kind == "blocks":
            cells = int(components[number])
        blocks.append(replace(block, volume=volume, cells=cells, components=int(components[number])))
    return blocks


def _entry(name: Name, record: dict) -> TileEntry:
    return TileEntry(
        *name,
        _stem(name),
        record["sha256"],
        sum(record["cells"]),
        record["faces"],
        record["vertices"],
        record["low"],
        record["high"],
        [block["volume"] for block in record["blocks"]],
    )


def _warnings(frame: Frame, store: _Store, names: list[Name]) -> list[BuildWarning]:
    """Those of all tiles; what they say of triangles and points as one."""
    items: dict[tuple, set] = {}
    wrong: dict[tuple[str, int, int], WrongPoints] = {}
    heights: dict[tuple[int, int], PartHeights] = {}
    for name in names:
        record = store.told("built", name)
        for told in record["warnings"]:
            key = (told["kind"], told["rock"], told["surface"])
            if told["kind"] != "no_area":
                key = (*key, told["text"])
            items.setdefault(key, set()).update(told["items"])
        for side in ("below", "above"):
            _join_each(wrong, [((side, r, k), WrongPoints(**own)) for r, k, own in record[side]])
        _join_each(heights, [((r, k), PartHeights(**own)) for r, k, own in record["heights"]])
    found = []
    for (r, k), of in sorted(heights.items()):
        found += frame.local[r, k].warnings(of, frame.project.rocks[r], k)
    for (side, r, k), own in sorted(wrong.items()):
        found.append(own.warning(frame.project.rocks[r], k, frame.sought[r, k], side))
    for (kind, rock, surface, *text), numbers in items.items():
        if kind == "no_area":
            what = "triangle" if len(numbers) == 1 else "triangles"
            text = [f"{len(numbers)} {what} without area left out"]
        found.append(BuildWarning(text[0], kind, rock, surface, tuple(sorted(numbers))))
    return found


def _join_each(found: dict, parts: list[tuple]) -> None:
    """Adds parts to what others had of the same."""
    for key, part in parts:
        found[key] = found[key].joined(part) if key in found else part


def write_index(store: _Store, pieces: list[str]) -> None:
    """The file that opens all tiles in ParaView."""
    with Outputs() as outputs, outputs.file(store.folder / INDEX) as file:
        write_pieces(file, pieces)
