# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of surfaces with their heights, without a model, and of the fields of series (.vtu)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import BinaryIO

import numpy as np

from ..base.errors import UsageError
from ..base.text import Step, no_step
from ..cells.model_data import UsedSurfaces
from ..fields import ScalarField
from ..fields.series_field import SeriesField
from .encodings.vtk_xml import write_grid
from .model_arrays import joined_attributes, texts, write_arrays
from .report import SCHEMA, body_entry, fault_entry, surface_entries, versions, warning_entries, write_report

_TRIANGLE = 5  # VTK's number
ATTRIBUTES = ("height", "variance", "distance")


def surface_arrays(surfaces: UsedSurfaces) -> dict[str, np.ndarray]:
    """By the names that the arrays of a model have: surface_vertices (Vs, 3), surface_triangles (Ts, 3)
    within their own surface, offsets (S+1,), surface_names, surface_kind (S,), and for each vertex
    surface_height, surface_variance and surface_distance (Vs,), NaN where there is none;
    surface_triangle_sheet (Ts,), the sheet of its surface that each triangle is of, from 0."""
    shapes = [surfaces.surface(number) for number in range(len(surfaces.surface_names))]
    arrays = {
        "surface_vertices": np.concatenate([vertices for vertices, _ in shapes]),
        "surface_triangles": np.concatenate([triangles for _, triangles in shapes]),
    }
    for name, column in (("surface_vertex_offsets", 0), ("surface_triangle_offsets", 1)):
        arrays[name] = np.cumsum([0, *(len(shape[column]) for shape in shapes)], dtype=np.int64)
    return {
        **arrays,
        **{f"surface_{name}": joined_attributes(surfaces, name) for name in ATTRIBUTES},
        "surface_triangle_sheet": surfaces.surface_triangle_sheet,
        "surface_names": texts(surfaces.surface_names),
        "surface_kind": surfaces.surface_kind,
    }


def write_surfaces_npz(surfaces: UsedSurfaces, file: BinaryIO, _step: Step) -> None:
    """Writes the arrays."""
    write_arrays(surface_arrays(surfaces), file)


def write_surfaces_vtu(surfaces: UsedSurfaces, file: BinaryIO, _step: Step) -> None:
    """Writes all triangles as one unstructured grid (VTK File Formats, XML), with the point arrays height,
    variance and distance (NaN where there is none) and the cell arrays `surface`, the number of each one's,
    and `sheet`."""
    arrays = surface_arrays(surfaces)
    first = np.repeat(arrays["surface_vertex_offsets"][:-1], np.diff(arrays["surface_triangle_offsets"]))
    corners = arrays["surface_triangles"].astype("<i8") + first[:, None]
    number = np.repeat(
        np.arange(len(surfaces.surface_names), dtype="<i4"), np.diff(arrays["surface_triangle_offsets"])
    )
    count = len(corners)
    write_grid(
        file,
        [
            ("Points", "Points", arrays["surface_vertices"].astype("<f8")),
            ("Cells", "connectivity", corners.ravel()),
            ("Cells", "offsets", 3 * np.arange(1, count + 1, dtype="<i8")),
            ("Cells", "types", np.full(count, _TRIANGLE, np.uint8)),
            *(("PointData", name, arrays[f"surface_{name}"].astype("<f8")) for name in ATTRIBUTES),
            ("CellData", "surface", number),
            ("CellData", "sheet", arrays["surface_triangle_sheet"].astype("<i4")),
        ],
    )


def write_surfaces_report(surfaces: UsedSurfaces, file: BinaryIO) -> None:
    """Writes the part of a model's report that is known before anything is intersected, as UTF-8 JSON."""
    report = {
        "schema": SCHEMA,
        "project": {
            "name": surfaces.project.name,
            "file": str(surfaces.project.path) if surfaces.project.path else None,
        },
        "surfaces": surface_entries(surfaces),
        "faults": [fault_entry(fault) for fault in surfaces.structures.faults],
        "bodies": [body_entry(body) for body in surfaces.structures.bodies],
        "warnings": warning_entries(surfaces),
        "versions": versions(),
    }
    write_report(report, file)


_TETRAHEDRON = 10  # VTK's number


def write_fields(
    fields_of_rocks: Iterable[Sequence[SeriesField]], file: BinaryIO, _step: Step = no_step
) -> None:
    """Writes the tetrahedra of the lattices of the fields of all rock masses, with the point array `field`, f
    at the nodes, and the cell arrays `series`, the number of the series in the model, and `compartment`, the
    number of the first compartment of its rock mass that has this field. Raises UsageError where there is
    none."""
    fields: list[tuple[ScalarField, int, int]] = []
    number = 0
    for rock in fields_of_rocks:
        for series_field in rock:
            fields += [
                (field, number, compartments[0]) for field, compartments in series_field.distinct().items()
            ]
            number += 1
    if not fields:
        raise UsageError("the model has no field: none of its series is of the kind 'field'")
    tetrahedra = [field.lattice.tetrahedra().astype("<i8") for field, _, _ in fields]
    begin = np.cumsum([0, *(field.lattice.nodes for field, _, _ in fields)])
    counts = [len(nodes) for nodes in tetrahedra]
    corners = np.concatenate([nodes + first for nodes, first in zip(tetrahedra, begin[:-1], strict=True)])
    write_grid(
        file,
        [
            ("Points", "Points", np.concatenate([field.lattice.positions() for field, _, _ in fields])),
            ("Cells", "connectivity", corners.ravel()),
            ("Cells", "offsets", 4 * np.arange(1, len(corners) + 1, dtype="<i8")),
            ("Cells", "types", np.full(len(corners), _TETRAHEDRON, np.uint8)),
            ("PointData", "field", np.concatenate([field.values for field, _, _ in fields]).astype("<f8")),
            ("CellData", "series", np.repeat(np.array([entry[1] for entry in fields], "<i4"), counts)),
            ("CellData", "compartment", np.repeat(np.array([entry[2] for entry in fields], "<i4"), counts)),
        ],
    )
