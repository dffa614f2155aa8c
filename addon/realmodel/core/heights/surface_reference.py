# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that refer to another surface: a height, heights at the nodes, a triangulated surface, or its
name."""

from __future__ import annotations

import numpy as np

from ..base.errors import InputRefused
from ..base.sheet import Sheet
from ..base.work import native_module
from ..settings.method_options import OptionRefused
from .interpolation import Task

Reference = float | str | np.ndarray | tuple[np.ndarray, np.ndarray]


def heights_of(task: Task, reference: Reference, places: np.ndarray, option: str) -> np.ndarray:
    """(N,) heights of a reference at places, NaN where it has none. Heights at the nodes (N,) can be asked at
    the nodes only, or elsewhere where the nodes have triangles."""
    if isinstance(reference, float):
        return np.full(len(places), reference)
    if isinstance(reference, np.ndarray) and places is task.nodes:
        return _of_nodes(task, reference, option)
    vertices, triangles = _triangulated(task, reference, option)
    if places is task.nodes and len(vertices) == len(places) and np.array_equal(vertices[:, :2], places):
        return vertices[:, 2].copy()  # on one mesh: not a bit is lost
    return task.run(native_module().surface_heights, vertices, triangles, np.ascontiguousarray(places))


def sheet_of(task: Task, reference: Reference, option: str) -> Sheet | None:
    """The triangles of a reference; None where it is a height."""
    return None if isinstance(reference, float) else _triangulated(task, reference, option)


def _of_nodes(task: Task, heights: np.ndarray, option: str) -> np.ndarray:
    if len(heights) != len(task.nodes):
        raise OptionRefused(
            f"'{option}' has {len(heights)} heights for {len(task.nodes)} nodes", option=option
        )
    return heights


def _triangulated(task: Task, reference: Reference, option: str) -> Sheet:
    """The triangles of a surface that is referred to."""
    if isinstance(reference, str):
        if reference not in task.surfaces:
            raise OptionRefused(
                f"'{option}' names surface '{reference}', which does not exist",
                option=option,
                advice="outside a project give vertices and triangles",
            )
        return task.surfaces[reference]
    if isinstance(reference, np.ndarray):
        heights = _of_nodes(task, reference, option)
        if task.triangles is None:
            raise InputRefused(
                f"'{option}' is known at the nodes only, and they have no triangles", item=option
            )
        finite = np.isfinite(heights)[task.triangles].all(axis=1)
        vertices = np.column_stack([task.nodes, heights])
        return Sheet(vertices, np.ascontiguousarray(task.triangles[finite]))
    assert not isinstance(reference, float)
    return Sheet(*reference)
