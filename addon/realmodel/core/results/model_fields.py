# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of the series of a model."""

from __future__ import annotations

import numpy as np

from ..base.errors import UsageError
from ..cells.model_data import ModelData
from ..fields import ScalarField
from ..surfaces.rock_input import RockInput


def field_of(model: ModelData, series: str, compartment: str | None) -> ScalarField:
    """Model.field."""
    found = {own.name: (entry, own) for entry in model.rock_inputs for own in entry.fields}
    if series not in found:
        there = f"there are {', '.join(found)}" if found else "the model has none"
        raise UsageError(f"no series '{series}' with a field: {there}")
    entry, own = found[series]
    fields = own.distinct()
    if compartment is None and len(fields) == 1:
        return own.fields[0]
    names = names_of_compartments(model, entry)
    if compartment not in names:
        what = f"series '{series}' has a field in each of several compartments"
        raise UsageError(f"{what}: name one of {', '.join(names)}")
    return own.fields[names.index(compartment)]


def names_of_compartments(model: ModelData, entry: RockInput) -> list[str]:
    """What the compartments of a rock mass are called in a model."""
    names = [name or entry.rock.name for name in entry.divided().names]
    if len(model.rock_inputs) > 1:
        names = [f"{entry.rock.name}: {name}" if name != entry.rock.name else name for name in names]
    return names


def local_compartments(model: ModelData, entry: RockInput) -> np.ndarray:
    """For each compartment of a model its number in a rock mass; -1 where it is of another."""
    names = names_of_compartments(model, entry)
    known = {name: number for number, name in enumerate(names)}
    if len(names) == 1:
        return np.zeros(max(len(model.compartment_names), 1), np.int64)
    return np.array([known.get(name, -1) for name in model.compartment_names], np.int64)
