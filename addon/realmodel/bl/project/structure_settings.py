# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts faults and bodies between the rows of a scene and realmodel.core."""

import numpy as np

from ...core import Body, Fault, Project
from ...core.base import work
from ...core.project.structure_entries import FAULT
from ...core.structures.shapes.reading import read_structures
from . import method_settings, settings, surface_dips


def entry_of(place, row):
    """A realmodel.core.Fault or Body with everything but its shape."""
    if place[0] == "body":
        body = Body(**method_settings.values(row, Body, "intervals" if row.source == "INTERVALS" else "mesh"))
        if body.void:
            body.property = 0
        return body
    if row.source == "POINTS_FILE":
        return Fault(**method_settings.values(row, Fault, "points"), dips=surface_dips.of_row(row))
    return Fault(**method_settings.values(row, Fault, "mesh"))


def set_trace(fault, row, trace):
    """Sets the trace of a realmodel.core.Fault, and what the row says of it."""
    fault.trace = trace
    vars(fault).update(method_settings.values(row, Fault, "trace"))


def set_stored_trace(fault, row):
    """Sets the trace that a row has stored; the dip of its file counts where the row has none."""
    arrays = row.stored_trace
    set_trace(fault, row, arrays["line"])
    for key in ("dip", "dip_direction"):
        if getattr(fault, key) is None and key in arrays:
            setattr(fault, key, arrays[key].item())


def trace_arrays(fault):
    """What a row stores of the trace of a realmodel.core.Fault that was read, with its dip."""
    arrays = {"line": fault.trace, "dip": fault.dip, "dip_direction": fault.dip_direction}
    return {key: value for key, value in arrays.items() if value is not None}


def mesh_arrays(entry):
    """What a row stores of a triangulated realmodel.core.Surface, Fault or Body."""
    vertices, triangles = entry.vertices, entry.triangles
    return {"vertices": np.asarray(vertices, np.float64), "triangles": np.asarray(triangles, np.int32)}


def clear_extension(entry):
    """The mesh of a fault was made from its file, as its settings say: they are not to be applied again."""
    if isinstance(entry, Fault):
        entry.extend, entry.stick, entry.dips = 0.0, None, None


def forget_extension(row):
    """The mesh that a fault's row has from now on was extended when it was made."""
    if settings.kind_of(row) == "fault":
        with settings.filling():
            method_settings.set_value(row, "extend", FAULT, 0.0)


def fill(scene, project):
    """Fills the rows from the faults and bodies of a project, in place of the present ones."""
    group = scene.realmodel
    group.faults.clear()
    group.bodies.clear()
    group.active_fault = group.active_body = 0
    group.structure_kind = "BODY" if project.bodies and not project.faults else "FAULT"
    for fault in (entry.traced or entry for entry in project.faults):
        row = group.faults.add()
        method_settings.set_values(row, Fault, fault)
        _fill_shape(row, fault, project.units)
    for body in project.bodies:
        row = group.bodies.add()
        method_settings.set_values(row, Body, body)
        _fill_shape(row, body, project.units)


def _fill_shape(row, entry, units):
    row.source = "MESH_FILE"
    if entry.input_file is not None:
        points, trace = (getattr(entry, key, None) for key in ("point_file", "trace_file"))
        row.source = "POINTS_FILE" if points else "TRACE_FILE" if trace else "MESH_FILE"
        row.filepath = str(entry.input_file)
        method_settings.fill_reading(row, points or trace or entry.mesh_file)
        if points:
            surface_dips.keep(row, entry.dips)
        return
    if isinstance(entry, Body) and not entry.has_shape:
        row.source = "INTERVALS"
        return
    if entry.vertices is None:  # points or a trace from a script or a project file
        entry = work.run(lambda task: _read_fault(task, entry, units))
        if entry.vertices is None:
            row.source, row.stored_trace = "TRACE_FILE", trace_arrays(entry)
            return
        forget_extension(row)
    row.stored_mesh = mesh_arrays(entry)


def _read_fault(task, fault, units):
    return read_structures(task, Project("points", [], units=units, faults=[fault]))[0][0]


def names_of(project):
    """The names of the faults and of the bodies of a project."""
    return [fault.name for fault in project.faults], [body.name for body in project.bodies]


def names_in(scene):
    """The names of the rows of a scene."""
    return tuple([row.name for row in settings.structures_of(scene, kind)] for kind in ("fault", "body"))
