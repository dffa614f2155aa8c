# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that sections, fences and boreholes are written to: polygons that know their block and its
property, and probabilities of blocks at samples of an ensemble."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from ..base.algebra import begins_run
from ..base.text import Step
from ..cells.model_data import ModelData
from ..drawing import Drawing
from ..results.model_holes import COLUMNS, Interval, PlannedHoleData, mean_share
from ..results.samples import GridSamples, HoleSamples, Probabilities, Samples, SectionSamples
from ..results.sections.section_data import FenceData, SectionData
from ..results.sections.section_drawing import draw_section
from .encodings.text_rows import write_rows
from .encodings.vtk_xml import write_grid, write_image
from .model_arrays import texts, write_arrays
from .shapes.shape_parts import Part, distinct_names

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


def write_borehole(borehole: tuple[ModelData, Sequence[Interval]], file: BinaryIO, _step: Step) -> None:
    """block (number), block_name, property, top and bottom (elevations) of each interval, from above."""
    model, intervals = borehole
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["block", "block_name", "property", "top", "bottom"])
    for interval in intervals:
        block = model.blocks[interval.block]
        ends = repr(interval.top), repr(interval.bottom)
        rows.writerow([interval.block, block.name, block.property, *ends])
    file.write(text.getvalue().encode("utf-8"))


def write_planned_hole(hole: PlannedHoleData, file: BinaryIO, _step: Step) -> None:
    """The rows of the hole; what is not known is empty. With an ensemble the probability of each block,
    averaged over the interval."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    intervals = hole.rows()
    blocks = [] if hole.probability is None else distinct_names(hole.block_names)
    rows.writerow([*COLUMNS, *(f"probability {name}" for name in blocks)])
    for row in intervals:
        values = [
            "" if value is None else repr(value) if isinstance(value, float) else value
            for value in row.values()
        ]
        if hole.probability is not None and hole.depths is not None:
            ends = row["from"], row["to"]
            values += [f"{mean_share(share, hole.depths, *ends):.9g}" for share in hole.probability.T]
        rows.writerow(values)
    file.write(text.getvalue().encode("utf-8"))


_QUADRILATERAL = 9
_SHADES = 64.0  # of each color: cells beside one another that have the same are drawn as one
Asked = tuple[Samples, Probabilities]


def _named(probabilities: Probabilities) -> list[tuple[str, np.ndarray]]:
    """Arrays of cells, by name."""
    shares = zip(distinct_names(probabilities.block_names), probabilities.probability.T, strict=True)
    return [
        ("entropy", probabilities.entropy().astype("<f8")),
        ("block", probabilities.likeliest().astype("<i4")),
        *((f"probability {name}", np.ascontiguousarray(share, "<f8")) for name, share in shares),
    ]


def write_samples_csv(asked: Asked, file: BinaryIO, _step: Step) -> None:
    """A row for each place where there may be rock: x, y, z, the distance along a section, the name of the
    likeliest block, entropy, and the probability of each block; the depth along a planned hole."""
    samples, probabilities = asked
    in_rock = np.flatnonzero(probabilities.probability.sum(axis=1) > 0)
    names, columns = distinct_names(probabilities.block_names), [samples.places[in_rock]]
    headings = ["x", "y", "z"]
    if isinstance(samples, SectionSamples):
        headings.append("distance")
        columns.append(samples.distance[in_rock])
    if isinstance(samples, HoleSamples):
        headings.append("depth")
        columns.append(samples.depths[in_rock])
    quoted = np.array([_cell(name) for name in [*probabilities.block_names, ""]], object)
    columns += [
        quoted[probabilities.likeliest()[in_rock]],
        probabilities.entropy()[in_rock],
        probabilities.probability[in_rock],
    ]
    headings += ["block", "entropy", *(f"probability {name}" for name in names)]
    file.write((",".join(map(_cell, headings)) + "\n").encode())
    form = ",".join(["%r"] * (len(headings) - 2 - len(names)) + ["%s"] + ["%.9g"] * (1 + len(names)))
    write_rows(file, form, *columns)


def _cell(text: str) -> str:
    """A text as a field of a CSV file."""
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow([text])
    return line.getvalue() if text else ""


def write_samples_npz(asked: Asked, file: BinaryIO, _step: Step) -> None:
    samples, probabilities = asked
    arrays = {
        "block_names": texts(probabilities.block_names),
        "places": samples.places,
        "probability": probabilities.probability,
        "entropy": probabilities.entropy(),
    }
    if isinstance(samples, SectionSamples):
        arrays |= {"corners": samples.corners, "distance": samples.distance}
    if isinstance(samples, HoleSamples):
        arrays["depth"] = samples.depths
    if isinstance(samples, GridSamples):
        arrays |= {"origin": samples.origin, "size": samples.size, "counts": np.array(samples.counts)}
    write_arrays(arrays, file)


def write_samples_vtu(asked: tuple[SectionSamples, Probabilities], file: BinaryIO, _step: Step) -> None:
    samples, probabilities = asked
    count = len(samples.places)
    arrays = [
        ("Points", "Points", samples.corners.reshape(-1, 3).astype("<f8")),
        ("Cells", "connectivity", np.arange(4 * count, dtype="<i8")),
        ("Cells", "offsets", np.arange(4, 4 * count + 1, 4, dtype="<i8")),
        ("Cells", "types", np.full(count, _QUADRILATERAL, np.uint8)),
    ]
    write_grid(file, [*arrays, *(("CellData", name, values) for name, values in _named(probabilities))])


def write_samples_vti(asked: tuple[GridSamples, Probabilities], file: BinaryIO, _step: Step) -> None:
    samples, probabilities = asked
    write_image(file, samples.origin, samples.size, samples.counts, _named(probabilities))


def draw_probabilities(samples: SectionSamples, found: Probabilities, exaggeration: float = 1.0) -> Drawing:
    """A section whose cells have the mean of the colors of the blocks, as probable as these are, below the
    outlines of the interpolated blocks."""
    cells = _joined(samples, found.colors(samples.section.block_colors))
    return draw_section(samples.section, exaggeration, cells=cells)


def _joined(samples: SectionSamples, colors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (M, 4, 2) and colors (M, 3) of cells that are not white; those of one color in a row as one."""
    shades = np.rint(colors * _SHADES) / _SHADES
    differs = begins_run(shades)
    differs[:: samples.columns] = True
    first = np.flatnonzero(differs)
    last = np.append(first[1:], len(shades)) - 1
    a, b = samples.flat[first], samples.flat[last]
    corners = np.stack([a[:, 0], b[:, 1], b[:, 2], a[:, 3]], axis=1)
    seen = (shades[first] < 1.0).any(axis=1)
    return corners[seen], shades[first][seen]
