# SPDX-License-Identifier: GPL-3.0-or-later
"""The last steps of a build, from the input of each rock mass to the model; a stage needs only these."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ..base.errors import BuildWarning
from ..base.work import Cancel, Progress, Work, refused_as, run
from ..project.project import Project
from ..project.project_checks import check_cells, check_stage
from ..structures.parts.part_models import LID
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.surface_input import SurfaceArrays
from .blocks import Block, named_blocks
from .built_cells import BuiltCells
from .cell_complex import CellComplex
from .joining import build_joined, built_cells
from .labels import compartments, warnings_where_rock_is
from .model_data import ModelData, SomeModel
from .stack_refusals import refused_stack

_STAGE_INTERSECTED = 0.99  # of the time of a stage: nothing is read again


def build_stage(
    model: SomeModel,
    m: int,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    cells: str | None = None,
) -> SomeModel:
    """Model.stage. cells: another kind of cells than the model has; nothing is interpolated again for it."""
    model.require_project("a stage")
    check_stage(model.project, m)
    kind = model.cell_kind if cells is None else cells
    check_cells(kind)
    inputs = [entry.stage(m) for entry in model.rock_inputs]
    if kind == model.cell_kind and all(
        len(entry.surfaces) == len(whole.surfaces)
        for entry, whole in zip(inputs, model.rock_inputs, strict=True)
    ):
        return model
    whole_project = model.project
    project = replace(whole_project, rocks=[entry.rock for entry in inputs])

    def task(work: Work) -> SomeModel:
        structures = model.structures.stage(m)
        with work.part(0.0, _STAGE_INTERSECTED):
            built = intersect(work, inputs, kind, structures)
        timings = {"intersect": time.perf_counter() - began}
        with work.part(_STAGE_INTERSECTED, 1.0):
            return type(model).of(assemble(work, project, inputs, built, timings, structures))

    began = time.perf_counter()
    return run(task, progress, cancel, threads=model.threads)


def are_joined(inputs: list[RockInput], structures: Structures) -> bool:
    """Whether the cells of rock masses are those of parts of space, joined: where structures divide them, or
    fields, or a base that cuts surfaces off."""
    return structures.is_divided or any(entry.fields or entry.reaches_base for entry in inputs)


def intersect(work: Work, inputs: list[RockInput], cells: str, structures: Structures) -> BuiltCells:
    """The cells of all rock masses, divided by structures where there are some."""
    if are_joined(inputs, structures):
        return build_joined(work, inputs, structures, cells)
    rocks = [entry.native() for entry in inputs]
    refused = refused_as(lambda error: refused_stack(error, inputs))
    with work.phase(0.0, 1.0, "intersecting and cutting"), refused as native:
        arrays = work.native(native.build_rock_masses, rocks, cells=cells)
    return built_cells(arrays, cells, inputs, structures)


def assemble(
    work: Work,
    project: Project,
    inputs: list[RockInput],
    built: BuiltCells,
    timings: dict[str, float],
    structures: Structures,
) -> ModelData:
    """The model that these cells are of."""
    began = time.perf_counter()
    with work.phase(0.0, 1.0, "assembling the model"):
        cell_complex = _complex(inputs, built, structures)
        cell_complex.find_components(work)
        work.step(0.8)
        blocks = list_blocks(inputs, built.volumes, cell_complex, structures)
        names = [surface.name for entry in inputs for surface in entry.rock.surfaces]
        kinds = [0] * len(names) + structures.kinds
        compartment, compartment_names, sides = compartments(inputs, built.parts, structures)
        model = ModelData(
            cell_complex,
            named_blocks(blocks),
            _surfaces(inputs, structures),
            surface_kind=np.array(kinds, np.int32),
            cell_compartment=compartment,
            compartment_names=compartment_names,
            compartment_sides=sides,
            structures=structures,
            surface_names=names + structures.names,
            project=project,
            rock_inputs=inputs,
            warnings=_warnings(inputs, built, blocks, structures),
            timings=timings,
            threads=work.threads,
        )
    timings["merge"] = time.perf_counter() - began
    return model


def _complex(inputs: list[RockInput], built: BuiltCells, structures: Structures) -> CellComplex:
    """The cells with blocks numbered without those that cannot exist."""
    exists = [
        number > 0 or _first_block(entry) == 0 for entry in inputs for number in range(len(entry.surfaces))
    ]
    exists += [structures.has_block(number) for number in range(len(structures))]
    block_of_surface = np.cumsum(exists, dtype=np.int32) - 1
    cell_block = block_of_surface[built.complex.cell_block].astype(np.int32, copy=False)
    return replace(built.complex, cell_block=cell_block)


def _surfaces(inputs: list[RockInput], structures: Structures) -> SurfaceArrays:
    """The surfaces, then the structures."""
    surfaces = [entry.surface(number) for entry in inputs for number in range(len(entry.surfaces))]
    return SurfaceArrays([*surfaces, *structures.shapes])


def _first_block(entry: RockInput) -> int:
    """The number of a rock mass's first block: 0 lies on the base elevation."""
    return 0 if entry.rock.base_elevation is not None else 1


def list_blocks(
    inputs: list[RockInput], volumes: np.ndarray, own: CellComplex, structures: Structures
) -> list[Block]:
    """The blocks of some cells; without cells those that may be."""
    total = sum(len(entry.surfaces) - _first_block(entry) for entry in inputs)
    bodies = structures.blocks_of_bodies()
    total += len(bodies)
    cells, components = own.count_blocks(total)
    blocks: list[Block] = []
    first_surface = 0
    for number, entry in enumerate(inputs):
        names = entry.rock.block_names()
        for k in range(_first_block(entry), len(entry.surfaces)):
            surface = entry.rock.surfaces[k]
            at = len(blocks)
            blocks.append(
                Block(
                    name=names[k],
                    rock=number,
                    surface=first_surface + k,
                    property=int(surface.property),
                    volume=float(volumes[first_surface + k]),
                    cells=int(cells[at]),
                    components=int(components[at]),
                )
            )
        first_surface += len(entry.surfaces)
    for number, body, rock in bodies:
        at = len(blocks)
        blocks.append(
            Block(
                name=body.name,
                rock=rock,
                surface=first_surface + number,
                property=int(body.property),
                volume=float(volumes[first_surface + number]),
                cells=int(cells[at]),
                components=int(components[at]),
            )
        )
    return blocks


def _warnings(
    inputs: list[RockInput], built: BuiltCells, blocks: list[Block], structures: Structures
) -> list[BuildWarning]:
    warnings = [warning for entry in inputs for warning in entry.warnings]
    owners = [(entry.rock.name, surface.name) for entry in inputs for surface in entry.rock.surfaces]
    for kind, surface, items, text in built.warnings:
        rock, named = owners[surface] if 0 <= surface < len(owners) else (None, None)
        warnings.append(BuildWarning(text, kind, rock, named, items))
    warnings += warnings_where_rock_is(inputs, built, structures)
    is_cut_off = bool((built.complex.face_surface == LID).any())
    for entry in (entry for entry in inputs if is_cut_off and entry.fields):
        tops = [field for field in entry.fields if field.numbers.stop == len(entry.surfaces)] or entry.fields
        what = (
            f"the rock of series '{tops[-1].name}' is cut off at elevation {tops[-1].top:g}: nothing ends it"
        )
        warnings.append(BuildWarning(f"{what} above; add a younger surface", "cut_off", entry.rock.name))
    for number, entry in enumerate(inputs):
        if len(entry.surfaces) == 1 and entry.rock.base_elevation is None:
            text = "a single surface does not bound a block"
        elif not any(block.cells for block in blocks if block.rock == number):
            text = "no block remains: surfaces and region do not overlap in plan, or all was eroded"
        else:
            continue
        warnings.append(BuildWarning(text, "no_block", entry.rock.name))
    return warnings
