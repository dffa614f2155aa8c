# SPDX-License-Identifier: GPL-3.0-or-later
"""Discrete smooth interpolation: the smoothest heights of a mesh that obey points, border and bounds."""

from __future__ import annotations

import numpy as np

from ..errors import UsageError
from ..work import native_module
from .interpolation import Result, Task
from .surface_reference import heights_of


def dsi(task: Task) -> Result:
    if task.triangles is None:
        raise UsageError("method 'dsi' works on a mesh: give the triangles of the nodes")
    settings = task.settings
    given = {}
    for option, argument in (("border", "equal"), ("above", "least"), ("below", "most")):
        if settings[option] is not None:
            given[argument] = heights_of(task, settings[option], task.nodes, option)
    if "equal" in given:
        given["equal"] = np.where(border_nodes(task.triangles, len(task.nodes)), given["equal"], np.nan)
    found = task.run(
        native_module().dsi,
        task.points,
        task.nodes,
        task.triangles,
        weight=settings["weight"] or 0.0,
        **given,
    )
    warnings = []
    if found["outside"]:
        warnings.append(
            f"{found['outside']} of {len(task.points)} points lie outside the mesh and do not count; "
            "other methods take them in"
        )
    if found["missed"]:
        warnings.append(
            f"{found['missed']} of {len(task.points)} points cannot all be met on this mesh, the farthest "
            f"is missed by {found['misfit']:.3g}: use a shorter edge_length, or give points a weight"
        )
    if not found["converged"]:
        warnings.append(
            "the heights are not quite as smooth as they could be: the mesh has triangles of unlike sizes "
            "or shapes; a more even mesh helps"
        )
    return Result(found["z"], warnings=warnings)


def border_nodes(triangles: np.ndarray, nodes: int) -> np.ndarray:
    """(N,) bool: the nodes of edges that one triangle alone has."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges = ends[:, 0].astype(np.int64) * nodes + ends[:, 1]
    edges, count = np.unique(edges, return_counts=True)
    border = np.zeros(nodes, bool)
    border[edges[count == 1] // nodes] = True
    border[edges[count == 1] % nodes] = True
    return border
