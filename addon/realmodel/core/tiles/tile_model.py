# SPDX-License-Identifier: GPL-3.0-or-later
"""One tile of a model that nothing divides, cut at its border; and any tile's model in a file."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..base.atomic import Outputs
from ..base.errors import BuildFailed, BuildWarning, OutputFailed
from ..base.triangles import Sheet
from ..base.work import NativeError, Work, refused_as
from ..cells.assembly import assemble
from ..cells.blocks import Block, blocks_of_arrays
from ..cells.built_cells import BuiltCells
from ..cells.cell_complex import CellComplex
from ..cells.joining import built_cells
from ..cells.stack_refusals import refused_stack
from ..exporters.model_arrays import model_arrays, write_arrays
from ..model.model import Model
from ..project.project import Project, Rock, Surface
from ..project.series import Series
from ..project.structure_entries import Body, Fault
from ..readers.npz import read_npz
from ..settings.series_kinds import FIELD
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.surface_input import SurfaceArrays
from .grid import Box, TileGrid, box_triangles, clipped_region
from .settling import BorderVertices

Name = tuple[int, int]  # column and row of a tile


@dataclass(frozen=True)
class Frame:
    """What all tiles of a model share. project: without shapes; cell_kind as of Model. blocks: without
    numbers of cells. structures: all of them, without shapes. surface_names, surface_kind: as of Model."""

    project: Project
    cell_kind: str
    grid: TileGrid
    blocks: list[Block]
    structures: Structures
    surface_names: list[str]
    surface_kind: np.ndarray


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


@dataclass(frozen=True)
class BuiltTile:
    """model: with borders as they come. borders: its BorderVertices as arrays."""

    model: Model
    borders: dict[str, np.ndarray]


def build_tile(work: Work, frame: Frame, inputs: list[RockInput], box: Box) -> BuiltTile:
    """A tile of a model that nothing divides, cut at its border. inputs: what meets it, each with the region
    that clips its surfaces, if there is one. Raises InputRefused."""
    rocks = [entry.native() for entry in inputs]
    seen = [
        box_triangles(box) if entry.region is None else clipped_region(entry.region, box) for entry in inputs
    ]
    inputs = [replace(entry, region=region) for entry, region in zip(inputs, seen, strict=True)]
    numbers = [entry.surface(k).of_surface for entry in inputs for k in range(len(entry.surfaces))]
    began = time.perf_counter()
    refused = refused_as(lambda error: refused_stack(_NumberedError(error, numbers), inputs))
    with work.phase(0.0, 0.8, "intersecting and cutting"), refused as native:
        arrays = work.native(native.build_tile, rocks, box, cells=frame.cell_kind)
    project = replace(frame.project, rocks=[entry.rock for entry in inputs])
    timings = {"intersect": time.perf_counter() - began}
    built = built_cells(arrays, frame.cell_kind, inputs, frame.structures)
    with work.part(0.8, 1.0):
        model = Model.of(assemble(work, project, inputs, built, timings, frame.structures))
    model.warnings = _warnings(inputs, built, numbers)
    return BuiltTile(model, BorderVertices.arrays_of(arrays))


class _NumberedError(Exception):
    """A native InputError with the triangles' numbers in the whole."""

    def __init__(self, error: NativeError, numbers: list[np.ndarray]):
        super().__init__(str(error))
        self.kind, self.surface, self.place = error.kind, error.surface, error.place
        self.items = error.items
        if error.kind in ("vertical_triangle", "double_valued"):
            self.items = [int(numbers[error.surface][triangle]) for triangle in error.items]


def _warnings(inputs: list[RockInput], built: BuiltCells, numbers: list[np.ndarray]) -> list[BuildWarning]:
    owners = [(entry.rock.name, surface.name) for entry in inputs for surface in entry.rock.surfaces]
    warnings = []
    for kind, surface, items, text in built.warnings:
        rock, named = owners[surface] if 0 <= surface < len(owners) else (None, None)
        if kind == "no_area":
            items = tuple(int(numbers[surface][triangle]) for triangle in items)
        warnings.append(BuildWarning(text, kind, rock, named, items))
    return warnings


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
