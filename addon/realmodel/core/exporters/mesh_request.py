# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests for meshes for simulation, of the command line and the panel, and their printed lines."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..base.atomic import Outputs
from ..base.work import Reporter
from ..cells.model_data import ModelData
from ..simulation.cleaned_cells import CleanedCells
from ..simulation.simulation_mesh import SimulationMesh, mesh_entry, simulation_mesh
from . import MESH

EDGES_ACROSS = 50  # of the model, where no edge length is given
EDGE_OVER_THICKNESS = 10  # where no minimum thickness is given


@dataclass(frozen=True)
class MeshRequest:
    """The options of a mesh for simulation. edge, thickness: None: by the size of the model, and by the edge
    length."""

    path: Path
    edge: float | None = None
    thickness: float | None = None
    layers: int | None = None
    layer_thickness: float | None = None
    elements: str = "prisms"
    exporter = MESH

    @property
    def outputs(self) -> list[Path]:
        return [self.path]

    def make(self, model: ModelData, threads: int, progress: Reporter | None = None) -> SimulationMesh:
        """The mesh. Raises as Model.simulation_mesh. Without progress it is a part of the present job."""
        extent = np.ptp(model.vertices[:, :2], axis=0) if len(model.vertices) else np.zeros(2)
        edge = float(extent.max()) / EDGES_ACROSS if self.edge is None else self.edge
        return simulation_mesh(
            model,
            edge,
            edge / EDGE_OVER_THICKNESS if self.thickness is None else self.thickness,
            layers=self.layers,
            elements=self.elements,
            layer_thickness=self.layer_thickness,
            threads=threads,
            progress=progress and (lambda _share, text: progress(1.0, text)),
        )

    def write(self, mesh: SimulationMesh, outputs: Outputs, unit: str, progress: Reporter) -> None:
        """Writes the mesh in the format of its file's ending."""
        MESH.write(mesh, self.path, outputs, lambda _: progress(1.0, f"writing {self.path.name}"), unit=unit)

    def line(self, mesh: SimulationMesh) -> str:
        """The printed line about the mesh."""
        entry = mesh_entry(mesh)
        counts = ", ".join(f"{count:,} {kind}s" for kind, count in entry["elements"].items())
        counts = counts.replace("tetrahedrons", "tetrahedra")
        angle = (
            "" if mesh.smallest_angle is None else f", angles of {mesh.smallest_angle:.2g} degrees and more"
        )
        return f"{self.path}: {counts or 'no elements'}{angle}; {_change_text(mesh)}"


def cleaned_line(cells: CleanedCells) -> str:
    """The printed line about cells cleaned by --cell-tolerance."""
    removed = ", ".join(f"{count:,} {what}" for what, count in cells.removed.items())
    left = ", ".join(f"{count:,} {what.replace('_', ' ')}" for what, count in cells.left.items() if count)
    return (
        f"cells cleaned to {cells.tolerance:g}: {removed} removed{f', {left} left' if left else ''}; "
        f"{_change_text(cells)}"
    )


def _change_text(mesh: SimulationMesh | CleanedCells) -> str:
    change = mesh.volumes - mesh.exact_volumes
    if not change.any():
        return "all volumes are exact"
    share = np.abs(change) / np.maximum(mesh.exact_volumes, np.finfo(float).tiny)
    most = int(np.where(mesh.exact_volumes > 0, share, 0).argmax())
    return (
        f"volumes differ from the exact ones by {100 * share[most]:.2g} % at most "
        f"({mesh.block_names[most]}), together by {100 * abs(change.sum()) / mesh.exact_volumes.sum():.2g} %"
    )
