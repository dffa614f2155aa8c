# SPDX-License-Identifier: GPL-3.0-or-later
"""The heights of the interpolated surfaces of a model, and by how much those of a realization differ."""

from __future__ import annotations

import numpy as np

from ..base.sheet import Sheet
from ..base.work import native_module, on_threads
from ..model.model import Model
from ..surfaces.rock_input import RockInput


def heights(model: Model) -> list[np.ndarray | None]:
    """The heights (V,) float64 of each surface: at the nodes of the planar mesh, or where faults divide the
    rock mass at the vertices of its sheets, one after another; None for ready meshes and level sets."""
    return [
        None if _is_ready(entry, number) else _own(entry, number)
        for entry in model.rock_inputs
        for number in range(len(entry.surfaces))
    ]


def differences(base: Model, drawn: Model, threads: int = 0) -> list[np.ndarray | None]:
    """The differences (V,) float64 of each surface: the heights of a realization minus those of the model, as
    of `heights`. NaN where a sheet of the realization does not reach."""
    return [
        None if _is_ready(entry, number) else _difference(entry, other, number, threads)
        for entry, other in zip(base.rock_inputs, drawn.rock_inputs, strict=True)
        for number in range(len(entry.surfaces))
    ]


def _is_ready(entry: RockInput, number: int) -> bool:
    return entry.interpolations[number] is None


def _own(entry: RockInput, number: int) -> np.ndarray:
    if entry.structure is None:
        return entry.interpolation(number).z
    return np.concatenate([vertices[:, 2] for _, (vertices, _) in _sheets(entry, number)])


def _difference(entry: RockInput, drawn: RockInput, number: int, threads: int) -> np.ndarray:
    if entry.structure is None:
        return drawn.interpolation(number).z - entry.interpolation(number).z
    changes = []
    for compartment, (vertices, _) in _sheets(entry, number):
        nodes, triangles = drawn.divided().sheet(compartment, number)
        if np.array_equal(nodes[:, :2], vertices[:, :2]):
            z = nodes[:, 2]
        else:
            plan = np.ascontiguousarray(vertices[:, :2])
            z = native_module().surface_heights(nodes, triangles, plan, execution=on_threads(threads))
        changes.append(z - vertices[:, 2])
    return np.concatenate(changes)


def _sheets(entry: RockInput, number: int) -> list[tuple[int, Sheet]]:
    """The different sheets of a surface, as of RockStructure.distinct, each with its first compartment."""
    first: dict[Sheet, int] = {}
    structure = entry.divided()
    for compartment in range(len(structure.sheets)):
        sheet = structure.sheet(compartment, number)
        first.setdefault(sheet, compartment)
    return [(compartment, sheet) for sheet, compartment in first.items()]
