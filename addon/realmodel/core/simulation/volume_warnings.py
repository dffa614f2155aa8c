# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about blocks whose volume a mesh changes."""

from __future__ import annotations

import numpy as np

from ..base.build_warning import BuildWarning
from ..cells.model_data import ModelData

_MOST_CHANGE = 0.1  # of a block's volume, without a warning


def changed_volumes(model: ModelData, volumes: np.ndarray, advice: str) -> list[BuildWarning]:
    """A warning for each block whose volume in a mesh, (B,), differs by more than a tenth."""
    return [
        BuildWarning(
            f"block '{block.name}' has a volume of {volume:.6g} in the mesh, and of {block.volume:.6g} in "
            f"the model; {advice}",
            "mesh_volume",
            model.rock_inputs[block.rock].rock.name,
        )
        for block, volume in zip(model.blocks, volumes, strict=True)
        if abs(volume - block.volume) > _MOST_CHANGE * block.volume
    ]
