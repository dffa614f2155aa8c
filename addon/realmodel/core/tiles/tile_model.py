# SPDX-License-Identifier: GPL-3.0-or-later
"""One tile: what it needs in a file, its model built from that, and the model in a file."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from ..base.atomic import Outputs, explained
from ..base.build_warning import BuildWarning
from ..base.errors import BuildFailed, OutputFailed
from ..base.mapped_arrays import in_pieces, read_mapped, write_mapped
from ..base.sheet import Sheet
from ..base.work import NativeError, Work, refused_as, run
from ..cells.assembly import assemble
from ..cells.blocks import blocks_of_arrays
from ..cells.built_cells import BuiltCells
from ..cells.cell_complex import CellComplex
from ..cells.stack_refusals import refused_stack
from ..exporters.npz import model_arrays, write_arrays
from ..model.model import Model
from ..project.project import Project, Rock, Surface
from ..project.series import Series
from ..project.structure_entries import Body, Fault
from ..readers.npz import read_npz
from ..settings.series import FIELD
from ..structures.parts.parts import structures_of
from ..surfaces.local_heights import LocalHeights, PartHeights
from ..surfaces.rock_input import RockInput
from ..surfaces.surface_arrays import SurfaceArrays
from ..surfaces.surface_heights import raise_to
from ..surfaces.wrong_sides import WrongPoints, below_older, heights_at
from .grid import (
    MeshPart,
    TileGrid,
    box_triangles,
    clipped_region,
    part_of,
    points_by_tile,
    triangles_by_tile,
)
from .settling import BorderVertices, Box
from .tile_lists import TileLists
from .windows import PointWindows

Name = tuple[int, int]  # column and row of a tile
REGION = "region"  # in the place of a surface's number
PLAN = "plan"  # of the surfaces that tiles interpolate
_WIDER = 3.0  # times as wide is the next window around a tile


@dataclass(frozen=True)
class Frame:
    """What all tiles of a model share. project: without shapes; cell_kind as of Model; clips: for each rock
    mass whether its region clips its surfaces, beside the tile. local: the surfaces that tiles interpolate,
    by rock mass and number, each after those that it needs; sought: those of which they look for points on
    wrong sides, each with how many points it has; off: for each rock mass wrong_sides.kept_off."""

    project: Project
    cell_kind: str
    grid: TileGrid
    clips: tuple[bool, ...]
    local: dict[tuple[int, int], LocalHeights] = field(default_factory=dict)
    sought: dict[tuple[int, int], int] = field(default_factory=dict)
    off: tuple[frozenset[int], ...] = ()


def without_shape(rock: Rock) -> Rock:
    """A rock mass with names, rules, properties and, for messages, files alone."""
    surfaces = [
        Surface(
            surface.name,
            rule=surface.rule,
            property=surface.property,
            block=surface.block,
            series=surface.series if rock.is_level_set(surface) else None,
            shape_file=surface.shape_source()[0],
        )
        for surface in rock.surfaces
    ]
    return Rock(
        rock.name,
        surfaces,
        base_elevation=rock.base_elevation,
        series=[Series(series.name) for series in rock.series if series.kind == FIELD],
        shape_file=rock.shape_source("region")[0],
    )


def without_shapes(project: Project, inputs: list[RockInput]) -> Project:
    """The project with names, rules and properties alone."""
    rocks = [without_shape(entry.rock) for entry in inputs]
    return Project(
        project.name,
        rocks,
        project.library,
        faults=[Fault(fault.name) for fault in project.faults],
        bodies=[Body(body.name, property=body.property) for body in project.bodies],
        units=project.units,
    )


def write_parts(
    mesh: Sheet, rock: int, surface: int | str, grid: TileGrid, folder_of: Callable[[Name], Path]
) -> dict[Name, Box]:
    """Writes what each tile needs of a surface, REGION or PLAN of a rock mass: a file for each tile that it
    meets. folder_of: of a tile. Returns these tiles, and the box around the vertices of each.

    One tile, or a piece of the surface, is in memory at a time: the numbers of triangles are files first."""
    met = {}
    with TileLists(folder_of, _part(rock, surface), np.empty(0, np.int32)) as listed:
        for name, numbers in triangles_by_tile(mesh, grid):
            listed.add(name, numbers)
        for name in listed.tiles:
            part = part_of(mesh, listed.of(name))
            plan = part.vertices[:, :2]
            met[name] = (*plan.min(axis=0).tolist(), *plan.max(axis=0).tolist())
            arrays = {key: getattr(part, key) for key in MeshPart.__dataclass_fields__}
            _write(arrays, folder_of(name) / _part(rock, surface))
    return met


def write_windows(
    points: np.ndarray,
    rock: int,
    surface: int,
    local: LocalHeights,
    boxes: dict[Name, Box],
    folder_of: Callable[[Name], Path],
) -> None:
    """Writes the points (P, 3) that each tile interpolates a surface from. boxes: around the nodes of each
    tile."""
    part, names = _part(rock, f"{surface}-near"), list(boxes)
    windows = PointWindows(points, list(boxes.values()), local.needed, local.grid, local.reach)
    with _listed(points, windows, names, TileLists(folder_of, part, np.empty((0, 3)))) as near:
        for name in near.tiles:
            _write({"points": near.of(name)}, folder_of(name) / part)


@contextmanager
def _listed(
    points: np.ndarray, windows: PointWindows, names: list[Name], lists: TileLists
) -> Iterator[TileLists]:
    """The points in the window of each tile, in `lists`, which are deleted at the end."""
    with lists:
        for number, piece in enumerate(in_pieces(points)):
            for window, which in windows.of(piece, number == 0):
                lists.add(names[window], piece[which])
        yield lists


def write_certain_heights(
    points: np.ndarray,
    rock: int,
    surface: int,
    local: LocalHeights,
    boxes: dict[Name, Box],
    folder_of: Callable[[Name], Path],
) -> None:
    """Writes the heights that each tile has of a surface with a border, from windows that grow until they are
    certain. boxes: around the nodes of each tile, of which PLAN is written."""
    part, wider = _part(rock, f"{surface}-near"), 1.0
    heights: dict[Name, np.ndarray] = {}
    waiting: dict[Name, np.ndarray] = {}  # the nodes whose heights are not certain
    while boxes:
        names = list(boxes)
        windows = PointWindows(points, list(boxes.values()), local.needed, wider=wider)
        with _listed(points, windows, names, TileLists(folder_of, part, np.empty((0, 3)))) as near:
            for number, name in enumerate(names):
                nodes = _read_part(folder_of(name), rock, PLAN).vertices[:, :2]
                z = heights.setdefault(name, np.empty(len(nodes)))
                left = waiting.setdefault(name, np.arange(len(nodes)))
                asked, window = np.ascontiguousarray(nodes[left]), windows.window(number)
                task = partial(local.certain_heights, points=near.of(name), nodes=asked, window=window)
                found, certain = run(task, threads=1)
                z[left[certain]] = found[certain]
                waiting[name] = left[~certain]
                if certain.all():
                    _write({"z": heights.pop(name)}, folder_of(name) / part)
                    del boxes[name]
        wider *= _WIDER


def write_own_points(
    points: np.ndarray, rock: int, surface: int, grid: TileGrid, folder_of: Callable[[Name], Path]
) -> None:
    """Writes the points (P, 3) of a surface that lie in each tile, with their numbers."""
    begin, part = 0, _part(rock, f"{surface}-own")
    row_of = np.dtype([("points", np.float64, 3), ("numbers", np.int64)])
    with TileLists(folder_of, part, np.empty(0, row_of)) as own:
        for piece in in_pieces(points):
            rows = np.empty(len(piece), row_of)
            rows["points"], rows["numbers"] = piece, np.arange(begin, begin + len(piece))
            for name, numbers in points_by_tile(piece, grid):
                own.add(name, rows[numbers])
            begin += len(piece)
        for name in own.tiles:
            rows = own.of(name)
            arrays = {key: np.ascontiguousarray(rows[key]) for key in row_of.names or ()}
            _write(arrays, folder_of(name) / part)


def _write(arrays: dict[str, np.ndarray], path: Path) -> None:
    with explained(path), path.open("wb") as file:
        write_mapped(arrays, file)


def _part(rock: int, surface: int | str) -> str:
    return f"{rock}-{surface}.arrays"


def _parts(work: Work, frame: Frame, box: Box, folder: Path) -> tuple[dict, dict]:
    """What the tile has of each surface and REGION, by rock mass and number; and of the surfaces that it
    interpolates Interpolated."""
    parts, made = {}, {}
    for r, rock in enumerate(frame.project.rocks):
        for k in (*range(len(rock.surfaces)), *([REGION] if frame.clips[r] else [])):
            if (r, k) not in frame.local:
                parts[r, k] = _read_part(folder, r, k)
    plans = {r: _read_part(folder, r, PLAN) for r in {r for r, _ in frame.local}}
    for r, k in frame.local:
        parts[r, k] = plans[r]
        if len(plans[r].vertices):
            of_rock = {number: part for (rock, number), part in parts.items() if rock == r}
            made[r, k] = _interpolated(work, frame, (r, k), of_rock, box, folder)
            parts[r, k] = made[r, k].part
    return parts, made


def _read_part(folder: Path, rock: int, surface: int | str) -> MeshPart:
    path = folder / _part(rock, surface)
    if not path.exists():
        columns = 2 if surface == REGION else 3
        none = np.empty(0, np.int32)
        return MeshPart(np.empty((0, columns)), np.empty((0, 3), np.int32), none, none)
    arrays = read_mapped(path)
    return MeshPart(*(arrays[name] for name in MeshPart.__dataclass_fields__))


@dataclass(frozen=True)
class Interpolated:
    """A part of a surface that a tile interpolated, and its heights. above: the WrongPoints of the surface
    before, from which it is kept off."""

    part: MeshPart
    heights: PartHeights
    above: WrongPoints | None


def _interpolated(
    work: Work, frame: Frame, key: tuple[int, int], parts: dict, box: Box, folder: Path
) -> Interpolated:
    """parts: of the rock mass, this one with the plan alone."""
    local, plan, (r, k) = frame.local[key], parts[key[1]], key
    nodes = np.ascontiguousarray(plan.vertices[:, :2])
    near = read_mapped(folder / _part(r, f"{k}-near")) if local.takes_points else {}
    points = near.get("points", np.empty((0, 3)))
    others = {n: part.vertices[:, 2] for n, part in parts.items() if n != REGION}
    z = near["z"] if "z" in near else local.heights(work, points, nodes, others)
    known = z[np.isfinite(z)]
    found = PartHeights(
        float(known.min(initial=np.inf)),
        float(known.max(initial=-np.inf)),
        int(np.isfinite(z)[plan.triangles].all(axis=1).sum()),
    )
    own = ((nodes >= box[:2]) & (nodes < box[2:])).all(axis=1)  # each node in one tile
    if local.settings.get("radius") is not None:
        beyond = local.beyond_radius(work, points, np.ascontiguousarray(nodes[own]))
        found = replace(found, alone=int(beyond.sum()))
    above = None
    if local.least is not None:
        shape = Sheet(np.column_stack([nodes, z]), plan.triangles)
        above = _older_above(work, shape, folder / _part(r, f"{k - 1}-own"), k)
        raised, lift = raise_to(z, others[k - 1] + local.least)
        lift = np.where(own, lift, 0.0)
        z = z if raised is None else raised
        if lift.any():
            worst = int(lift.argmax())
            found = replace(
                found,
                raised=int((lift > 0).sum()),
                by=float(lift[worst]),
                worst=int(plan.of_vertices[worst]),
                place=tuple(nodes[worst].tolist()),
            )
    part = replace(plan, vertices=np.column_stack([nodes, z]))
    return Interpolated(part if len(known) == len(z) else _where_known(part), found, above)


def _where_known(part: MeshPart) -> MeshPart:
    """The triangles all of whose vertices have a height."""
    known = np.isfinite(part.vertices[:, 2])[part.triangles].all(axis=1)
    rest = part_of(part.sheet, np.flatnonzero(known))
    return replace(rest, numbers=part.numbers[known], of_vertices=part.of_vertices[rest.of_vertices])


def _older_above(work: Work, shape: Sheet, file: Path, number: int) -> WrongPoints | None:
    """The points of the older surface, in a file if there are some, above one that is to keep off it."""
    if not file.exists():
        return None
    own = read_mapped(file)
    beyond = own["points"][:, 2] - heights_at(work, shape, own["points"][:, :2])
    return WrongPoints.of(own["points"], beyond, number, own["numbers"])


def _wrong_points(work: Work, frame: Frame, parts: dict, folder: Path) -> dict:
    """The WrongPoints of a tile by rock mass and number of their surface."""
    found = {}
    for r, rock in enumerate(frame.project.rocks):
        own = {}
        for k in range(len(rock.surfaces)):
            path = folder / _part(r, f"{k}-own")
            if (r, k) in frame.sought and path.exists():
                own[k] = read_mapped(path)
        shapes = [parts[r, k] for k in range(len(rock.surfaces))]
        shapes = [part.sheet if len(part.triangles) else None for part in shapes]
        points = {k: arrays["points"] for k, arrays in own.items()}
        below = below_older(work, rock, shapes, points, frame.off[r] if own else ())
        for k, (beyond, others) in below.items():
            wrong = WrongPoints.of(points[k], beyond, others, own[k]["numbers"])
            if wrong is not None:
                found[r, k] = wrong
    return found


@dataclass(frozen=True)
class BuiltTile:
    """model: with borders as they come. borders: its BorderVertices as arrays. By rock mass and number of
    their surface: wrong, WrongPoints below others; above, those above the next younger one; heights, of those
    that were interpolated here."""

    model: Model
    borders: dict[str, np.ndarray]
    wrong: dict[tuple[int, int], WrongPoints]
    above: dict[tuple[int, int], WrongPoints]
    heights: dict[tuple[int, int], PartHeights]


def build_tile(work: Work, frame: Frame, box: Box, folder: Path) -> BuiltTile:
    """folder: with the files that are written here."""
    parts, made = _parts(work, frame, box, folder)
    inputs, rocks = [], []
    for r, rock in enumerate(frame.project.rocks):
        surfaces = [parts[r, k] for k in range(len(rock.surfaces))]
        region, seen = None, box_triangles(box)
        if frame.clips[r]:
            region = Sheet(parts[r, REGION].vertices[:, :2].copy(), parts[r, REGION].triangles)
            seen = clipped_region(region, box)
        given = [
            replace(surface, vertices=part.vertices, triangles=part.triangles)
            for surface, part in zip(rock.surfaces, surfaces, strict=True)
        ]
        entry = RockInput(
            replace(rock, surfaces=given),
            [part.sheet for part in surfaces],
            region,
            [None] * len(surfaces),
            [None] * len(surfaces),
        )
        rocks.append(entry.native())
        inputs.append(replace(entry, region=seen))
    numbers = [
        parts[r, k].numbers for r, rock in enumerate(frame.project.rocks) for k in range(len(rock.surfaces))
    ]
    began = time.perf_counter()
    refused = refused_as(lambda error: refused_stack(_NumberedError(error, numbers), inputs))
    with work.phase(0.0, 0.8, "intersecting and cutting"), refused as native:
        arrays = work.native(native.build_tile, rocks, box, cells=frame.cell_kind)
    project = replace(frame.project, rocks=[entry.rock for entry in inputs])
    timings = {"intersect": time.perf_counter() - began}
    built = BuiltCells.of(arrays, frame.cell_kind)
    no_structures = structures_of(project, [], [])
    with work.part(0.8, 1.0):
        model = Model.of(assemble(work, project, inputs, built, timings, no_structures))
    model.warnings = _warnings(inputs, built, numbers)
    wrong = _wrong_points(work, frame, parts, folder)
    above = {(r, k - 1): each.above for (r, k), each in made.items() if each.above is not None}
    heights = {key: each.heights for key, each in made.items()}
    return BuiltTile(model, BorderVertices.arrays_of(arrays), wrong, above, heights)


class _NumberedError(Exception):
    """A native InputError with the triangles' numbers in the whole."""

    def __init__(self, error: NativeError, numbers: list[np.ndarray]):
        super().__init__(str(error))
        self.kind, self.surface, self.place = error.kind, error.surface, error.place
        self.items = error.items
        if error.kind in ("vertical_triangle", "double_valued"):
            self.items = [int(numbers[error.surface][item]) for item in error.items]


def _warnings(inputs: list[RockInput], built: BuiltCells, numbers: list[np.ndarray]) -> list[BuildWarning]:
    owners = [(entry.rock.name, surface.name) for entry in inputs for surface in entry.rock.surfaces]
    found = []
    for kind, surface, items, text in built.warnings:
        rock, named = owners[surface] if 0 <= surface < len(owners) else (None, None)
        if kind == "no_area":
            items = tuple(int(numbers[surface][item]) for item in items)
        found.append(BuildWarning(text, kind, rock, named, items))
    return found


def tile_arrays(model: Model) -> dict[str, np.ndarray]:
    """A tile's model as arrays: those of others, and what clips its rock masses. A tile of a model with
    faults or bodies is a part of one, which nothing clips."""
    arrays = model_arrays(model)
    for r, entry in enumerate(model.rock_inputs):
        if not model.is_cut:
            arrays[f"region_vertices_{r}"], arrays[f"region_triangles_{r}"] = entry.planar_mesh()
    return arrays


def write_model(model: Model, path: Path) -> None:
    """Writes a tile's model to an .npz. Raises OutputFailed."""
    with Outputs() as outputs, outputs.file(path) as file:
        write_arrays(tile_arrays(model), file)


def read_model(project: Project, path: Path) -> Model:
    """A tile's model from its file. project: without shapes."""
    return model_of(project, read_arrays(path))


def model_of(project: Project, arrays: dict[str, np.ndarray]) -> Model:
    """A tile's model from its arrays."""
    model = Model(
        CellComplex.of(arrays, str(arrays["cell_kind"])),
        blocks_of_arrays(arrays),
        SurfaceArrays.of_arrays(arrays),
        surface_names=arrays["surface_names"].tolist(),
        project=project,
        is_cut="region_vertices_0" not in arrays,
        surface_kind=arrays["surface_kind"],
        cell_compartment=arrays["cell_compartment"],
        compartment_names=arrays["compartment_names"].tolist(),
    )
    inputs, number = [], 0
    for r, rock in enumerate(project.rocks):
        shapes = [Sheet(*model.surface(number + k)) for k in range(len(rock.surfaces))]
        number += len(shapes)
        surfaces = [
            replace(surface, vertices=shape.vertices, triangles=shape.triangles)
            for surface, shape in zip(rock.surfaces, shapes, strict=True)
        ]
        inputs.append(
            RockInput(
                replace(rock, surfaces=surfaces),
                list(shapes),
                None
                if model.is_cut
                else Sheet(arrays[f"region_vertices_{r}"], arrays[f"region_triangles_{r}"]),
                [None] * len(shapes),
                [None] * len(shapes),
            )
        )
    return replace(
        model, project=replace(project, rocks=[entry.rock for entry in inputs]), rock_inputs=inputs
    )


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """All arrays of an .npz. Raises BuildFailed where it cannot be read."""
    try:
        return read_npz(path)
    except OSError as error:
        raise OutputFailed(f"{path}: cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise BuildFailed(f"{path}: cannot be read; delete it and start again") from error
