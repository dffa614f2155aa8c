# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that refer to another surface: a height, heights at the nodes, a triangulated surface, or its
name."""

from __future__ import annotations

import numpy as np

from ..base.errors import InputRefused
from ..base.work import native_module
from ..settings.method_options import OptionRefused
from .interpolation import Task


def heights_of(task: Task, reference, places: np.ndarray, option: str) -> np.ndarray:
    """(N,) heights of a reference at places, NaN where it has none. Heights at the nodes (N,) can be asked at
    the nodes only, or elsewhere where the nodes have triangles."""
    if isinstance(reference, float):
        return np.full(len(places), reference)
    if isinstance(reference, str):
        if reference not in task.surfaces:
            raise OptionRefused(
                f"'{option}' names surface '{reference}', which does not exist",
                option=option,
                advice="outside a project give vertices and triangles",
            )
        reference = task.surfaces[reference]
    if isinstance(reference, np.ndarray):
        if len(reference) != len(task.nodes):
            raise OptionRefused(
                f"'{option}' has {len(reference)} heights for {len(task.nodes)} nodes", option=option
            )
        if places is task.nodes:
            return reference
        if task.triangles is None:
            raise InputRefused(
                f"'{option}' is known at the nodes only, and they have no triangles", item=option
            )
        reference = (np.column_stack([task.nodes, reference]), task.triangles)
        known = np.isfinite(reference[0][:, 2])[task.triangles].all(axis=1)
        reference = (reference[0], np.ascontiguousarray(task.triangles[known]))
    vertices, triangles = reference
    if places is task.nodes and len(vertices) == len(places) and np.array_equal(vertices[:, :2], places):
        return vertices[:, 2].copy()  # on one mesh: not a bit is lost
    return task.run(native_module().surface_heights, vertices, triangles, np.ascontiguousarray(places))
