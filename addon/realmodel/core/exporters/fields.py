# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of series as an unstructured grid of VTK (.vtu)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import BinaryIO

import numpy as np

from ..base.errors import UsageError
from ..base.text import Step, no_step
from ..fields import ScalarField
from ..fields.series_field import SeriesField
from .encodings.vtk_xml import write_grid

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
