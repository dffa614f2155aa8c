# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a built model for color scales: thickness of layers, attributes of the library, fields of
series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.errors import UsageError
from ..base.work import native_module, on_threads
from ..cells.model_data import ModelData
from ..fields import ScalarField
from ..fields.series_field import SeriesField
from ..project.project import Project
from ..settings.series_kinds import FIELD
from ..surfaces.rock_input import RockInput


def thickness(vertices: np.ndarray, triangles: np.ndarray, plan: np.ndarray, threads: int = 0) -> np.ndarray:
    """(N,) float64: the vertical thickness of a layer at places in plan (N, 2), NaN where it is not there.

    vertices (V, 3) float64, triangles (T, 3) int32: its closed boundary, counter-clockwise seen from outside.
    """
    a, b, c = (vertices[triangles[:, corner], :2] for corner in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    doubled = ux * vy - uy * vx
    top = at_places(vertices, triangles[doubled > 0], plan, threads)
    return top - at_places(vertices, triangles[doubled < 0], plan, threads)


def at_places(vertices: np.ndarray, triangles: np.ndarray, plan: np.ndarray, threads: int = 0) -> np.ndarray:
    """(N,) float64: the third coordinate of a triangulation (V, 3), (T, 3) at places in plan (N, 2), linear
    within triangles; NaN where there is none."""
    if not len(triangles):
        return np.full(len(plan), np.nan)
    heights = native_module().surface_heights(
        np.ascontiguousarray(vertices, np.float64),
        np.ascontiguousarray(triangles, np.int32),
        np.ascontiguousarray(plan, np.float64),
        execution=on_threads(threads),
    )
    return np.asarray(heights)


@dataclass(frozen=True)
class RockFields:
    """The fields of the series of a rock mass. compartments: what its compartments are called in a model."""

    compartments: list[str]
    fields: list[SeriesField]


def rock_fields(inputs: Sequence[RockInput]) -> list[RockFields]:
    """Of each rock mass of the model of these."""
    return [RockFields(names_of_compartments(inputs, entry), entry.fields) for entry in inputs]


def field_of(
    project: Project, rocks: Sequence[RockFields], series: str, compartment: str | None
) -> ScalarField:
    """Model.field, of a model of the project."""
    fields = {field.name: (rock, field) for rock in rocks for field in rock.fields}
    if series not in fields:
        project_series = [entry for rock in project.rocks for entry in rock.series]
        if any(entry.name == series and entry.kind == FIELD for entry in project_series):
            what = f"series '{series}' has no field here"
            raise UsageError(f"{what}: a stage before it has none, and of tiles only the whole has it")
        choices = f"there are {', '.join(fields)}" if fields else "the model has none"
        raise UsageError(f"no series '{series}' with a field: {choices}")
    rock, field = fields[series]
    if compartment is None and len(field.distinct()) == 1:
        return field.fields[0]
    if compartment not in rock.compartments:
        what = f"series '{series}' has a field in each of several compartments"
        raise UsageError(f"{what}: name one of {', '.join(rock.compartments)}")
    return field.fields[rock.compartments.index(compartment)]


def names_of_compartments(inputs: Sequence[RockInput], entry: RockInput) -> list[str]:
    """What the compartments of a rock mass are called in the model of these rock masses."""
    names = [name or entry.rock.name for name in entry.divided().names]
    if len(inputs) > 1:
        names = [f"{entry.rock.name}: {name}" if name != entry.rock.name else name for name in names]
    return names


def local_compartments(model: ModelData, entry: RockInput) -> np.ndarray:
    """For each compartment of a model its number in a rock mass; -1 where it is of another."""
    names = names_of_compartments(model.rock_inputs, entry)
    numbers = {name: number for number, name in enumerate(names)}
    if len(names) == 1:
        return np.zeros(max(len(model.compartment_names), 1), np.int64)
    return np.array([numbers.get(name, -1) for name in model.compartment_names], np.int64)
