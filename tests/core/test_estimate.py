# SPDX-License-Identifier: GPL-3.0-or-later
"""What a build will take, told before it: counts against the build itself, and refusals."""

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import (
    BuildFailed,
    Cancelled,
    InputRefused,
    NotEnoughMemory,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    estimate,
)
from realmodel.core import sample_windows as sample_windows_module
from realmodel.core.coarse_blocks import coarse_blocks
from realmodel.core.estimate import memory_text, touching_vertices
from realmodel.core.measured_costs import COSTS
from realmodel.core.sample_windows import Window, cut_out, sample_windows, within_rings

FACTOR = 1.5


@pytest.fixture(autouse=True)
def small_windows(monkeypatch):
    """Windows for surfaces small enough to be built here as well."""
    monkeypatch.setattr(sample_windows_module, "_WHOLE_BELOW", 10_000)
    monkeypatch.setattr(sample_windows_module, "TRIANGLES_PER_WINDOW", 800)
    monkeypatch.setattr(sample_windows_module, "FEWEST_OF_A_SURFACE", 0)


def jittered(random, n):
    """A square surface of 2 n^2 triangles on places of its own; waves that cross those of others."""
    vertices, triangles = grid_surface(n, lambda x, y: 0 * x)
    inside = ((vertices[:, :2] > 0) & (vertices[:, :2] < 1)).all(axis=1)
    vertices[inside, :2] += random.uniform(-0.2 / n, 0.2 / n, (inside.sum(), 2))
    p, q = random.uniform(0, 6, 2)
    vertices[:, 2] = 0.1 * np.sin(3 * vertices[:, 0] + p) * np.cos(4 * vertices[:, 1] + q)
    return vertices, triangles


def waves(count=5, n=50, step=0.05, own=True, **rock):
    """Surfaces of 2 n^2 triangles: more than the sample takes whole."""
    random = np.random.default_rng(3)
    surfaces = []
    for number in range(count):
        vertices, triangles = jittered(random, n)
        if not own:
            vertices[:, :2] = grid_surface(n, lambda x, y: 0 * x)[0][:, :2]
        surfaces.append(Surface(f"S{number}", vertices + np.array([0, 0, step * number]), triangles))
    return Project("waves", [Rock("rock", surfaces, **rock)])


def steps(n=60):
    """Heights 0 .. 3 at random on one lattice: blocks in many small parts."""
    random = np.random.default_rng(4)
    plan, triangles = grid_surface(n, lambda x, y: 0 * x, float(n))
    surfaces = []
    for number in range(4):
        vertices = plan.copy()
        vertices[:, 2] = random.integers(0, 4, len(vertices))
        surfaces.append(Surface(f"S{number}", vertices, triangles))
    return Project("steps", [Rock("rock", surfaces)])


def within_factor(told, real):
    return real / FACTOR <= told <= real * FACTOR


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize(
    "make",
    [
        waves,
        lambda: waves(own=False, base_elevation=-1.0),
        lambda: waves(region=np.array([[0.1, 0.1], [0.9, 0.2], [0.6, 0.9]])),
        steps,
    ],
    ids=["own meshes", "one mesh and a base", "region", "steps"],
)
def test_counts_as_the_build_finds_them(make, cells):
    project = make()
    told = estimate(project, cells)
    model = build(project, cells)
    assert told.triangles == len(model.surface_triangles)
    assert within_factor(told.cells, len(model.cell_block)), (told.cells, len(model.cell_block))
    assert within_factor(told.faces, len(model.face_cells)), (told.faces, len(model.face_cells))
    assert within_factor(told.vertices, len(model.vertices)), (told.vertices, len(model.vertices))
    arrays = (model.vertices, model.face_offsets, model.face_vertices, model.face_cells, model.face_surface)
    size = sum(array.nbytes for array in (*arrays, model.cell_block, model.surface_vertices))
    assert within_factor(told.model_memory, size + model.surface_triangles.nbytes)
    assert told.memory >= told.model_memory
    assert told.seconds > 0


@pytest.mark.parametrize(
    ("make", "kind"), [(waves, "own"), (lambda: waves(own=False), "shared"), (steps, "touching")]
)
def test_stacks_cost_as_their_kind(make, kind, monkeypatch):
    def told():
        return estimate(make(), "blocks")

    plain = told()
    costs = COSTS["blocks"]
    monkeypatch.setitem(costs, f"bytes_{kind}", {n: 9 * size for n, size in costs[f"bytes_{kind}"].items()})
    monkeypatch.setitem(costs, f"scale_{kind}", {"pace": 1e6, "growth": 1.0})
    dearer = told()
    assert dearer.memory > 5 * plain.memory
    assert dearer.seconds > 1000 * plain.seconds


def test_vertices_that_stand_in_one_place_are_counted():
    one = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 2]])
    other = one + np.array([0.0, 0, 1])
    assert touching_vertices([one, other]).tolist() == [0, 6]
    assert touching_vertices([one, one[:2], other]).tolist() == [2, 8]
    assert touching_vertices([one, one, one]).tolist() == [6, 9]


def test_a_small_project_is_its_own_sample():
    project = waves(3, 20)
    told, model = estimate(project), build(project)
    assert told.cells == len(model.cell_block)
    assert told.faces == len(model.face_cells)
    assert told.vertices == len(model.vertices)


def test_surfaces_of_points_are_interpolated_in_the_sample_only():
    random = np.random.default_rng(5)
    x, y = random.uniform(0, 1, (2, 300))
    surfaces = [
        Surface(
            f"S{k}",
            points=np.column_stack([x, y, 0.05 * k + 0.1 * np.sin(3 * x + k) * np.cos(4 * y)]),
            method="kriging",
            options={"variogram": {"model": "spherical", "range": 0.5, "sill": 0.01}},
        )
        for k in range(4)
    ]
    region = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    project = Project("points", [Rock("rock", surfaces, region=region, edge_length=0.02)])
    told, model = estimate(project), build(project)
    assert told.triangles == len(model.surface_triangles)
    assert within_factor(told.cells, len(model.cell_block))
    assert within_factor(told.faces, len(model.face_cells))


def test_halves_that_differ_are_both_sampled():
    """For x < 1/2 the surfaces coincide: half as many cells as elsewhere."""
    plan, triangles = grid_surface(120, lambda x, y: 0 * x)
    above = plan.copy()
    above[:, 2] = np.maximum(0.0, plan[:, 0] - 0.5)
    project = Project("half", [Rock("rock", [Surface("A", plan, triangles), Surface("B", above, triangles)])])
    assert within_factor(estimate(project).cells, len(build(project).cell_block))


def test_a_stage_is_told_as_a_stage():
    project = waves(4, 20)
    assert estimate(project, stage=1).cells == len(build(project, stage=1).cell_block)
    with pytest.raises(UsageError, match="stage 9"):
        estimate(project, stage=9)


def test_a_build_that_would_not_fit_is_refused_before_it_begins():
    project = waves()
    limit = estimate(project).memory // 2
    with pytest.raises(NotEnoughMemory) as refused:
        build(project, memory=limit)
    error = refused.value
    assert isinstance(error, BuildFailed)
    assert error.available == limit < error.needed
    assert within_factor(error.needed, estimate(project).memory)
    assert f"{memory_text(limit)} are allowed" in str(error)
    assert "triangles in all instead of 25,000" in error.advice
    assert "\n" not in str(error)


def test_blocks_are_proposed_where_they_would_fit(monkeypatch):
    half = {name: value / 2 for name, value in COSTS["columns"]["bytes_own"].items()}
    monkeypatch.setitem(COSTS["blocks"], "bytes_own", half)
    project = waves()
    limit = round(0.8 * estimate(project).memory)
    with pytest.raises(NotEnoughMemory, match='cells="blocks"'):
        build(project, memory=limit)


def test_what_fits_by_the_sample_is_built_though_the_bound_does_not_tell():
    project = waves(own=False)
    assert build(project, memory=2 * estimate(project).memory).volume > 0


@pytest.mark.parametrize("memory", [0, -5, True, 2.5, "lots"])
def test_a_limit_that_is_none_is_refused(memory):
    with pytest.raises(UsageError, match="memory"):
        build(waves(2, 4), memory=memory)


def test_what_the_sample_shows_to_be_wrong_is_refused_as_the_build_refuses_it():
    project = waves(2, 10)
    surface = project.rocks[0].surfaces[1]
    surface.vertices[0, 2] = 1e60
    with pytest.raises(InputRefused, match="surface 'S1'"):
        estimate(project)


def test_triangles_keep_their_numbers_in_a_refused_sample():
    project = waves(2, 80)
    surface = project.rocks[0].surfaces[1]
    doubled = np.arange(0, len(surface.triangles), 7)  # so many that each window has one
    surface.triangles = np.concatenate([surface.triangles, surface.triangles[doubled]])
    with pytest.raises(InputRefused, match="overlap in plan") as refused:
        estimate(project)
    first, second = refused.value.triangles
    assert surface.triangles[first].tolist() == surface.triangles[second].tolist()


def test_estimating_can_be_cancelled():
    with pytest.raises(Cancelled):
        estimate(waves(), cancel=lambda: True)


def test_the_table_reads_well():
    table = estimate(waves(3, 20)).table()
    assert "triangles of all surfaces  2,400" in table
    assert "cells (columns)" in table
    assert "memory while building" in table
    assert "time" in table


def test_windows_hold_about_as_many_triangles_as_they_should():
    plans = [jittered(np.random.default_rng(k), 80) for k in range(3)]
    windows, used = sample_windows(plans, None)
    assert used == 3 * 2 * 80 * 80
    again, _ = sample_windows(plans, None)
    assert len(windows) == 8
    assert all(
        (a.low == b.low).all() and (a.high == b.high).all() for a, b in zip(windows, again, strict=True)
    )
    for window in windows:
        centres = np.concatenate([v[t][:, :, :2].mean(axis=1) for v, t in plans])
        assert 400 < window.holds(centres).sum() < 1_600


def test_a_window_finds_triangles_larger_than_itself():
    plan = (np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]]), np.array([[0, 1, 2], [1, 3, 2]]))
    window = Window(np.array([1.0, 1.0]), np.array([2.0, 2.0]))
    assert window.overlapping(plan).tolist() == [0, 1]  # by bounding boxes
    vertices, triangles = cut_out(plan, np.array([1]))
    assert vertices[triangles[0]].tolist() == [[10, 0], [10, 10], [0, 10]]


def test_places_within_rings_count_even_odd():
    outer = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
    hole = np.array([[1, 1], [1, 3], [3, 3], [3, 1]], float)
    places = np.array([[0.5, 0.5], [2, 2], [3.5, 2], [5, 2], [-1, 2], [2, 0.5]], float)
    assert within_rings(places, [outer, hole]).tolist() == [True, False, True, False, False, True]


@pytest.mark.parametrize(
    ("rules", "parts"), [(("erosional",) * 3, 3), (("erosional", "conformable", "erosional"), 3)]
)
def test_coarse_blocks_of_a_valley(rules, parts):
    """The youngest surface cuts the upper layer in two and leaves the lower one whole."""
    heights = [lambda x, y: 0 * x, lambda x, y: 1 + 0 * x, lambda x, y: 0.5 + 20 * (x - 0.5) ** 2]
    surfaces = [
        Surface(f"S{k}", *grid_surface(60, height), rule=rule)
        for k, (height, rule) in enumerate(zip(heights, rules, strict=True))
    ]
    rock = Rock("rock", surfaces)
    # beneath S1 one part; what S2 leaves above S1 stands on both sides
    assert coarse_blocks(rock, [surface.vertices for surface in surfaces]) == parts
    model = build(Project("valley", [rock]), "blocks")
    assert len(model.cell_block) == parts
