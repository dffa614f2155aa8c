# SPDX-License-Identifier: GPL-3.0-or-later
"""The juxtaposition of the blocks on both sides of a fault of a model."""

from __future__ import annotations

from pathlib import Path

from ..base.errors import UsageError
from ..base.named import number_of
from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..exporters import JUXTAPOSITION
from ..results.displacements import displacements
from ..results.faults.juxtaposition import (
    CutoffLine,
    JuxtapositionData,
    cutoff_lines,
    dip_direction,
    fault_faces,
)
from ..results.faults.strike_line import StrikeLine
from .cutting import section_arrays


class Juxtaposition(JuxtapositionData):
    """What lies on both sides of a fault."""

    def save(self, path: str | Path, exaggeration: float = 1.0) -> None:
        """Draws the juxtaposition diagram, with the throws of the surfaces below, to a .svg, .pdf, .dxf or
        .png. It appears whole or not at all. exaggeration: of elevations. Raises UsageError, OutputFailed."""
        JUXTAPOSITION.save(self, path, exaggeration=exaggeration)


def juxtaposition(model: ModelData, fault: int | str) -> Juxtaposition:
    """What lies on both sides of a fault: polygons of pairs of blocks with their areas, the cutoff lines of
    the surfaces that it displaces, and their throws.

    fault: its name, or its number among the faults from 0. Raises UsageError for an unknown one, and for one
    of which nothing is in the model; InputRefused for a model without its project.
    """
    model.require_project("a juxtaposition diagram")
    structures = model.structures
    number = number_of(fault, [entry.name for entry in structures.faults], "fault")
    name, shape = structures.faults[number].name, structures.fault_shapes()[number]
    throws = displacements(model, name)
    displaced = {entry.surface for entry in throws}
    surfaces = [k for k, other in enumerate(model.surface_names) if other in displaced]
    surfaces = [k for k in surfaces if model.surface_kind[k] == 0]

    def task(work: Work) -> tuple[dict, list[CutoffLine]]:
        faces, arrays = fault_faces(work, model, number)
        return arrays, cutoff_lines(work, model, faces, number, surfaces)

    arrays, cutoffs = run(task, threads=model.threads)
    if not len(arrays["cells"]):
        raise UsageError(f"nothing of fault '{name}' is in the model")
    return Juxtaposition(
        **section_arrays(model, arrays),
        fault=name,
        strike=StrikeLine.of(shape.vertices, shape.triangles, arrays["vertices"], dip_direction(arrays)),
        cutoffs=cutoffs,
        throws=throws,
    )
