# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that nobody here made: claudius, drogon, pleasant, shellmound; their models pass the check."""

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import build, load_project
from stacks import places, project_files, real_data

pytestmark = [
    pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT),
    pytest.mark.skipif(not places.CHECK.is_dir(), reason=places.CHECK_ABSENT),
]


def built_and_checked(project_path, cells):
    """The model of a project file, saved and passed by check_model.py run from the command line."""
    model = build(load_project(project_path), cells=cells)
    exported = project_path.with_name(f"{cells}.npz")
    model.save(exported)
    check = subprocess.run(
        [sys.executable, places.CHECK / "check_model.py", project_path, exported],
        capture_output=True,
        text=True,
        check=False,
    )
    assert check.returncode == 0, check.stdout + check.stderr
    return model


def test_claudius_on_one_mesh(tmp_path):
    points = real_data.claudius_points()
    assert [len(p) for p in points.values()] == [5219, 5268, 5277, 5259]
    path = project_files.points_project(tmp_path, "claudius", points, real_data.CLAUDIUS_REGION, 150.0)
    model = built_and_checked(path, "blocks")
    assert len(model.blocks) == 3
    assert all(block.volume > 0 for block in model.blocks)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_claudius_on_a_mesh_for_each_horizon(tmp_path, cells):
    path = project_files.mesh_project(tmp_path, "claudius", real_data.claudius_on_own_meshes(150.0))
    model = built_and_checked(path, cells)
    assert len(model.blocks) == 3
    assert all(block.volume > 0 for block in model.blocks)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_claudius_on_meshes_of_one_outline(tmp_path, cells):
    """Each mesh has its own vertices along the outline, beside its lines by rounding: no slivers there."""
    meshes = real_data.claudius_on_own_meshes(150.0, real_data.claudius_outline())
    model = built_and_checked(project_files.mesh_project(tmp_path, "claudius", meshes), cells)
    assert [block.components for block in model.blocks] == [1, 1, 1]


def test_drogon_pinches_out_exactly(tmp_path):
    """Volumes equal the sums over the grid's own triangles: the horizons meet but never cross."""
    meshes = real_data.drogon()
    vertices = [v for v, _ in meshes.values()]
    triangles = next(iter(meshes.values()))[1]
    together = [(upper[:, 2] == lower[:, 2]).sum() for lower, upper in pairwise(vertices)]
    assert together == [668, 2169, 166]
    assert all((upper[:, 2] >= lower[:, 2]).all() for lower, upper in pairwise(vertices))

    model = built_and_checked(project_files.mesh_project(tmp_path, "drogon", meshes), "columns")
    corners = vertices[0][triangles][:, :, :2]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    for block, (lower, upper) in zip(model.blocks, pairwise(vertices), strict=True):
        thickness = (upper[:, 2] - lower[:, 2])[triangles].mean(axis=1)
        assert block.volume == pytest.approx((area * thickness).sum(), rel=1e-9)
        assert block.cells == np.count_nonzero(thickness)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_pleasant_thin_layers(tmp_path, cells):
    """Layers clipped to a thickness of 1 m; a base closes the model below."""
    meshes = real_data.pleasant()
    assert all(len(v) == 2940 for v, _ in meshes.values())
    model = built_and_checked(
        project_files.mesh_project(tmp_path, "pleasant", meshes, base_elevation=100.0), cells
    )
    assert len(model.blocks) == 4
    assert all(block.volume > 0 for block in model.blocks)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_shellmound_partial_extent(tmp_path, cells):
    """The youngest unit lies on part of the region only."""
    meshes = real_data.shellmound()
    assert [len(v) for v, _ in meshes.values()] == [503, 503, 503, 503, 145]
    model = built_and_checked(project_files.mesh_project(tmp_path, "shellmound", meshes), cells)
    assert len(model.blocks) == 4
