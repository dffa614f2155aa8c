# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model was built from, in its file: all that the arrays of docs/dev/geometry.md do not say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import PurePath
from typing import Any

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.errors import InputRefused
from ..base.sheet import Sheet
from ..base.stored_objects import NamedArrays, StoredClasses, fits, hints_of
from ..heights import Interpolation
from ..project.library import Library, Property
from ..project.project import Project, Rock, Surface
from ..project.structure_entries import Body, Fault
from ..settings.map_layer import MapLayer
from ..settings.point_file import MeshFile, PointFile
from ..settings.variogram import Structure, Variogram
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import RockStructure
from ..surfaces.sides import FaultShape, RockFaults
from ..surfaces.surface_arrays import SurfaceArrays
from .model_data import ModelData

RECORDED: tuple[type, ...] = (
    *(RockInput, Rock, Surface, RockStructure, RockFaults, FaultShape, Structures, Fault, Body, Sheet),
    *(BuildWarning, InputRefused, Project, Library, Property, Interpolation, Variogram, Structure),
    *(MapLayer, MeshFile, PointFile),
)
RECORD = "record"  # the table of objects; its arrays are record_0, record_1, ...
_STORED = StoredClasses(RECORDED)
_FIELDS = ("project", "rock_inputs", "structures", "warnings", "compartment_sides", "is_cut")


def record_arrays(model: ModelData) -> dict[str, np.ndarray]:
    """The record of a model as arrays of its file. It says nothing of where and when the model was built, and
    of files only the names in the folder of the project."""
    model.require_project("an .npz file")
    arrays = NamedArrays(_shapes(model.surfaces), f"{RECORD}_")
    values = {name: getattr(model, name) for name in _FIELDS}
    text = _STORED.write(values, arrays, _name_within(model.project))
    return {RECORD: np.frombuffer(text, np.uint8), **arrays}


def read_record(arrays: Mapping[str, np.ndarray], surfaces: SurfaceArrays) -> dict[str, Any]:
    """The fields of ModelData in the record of a file. Raises ValueError where it is damaged."""
    values = _STORED.read(arrays[RECORD].tobytes(), {**arrays, **_shapes(surfaces)})
    hints = hints_of(ModelData)
    if not isinstance(values, dict) or list(values) != list(_FIELDS):
        raise ValueError("it is of another version of RealModel")
    for name, value in values.items():
        if not fits(value, hints[name]):
            raise ValueError(f"{name} is not what a model has")
    return values


def _shapes(surfaces: SurfaceArrays) -> dict[str, np.ndarray]:
    """The parts of `surface_vertices` and `surface_triangles`, which most sheets of a record are."""
    found = {}
    for number in range(len(surfaces.vertex_offsets) - 1):
        for name, array in zip(("vertices", "triangles"), surfaces.surface(number), strict=True):
            found[f"surface_{name}[{number}]"] = array
    return found


def _name_within(project: Project) -> Callable[[PurePath], str]:
    """What is stored of a path: its part below the folder of the project, else its last part."""
    folder = None if project.path is None else project.path.parent

    def name(path: PurePath) -> str:
        is_within = folder is not None and path.is_relative_to(folder)
        return path.relative_to(folder).as_posix() if is_within else path.name

    return name


def without_record(arrays: Mapping[str, np.ndarray], surfaces: SurfaceArrays, name: str) -> dict[str, Any]:
    """The fields of ModelData that follow from the arrays of a file of RealModel 0.1, which had no record:
    names, properties and shapes."""
    block_of = {surface: number for number, surface in enumerate(arrays["block_surface"].tolist())}
    rocks = [Rock(each, []) for each in arrays["rock_names"].tolist()]
    faults, bodies, rock = [], [], -1
    kinds, names = arrays["surface_kind"].tolist(), arrays["surface_names"].tolist()
    for number, (kind, own) in enumerate(zip(kinds, names, strict=True)):
        vertices, triangles = surfaces.surface(number)
        block = block_of.get(number)
        known = {} if block is None else {"property": int(arrays["block_property"][block])}
        if kind == 1:
            faults.append(Fault(own, vertices, triangles))
        elif kind == 2:
            bodies.append(Body(own, vertices, triangles, **known))
        else:
            # without a block beneath it a surface is the oldest of its rock mass
            rock = rock + 1 if block is None else int(arrays["block_rock"][block])
            named = {} if block is None else {"block": str(arrays["block_names"][block])}
            rocks[rock].surfaces.append(Surface(own, vertices, triangles, **known, **named))
    inputs, first = [], 0
    for each in rocks:
        entry = RockInput(each, [Sheet(s.vertices, s.triangles) for s in each.surfaces])
        count = len(each.surfaces)
        entry.interpolations, entry.file_faces = [None] * count, [None] * count
        for k in range(count):
            begin, end = surfaces.vertex_offsets[first + k : first + k + 2]
            attributes = {key: arrays[f"surface_{key}"][begin:end] for key in ("variance", "distance")}
            entry.attributes[k] = attributes
        first += count
        inputs.append(entry)
    structures = Structures(faults, bodies, [], [])
    project = Project(name, rocks, faults=faults, bodies=bodies)
    return {"project": project, "rock_inputs": inputs, "structures": structures}
