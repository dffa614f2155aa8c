# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain form of meshes for simulation."""

import numpy as np
from realmodel.core import build, load_project
from realmodel.core.simulation import PolyhedralMesh


def test_a_models_cells_are_a_polyhedral_mesh_without_a_copy():
    model = build(load_project("blend_samples/two_layers/project.toml"))
    mesh = PolyhedralMesh.of_model(model)
    assert mesh.cells == len(model.cell_block)
    assert np.shares_memory(mesh.face_vertices, model.face_vertices)
    assert mesh.block_names == ["Clay", "Sand"]
    assert mesh.surface_names == list(model.surface_names)
