# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of beds, modeled by RealModel and by other programs from the same contacts and dips.

GemPy and LoopStructural get the settings of their own tutorials (`1.1 basics`, `1b. Implicit surface
modelling`). LoopStructural and SciPy ask for the value of each surface, which is its distance from the first.
"""

from __future__ import annotations

import contextlib
import io
import logging
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from realmodel.core.base.errors import RealModelError
from realmodel.core.base.work import run
from realmodel.core.fields import Lattice, LevelSetData, solve_field

NODES = 50_000  # of our lattice
ELEMENTS = 10_000  # of LoopStructural's: the number of its tutorial


class Refused(Exception):
    """A program makes no model of the data, and why."""


@dataclass(frozen=True)
class Beds:
    """A series in a box. data: contacts, dips and their normals toward younger rock; low, high: (3,) corners
    of the box; values: (S,) distances of the surfaces from the oldest one, or levels of the truth."""

    data: LevelSetData
    low: np.ndarray
    high: np.ndarray
    values: np.ndarray

    def contacts(self, surface: int) -> np.ndarray:
        return self.data.contacts[self.data.contact_surfaces == surface]


@dataclass(frozen=True)
class Solved:
    """A scalar field. at: values at points (P, 3); levels: (S,) of its surfaces, oldest first."""

    at: Callable[[np.ndarray], np.ndarray]
    levels: np.ndarray

    def blocks(self, places: np.ndarray) -> np.ndarray:
        """(P,) which block each place is in, 0 below the oldest surface."""
        values = self.at(places)
        if not np.isfinite(values).all() or not np.isfinite(self.levels).all():
            raise Refused("the field is not finite")
        return np.searchsorted(self.levels, values)


def realmodel(beds: Beds) -> Solved:
    """A series of a field with default options."""
    size = beds.high - beds.low
    steps = np.ceil(size / np.cbrt(size.prod() / NODES)).astype(int)
    lattice = Lattice(tuple(beds.low), tuple(size / steps), tuple((steps + 1).tolist()))
    try:
        field = run(lambda work: solve_field(lattice, beds.data, work))
    except RealModelError as refusal:
        raise Refused(str(refusal)) from refusal
    return Solved(field.at, field.levels)


def gempy(beds: Beds) -> Solved:
    """Default options, as in its tutorials; evaluated at the places themselves."""
    model = gempy_model([("beds", beds)])
    frame = model.structural_frame

    def at(places):
        return gempy_values(model, places)[0]

    at(beds.data.contacts[:1])
    fields = model.solutions.octrees_output[0].outputs_centers[0].exported_fields
    levels = np.atleast_1d(fields.scalar_field_at_surface_points)  # the youngest first
    if len(levels) != len(frame.structural_groups[0].elements):
        raise Refused("GemPy gives no level for a surface")
    return Solved(at, np.asarray(levels, float)[::-1])


def gempy_model(groups: Sequence[tuple[str, Beds]], faults: Sequence[str] = ()):
    """GemPy's model of groups, the youngest first, each eroding what is older. faults: groups that are
    faults. A group without dips gets one from its points, by GemPy's own function."""
    import gempy

    data = gempy.data
    made = []
    colors = data.ColorsGenerator()
    for name, beds in groups:
        elements = []
        for surface in reversed(range(len(beds.data.names))):
            points = beds.contacts(surface)
            unit = f"{name} {beds.data.names[surface]}"
            first = surface == len(beds.data.names) - 1
            at, normals = (beds.data.dips, beds.data.normals) if first else (np.empty((0, 3)),) * 2
            if first and not len(beds.data.dips):
                at, normals = _dip_of_points(gempy, points)
            elements.append(
                data.StructuralElement(
                    name=unit,
                    color=next(colors),
                    surface_points=data.SurfacePointsTable.from_arrays(*points.T, names=[unit] * len(points)),
                    orientations=data.OrientationsTable.from_arrays(*at.T, *normals.T, names=[unit] * len(at))
                    if len(at)
                    else data.OrientationsTable.initialize_empty(),
                )
            )
        kind = data.StackRelationType.FAULT if name in faults else data.StackRelationType.ERODE
        made.append(data.StructuralGroup(name=name, elements=elements, structural_relation=kind))
    first = groups[0][1]
    extent = np.column_stack([first.low, first.high]).ravel().tolist()
    with _quiet():
        model = gempy.create_geomodel(
            project_name="beds",
            extent=extent,
            resolution=[6, 6, 6],
            structural_frame=data.StructuralFrame(structural_groups=made, color_gen=colors),
        )
        for name in faults:
            gempy.set_is_fault(model, [name])
    model.interpolation_options.mesh_extraction = False
    return model


def _dip_of_points(gempy, points):
    one = gempy.create_orientations_from_surface_points_coords(points)
    at = np.column_stack([one.data[axis] for axis in "XYZ"])
    normals = np.column_stack([one.data[f"G_{axis}"] for axis in "xyz"])
    return at, np.where(normals[:, 2:] < 0, -normals, normals)


def gempy_values(model, places: np.ndarray):
    """(G, P) the scalar field of each group at places, and (P,) the number of the unit there."""
    import gempy

    with _quiet():
        try:
            units = np.asarray(gempy.compute_model_at(model, np.ascontiguousarray(places)))
        except Exception as error:  # whatever GemPy raises is its refusal
            raise Refused(f"{type(error).__name__}: {error}") from error
    outputs = model.solutions.octrees_output[0].outputs_centers
    fields = [output.exported_fields.scalar_field for output in outputs]
    fields = np.array([np.asarray(field)[-len(places) :] for field in fields])
    return fields, np.rint(units.ravel()[-len(places) :]).astype(int)


def loopstructural(beds: Beds) -> Solved:
    """FDI with 10,000 elements, a buffer of 0.3 and damping, as its tutorial has it."""
    with _quiet():
        try:
            field = loop_model(beds)["beds"]
            field.evaluate_value(beds.data.contacts[:1])
        except Exception as error:  # whatever LoopStructural raises is its refusal
            raise Refused(f"{type(error).__name__}: {error}") from error
    return Solved(field.evaluate_value, beds.values)


def loop_model(beds: Beds):
    """LoopStructural's model with one foliation, "beds"."""
    import pandas
    from LoopStructural import GeologicalModel

    logging.disable(logging.CRITICAL)
    contacts = pandas.DataFrame(beds.data.contacts, columns=list("XYZ"))
    contacts["val"] = beds.values[beds.data.contact_surfaces]
    dips = pandas.DataFrame(beds.data.dips, columns=list("XYZ"))
    dips[["nx", "ny", "nz"]] = beds.data.normals
    model = GeologicalModel(beds.low, beds.high)
    model.data = pandas.concat([contacts, dips], ignore_index=True).assign(feature_name="beds")
    model.create_and_add_foliation("beds", interpolatortype="FDI", nelements=ELEMENTS, buffer=0.3, damp=True)
    return model


def scipy_rbf(beds: Beds) -> Solved:
    """RBFInterpolator with default options (thin_plate_spline) through the values at contacts; it takes no
    dips."""
    from scipy.interpolate import RBFInterpolator

    if len(beds.data.names) == 1:  # its height: values alone would be the same everywhere
        heights = RBFInterpolator(beds.data.contacts[:, :2], beds.data.contacts[:, 2])
        return Solved(lambda places: places[:, 2] - heights(places[:, :2]), np.zeros(1))
    scale = float((beds.high - beds.low).max())
    try:
        values = beds.values[beds.data.contact_surfaces]
        function = RBFInterpolator(beds.data.contacts / scale, values)
    except (ValueError, np.linalg.LinAlgError) as error:
        raise Refused(str(error)) from error
    return Solved(lambda places: function(places / scale), beds.values)


PROGRAMS = {
    "RealModel": realmodel,
    "GemPy": gempy,
    "LoopStructural": loopstructural,
    "SciPy RBF": scipy_rbf,
}


@contextlib.contextmanager
def _quiet():
    with (
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        yield
