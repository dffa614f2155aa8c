# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads faults and bodies: arrays instead of files and points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...base.algebra import are_among, norm
from ...base.errors import BuildWarning, InputRefused, naming, number_list, place_text
from ...base.triangles import (
    NoTwoSidesError,
    Sheet,
    checked_triangulation,
    meet,
    open_edges,
    oriented,
    without_flat,
)
from ...base.work import Work, native_module, on_threads
from ...heights.interpolate import checked_points
from ...project.project import Project
from ...project.structure_entries import Body, Fault
from ...project.structure_history import body_times, displaced_surfaces
from ...readers import dip_warnings, read_mesh, read_space_dips
from ...readers.fault_input import read_fault_points
from ...settings.dips import SpaceDips
from ...surfaces.rock_input import RockInput
from .between_walls import body_between_walls, pierced
from .continued import extended
from .fitted import fit_points, fit_sticks, read_trace, trace_surface
from .ground import Top


def read_structures(
    work: Work, project: Project, inputs: list[RockInput] | None = None
) -> tuple[list[Fault], list[Body], list[BuildWarning]]:
    """The faults and bodies of a project, their shapes as vertices (V, 3) float64 and triangles (T, 3) int32
    only; and the warnings of reading and fitting. inputs: the rock masses, read (RockInput), which faults
    given by a trace go through, and whose intervals bodies are made of; None: these keep their traces, read,
    and such bodies have no shape yet. Raises InputRefused."""
    warnings: list[BuildWarning] = []
    total = len(project.faults) + len(project.bodies) or 1
    faults, bodies = [], []
    for number, fault in enumerate(project.faults):
        work.step(number / total)
        if fault.trace is not None:
            faults.append(_read_traced(work, fault, project, inputs, warnings))
        else:
            faults.append(_read_fault(work, fault, project.units, warnings))
    for number, body in enumerate(project.bodies, len(faults)):
        work.step(number / total)
        bodies.append(_read_body(work, body, project, inputs, warnings))
    return faults, bodies, warnings


def _read_fault(work: Work, fault: Fault, units: str, warnings: list[BuildWarning]) -> Fault:
    shape_file = fault.input_file or fault.shape_file
    with naming(fault.item, fault.shape_source):
        if fault.points is not None:
            points: Any = fault.points
            texts: list[str] = []
            if fault.point_file is not None:
                points, texts = read_fault_points(fault.point_file, fault.stick, units)
            warnings += [BuildWarning(f"{fault.item}: {text}", "points") for text in texts]
            if fault.dip_file is not None:
                said = dip_warnings(fault.dip_file, units)
                warnings += [BuildWarning(f"{fault.item}: {text}", "points") for text in said]
            vertices, triangles = _fitted(work, fault, points, _dips_of(fault, units))
        else:
            vertices, triangles = _mesh_of(fault, units, warnings)
            crossing = crossing_triangles(work, Sheet(vertices, triangles))
            if len(crossing):
                place = place_text(vertices[triangles[crossing[0]]].mean(axis=0))
                what = f"{len(crossing)} of its triangles cross one another or overlap, one at {place}"
                text = f"{fault.item}: {what}: there it is not clear which rock lies on which side"
                warnings.append(BuildWarning(text, "crossing"))
        triangles = _two_sided(vertices, triangles)
        if fault.points is None and fault.extend > 0:
            vertices, triangles = extended(vertices, triangles, fault.extend, not fault.dies_out)
    return replace(
        fault,
        vertices=vertices,
        triangles=triangles,
        points=None,
        dips=None,
        stick=None,
        extend=0.0,
        mesh=None,
        shape_file=shape_file,
    )


def _dips_of(fault: Fault, units: str) -> SpaceDips | None:
    dips = fault.dips if fault.dip_file is None else read_space_dips(fault.dip_file, units)
    assert dips is None or isinstance(dips, SpaceDips)
    return None if dips is None else dips.checked()


def _read_traced(
    work: Work,
    fault: Fault,
    project: Project,
    inputs: list[RockInput] | None,
    warnings: list[BuildWarning],
) -> Fault:
    fault = replace(fault, shape_file=fault.input_file or fault.shape_file)
    with naming(fault.item, fault.shape_source):
        traced, texts = read_trace(fault, project.units)
        if inputs is None:
            return traced
        (vertices, triangles), more = trace_surface(work, traced, _tops(project, inputs, fault))
    warnings += [BuildWarning(f"{fault.item}: {text}", "trace") for text in (*texts, *more)]
    return replace(
        traced,
        vertices=vertices,
        triangles=triangles,
        trace=None,
        dip=None,
        dip_direction=None,
        elevation=None,
        extend=0.0,
        traced=traced,
    )


def _tops(project: Project, inputs: list[RockInput], fault: Fault) -> list[Top]:
    """Of each rock mass that a fault displaces its RockInput, and the number of the surface that the trace is
    on: of the named one (None where there is none), else of the youngest."""
    tops = []
    for rock in displaced_surfaces(project, fault):
        names = [surface.name for surface in inputs[rock].rock.surfaces]
        named = fault.elevation if isinstance(fault.elevation, str) else names[-1]
        tops.append((inputs[rock], names.index(named) if named in names else None))
    return tops


def _fitted(
    work: Work, fault: Fault, points: np.ndarray | Sequence[np.ndarray], dips: SpaceDips | None
) -> Sheet:
    sideways = not fault.dies_out
    if isinstance(points, np.ndarray) or np.ndim(points[0]) < 2:
        return fit_points(work, checked_points(points), fault.extend, sideways, dips)
    if dips is not None:
        raise InputRefused("'dips' has no effect, as its points are sticks", advice="take it out")
    sticks = [checked_points(stick, f"stick {number}") for number, stick in enumerate(points, 1)]
    sheet = fit_sticks(sticks, fault.extend, sideways)
    crossing = crossing_triangles(work, sheet)
    if len(crossing):
        corners = sheet.vertices[sheet.triangles[crossing]].reshape(-1, 3)
        crossing_sticks = [
            f"{number}" for number, stick in enumerate(sticks, 1) if are_among(corners, stick).any()
        ]
        place = corners[0]
        raise InputRefused(
            f"the surface through its sticks crosses itself at {place_text(place)}, between the sticks of "
            f"number {number_list(crossing_sticks)}, from 1",
            advice="check whether two of them cross, or one has points of another; leave one out",
            place=tuple(place.tolist()),
        )
    return sheet


def crossing_triangles(work: Work, surface: Sheet) -> np.ndarray:
    """The numbers of the triangles of a surface that others of it cross, or overlap."""
    vertices, triangles = surface
    beyond = vertices.max(axis=0) + np.ptp(vertices, axis=0).max() + np.eye(3)  # a triangle that meets none
    other = np.array([[0, 1, 2]], np.int32)
    divided = work.native(native_module().intersect, vertices, triangles, beyond, other)
    sources = divided.source_triangle[divided.source == 0]
    return np.flatnonzero(np.bincount(sources, minlength=len(triangles)) != 1)


def _two_sided(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    try:
        return oriented(vertices, triangles)
    except NoTwoSidesError as error:
        place = error.edge.mean(axis=0)
        what = f"it has no two sides: it returns to itself the other way round at {place_text(place)}"
        raise InputRefused(what, advice="cut it open there", place=tuple(place.tolist())) from error


def _read_body(
    work: Work,
    body: Body,
    project: Project,
    inputs: list[RockInput] | None,
    warnings: list[BuildWarning],
) -> Body:
    shape_file = body.input_file or body.shape_file
    if not body.has_shape and inputs is None:
        return body
    with naming(body.item, body.shape_source):
        if body.has_shape:
            vertices, triangles = _mesh_of(body, project.units, warnings)
        else:
            assert inputs is not None
            seen = [inputs[rock].rock.observed for rock in body_times(project, body)]
            met, texts = pierced(body.name, [observed for observed in seen if observed is not None])
            (vertices, triangles), more = body_between_walls(work, met, body.reach)
            warnings += [BuildWarning(f"{body.item}: {text}", "points") for text in (*texts, *more)]
        edges = open_edges(vertices, triangles)
        if len(edges):
            place = vertices[edges[0]].mean(axis=0)
            count = "an open edge" if len(edges) == 1 else f"{len(edges)} open edges"
            raise InputRefused(
                f"it is not closed: it has {count}, one at {place_text(place)}",
                advice="close its surface: each edge must belong to two triangles",
                place=tuple(place.tolist()),
            )
        triangles = _two_sided(vertices, triangles)
    return replace(body, vertices=vertices, triangles=triangles, mesh=None, reach=None, shape_file=shape_file)


def _mesh_of(entry: Fault | Body, units: str, warnings: list[BuildWarning]) -> Sheet:
    if entry.mesh_file is None:
        vertices, triangles = checked_triangulation(*entry.triangulation())
    else:
        mesh = read_mesh(entry.mesh_file)
        vertices, texts = mesh.in_model(entry.mesh_file, units)
        warnings += [BuildWarning(text, "mesh_file") for text in texts]
        triangles = mesh.triangles
    with_area = without_flat(vertices, triangles)
    if len(with_area) < len(triangles):
        left_out = len(triangles) - len(with_area)
        text = f"{entry.item}: {left_out} triangle{'s' if left_out > 1 else ''} without area left out"
        warnings.append(BuildWarning(text, "left_out"))
    if not len(with_area):
        raise InputRefused("its triangles have no area")
    return Sheet(vertices, with_area)


_TOUCHES = 1e-6  # of the extent of both faults: a border so near another fault reaches it


def require_meeting(fault: Fault, ends: list[Fault]) -> None:
    """Refuses a fault that does not meet those at which it ends. All have arrays. Raises InputRefused."""
    for other in ends:
        nearest = nearest_to_meet(fault, other)
        if nearest is not None:
            raise _does_not_meet(fault, other, *nearest)


def nearest_to_meet(branch: Fault, other: Fault) -> tuple[np.ndarray, float] | None:
    """Where the border of a fault comes nearest to another one, and how near; None where they meet."""
    (vertices, triangles), (of_other, others) = branch.triangulation(), other.triangulation()
    if meet(vertices[triangles], of_other[others]).any():
        return None
    border = np.unique(open_edges(vertices, triangles))
    places = vertices[border] if len(border) else vertices
    _, away = native_module().nearest_triangles(of_other[others], places, execution=on_threads(1))
    nearest = int(away.argmin())
    near = _TOUCHES * float(norm(np.ptp(np.concatenate([vertices, of_other]), axis=0)))
    return None if away[nearest] <= near else (places[nearest], float(away[nearest]))


def _does_not_meet(branch: Fault, other: Fault, place: np.ndarray, away: float) -> InputRefused:
    source = branch.source
    return InputRefused(
        f"it ends at fault '{other.name}', but does not meet it: the nearest it comes is {away:.6g} at "
        f"{place_text(place)}",
        file=source.document.file if source else branch.shape_file,
        line=source.line("ends_at") if source else None,
        item=branch.item,
        advice="extend it to that fault, or take it out of 'ends_at'",
        place=tuple(place.tolist()),
    )
