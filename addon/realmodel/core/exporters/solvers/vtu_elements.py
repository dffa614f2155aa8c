# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK unstructured grid (.vtu) of elements, binary, for ParaView, PyVista, meshio and OpenGeoSys."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

from ...simulation import VolumeMesh
from ..encodings.vtk_xml import write_grid


def write_vtu_elements(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements with the cell arrays `MaterialIDs`, as OpenGeoSys calls it, and `block`, both the
    number of the block in the model's list, `property` (library id, 0: none) and, where it is known,
    `compartment`."""
    cells, data = mesh.vtk_cells(), mesh.cell_data()
    step(0.3)
    write_grid(
        file,
        [
            ("Points", "Points", mesh.points.astype("<f8", copy=False)),
            ("Cells", "connectivity", cells.corners.astype("<i8")),
            ("Cells", "offsets", cells.offsets[1:].astype("<i8")),
            ("Cells", "types", cells.types),
            *(
                ("CellData", name, values.astype("<i4"))
                for name, values in {"MaterialIDs": data["block"], **data}.items()
            ),
        ],
    )
    step(1.0)
