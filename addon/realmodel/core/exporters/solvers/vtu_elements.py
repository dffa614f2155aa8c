# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK unstructured grid (.vtu) of elements, binary, for ParaView, PyVista, meshio and OpenGeoSys."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import CORNERS, VolumeMesh
from ..encodings.vtk_xml import write_grid

_TYPES = {"tetrahedron": 10, "pyramid": 14, "prism": 13, "hexahedron": 12}
_PRISM = [0, 2, 1, 3, 5, 4]  # VTK's prisms turn the other way round


def write_vtu_elements(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements with the cell arrays `MaterialIDs`, as OpenGeoSys calls it, and `block`, both the
    number of the block in the model's list, `property` (library id, 0: none) and, where it is known,
    `compartment`."""
    kinds = {kind: elements for kind, elements in mesh.elements.items() if len(elements)}
    corners = [
        (elements[:, _PRISM] if kind == "prism" else elements).astype("<i8").ravel()
        for kind, elements in kinds.items()
    ]
    sizes = [np.full(len(elements), CORNERS[kind], np.int64) for kind, elements in kinds.items()]
    types = [np.full(len(elements), _TYPES[kind], np.uint8) for kind, elements in kinds.items()]
    block = np.concatenate([*(mesh.element_block[kind] for kind in kinds), np.empty(0, np.int32)])
    block = block.astype("<i4")
    empty = np.empty(0, np.int64)
    compartment = []
    if mesh.element_compartment is not None:
        own = np.concatenate([*(mesh.element_compartment[kind] for kind in kinds), np.empty(0, np.int32)])
        compartment.append(("CellData", "compartment", own.astype("<i4")))
    step(0.3)
    write_grid(
        file,
        [
            ("Points", "Points", mesh.points.astype("<f8", copy=False)),
            ("Cells", "connectivity", np.concatenate([*corners, empty])),
            ("Cells", "offsets", np.cumsum(np.concatenate([*sizes, empty])).astype("<i8")),
            ("Cells", "types", np.concatenate([*types, np.empty(0, np.uint8)])),
            ("CellData", "MaterialIDs", block),
            ("CellData", "block", block),
            ("CellData", "property", mesh.block_property[block].astype("<i4") if len(block) else block),
            *compartment,
        ],
    )
    step(1.0)
