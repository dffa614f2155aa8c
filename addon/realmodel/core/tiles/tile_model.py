# SPDX-License-Identifier: GPL-3.0-or-later
"""One tile: what it needs in a file, its model built from that, and the model in a file."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..assembly import assemble
from ..atomic import Outputs, explained
from ..blocks import Block
from ..build_warning import BuildWarning
from ..errors import BuildFailed, OutputFailed
from ..exporters.npz import model_arrays, write_arrays
from ..model import Model
from ..project import Project, Rock, Surface
from ..rock_input import RockInput
from ..stack_refusals import refused_stack
from ..surface_heights import Triangulation
from ..work import Work, native_module
from .grid import MeshBins, Part, TileGrid, box_triangles, clipped_region
from .settling import BorderVertices, Box

Name = tuple[int, int]  # column and row of a tile
REGION = "region"  # in the place of a surface's number


@dataclass(frozen=True)
class Frame:
    """What all tiles of a model share. project: without shapes; cell_kind as of Model; clips: for each rock
    mass whether its region clips its surfaces, beside the tile."""

    project: Project
    cell_kind: str
    grid: TileGrid
    clips: tuple[bool, ...]


def without_shapes(project: Project, inputs: list[RockInput]) -> Project:
    """The project with names, rules and properties alone."""
    rocks = []
    for entry in inputs:
        surfaces = [
            Surface(
                surface.name,
                rule=surface.rule,
                property=surface.property,
                block=surface.block,
                shape_file=surface.shape_source()[0],
            )
            for surface in entry.rock.surfaces
        ]
        rocks.append(Rock(entry.rock.name, surfaces, base_elevation=entry.rock.base_elevation))
    return Project(project.name, rocks, project.library, units=project.units)


def write_parts(
    mesh: Triangulation, rock: int, surface: int | str, grid: TileGrid, folder_of: Callable[[Name], Path]
) -> list[Name]:
    """Writes what each tile needs of a surface, or REGION, of a rock mass: a file for each tile that it
    meets. folder_of: of a tile. Returns these tiles."""
    bins, met = MeshBins(mesh, grid), []
    for column in range(grid.columns):
        for row in range(grid.rows):
            part = bins.part(column, row)
            if not len(part.triangles):
                continue
            met.append((column, row))
            path = folder_of((column, row)) / _part(rock, surface)
            with explained(path), path.open("wb") as file:
                write_arrays({name: getattr(part, name) for name in Part.__dataclass_fields__}, file)
    return met


def _part(rock: int, surface: int | str) -> str:
    return f"{rock}-{surface}.npz"


def _parts(frame: Frame, folder: Path) -> dict[tuple, Part]:
    parts = {}
    for r, rock in enumerate(frame.project.rocks):
        for k in (*range(len(rock.surfaces)), *([REGION] if frame.clips[r] else [])):
            path = folder / _part(r, k)
            if path.exists():
                arrays = read_arrays(path)
                parts[r, k] = Part(*(arrays[name] for name in Part.__dataclass_fields__))
            else:
                columns = 2 if k == REGION else 3
                parts[r, k] = Part(np.empty((0, columns)), np.empty((0, 3), np.int32), np.empty(0, np.int32))
    return parts


def build_tile(
    work: Work, frame: Frame, box: Box, folder: Path, threads: int
) -> tuple[Model, dict[str, np.ndarray]]:
    """The model of a tile, with borders as they come, and its BorderVertices as arrays. folder: what
    write_parts wrote."""
    parts = _parts(frame, folder)
    inputs, rocks = [], []
    for r, rock in enumerate(frame.project.rocks):
        surfaces = [parts[r, k] for k in range(len(rock.surfaces))]
        shapes = [(part.vertices, part.triangles) for part in surfaces]
        region, seen = None, box_triangles(box)
        if frame.clips[r]:
            region = (parts[r, REGION].vertices[:, :2].copy(), parts[r, REGION].triangles)
            seen = clipped_region(region, box)
        given = [
            replace(surface, vertices=vertices, triangles=triangles)
            for surface, (vertices, triangles) in zip(rock.surfaces, shapes, strict=True)
        ]
        nothing = [None] * len(shapes)
        entry = RockInput(replace(rock, surfaces=given), shapes, region, nothing, nothing)
        rocks.append(entry.native())
        inputs.append(replace(entry, region=seen))
    numbers = [
        parts[r, k].numbers for r, rock in enumerate(frame.project.rocks) for k in range(len(rock.surfaces))
    ]
    native = native_module()
    began = time.perf_counter()
    with work.phase(0.0, 0.8, "intersecting and cutting"):
        try:
            built = work.native(native.build_tile, rocks, box, cells=frame.cell_kind, threads=threads)
        except native.InputError as error:
            raise refused_stack(_NumberedError(error, numbers), inputs) from error
    project = replace(frame.project, rocks=[entry.rock for entry in inputs])
    timings = {"intersect": time.perf_counter() - began}
    model = assemble(Model, work, project, inputs, built, frame.cell_kind, threads, timings, 0.8)
    model.warnings = _warnings(inputs, built, numbers)
    return model, BorderVertices.arrays_of(built)


class _NumberedError(Exception):
    """A native InputError with the triangles' numbers in the whole."""

    def __init__(self, error, numbers: list[np.ndarray]):
        super().__init__(str(error))
        self.kind, self.surface, self.place = error.kind, error.surface, error.place
        self.items = error.items
        if error.kind in ("vertical_triangle", "double_valued"):
            self.items = [int(numbers[error.surface][item]) for item in error.items]


def _warnings(inputs: list[RockInput], built: dict, numbers: list[np.ndarray]) -> list[BuildWarning]:
    owners = [(entry.rock.name, surface.name) for entry in inputs for surface in entry.rock.surfaces]
    found = []
    for kind, surface, items, text in built["warnings"]:
        rock, named = owners[surface] if 0 <= surface < len(owners) else (None, None)
        if kind == "no_area":
            items = [int(numbers[surface][item]) for item in items]
        found.append(BuildWarning(text, kind, rock, named, tuple(int(item) for item in items)))
    return found


def tile_arrays(model: Model) -> dict[str, np.ndarray]:
    """A tile's model as arrays: those of others, and what clips its rock masses."""
    arrays = model_arrays(model)
    for r, entry in enumerate(model.rock_inputs):
        arrays[f"region_vertices_{r}"], arrays[f"region_triangles_{r}"] = entry.region
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
    names = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")
    of_surfaces = ("vertices", "triangles", "vertex_offsets", "triangle_offsets")
    given = {name: arrays[name] for name in (*names, *(f"surface_{name}" for name in of_surfaces))}
    blocks = [
        Block(str(name), int(rock), int(surface), int(prop), float(volume), int(cells), int(components))
        for name, rock, surface, prop, volume, cells, components in zip(
            *(
                arrays[f"block_{key}"]
                for key in ("names", "rock", "surface", "property", "volume", "cells", "components")
            ),
            strict=True,
        )
    ]
    model = Model(
        **given,
        cell_kind=str(arrays["cell_kind"]),
        blocks=blocks,
        surface_names=arrays["surface_names"].tolist(),
        project=project,
    )
    inputs, number = [], 0
    for r, rock in enumerate(project.rocks):
        shapes = [model.surface(number + k) for k in range(len(rock.surfaces))]
        number += len(shapes)
        surfaces = [
            replace(surface, vertices=shape[0], triangles=shape[1])
            for surface, shape in zip(rock.surfaces, shapes, strict=True)
        ]
        inputs.append(
            RockInput(
                replace(rock, surfaces=surfaces),
                shapes,
                (arrays[f"region_vertices_{r}"], arrays[f"region_triangles_{r}"]),
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
        with np.load(path, allow_pickle=False) as file:
            return dict(file)
    except OSError as error:
        raise OutputFailed(f"{path}: cannot be read: {error.strerror or error}") from error
    except Exception as error:  # whatever zipfile and NumPy make of a damaged file
        raise BuildFailed(f"{path}: cannot be read; delete it and start again") from error
