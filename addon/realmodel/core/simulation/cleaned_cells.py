# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact cells without details too small for solvers: Model.cleaned_cells."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..base.algebra import is_number
from ..base.errors import BuildWarning, InputRefused, UsageError
from ..base.work import Cancel, Progress, Work, native_module, run
from ..cells.model_data import ModelData
from ..settings.method_options import check_threads
from .volume_mesh import PolyhedralMesh, changed_volumes, model_arrays


@dataclass(frozen=True, eq=False, repr=False)
class CleanedCells(PolyhedralMesh):
    """Polyhedra, and the changes from the exact cells.

    tolerance, largest_move: model units; the largest move of a vertex. removed: how many "edges", "faces",
    "cells" are gone; left: how many "short_edges" and "thin_cells" had to stay. volumes, exact_volumes: (B,)
    float64, of the blocks after and before, model units cubed. warnings: blocks whose volume changed by more
    than a tenth. block_names, block_property (ids of the library, 0: none), surface_names, surface_kind: as
    of the model, whose numbers blocks and surfaces keep.
    """

    tolerance: float = 0.0
    largest_move: float = 0.0
    removed: dict[str, int] = field(default_factory=dict)
    left: dict[str, int] = field(default_factory=dict)
    volumes: np.ndarray = field(default_factory=lambda: np.empty(0))
    exact_volumes: np.ndarray = field(default_factory=lambda: np.empty(0))
    warnings: list[BuildWarning] = field(default_factory=list)


def cleaned_cells(
    model: ModelData,
    tolerance: float,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> CleanedCells:
    """The model's cells without edges shorter and faces and cells thinner than `tolerance`.

    tolerance: model units. The ends of short edges become one vertex; of a thin face a vertex and the edge
    across from it come together; a thin cell joins the neighbor that it has the largest face with, of its
    own block if that is nearly as large. A step is done only where all cells around stay closed and
    connected, with a positive volume, and no face turns over: what is left for this reason is counted in
    `left`. No vertex moves farther than the tolerance. The same input gives the same mesh.

    Raises UsageError, InputRefused where there are no cells or none is left, Cancelled.
    """
    threads = check_threads(threads)
    if not is_number(tolerance) or tolerance <= 0:
        raise UsageError(f"tolerance must be a finite number above 0, not {tolerance!r}")
    if not len(model.cell_block):
        raise InputRefused("the model has no cells", advice="its surfaces enclose no block")

    def task(work: Work) -> CleanedCells:
        with work.phase(0.0, 1.0, "cleaning cells"):
            made = work.native(
                native_module().clean_cells,
                model_arrays(model),
                len(model.blocks),
                model.surface_kind,
                float(tolerance),
            )
        if not len(made["cell_block"]):
            raise InputRefused(
                f"all cells are thinner than the tolerance of {tolerance:g}", advice="use a smaller tolerance"
            )
        return _assembled(model, float(tolerance), made)

    return run(task, progress, cancel, threads=threads)


def _assembled(model: ModelData, tolerance: float, made: dict) -> CleanedCells:
    exact = PolyhedralMesh.of_model(model)
    assert exact.cell_compartment is not None  # that of a model has them
    return CleanedCells(
        points=made["vertices"],
        face_offsets=made["face_offsets"],
        face_vertices=made["face_vertices"],
        face_cells=made["face_cells"],
        face_surface=made["face_surface"],
        cell_block=made["cell_block"],
        block_names=exact.block_names,
        block_property=exact.block_property,
        surface_names=exact.surface_names,
        surface_kind=exact.surface_kind,
        cell_compartment=exact.cell_compartment[made["cell_origin"]],
        tolerance=tolerance,
        largest_move=made["largest_move"],
        removed={what: count - made["after"][what] for what, count in made["before"].items()},
        left={what: made[what] for what in ("short_edges", "thin_cells")},
        volumes=made["volumes"],
        exact_volumes=made["volumes_before"],
        warnings=changed_volumes(model, made["volumes"], "a smaller tolerance changes less"),
    )


def cleaned_entry(cells: CleanedCells) -> dict:
    """The entry of cleaned cells in the report: lengths and volumes are in model units."""
    return {
        "tolerance": cells.tolerance,
        "cells": cells.cells,
        "removed": cells.removed,
        "left": cells.left,
        "largest_move": cells.largest_move,
        "blocks": [
            {"block": name, "volume": float(volume), "exact_volume": float(exact)}
            for name, volume, exact in zip(cells.block_names, cells.volumes, cells.exact_volumes, strict=True)
        ],
    }
