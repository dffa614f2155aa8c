# SPDX-License-Identifier: GPL-3.0-or-later
"""--section, --fence, --borehole and --export together with --ensemble: files with the probability of each
block along them, or on a regular grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..core.ensembles import (
    Ensemble,
    borehole_samples,
    grid_samples,
    hole_samples,
    section_samples,
)
from ..core.exporters import SAMPLES
from ..core.results.planned_holes import HoleAxis
from ..core.results.samples import Samples
from .cuts import BoreholeRequest, SectionRequest, borehole_request, fence_request, section_request


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
