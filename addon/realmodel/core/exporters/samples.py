# SPDX-License-Identifier: GPL-3.0-or-later
"""Files with the probability of each block at samples: tables (.csv), arrays (.npz), cells for ParaView
(.vtu, .vti), and drawings of sections: each place has the mean color of its blocks."""

from __future__ import annotations

import csv
import io
from typing import BinaryIO

import numpy as np

from ..base.algebra import begins_run
from ..base.text import Step
from ..drawing import Drawing
from ..results.samples import GridSamples, HoleSamples, Probabilities, Samples, SectionSamples
from ..results.sections.section_drawing import draw_section
from .encodings.text_rows import write_rows
from .encodings.vtk_xml import write_grid, write_image
from .npz import texts, write_arrays
from .shapes.parts import distinct_names

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
