# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a section or fence is written to: polygons that know their block and its property.

.vtu: VTK unstructured grid ("VTK File Formats", XML) of polygon cells, for ParaView, PyVista and meshio.
.obj: Wavefront OBJ, a group for each block and a material for each property, for any modeller.
.csv: one row for each corner of each polygon. .npz: the arrays of Section.
"""

from __future__ import annotations

import csv
import io
import re
from typing import BinaryIO

import numpy as np

from ..base.text import Step
from ..results.sections.section_data import FenceData, SectionData
from .encodings.text_rows import write_rows
from .encodings.vtk_xml import write_grid
from .npz import write_arrays
from .shapes.parts import Part

_POLYGON = 7


def write_section_npz(section: SectionData, file: BinaryIO, _step: Step) -> None:
    write_arrays(section.arrays(), file)


def write_section_vtu(section: SectionData, file: BinaryIO, _step: Step) -> None:
    """Polygon cells with the cell arrays `block` (number in the model's list), `property` (library id, 0:
    none), `compartment`, `cells` (the model's, below and above; -1: outside), and `panel` of a fence."""
    arrays = [
        ("Points", "Points", section.vertices.astype("<f8")),
        ("Cells", "connectivity", section.polygon_vertices.astype("<i8")),
        ("Cells", "offsets", section.offsets[1:].astype("<i8")),
        ("Cells", "types", np.full(len(section), _POLYGON, np.uint8)),
        ("CellData", "block", section.block.astype("<i4")),
        ("CellData", "property", section.property.astype("<i4")),
        ("CellData", "compartment", section.compartment.astype("<i4")),
        ("CellData", "cells", section.cells.astype("<i4")),
    ]
    if isinstance(section, FenceData):
        arrays.append(("CellData", "panel", section.panel.astype("<i4")))
    write_grid(file, arrays)


def write_section_obj(section: SectionData, file: BinaryIO, _step: Step) -> None:
    """Triangles by block: a group `block_NUMBER_NAME`, and the material `property_ID`."""
    file.write(b"# section of a RealModel model: groups are blocks, materials are library ids\n")
    write_rows(file, "v %r %r %r", section.vertices)
    sizes = np.diff(section.offsets)
    for block in np.unique(section.block).tolist():
        in_block = section.block == block
        name = re.sub(r"\s+", "_", section.block_names[block].strip())
        group = f"block_{block}_{name}"
        material = f"property_{section.property[in_block][0]}"
        file.write(f"o {group}\ng {group}\nusemtl {material}\n".encode())
        offsets = np.concatenate([[0], np.cumsum(sizes[in_block])])
        part = Part(name, section.vertices, offsets, section.polygon_vertices[np.repeat(in_block, sizes)])
        write_rows(file, "f %d %d %d", part.triangles + 1)


def write_section_csv(section: SectionData, file: BinaryIO, _step: Step) -> None:
    """polygon, block (number), block_name, property, x, y, z of every corner; of a fence also panel and the
    distance along it, so that distance and z draw the unrolled picture; of a model that faults divide also
    the name of the compartment."""
    is_divided = len(section.compartment_names) > 1
    fence = section if isinstance(section, FenceData) else None
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["polygon", "block", "block_name", "property", "x", "y", "z"]
        + ["panel", "distance"] * (fence is not None)
        + ["compartment"] * is_divided
    )
    along = np.empty(0) if fence is None else fence.corner_distances()
    for k in range(len(section)):
        block = int(section.block[k])
        common = [k, block, section.block_names[block], int(section.property[k])]
        for corner in range(int(section.offsets[k]), int(section.offsets[k + 1])):
            place = section.vertices[section.polygon_vertices[corner]].tolist()
            extra = [int(fence.panel[k]), repr(float(along[corner]))] if fence is not None else []
            extra += [section.compartment_names[int(section.compartment[k])]] * is_divided
            rows.writerow([*common, *map(repr, place), *extra])
    file.write(text.getvalue().encode("utf-8"))
