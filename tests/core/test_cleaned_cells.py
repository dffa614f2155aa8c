# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact cells cleaned: closed, conforming and of positive volume; nothing moves beyond the tolerance."""

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Body,
    Cancelled,
    Fault,
    InputRefused,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.simulation import PolyhedralMesh
from sample_scripts import built_sample
from solvers import foam_program, run_foam
from stacks.generate import random_stack
from stacks.model_view import rocks_of
from stacks.project_files import stack_project
from stacks.rock_masses import random_rock_masses
from structure_cases import box_body, plane_fault

SAMPLES = Path(__file__).parents[2] / "blend_samples"
SQUARE = [[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0]]

foam_only = pytest.mark.skipif(
    foam_program("checkMesh") is None,
    reason="OpenFOAM is absent: scripts/install_dependencies.sh solvers",
)


def plane(name, height, **more):
    heights = np.broadcast_to(np.asarray(height, float), 4)
    vertices = np.column_stack([np.asarray(SQUARE), heights])
    return Surface(name=name, vertices=vertices, triangles=[[0, 1, 2], [0, 2, 3]], **more)


def loops(mesh):
    return np.split(mesh.face_vertices, mesh.face_offsets[1:-1])


def edge_set(mesh):
    sizes = np.diff(mesh.face_offsets)
    following = np.arange(1, len(mesh.face_vertices) + 1)
    following[mesh.face_offsets[1:] - 1] = mesh.face_offsets[:-1]
    pairs = np.sort(np.column_stack([mesh.face_vertices, mesh.face_vertices[following]]), axis=1)
    return np.unique(pairs, axis=0), sizes


def cell_volumes(points, mesh):
    """Of each cell, by the triangles between the edges and the mean corner of each face."""
    volumes = np.zeros(len(mesh.cell_block))
    for loop, (first, second) in zip(loops(mesh), mesh.face_cells.tolist(), strict=True):
        corners = points[loop] - points[mesh.face_vertices[0]]
        middle = corners.mean(axis=0)
        parts = np.cross(corners - middle, np.roll(corners, -1, axis=0) - middle) / 2
        weights = np.linalg.norm(parts, axis=1)
        centers = (corners + np.roll(corners, -1, axis=0) + middle) / 3
        center = weights @ centers / weights.sum() if weights.sum() else middle
        share = parts.sum(axis=0) @ center / 3
        volumes[first] += share
        if second >= 0:
            volumes[second] -= share
    return volumes


def check_complex(mesh):
    """Closed cells without doubled edges, faces of different corners, two cells to a face; one outside."""
    assert mesh.face_cells[:, 0].min() >= 0
    assert (mesh.face_cells[:, 0] != mesh.face_cells[:, 1]).all()
    used = np.unique(mesh.face_cells[mesh.face_cells >= 0])
    assert np.array_equal(used, np.arange(len(mesh.cell_block)))
    directed, rings = Counter(), Counter()
    for loop, (first, second) in zip(loops(mesh), mesh.face_cells.tolist(), strict=True):
        corners = loop.tolist()
        assert len(set(corners)) == len(corners) >= 3
        rings[tuple(sorted(corners))] += 1
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            directed[first, a, b] += 1
            directed[second, b, a] += 1
    assert max(rings.values()) == 1
    for (cell, a, b), count in directed.items():
        assert directed.get((cell, b, a), 0) == count
    return sum(count - 1 for count in directed.values())


def check_cleaned(model, cells):
    assert check_complex(cells) <= check_complex(model_mesh(model))
    assert np.array_equal(np.unique(cells.face_vertices), np.arange(len(cells.points)))
    where = {tuple(p): i for i, p in enumerate(model.vertices.tolist())}
    assert all(tuple(p) in where for p in cells.points.tolist())
    assert cells.largest_move <= cells.tolerance
    before, after = edge_set(model_mesh(model)), edge_set(cells)
    assert cells.removed == {
        "edges": len(before[0]) - len(after[0]),
        "faces": len(model.face_cells) - len(cells.face_cells),
        "cells": len(model.cell_block) - len(cells.cell_block),
    }
    lengths = np.linalg.norm(cells.points[after[0][:, 0]] - cells.points[after[0][:, 1]], axis=1)
    assert (lengths < cells.tolerance).sum() == cells.left["short_edges"]
    volumes = cell_volumes(cells.points, cells)
    of_block = np.bincount(cells.cell_block, volumes, len(model.blocks))
    size = np.prod(np.ptp(model.vertices, axis=0))
    assert cells.volumes == pytest.approx(of_block, rel=1e-9, abs=1e-12 * size)
    return volumes


def model_mesh(model):
    return PolyhedralMesh.of_model(model)


def two_planes(bottom, top, **more):
    return build(Project(name="p", rocks=[Rock(name="r", surfaces=[plane("S0", bottom), *top], **more)]))


def test_a_thin_end_of_a_layer_collapses():
    """A wedge from 0.2 to 6 m between two layers: its thin side becomes an edge, the layers above and below
    meet there."""
    model = two_planes(0.0, [plane("S1", 5.0), plane("S2", [5.2, 11, 11, 5.2]), plane("S3", 20.0)])
    cells = model.cleaned_cells(0.5)
    volumes = check_cleaned(model, cells)
    assert volumes.min() > 0
    heights = cells.points[:, 2][cells.points[:, 0] == 0.0]
    assert sorted(np.unique(heights)) in ([0.0, 5.0, 20.0], [0.0, 5.2, 20.0])
    # a prism of triangles now, 100 x 60 x 5.8 / 2 or 6 / 2
    assert cells.volumes[1] in (pytest.approx(17_400.0), pytest.approx(18_000.0))
    assert cells.volumes.sum() == pytest.approx(120_000.0)
    assert cells.left == {"short_edges": 0, "thin_cells": 0}


def test_a_thin_layer_vanishes():
    model = two_planes(0.0, [plane("S1", 5.0), plane("S2", 5.01), plane("S3", 9.0)])
    cells = model.cleaned_cells(0.05)
    check_cleaned(model, cells)
    assert set(cells.cell_block.tolist()) == {0, 2}
    assert cells.volumes.sum() == pytest.approx(54_000.0)
    assert cells.volumes[1] == 0
    assert [warning.kind for warning in cells.warnings] == ["mesh_volume"]
    assert "has a volume of 0 in the mesh" in str(cells.warnings[0])
    # what lies between the two layers is one surface, and the outside is where it was
    between = (cells.face_cells >= 0).all(axis=1)
    blocks = np.sort(cells.cell_block[cells.face_cells[between]], axis=1)
    assert (cells.face_surface[between][blocks[:, 0] != blocks[:, 1]] == 2).all()
    assert np.ptp(cells.points, axis=0).tolist() == [100.0, 60.0, 9.0]


def test_nothing_to_clean_changes_nothing():
    model = two_planes(0.0, [plane("S1", 5.0)])
    cells = model.cleaned_cells(0.1)
    assert cells.removed == {"edges": 0, "faces": 0, "cells": 0}
    assert cells.largest_move == 0
    for name in ("face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block"):
        assert np.array_equal(getattr(cells, name), getattr(model, name))


@settings(
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=60,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
@given(
    st.sampled_from(["partial", "jumps", "regions", "rules", "T-junctions", "coinciding", "rock masses"]),
    st.sampled_from([0.3, 0.03, 0.003]),
    st.sampled_from(["columns", "columns", "blocks"]),
    st.randoms(use_true_random=True),
)
def test_random_stacks(tmp_path_factory, family, size, kind, rng):
    case = random_rock_masses(rng) if family == "rock masses" else random_stack(rng, family)
    path = stack_project(tmp_path_factory.mktemp("stack"), rocks_of(case))
    assume(path is not None)
    model = build(load_project(path), cells=kind)
    assume(len(model.cell_block))
    exact = cell_volumes(model.vertices, model_mesh(model))
    tolerance = 1.00713 * size * float(np.ptp(model.vertices, axis=0).max())  # no length of a lattice
    try:
        cells = model.cleaned_cells(tolerance, threads=1)
    except InputRefused as error:
        assert "all cells are thinner" in str(error)
        return
    volumes = check_cleaned(model, cells)
    if exact.min() > 1e-9 * exact.max():  # of a cell that rounding made flat nobody knows the sign
        assert volumes.min() > 0
    for threads in (2, 3):
        again = model.cleaned_cells(tolerance, threads=threads)
        for name in ("points", "face_offsets", "face_vertices", "face_cells", "face_surface"):
            assert getattr(again, name).tobytes() == getattr(cells, name).tobytes()


def face_area(mesh, surface):
    area = 0.0
    for face in np.flatnonzero(mesh.face_surface == surface):
        corners = mesh.points[mesh.face_vertices[mesh.face_offsets[face] : mesh.face_offsets[face + 1]]]
        spans = corners[1:] - corners[0]
        area += np.linalg.norm(np.cross(spans[:-1], spans[1:]).sum(axis=0)) / 2
    return area


@pytest.mark.parametrize("kind", ["columns", "blocks"])
def test_faults_and_bodies_stay(kind):
    """A leaning fault through waves, and a box in them: their faces keep their area but for the tolerance."""

    def points(lift):
        x, y = np.random.default_rng(1).uniform(0.0, 10.0, (200, 2)).T
        return np.column_stack([x, y, lift + 0.3 * np.sin(x + lift) * np.cos(y)])

    surfaces = [Surface(f"S{k}", points=points(0.7 * k)) for k in range(3)]
    square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]
    model = build(
        Project(
            "p",
            [Rock("r", surfaces, region=square, edge_length=1.0, base_elevation=-3.0)],
            faults=[Fault("F", *plane_fault(lean=0.3))],
            bodies=[Body("B", *box_body((6.0, 2.0, -1.0), (8.0, 4.0, 1.1)))],
        ),
        cells=kind,
    )
    cells = model.cleaned_cells(0.05)
    assert check_cleaned(model, cells).min() > 0
    assert cells.removed["edges"] > 100
    for surface in np.flatnonzero(model.surface_kind).tolist():
        assert face_area(cells, surface) == pytest.approx(face_area(model_mesh(model), surface), rel=0.02)
    assert set(np.unique(cells.cell_compartment)) == set(np.unique(model.cell_compartment))
    assert cells.volumes == pytest.approx(cells.exact_volumes, rel=0.02)


def test_a_half_is_cleaned():
    model = two_planes(0.0, [plane("S1", 5.0), plane("S2", 9.0)])
    half = model.cut_by_plane([50.0, 30.0, 5.02], [0.001, 0.0, 1.0]).above
    cells = half.cleaned_cells(0.2)
    assert check_cleaned(half, cells).min() > 0
    assert -3 in cells.face_surface
    assert cells.removed["edges"] > 0


@pytest.fixture(scope="module")
def castle_hill():
    return built_sample("castle_hill")


@foam_only
def test_check_mesh_finds_no_short_edges_and_turned_cells(castle_hill, tmp_path):
    """The exact cells fail nine checks; at 1 m short edges, flat and, but for one or two faces, turned
    cells are gone."""
    castle_hill.save(tmp_path / "m.foam", tolerance=1.0)
    output = run_foam("checkMesh", tmp_path / "m.foam", "-allGeometry", "-allTopology")
    assert "Mesh has 3 solution" in output
    for what in (
        "Open cells",
        "High aspect ratio",
        "negative cell volume",
        "non-orthogonality errors",
        "Edges too small",
    ):
        assert what not in output, output
    turned = re.search(r"face pyramids: (\d+) faces", output)
    assert turned is None or int(turned[1]) <= 2  # of 269,480 faces
    found = re.search(r"small determinant .* number of cells: (\d+)", output)
    assert int(found[1]) < 6000  # of 10,957


def test_it_can_be_stopped(castle_hill):
    with pytest.raises(Cancelled):
        castle_hill.cleaned_cells(2.0, cancel=lambda: True)


@pytest.mark.parametrize("ending", [".vtu", ".foam", ".exo", ".disu"])
def test_all_formats_of_cells(tmp_path, ending):
    model = two_planes(0.0, [plane("S1", 5.0), plane("S2", 5.01), plane("S3", 9.0)])
    exact, clean = tmp_path / f"exact{ending}", tmp_path / f"clean{ending}"
    model.save(exact)
    model.save(clean, tolerance=0.05)
    sizes = [
        sum(file.stat().st_size for file in (path.rglob("*") if path.is_dir() else [path]) if file.is_file())
        for path in (exact, clean)
    ]
    assert 0 < sizes[1] < sizes[0]


def test_wrong_usage(tmp_path):
    model = two_planes(0.0, [plane("S1", 5.0)])
    for wrong in (0, -1, float("nan"), float("inf"), "1", None, True):
        with pytest.raises(UsageError, match="tolerance must be a finite number above 0"):
            model.cleaned_cells(wrong)
    with pytest.raises(UsageError, match="has no polyhedral cells"):
        model.save(tmp_path / "m.obj", tolerance=1.0)
    assert not any(tmp_path.iterdir())
    with pytest.raises(InputRefused, match="all cells are thinner"):
        model.cleaned_cells(200.0)
