# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimate of a build: compared with the build itself, and refusals."""

import re

import numpy as np
import pytest
from conftest import ROOT, grid_surface
from folded_rocks import dome, folded
from realmodel.core import (
    BuildFailed,
    Cancelled,
    Fault,
    InputRefused,
    NotEnoughMemory,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    estimate,
    load_project,
)
from realmodel.core.model.estimate import BYTES_OF_ANY, memory_text
from test_slits import leaning


def jittered(random, n):
    """A square surface of 2 n^2 triangles on places of its own; waves that cross those of others."""
    vertices, triangles = grid_surface(n, lambda x, y: 0 * x)
    inside = ((vertices[:, :2] > 0) & (vertices[:, :2] < 1)).all(axis=1)
    vertices[inside, :2] += random.uniform(-0.2 / n, 0.2 / n, (inside.sum(), 2))
    p, q = random.uniform(0, 6, 2)
    vertices[:, 2] = 0.1 * np.sin(3 * vertices[:, 0] + p) * np.cos(4 * vertices[:, 1] + q)
    return vertices, triangles


def waves(count=5, n=50, step=0.05, own=True, **rock):
    """Surfaces of 2 n^2 triangles."""
    random = np.random.default_rng(3)
    surfaces = []
    for number in range(count):
        vertices, triangles = jittered(random, n)
        if not own:
            vertices[:, :2] = grid_surface(n, lambda x, y: 0 * x)[0][:, :2]
        surfaces.append(Surface(f"S{number}", vertices + np.array([0, 0, step * number]), triangles))
    return Project("waves", [Rock("rock", surfaces, **rock)])


def of_points(**rock):
    random = np.random.default_rng(5)
    x, y = random.uniform(0, 1, (2, 300))
    surfaces = [
        Surface(f"S{k}", points=np.column_stack([x, y, 0.05 * k + 0.1 * np.sin(3 * x)]), method="idw")
        for k in range(4)
    ]
    region = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    return Project("points", [Rock("rock", surfaces, region=region, edge_length=0.05, **rock)])


@pytest.mark.parametrize("make", [waves, lambda: waves(own=False), of_points])
def test_triangles_are_those_of_the_build_and_memory_holds_its_arrays(make):
    project = make()
    for cells in ("columns", "blocks"):
        estimated, model = estimate(project, cells), build(project, cells)
        assert estimated.triangles == len(model.surface_triangles)
        arrays = (model.vertices, model.face_offsets, model.face_vertices, model.face_cells)
        assert estimated.memory >= sum(array.nbytes for array in arrays)
        assert estimated.fits
        assert estimated.seconds > 0


def test_one_plan_mesh_and_whole_blocks_take_less_memory():
    own, shared = waves(), waves(own=False)
    assert estimate(shared).memory < estimate(own).memory
    assert estimate(own, "blocks").memory < estimate(own).memory


def test_a_stage_is_estimated_as_a_stage():
    project = waves(4, 20)
    assert estimate(project, stage=1).triangles == 2 * estimate(waves(1, 20)).triangles
    with pytest.raises(UsageError, match="stage 9"):
        estimate(project, stage=9)


def test_a_build_that_would_not_fit_is_refused_before_it_begins():
    project = waves()
    memory = estimate(project).memory
    limit = round(0.8 * memory)
    with pytest.raises(NotEnoughMemory) as refused:
        build(project, memory=limit)
    error = refused.value
    assert isinstance(error, BuildFailed)
    assert (error.available, error.needed) == (limit, memory)
    assert f"{memory_text(limit)} are allowed" in str(error)
    assert "triangles in all instead of 25,000" in error.advice
    assert 'cells="blocks"' in error.advice
    assert "\n" not in str(error)
    with pytest.raises(NotEnoughMemory) as refused:
        build(project, memory=limit // 20)
    assert "blocks" not in refused.value.advice
    assert build(project, memory=memory).volume > 0


def a_quarter_of(memory):
    """Of the memory that depends on the model."""
    return BYTES_OF_ANY + (memory - BYTES_OF_ANY) // 4


def test_a_longer_edge_is_proposed_where_a_region_is_meshed():
    with pytest.raises(NotEnoughMemory, match=r"or an edge length 2\.1 times as long"):
        build(of_points(), memory=a_quarter_of(estimate(of_points()).memory))


@pytest.mark.parametrize("memory", [0, -5, True, 2.5, "lots"])
def test_a_limit_that_is_none_is_refused(memory):
    with pytest.raises(UsageError, match="memory"):
        build(waves(2, 4), memory=memory)


def test_what_cannot_be_read_is_refused_as_the_build_refuses_it():
    project = waves(2, 10)
    project.rocks[0].surfaces[1].vertices[0, 2] = np.nan
    with pytest.raises(InputRefused, match="surface 'S1'"):
        estimate(project)


@pytest.mark.parametrize("faults", [0, 1])
def test_level_sets_of_fields(faults):
    """Some triangles more or less, and the memory of the dense arrays at least."""
    given = [Fault("F", *leaning((-2.0, 12.0)), youngest="fii")][:faults]
    project = folded(dome, (3.0, 4.5, 6.0), faults=given)
    estimated, model = estimate(project, "blocks"), build(project, cells="blocks")
    fields = list(model.rock_inputs[0].fields[0].distinct())
    assert estimated.lattice_nodes == fields[0].lattice.nodes
    assert 0.4 < estimated.triangles / len(model.surface_triangles) < 3
    assert estimated.memory > 10 * model.vertices.nbytes
    assert f"nodes of lattices             {estimated.lattice_nodes:,}\n" in estimated.table()
    with pytest.raises(NotEnoughMemory, match="or a resolution of series 2"):
        build(project, memory=a_quarter_of(estimate(project).memory))


def test_nodes_of_fields_count_on_each_combination_of_sides():
    """Three faults: four times as many level sets, and seven combinations."""
    sheets = [leaning((-2.0, 12.0)) for _ in range(3)]
    given = [Fault(f"F{n}", *sheet, youngest="f") for n, sheet in enumerate(sheets)]
    plain, faulted = (estimate(folded(dome, (4.5,), faults=faults), "blocks") for faults in ([], given))
    assert faulted.lattice_nodes == plain.lattice_nodes
    values_and_numbers, coordinates_and_sides = 8 + 8, 3 * (8 + 1)
    least = 7 * plain.lattice_nodes * (values_and_numbers + coordinates_and_sides)
    assert faulted.memory - BYTES_OF_ANY - 4 * (plain.memory - BYTES_OF_ANY) > least


def test_estimating_can_be_cancelled():
    project = of_points()
    project.rocks[0].edge_length = 0.0005  # its mesh takes far longer than a look at cancel()
    with pytest.raises(Cancelled):
        estimate(project, cancel=lambda: True)


def test_the_table_reads_well():
    table = estimate(waves(3, 20)).table()
    assert "triangles of all surfaces      2,400\n" in table
    assert "memory while building columns  at most 12 MB\n" in table
    assert re.search(r"^time {27}about [\d.]+ s$", table, re.MULTILINE)


@pytest.mark.parametrize("make", [waves, of_points, lambda: of_points(base_elevation=-1.0)])
def test_the_progress_of_a_build_rises_to_1_through_all_its_phases(make):
    calls = []
    build(make(), progress=lambda share, text: calls.append((share, text)))
    shares = [share for share, _ in calls]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert calls[-1][1] == "assembling the model"


# MB that the process grew by at its peak (VmHWM), in columns and in blocks, on two threads
MEASURED = {
    "block_diagram": (40, 26),
    "castle_hill": (66, 51),
    "fault_blocks": (47, 34),
    "faulted_dome": (254, 102),
    "gravel_plain": (11, 9),
    "haut_barr": (42, 41),
    "intrusion": (79, 40),
    "mapped_valley": (16, 10),
    "quarry": (38, 27),
    "recumbent_fold": (333, 90),
    "rift_basin": (78, 52),
    "sculpted_island": (62, 39),
    "tunnel": (17, 15),
    "two_layers": (4, 4),
    "uncertain_valley": (14, 11),
}


@pytest.mark.parametrize("sample", MEASURED)
def test_no_sample_took_more_than_the_bound(sample):
    project = load_project(ROOT / "blend_samples" / sample / "project.toml")
    for cells, took in zip(("columns", "blocks"), MEASURED[sample], strict=True):
        assert estimate(project, cells).memory > took * 1e6
