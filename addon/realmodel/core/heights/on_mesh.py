# SPDX-License-Identifier: GPL-3.0-or-later
"""Discrete smooth interpolation: the smoothest heights of a mesh that honor points, border and bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.errors import InputRefused, UsageError, counted, place_text
from ..base.work import native_module
from ..settings.dips import Dips
from ..settings.methods import checked_options
from .companions import Companions, pooled
from .from_neighbors import mean_offsets, structure
from .interpolation import Reference, Result, Task, heights_of

_ARGUMENTS = {"border": "equal", "above": "least", "below": "most"}  # of native code, by options
BOUNDS = tuple(_ARGUMENTS)


def dsi(task: Task) -> Result:
    """The smoothest heights. Of a sheet of a series they are those that all sheets have in common, and the
    smoothest differences from these."""
    if task.triangles is None:
        raise UsageError("method 'dsi' works on a mesh: give the triangles of the nodes")
    return _smoothest(task) if task.companions is None else _of_series(task, task.companions)


def _of_series(task: Task, companions: Companions) -> Result:
    """What sheets have in common goes through the contacts of all of them, each less what its sheet lies
    above the others as kriging estimates it, and has their dips."""
    points, dips = companions.data(task.points, task.dips)
    asked = replace(task, settings=checked_options("kriging", {}))
    # those of the likeliest model are of thicknesses far from the data; here they are of those at the data
    offsets = mean_offsets(replace(asked, companions=None), structure(asked), points, dips)
    dips_of_sheets = [slopes for slopes in dips if slopes is not None]
    of_all = Dips.joined(dips_of_sheets).merged()[0] if dips_of_sheets else None
    alone = replace(task, companions=None)
    free = {**task.settings, **dict.fromkeys(BOUNDS)}
    common = replace(alone, points=pooled(points, offsets), dips=of_all, bounds=None, settings=free)
    base = _smoothest(common).z + offsets[companions.own]
    settings = dict(task.settings)
    for option in BOUNDS:
        if settings[option] is not None:
            settings[option] = heights_of(task, settings[option], task.nodes, option) - base
    points_above, bounds = _above(task, task.points, base), task.bounds
    if bounds is not None:
        places = _above(task, bounds.places, base)
        bounds = replace(bounds, places=places)
    if task.dips is not None:  # these slopes are common
        alone = replace(alone, dips=replace(task.dips, gradients=np.zeros_like(task.dips.gradients)))
    result = _smoothest(replace(alone, points=points_above, bounds=bounds, settings=settings))
    result.z = base + result.z
    return result


def _above(task: Task, points: np.ndarray, base: np.ndarray) -> np.ndarray:
    """(P, 3) points with their heights above heights at the nodes; beyond the mesh, where they do not count,
    they stay."""
    under = heights_of(task, base, np.ascontiguousarray(points[:, :2]), "base")
    points_above = points.copy()
    points_above[:, 2] -= np.nan_to_num(under)
    return points_above


def _smoothest(task: Task) -> Result:
    assert task.triangles is not None
    settings = task.settings
    limits = {}
    for option, argument in _ARGUMENTS.items():
        if settings[option] is not None:
            limits[argument] = heights_of(task, settings[option], task.nodes, option)
    if "equal" in limits:
        limits["equal"] = np.where(border_nodes(task.triangles, len(task.nodes)), limits["equal"], np.nan)
    for lower, upper in (("above", "below"), ("above", "border"), ("border", "below")):
        _refuse_crossed(task, limits, lower, upper)
    dips = None if task.dips is None else (task.dips.positions, task.dips.gradients)
    equal, least, most = (limits.get(bound, np.zeros(0)) for bound in ("equal", "least", "most"))
    output = task.run(
        native_module().dsi,
        task.points,
        task.nodes,
        task.triangles,
        (equal, least, most),
        settings["weight"] or 0.0,
        dips,
        None if task.bounds is None else (task.bounds.lower, task.bounds.upper),
    )
    warnings = []
    if output["outside"]:
        warnings.append(
            f"{output['outside']} of {len(task.points)} points lie outside the mesh and are ignored; "
            "other methods use them"
        )
    if output["dips_outside"]:
        warnings.append(f"left out: {counted(output['dips_outside'], 'dip')} outside the mesh")
    beyond = [*_beyond(task, "above"), *_beyond(task, "below")]
    warnings += beyond
    if output["missed"] and not beyond:
        warnings.append(
            f"{output['missed']} of {len(task.points)} points cannot all be honored on this mesh, the "
            f"largest misfit is {output['misfit']:.3g}: use a shorter edge_length, or give points a weight"
        )
    if output["dips_missed"]:
        warnings.append(
            "some dips cannot be honored on this mesh beside the points in their triangles: use a shorter "
            "edge_length, or give points a weight"
        )
    if output["bounds_missed"]:
        warnings.append(
            f"{output['bounds_missed']} bounds cannot be kept on this mesh beside its points: use a shorter "
            "edge_length"
        )
    if not output["converged"]:
        warnings.append(
            "the solver stopped before the elevations were as smooth as possible: triangles of the mesh "
            "differ much in size or shape; a more even mesh helps"
        )
    return Result(output["z"], warnings=warnings)


def within_bounds(task: Task, z: np.ndarray, at_border: np.ndarray) -> np.ndarray:
    """(N,) heights that are not of dsi itself, within the bounds of its options; at_border: (N,), those of
    the nodes at the border where the option gives these."""
    settings = task.settings
    for option, limit in (("above", np.fmax), ("below", np.fmin)):
        if settings.get(option) is not None:
            bound = heights_of(task, settings[option], task.nodes, option)
            z = np.where(np.isnan(z), z, limit(z, bound))
    if settings.get("border") is not None:
        assert task.triangles is not None  # heights for a border are requested on a mesh
        z = np.where(border_nodes(task.triangles, len(task.nodes)), at_border, z)
    return z


def _called(reference: Reference) -> str:
    """The surface or height that an option names, as messages write it."""
    if isinstance(reference, str):
        return f"'{reference}'"
    return f"{reference:g}" if isinstance(reference, float) else "the given elevations"


def _refuse_crossed(task: Task, limits: dict, lower: str, upper: str) -> None:
    """Refuses bounds that contradict: no surface lies between them."""
    low, high = (limits.get(_ARGUMENTS[option]) for option in (lower, upper))
    if low is None or high is None:
        return
    gap = np.where(np.isfinite(low) & np.isfinite(high), low - high, 0.0)
    worst = int(gap.argmax())
    if not gap[worst] > 0:
        return
    names = {option: f"{option} = {_called(task.settings[option])}" for option in (lower, upper)}
    raise InputRefused(
        f"no surface lies between: {names[lower]} is {gap[worst]:.4g} higher than {names[upper]} at "
        f"{place_text(task.nodes[worst])}",
        advice="remove one of them, or change the surface that it names",
    )


def _beyond(task: Task, option: str) -> list[str]:
    """The warning about points on the wrong side of a bound, which takes precedence over them."""
    reference = task.settings[option]
    if reference is None or not len(task.points):
        return []
    plan = np.ascontiguousarray(task.points[:, :2])
    bound = heights_of(task, reference, plan, option)
    past = bound - task.points[:, 2] if option == "above" else task.points[:, 2] - bound
    past += heights_of(task, np.zeros(len(task.nodes)), plan, option)  # NaN outside the mesh
    past[~(past > 0)] = 0.0  # NaN, where the bound has no height, too
    wrong = int(np.count_nonzero(past))
    if not wrong:
        return []
    other, worst = "below" if option == "above" else "above", int(past.argmax())
    return [
        f"{wrong} of {len(past)} points lie {other} {_called(reference)}, but the surface is kept "
        f"{option} it: they are not honored, the farthest is {other} by {past[worst]:.4g}: the point at "
        f"{place_text(task.points[worst])}"
    ]


def border_nodes(triangles: np.ndarray, nodes: int) -> np.ndarray:
    """(N,) bool: the nodes of edges that one triangle alone has."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges = ends[:, 0].astype(np.int64) * nodes + ends[:, 1]
    edges, count = np.unique(edges, return_counts=True)
    border = np.zeros(nodes, bool)
    border[edges[count == 1] // nodes] = True
    border[edges[count == 1] % nodes] = True
    return border
