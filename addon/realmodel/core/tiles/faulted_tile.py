# SPDX-License-Identifier: GPL-3.0-or-later
"""One tile of a model with faults or bodies: the model around it, and the cells that belong to the tile."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from ..base.triangles import Sheet
from ..base.work import Work
from ..cells.assembly import assemble
from ..cells.blocks import named_blocks
from ..cells.built_cells import BuiltCells, CellParts
from ..cells.cell_complex import CellComplex
from ..cells.joining import blocks_divided, body_block, build_joined
from ..cells.labels import compartments
from ..cells.model_data import ModelData
from ..model.model import Model
from ..surfaces.surface_input import SurfaceArrays
from .owned_cells import Seam, inseparable, owners, reach_of
from .tile_model import Frame, Name
from .windows import Window

_WALL = -1  # face_surface


@dataclass(frozen=True)
class FaultedTile:
    """around: the model of all that the window holds. model: of the cells that belong to the tile, numbered
    as in the whole. seams: by the tile on the other side. reach: a box in plan around these cells and those
    beside them; None where there is no cell. part: (C,) the cell of a model of blocks that each is in."""

    around: Model
    model: Model
    seams: dict[Name, Seam]
    reach: tuple[float, float, float, float] | None
    part: np.ndarray


def build_faulted_tile(work: Work, frame: Frame, window: Window, name: Name) -> FaultedTile:
    """Raises InputRefused."""
    inputs, few = window.inputs, window.structures
    began = time.perf_counter()
    with work.part(0.0, 0.8):
        built = build_joined(work, inputs, few, "columns", window.reach)
    project = replace(
        frame.project, rocks=[entry.rock for entry in inputs], faults=few.faults, bodies=few.bodies
    )
    timings = {"intersect": time.perf_counter() - began}
    with work.part(0.8, 1.0):
        model = Model.of(assemble(work, project, inputs, built, timings, few))
    model.warnings = [warning for warning in model.warnings if warning.kind != "no_block"]
    together = inseparable(model.complex)
    owner = owners(model.complex, frame.grid, together)
    mine = (owner == name).all(axis=1)
    as_whole = _numbered_as_whole(model, frame, window)
    cells = as_whole.without_cells(~mine)
    labels = _labels(built, frame, window, mine)
    number = np.arange(int(mine.sum()))
    is_mine = np.append(mine, False)[model.face_cells]
    is_one = _within_one_cell(as_whole, built, len(frame.surface_names) - len(frame.structures))
    if frame.cell_kind == "blocks":
        cells, number = cells.one_cell_each(is_one[is_mine.any(axis=1)])
        cells = replace(cells, cell_kind=frame.cell_kind)
        first = np.full(len(cells.cell_block), len(number), np.int64)
        np.minimum.at(first, number, np.arange(len(number)))
        labels = labels[0][first], *labels[1:]
    of_tile = np.full(len(mine), -1)
    of_tile[mine] = number
    tile_model = _model(frame, window, cells, labels)
    part = np.arange(len(tile_model.cell_block)) if frame.cell_kind == "blocks" else tile_model.cell_component
    both = np.column_stack([tile_model.cell_component, part])
    between = np.flatnonzero((is_mine[:, 0] != is_mine[:, 1]) & (model.face_cells >= 0).all(axis=1))
    side = np.where(is_mine[between, 0], 0, 1)
    others = owner[model.face_cells[between, 1 - side]]
    parts = both[of_tile[model.face_cells[between, side]]]
    seams = {}
    for other in np.unique(others, axis=0).tolist():
        which = (others == other).all(axis=1)
        seams[tuple(other)] = Seam.of(
            as_whole, between[which], side[which], parts[which], is_one[between[which]]
        )
    reach = reach_of(model.complex, mine, together) if mine.any() else None
    return FaultedTile(model, tile_model, seams, reach, part)


def _within_one_cell(cell_complex: CellComplex, built: BuiltCells, layers: int) -> np.ndarray:
    """(F,) bool: the faces that lie within one cell of a model of blocks. Between cells of one block in one
    rock mass these are walls between columns, and in bodies also surfaces, the first `layers` of all: a body
    has columns between older surfaces."""
    surface, cells, own_block = cell_complex.face_surface, cell_complex.face_cells, built.parts.own_block
    is_same = (cells >= 0).all(axis=1) & (own_block[cells[:, 0]] == own_block[cells[:, 1]])
    return is_same & ((surface == _WALL) | ((surface >= 0) & (surface < layers)))


def _numbered_as_whole(model: ModelData, frame: Frame, window: Window) -> CellComplex:
    """The cells of the model around a tile with surfaces and blocks numbered as in the whole."""
    surfaces = sum(len(entry.surfaces) for entry in window.inputs)
    number = np.concatenate([np.arange(surfaces), surfaces + window.numbers, [-2, -1]]).astype(np.int32)
    of_surface = {block.surface: n for n, block in enumerate(frame.blocks)}
    blocks = np.array([of_surface[int(number[block.surface])] for block in model.blocks], np.int32)
    return replace(
        model.complex,
        face_surface=number[model.face_surface],
        cell_block=blocks[model.cell_block] if len(blocks) else model.cell_block,
    )


def _labels(built: BuiltCells, frame: Frame, window: Window, mine: np.ndarray) -> tuple:
    """What compartments gives for the cells of the tile, by all faults of the whole."""
    inputs, few, structures = window.inputs, window.structures, frame.structures
    surfaces = sum(len(entry.surfaces) for entry in inputs)
    block_numbers = np.arange(surfaces + len(inputs) * len(few))
    for rock in range(len(inputs)):
        for body in range(len(few.bodies)):
            number = int(window.numbers[len(few.faults) + body]) - len(structures.faults)
            block_numbers[body_block(few, surfaces, rock, body)] = body_block(
                structures, surfaces, rock, number
            )
    rocks = np.arange(len(inputs), dtype=np.int32)
    counts = [len(entry.surfaces) for entry in inputs]
    as_whole = CellParts(
        window.part[built.parts.part][mine],
        block_numbers[built.parts.own_block][mine],
        np.append(np.repeat(rocks, counts), np.repeat(rocks, len(structures))),
        blocks_divided(inputs, structures),
    )
    return compartments(inputs, as_whole, structures)


def _model(frame: Frame, window: Window, cell_complex: CellComplex, labels: tuple) -> Model:
    volume = cell_complex.cell_volumes()
    cells, components = cell_complex.count_blocks(len(frame.blocks))
    blocks = [
        replace(
            block,
            volume=float(volume[cell_complex.cell_block == n].sum()),
            cells=int(cells[n]),
            components=int(components[n]),
        )
        for n, block in enumerate(frame.blocks)
    ]
    nothing = Sheet(np.empty((0, 3)), np.empty((0, 3), np.int32))
    ends = [nothing] * len(frame.structures)
    for n, shape in zip(window.numbers.tolist(), window.structures.shapes, strict=True):
        ends[n] = shape
    shapes = [entry.surface(number) for entry in window.inputs for number in range(len(entry.surfaces))]
    labels_of_cells, names, sides = labels
    return Model(
        cell_complex,
        named_blocks(blocks),
        SurfaceArrays(shapes + ends),
        surface_names=frame.surface_names,
        project=frame.project,
        rock_inputs=[replace(entry, structure=None) for entry in window.inputs],
        is_cut=True,
        surface_kind=frame.surface_kind,
        cell_compartment=labels_of_cells,
        compartment_names=names,
        compartment_sides=sides,
    )
