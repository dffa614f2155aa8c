# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of volumes, for people to read on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..core.base.errors import counted
from ..core.ensembles import (
    PERCENTILES,
    Ensemble,
    borehole_samples,
    grid_samples,
    hole_samples,
    section_samples,
)
from ..core.exporters import SAMPLES
from ..core.results.model_holes import HoleAxis
from ..core.results.samples import Samples
from ..core.results.volumes import Erosion
from .cuts import BoreholeRequest, SectionRequest, borehole_request, fence_request, section_request

_HEADINGS = ("block", "property", "rock", "volume", "share", "cells", "components", "largest")
_HEADINGS_OF_EROSION = ("eroded", "surface eroded")
_HEADING_OF_BODIES = "taken"
_NUMBERS_FROM = 3


def volume_table(model, erosion: Erosion | None = None) -> str:
    """A line for each block, youngest first as in the field, and the sum; plain text with aligned columns.

    `largest` is the share of a block's largest connected component, if it has several. With an erosion the
    table has the eroded volume of each block, the volume of all older blocks that the surface above it
    eroded, and the volume of the block that bodies replaced.
    """
    headings = _HEADINGS if erosion is None else (*_HEADINGS, *_HEADINGS_OF_EROSION)
    with_bodies = erosion is not None and len(erosion.taken) > 0
    if with_bodies:
        headings = (*headings, _HEADING_OF_BODIES)
    rows = []
    for number, block in reversed(list(enumerate(model.blocks))):
        parts = model.component_volumes[number]
        row = [*_row(model, block), _share(parts[0], block.volume) if len(parts) > 1 else ""]
        if erosion is not None:
            row += [_figure(erosion.by_block[number]), _figure(erosion.by_surface[block.surface])]
        if with_bodies:
            row.append(_figure(erosion.taken[:, number].sum()))
        rows.append(row)
    sums = [*_sums(model), ""]
    if erosion is not None:
        sums += [_figure(erosion.total)] * 2
    if with_bodies:
        sums.append(_figure(erosion.taken.sum()))
    return _table(headings, rows, sums)


_HEADINGS_OF_SURFACES = (
    "surface",
    "rock",
    "method",
    "points",
    "vertices",
    "lowest",
    "highest",
    "max deviation",
    "beyond points",
)


def surface_table(surfaces) -> str:
    """A line for each fault and body, then for each interface, youngest first. `max deviation` is the largest
    standard deviation of a height where the method gives one, `beyond points` the share of the vertices
    outside the hull of the points."""
    rows = []
    rocks = [entry.rock.name for entry in surfaces.rock_inputs for _ in entry.surfaces]
    inputs = [surface for entry in surfaces.rock_inputs for surface in entry.rock.surfaces]
    for number, kind in enumerate(surfaces.surface_kind[len(inputs) :].tolist(), len(inputs)):
        heights = surfaces.surface(number)[0][:, 2]
        shape = [f"{len(heights)}", f"{heights.min():.7g}", f"{heights.max():.7g}"]
        rows.append([surfaces.surface_names[number], "", ("fault", "body")[kind - 1], "", *shape, "", ""])
    for number in reversed(range(len(inputs))):
        result = surfaces.interpolations[number]
        attributes = surfaces.surface_attributes(number)
        variances = attributes["variance"][np.isfinite(attributes["variance"])]
        rows.append(
            [
                surfaces.surface_names[number],
                rocks[number],
                result.method if result else "ready mesh",
                f"{len(inputs[number].points)}" if result else "",
                f"{len(attributes['height'])}",
                f"{attributes['height'].min():.7g}",
                f"{attributes['height'].max():.7g}",
                f"{variances.max() ** 0.5:.3g}" if len(variances) else "",
                f"{100 * result.extrapolated:.3g} %" if result else "",
            ]
        )
    return _table(_HEADINGS_OF_SURFACES, rows)


_HEADINGS_OF_ENSEMBLE = ("block", "property", "rock", "interpolated", "mean", "deviation")


def ensemble_table(ensemble) -> str:
    """A line for each block, youngest first: its volume with the interpolated heights, and of the volumes of
    all realizations the mean, the standard deviation and percentiles."""
    headings = (*_HEADINGS_OF_ENSEMBLE, *(f"P{percent}" for percent in PERCENTILES))
    percentiles, deviations = ensemble.percentiles(), ensemble.volume_deviations()
    library = ensemble.model.project.library
    rows = []
    for number, block in reversed(list(enumerate(ensemble.model.blocks))):
        drawn = ensemble.volumes[:, number]
        figures = (block.volume, drawn.mean(), deviations[number], *percentiles[:, number])
        rows.append(
            [
                block.name,
                _property(library, block),
                ensemble.model.project.rocks[block.rock].name,
                *map(_figure, figures),
            ]
        )
    return _table(headings, rows)


_HEADINGS_OF_HOLES = ("hole", "rock", "length", "right", "contacts", "largest error")
_MOST_HOLES = 20  # in the table; the report has all


def left_out_table(found) -> str:
    """A line for each hole that was left out, those with the smallest shares of their length in the right
    block first."""
    order = sorted(found.holes, key=lambda hole: 2.0 if hole.share is None else hole.share)
    rows = []
    for hole in order[:_MOST_HOLES]:
        errors = hole.errors
        worst = f"{errors[np.abs(errors).argmax()]:+.4g}" if len(errors) else ""
        right = "" if hole.share is None else f"{100 * hole.share:.1f} %"
        length = f"{hole.length:.6g}" if hole.length else ""
        rows.append([hole.hole, hole.rock, length, right, f"{len(hole.contacts)}", worst])
    return _table(_HEADINGS_OF_HOLES, rows)


def tiles_table(model) -> str:
    """A line for each block of a model in tiles, youngest first, and the sum; then the tiles."""
    rows = [_row(model, block) for block in reversed(model.blocks)]
    sums = _sums(model)
    summary = (
        f"{counted(len(model.tiles), 'tile')}, each validated; {model.patches} patches on their borders, "
    )
    summary += "equal on both sides"
    if model.unequal:
        summary += f" but for {model.unequal}"
    return f"{_table(_HEADINGS[: len(sums)], rows, sums)}\n{summary}"


def _table(headings, rows, sums=None) -> str:
    """Aligned columns, and below a rule the sums where there are any."""
    below = [] if sums is None else [sums]
    widths = [max(len(row[i]) for row in (headings, *rows, *below)) for i in range(len(headings))]
    rule = "-" * (sum(widths) + 2 * (len(widths) - 1))
    lines = [_line(headings, widths), rule, *(_line(row, widths) for row in rows)]
    lines += [line for row in below for line in (rule, _line(row, widths))]
    return "\n".join(lines)


def _row(model, block) -> list[str]:
    """The row of a block, of a model or of one in tiles."""
    return [
        block.name,
        _property(model.project.library, block),
        model.project.rocks[block.rock].name,
        _figure(block.volume),
        _share(block.volume, model.volume),
        f"{block.cells}",
        f"{block.components}",
    ]


def _sums(model) -> list[str]:
    total, blocks = model.volume, model.blocks
    counts = sum(block.cells for block in blocks), sum(block.components for block in blocks)
    return ["total", "", "", _figure(total), _share(total, total), *map(str, counts)]


def _property(library, block) -> str:
    entry = library.get(block.property) if library else None
    return entry.name if entry else str(block.property) if block.property else "none"


def _share(part: float, whole: float) -> str:
    return f"{100 * part / whole if whole else 0:.2f} %"


def _figure(volume: float) -> str:
    """Seven significant digits, without an exponent where that can be read; "-" where it is not known."""
    if volume != volume:
        return "-"
    if volume and not 1e-3 <= abs(volume) < 1e12:
        return f"{volume:.6e}"
    digits = max(0, 6 - len(str(int(abs(volume)))) + 1) if volume else 0
    return f"{volume:.{min(digits, 6)}f}"


def _line(row, widths) -> str:
    entries = [
        text.ljust(width) if column < _NUMBERS_FROM else text.rjust(width)
        for column, (text, width) in enumerate(zip(row, widths, strict=True))
    ]
    return "  ".join(entries).rstrip()


@dataclass
class ProbabilityRequests:
    """The requested files. size: of cells."""

    made: list[SectionRequest | BoreholeRequest | GridRequest]
    size: Sequence[float] | None
    exaggeration: float
    _samples: list[Samples] = field(default_factory=list)

    @classmethod
    def of(cls, options) -> ProbabilityRequests:
        """Raises UsageError."""
        return cls(
            [
                *(section_request(text, SAMPLES["section"]) for text in options.section),
                *(fence_request(text, SAMPLES["section"]) for text in options.fence),
                *(borehole_request(text, SAMPLES["borehole"]) for text in options.borehole),
                *(GridRequest(path) for path in options.export),
            ],
            options.cell_size,
            options.exaggeration,
        )

    def places(self, model) -> np.ndarray:
        """(N, 3) where the ensemble is to be asked. Raises UsageError."""
        self._samples = [self._sampled(model, request) for request in self.made]
        return np.concatenate([np.zeros((0, 3)), *(samples.places for samples in self._samples)])

    def _sampled(self, model, request) -> Samples:
        if isinstance(request, BoreholeRequest):
            height = None if self.size is None else self.size[-1]
            if isinstance(request.what, HoleAxis):
                return hole_samples(model, request.what, height)
            return borehole_samples(model, *request.what, height)
        if isinstance(request, GridRequest):
            return grid_samples(model, self.size)
        return section_samples(model, request.cut(model), self.size)

    def write(self, found: Ensemble, outputs) -> None:
        """Stages all files."""
        begin = 0
        for request, samples in zip(self.made, self._samples, strict=True):
            end = begin + len(samples.places)
            asked = samples, found.at(begin, end)
            request.exporter.write(asked, request.file, outputs, exaggeration=self.exaggeration)
            begin = end


@dataclass
class GridRequest:
    """The cells of a regular grid, and their file."""

    file: Path
    exporter = SAMPLES["grid"]

    def __post_init__(self):
        self.exporter.format(self.file)
        self.outputs, self.inputs = [self.file], []

    def read(self) -> None:
        pass
