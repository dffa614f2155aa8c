# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model was built from, in its file: all that the arrays of docs/dev/geometry.md do not say."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from ..base.errors import BuildWarning, InputRefused
from ..base.stored_objects import NamedArrays, StoredClasses, fits, hints_of
from ..base.triangles import Sheet
from ..fields import Anisotropy, Lattice, ScalarField, SolvedField
from ..fields.series_field import SeriesField
from ..heights import Interpolation
from ..project.library import Library, Property
from ..project.project import Project, Rock, Surface
from ..project.series import Series
from ..project.structure_entries import Body, Fault
from ..readers.tables.interval_values import IntervalValues
from ..readers.tables.observations import Bounds, LeftOut, Observations, Origin
from ..settings.data_files import MapLayer, MeshFile, PointFile
from ..settings.dips import DipFile, Dips, SpaceDips
from ..settings.variogram import Structure, Variogram
from ..structures.parts.parts import Structures
from ..surfaces.observed.surface_data import SurfaceData
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import FaultShape, RockFaults, RockStructure
from ..surfaces.surface_input import SurfaceArrays
from .blocks import blocks_of_arrays
from .model_data import ModelData

RECORDED: tuple[type, ...] = (
    *(RockInput, Rock, Surface, RockStructure, RockFaults, FaultShape, Structures, Fault, Body, Sheet),
    *(BuildWarning, InputRefused, Project, Library, Property, Interpolation, Variogram, Structure),
    *(SeriesField, Lattice, ScalarField, SolvedField, Anisotropy, MapLayer, MeshFile, PointFile, DipFile),
    *(Dips, SpaceDips, Series, Observations, Bounds, LeftOut, Origin, SurfaceData, IntervalValues),
)
RECORD = "record"  # the table of objects; its arrays are record_0, record_1, ...
_STORED = StoredClasses(RECORDED)
_FIELDS = ("project", "rock_inputs", "structures", "warnings", "compartment_sides", "is_cut")


def record_arrays(model: ModelData) -> dict[str, np.ndarray]:
    """The record of a model as arrays of its file. It contains neither place nor time of the build, and of
    files only the names in the folder of the project."""
    model.require_project("an .npz file")
    arrays = NamedArrays(_shapes(model.surface_arrays), f"{RECORD}_")
    values = {name: getattr(model, name) for name in _FIELDS}
    text = _STORED.write(values, arrays, _within_folder(model.project))
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
    parts = {}
    for number, shape in enumerate(surfaces.shapes):
        for name, array in zip(("vertices", "triangles"), shape, strict=True):
            parts[f"surface_{name}[{number}]"] = array
    return parts


def _within_folder(project: Project) -> Callable[[Any], Any]:
    """What is stored of a path: its part below the folder of the project, else its last part; and of a
    warning, which may begin with such a path."""
    folder = Path() if project.path is None else project.path.parent
    named = re.compile(f"(^|: ){re.escape(str(folder) + os.sep)}")

    def stored(value: Any) -> Any:
        if isinstance(value, PurePath):
            is_within = value.is_relative_to(folder)
            return value.relative_to(folder) if is_within else PurePath(value.name)
        if isinstance(value, BuildWarning):
            return replace(value, text=named.sub(r"\1", value.text))
        return value

    return stored


def without_record(arrays: Mapping[str, np.ndarray], surfaces: SurfaceArrays, name: str) -> dict[str, Any]:
    """The fields of ModelData that follow from the arrays of a file of RealModel 0.1, which had no record:
    names, properties and shapes."""
    blocks = {block.surface: block for block in blocks_of_arrays(arrays)}
    inputs = [RockInput(Rock(rock_name, []), []) for rock_name in arrays["rock_names"].tolist()]
    structures, rock = Structures([], [], [], []), -1
    named = zip(arrays["surface_kind"].tolist(), arrays["surface_names"].tolist(), strict=True)
    for number, (kind, label) in enumerate(named):
        vertices, triangles = surfaces.shapes[number]
        block = blocks.get(number)
        library_id = 0 if block is None else block.property
        if kind == 1:
            structures.faults.append(Fault(label, vertices, triangles))
        elif kind == 2:
            structures.bodies.append(Body(label, vertices, triangles, property=library_id))
        else:
            # without a block beneath it a surface is the oldest of its rock mass
            rock = rock + 1 if block is None else block.rock
            entry = inputs[rock]
            begin, end = surfaces.vertex_offsets[number : number + 2]
            attributes = {key: arrays[f"surface_{key}"][begin:end] for key in ("variance", "distance")}
            entry.attributes[len(entry.surfaces)] = attributes
            entry.surfaces.append(Sheet(vertices, triangles))
            entry.interpolations.append(None)
            entry.file_faces.append(None)
            surface = Surface(label, vertices, triangles, property=library_id)
            surface.block = None if block is None else block.name
            entry.rock.surfaces.append(surface)
    rocks = [entry.rock for entry in inputs]
    project = Project(name, rocks, faults=structures.faults, bodies=structures.bodies)
    return {"project": project, "rock_inputs": inputs, "structures": structures}
