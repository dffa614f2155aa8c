# SPDX-License-Identifier: GPL-3.0-or-later
"""From a project to surfaces: reads it, meshes and interpolates; with faults and bodies the sheets in
compartments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.algebra import norm
from ..base.errors import BuildFailed, BuildWarning
from ..base.mapped_arrays import StoreArray, unchanged
from ..base.triangles import Sheet
from ..base.work import Work, native_module
from ..project.project import Project
from ..project.structure_entries import Fault
from ..surfaces.field_data import apply_observations, left_out_warnings, observed_on_mesh
from ..surfaces.likely_unit import shape_unit_warnings
from ..surfaces.observed.derived import PlaceContext
from ..surfaces.prepare import (
    interpolate_rock,
    mesh_again,
    mesh_rock,
    propose_series,
    read_rocks,
)
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import FaultShape, fault_sides, joined
from ..surfaces.surface_heights import interpolation_order
from ..surfaces.surface_input import Reader, read_each
from .fields import make_fields, place_level_sets, with_levels
from .gaps import close_gaps, gap_widths, tops_of_faults
from .observed_places import apply_in_compartments
from .parts.parts import Structures, add_compartments, box_around, divide, refused_structure, structures_of
from .shapes.reading import read_structures
from .sheets.sheets import make_sheets, warn_of_doubts

_DIVIDED = 0.1  # of the rest of the progress: until the parts of space are known
_ROUNDS = 4  # in which sheets may reach beyond what was divided
_SHEETS = 0.5  # of the progress of surfaces: until only fields are left


def read_inputs(work: Work, project: Project, reader: Reader = read_each) -> tuple[list[RockInput], Project]:
    """Reads a project: its rock masses, and the project with the arrays of its faults and bodies. reader: how
    surfaces are read. Raises InputRefused."""
    inputs = read_rocks(work, project, reader)
    faults, bodies, warnings = read_structures(work, project, inputs)
    given = [*project.faults, *project.bodies]
    warnings += shape_unit_warnings(given, [*faults, *bodies], inputs, project.units)
    if warnings:
        inputs[0].warnings += warnings
    return inputs, replace(project, faults=faults, bodies=bodies)


def mesh_inputs(work: Work, inputs: list[RockInput], keep: StoreArray = unchanged) -> None:
    """Meshes the regions of rock masses. keep: where the meshes are kept. Raises InputRefused."""
    for entry in work.share_out(inputs):
        with work.phase(0.0, 1.0, f"meshing the region of {entry.rock.name}"):
            mesh_rock(work, entry)
        if entry.region is not None:
            entry.region = Sheet(*map(keep, entry.region))
        if entry.rock.observed is not None and entry.rock.interpolates:
            on_mesh = observed_on_mesh(entry, entry.rock.observed)
            if not on_mesh[1].all():  # along inclined holes bounds follow the mesh
                apply_observations(work, entry, PlaceContext(), on_mesh)


def make_surfaces(
    work: Work,
    project: Project,
    inputs: list[RockInput],
    stage: int | None,
    keep: StoreArray = unchanged,
    joins: bool = True,
) -> Structures:
    """Interpolates the surfaces of rock masses that are read and meshed, and divides these by the faults and
    bodies of the project, as read_inputs gives it.

    keep: as of interpolate_rock. joins: as of make_structures. Raises InputRefused, BuildFailed.
    """
    place_level_sets(inputs)
    middle = _SHEETS if any(rock.has_fields for rock in project.rocks) else 1.0
    with work.part(0.0, middle):
        if project.faults or project.bodies:
            structures = make_structures(work, project, inputs, stage, joins, keep)
        else:
            for entry in work.share_out(inputs):
                interpolate_rock(work, entry, stage, keep)
            structures = structures_of(project, [], [])
    with work.part(middle, 1.0):
        make_fields(work, inputs, stage)
    return structures


def make_structures(
    work: Work,
    project: Project,
    inputs: list[RockInput],
    stage: int | None,
    joins: bool = True,
    keep: StoreArray = unchanged,
) -> Structures:
    """Gives each rock mass (RockInput, read and meshed) its compartments and sheets, `entry.structure`, and
    returns the parts of space.

    project: as of read_inputs. joins: whether `entry.surfaces` gets the sheets of each
    surface, one after another. keep: where the arrays of sheets are kept. Raises InputRefused, and
    BuildFailed where the parts never settle.
    """
    with work.phase(0.0, _DIVIDED, "dividing by faults and bodies"):
        faults = [_facing_up(work, fault) for fault in project.faults]
        structures = structures_of(project, faults, project.bodies)
        box = box_around(inputs, structures)
        widths = gap_widths(structures, inputs)
        structures = _without_gaps(work, structures, inputs, box, widths)
        structures = divide(work, structures, box)
    is_closed = False
    for _ in range(_ROUNDS):
        _divide_inputs(work, structures, inputs, keep)
        tops = [tops_of_faults(structures, number, entry.rock) for number, entry in enumerate(inputs)]
        share = sum(map(len, tops)) / sum(len(entry.surfaces) for entry in inputs)
        middle = _DIVIDED + (1.0 - _DIVIDED) * share
        with work.part(_DIVIDED, middle):
            _make_all(work, inputs, tops, stage, keep)
        if not is_closed:
            is_closed = True
            closed = _without_gaps(work, structures, inputs, box, widths, has_sheets=True)
            if closed is not structures:
                structures = divide(work, closed, box)
                _divide_inputs(work, structures, inputs, keep)
                with work.part(_DIVIDED, middle):
                    _make_all(work, inputs, tops, stage, keep)
        with work.part(middle, 1.0):
            _make_all(work, inputs, None, stage, keep)
        for entry in inputs:
            numbers = {surface.name: number for number, surface in enumerate(entry.rock.surfaces)}
            entry.divided().warnings.sort(key=lambda row: numbers[row[1].surface or ""])
            warn_of_doubts(work, entry, stage, keep)
        wider = box_around(inputs, structures, has_sheets=True)
        if (wider[0] >= box[0]).all() and (wider[1] <= box[1]).all():
            break
        box = np.array([np.minimum(wider[0], box[0]), np.maximum(wider[1], box[1])])
        before = structures.sides
        structures = divide(work, structures, box)
        if np.array_equal(structures.sides, before):
            break
    else:
        raise BuildFailed(
            "the faults divide space in new parts each time that the surfaces are made in these; "
            "give points of the surfaces in all compartments, or extend the faults"
        )
    inputs[0].warnings += _warnings_of_idle(structures)
    for entry in inputs:
        entry.warnings += left_out_warnings(entry)
        propose_series(work, entry, interpolation_order(entry.rock, stage))
    if joins:
        for entry in inputs:
            structure = entry.divided()
            for number in range(len(entry.surfaces)):
                if structure.is_made(number):  # not younger than the stage
                    entry.surfaces[number] = joined(structure.distinct(number))
    return structures


def _divide_inputs(work: Work, structures: Structures, inputs: list[RockInput], keep: StoreArray) -> None:
    """Gives each rock mass its compartments, and its surfaces what observations say there."""
    add_compartments(structures, inputs)
    apply_in_compartments(work, structures, inputs)
    again = [mesh_again(work, entry, keep) for entry in inputs]
    if any(again):  # along inclined holes their bounds follow the mesh
        apply_in_compartments(work, structures, inputs)


def _make_all(
    work: Work, inputs: list[RockInput], numbers: list[set[int]] | None, stage: int | None, keep: StoreArray
) -> None:
    """Makes the sheets of some surfaces of each rock mass (RockInput); None: of all that have none yet."""
    for number, entry in enumerate(work.share_out(inputs)):
        make_sheets(work, entry, stage, keep, numbers[number] if numbers else None, with_levels)


def _without_gaps(
    work: Work,
    structures: Structures,
    inputs: list[RockInput],
    box: np.ndarray,
    widths: dict[int, float],
    has_sheets: bool = False,
) -> Structures:
    """The structures with their faults continued where close_gaps does so; the same ones where it does not.
    Its warnings are added to the first RockInput."""
    faults, warnings = close_gaps(work, structures, inputs, box, widths, has_sheets)
    if not warnings:
        return structures
    inputs[0].warnings += warnings
    return replace(structures, faults=faults)


def _warnings_of_idle(structures: Structures) -> list[BuildWarning]:
    """Those of faults that have all of the rock on one side, and of bodies that have it outside."""
    texts = []
    for number, (name, sides) in enumerate(zip(structures.names, structures.sides.T, strict=True)):
        is_below, is_above = (sides < 0).any(), (sides > 0).any()
        if number < len(structures.faults) and not (is_below and is_above):
            texts.append(f"fault '{name}' meets no rock and displaces nothing; check its coordinates")
        elif number >= len(structures.faults) and not is_below:  # inside is below
            texts.append(f"body '{name}' lies outside of all rock masses; check its coordinates")
    return [BuildWarning(text, "structure") for text in texts]


def _facing_up(work: Work, fault: Fault) -> Fault:
    """The fault with its triangles turned as the native part has them: on the whole they face up."""
    vertices, triangles = fault.triangulation()
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    largest = int(np.linalg.norm(normals, axis=1).argmax())
    size = norm(normals[largest])
    beside = corners[largest].mean(axis=0) + normals[largest] / size * 1e-3 * np.sqrt(size)
    native = native_module()
    try:
        side = fault_sides(work, beside[None], FaultShape(vertices, triangles, fault.dies_out))
    except native.InputError as error:
        error.surface = 0
        raise refused_structure(error, [fault], []) from error
    if side[0] > 0:
        return fault
    return replace(fault, triangles=np.ascontiguousarray(triangles[:, ::-1]))
