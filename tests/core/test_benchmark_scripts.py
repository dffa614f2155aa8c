# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/benchmark.sh stands on: its inputs, its page, and the guard round its processes."""

import sys

import numpy as np
import pytest
from conftest import ROOT
from realmodel import _native
from realmodel.core import mesh_region

sys.path.insert(0, str(ROOT / "scripts"))

from benchmarks import (
    files,
    files_table,
    hard_outlines,
    meshing,
    page,
    peers,
    process,
    structures,
    tiles,
    tiles_table,
)
from benchmarks.made_stacks import StackSpec


@pytest.mark.parametrize(
    "spec",
    [
        StackSpec(3, 8),
        StackSpec(3, 8, "shared"),
        StackSpec(3, 8, "lattice", "steps"),
        StackSpec(2, 8, "shared", "half"),
    ],
)
def test_made_stacks_are_what_they_say(spec):
    surfaces, again = spec.make(), spec.make()
    assert len(surfaces) == spec.surfaces
    for (vertices, triangles), (same, _) in zip(surfaces, again, strict=True):
        assert (vertices == same).all()
        assert len(triangles) == spec.triangles
        assert triangles.max() == len(vertices) - 1
    plans = [vertices[:, :2] for vertices, _ in surfaces]
    assert all((plan == plans[0]).all() for plan in plans) == (spec.plan != "own")
    assert len(_native.build_stack(surfaces)["cell_block"]) > 0
    if spec.heights == "half":
        (older, _), (younger, _) = surfaces
        assert (older[:, 2] == younger[:, 2]).mean() == pytest.approx(5 / 9)


def test_a_surface_closed_for_peers_is_a_closed_solid():
    spec = StackSpec(1, 5)
    vertices, triangles = peers.close_to_solid(spec.make()[0], -1.0)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    directed = {tuple(edge) for edge in edges.tolist()}
    assert len(directed) == len(edges)
    assert all((b, a) in directed for a, b in directed)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert 0.8 < volume < 1.3, "counter-clockwise seen from outside"


def test_a_model_in_tiles_is_measured_beside_the_whole(tmp_path):
    pytest.importorskip("distributed")
    folders = [tmp_path / name for name in ("inputs", "whole", "tiles")]
    for folder in folders:
        folder.mkdir()
    spec = {"surfaces": 3, "quads": 12, "side": 2.0}
    project = tiles.write_project(spec, str(folders[0]))["project"]
    whole = tiles.undivided(project, str(folders[1]), 1)
    assert (folders[1] / "model.npz").exists() and (folders[1] / "model.vtu").exists()
    found = tiles.in_tiles(project, str(folders[2]), 1.0, 1, False)
    assert found["tiles"] == 4 and found["cells"] > whole["cells"] > 800
    assert found["all"] > found["worker"]
    row = tiles_table._pair(
        "tiles", "whole", {"seconds": 2, "processor": 3}, {"seconds": 1, "processor": 3}, 1.3
    )
    assert row == ["tiles", "whole", "2.0", "3.0", "1.0", "3.0", "**2.00**", "1.00", "1.30", "NOT met"]
    assert len(row) == len(tiles_table.BESIDE)


@pytest.mark.parametrize(("faults", "compartments"), [(0, 1), (1, 2), (3, 6)])
def test_a_stack_with_faults_has_its_compartments(faults, compartments):
    spec = {"surfaces": 3, "quads": 12, "plan": "own"}
    found = structures.build_faulted(spec, "columns", 1, faults)
    assert found["compartments"] == compartments
    assert found["cells"] > 400


def test_a_sphere_cuts_as_much_from_ours_as_from_its_peer():
    spec = {"surfaces": 3, "quads": 12}
    try:
        theirs = structures.manifold_cut(spec, 8)
    except process.Skipped as missing:
        pytest.skip(str(missing))
    assert structures.ours_cut(spec, "columns", 8, 1)["volume"] == pytest.approx(theirs["volume"], rel=1e-9)


@pytest.mark.parametrize("graded", [False, True])
def test_a_measured_mesh_has_the_figures_it_should(graded):
    edge = meshing.graded_largest(8000) if graded else meshing.edge_for(8000)
    found = meshing.mesh("frontal", edge, graded)
    assert found["triangles"] == pytest.approx(8000, rel=0.25)
    assert found["mean_edge"] == pytest.approx(1, rel=0.1)
    assert 25 <= found["least_angle"] <= 60
    assert 0.95 <= found["mean_ratio"] <= 1
    assert 0.9 <= found["six"] <= 1
    assert 1e7 < found["resident"] < 1e10


def test_statistics_of_a_mesh_by_hand():
    hexagon = np.array([[0, 0], *((np.cos(a), np.sin(a)) for a in np.arange(6) * np.pi / 3)])
    fan = np.array([[0, i, i % 6 + 1] for i in range(1, 7)])
    found = meshing.figures(hexagon, fan, 0.5, False)
    assert found == pytest.approx(
        {"triangles": 6, "least_angle": 60, "mean_ratio": 1, "mean_edge": 2, "six": 1}
    )


@pytest.mark.parametrize("kind", ["coast", "star", "bristles", "holes"])
def test_polygons_that_are_measured_have_so_many_corners(kind):
    assert sum(map(len, meshing.polygon(kind))) == pytest.approx(100_000, rel=0.03)


def test_each_run_rewrites_its_own_part_of_the_page(tmp_path):
    path = tmp_path / "page.md"
    page.write_part(path, "one", ["1"])
    page.write_part(path, "two", ["2"])
    path.write_text(path.read_text() + "\nby hand\n")
    page.write_part(path, "one", ["1", "more"])
    assert path.read_text() == (
        "# Performance\n\n<!-- one begins -->\n1\nmore\n<!-- one ends -->\n\n"
        "<!-- two begins -->\n2\n<!-- two ends -->\n\nby hand\n"
    )


def test_a_process_that_takes_too_long_or_fails_is_skipped():
    with pytest.raises(process.Skipped, match="not done within"):
        process.run_apart([sys.executable, "-c", "import time; time.sleep(60)"], 0.3, 10**9)
    with pytest.raises(process.Skipped, match="no such thing"):
        process.run_apart([sys.executable, "-c", "raise SystemExit('no such thing')"], 300, 10**9)
    with pytest.raises(process.Skipped, match="more than"):
        process.run_apart(
            [sys.executable, "-c", "b = bytearray(300_000_000); import time; time.sleep(600)"], 300, 10**8
        )
    out, seconds, _ = process.run_apart([sys.executable, "-c", "print(42)"], 300, 10**9)
    assert out == "42\n"
    assert 0 < seconds < 300


@pytest.mark.parametrize("kind", hard_outlines.CASES)
def test_hard_outlines_are_meshed_as_a_whole(kind):
    try:
        polygons = hard_outlines.polygons(kind)
    except process.Skipped as missing:
        pytest.skip(str(missing))
    rings = [ring for polygon in polygons for ring in polygon]
    areas = [[abs(meshing.signed_area(ring)) for ring in polygon] for polygon in polygons]
    area = sum(outline - sum(holes) for outline, *holes in areas)
    edge = hard_outlines.CASES[kind][1][0]
    vertices, triangles = mesh_region(rings, edge_length=edge, mesher="delaunay")
    found = sum(meshing.signed_area(corners) for corners in vertices[triangles])
    assert found == pytest.approx(area, rel=1e-9)


def test_files_are_measured_beside_their_bytes():
    spec = {"surfaces": 3, "quads": 12, "plan": "shared"}
    found = files.write_in_turns(spec, [".vtu", ".foam"], 1, 1)
    assert found["cells"] > 400
    for ending in (".vtu", ".foam"):
        row = files_table._row(ending, found["cells"], found[ending])
        assert len(row) == len(files_table.FILES)
        assert found[ending]["bytes"] > 40 * found["cells"]
        assert all(seconds > 0 for name in ("cached", "synced") for seconds in found[ending][name])


def test_loading_is_measured_beside_building(tmp_path):
    path = str(tmp_path / "m.npz")
    built, loaded = files.build_and_save({"surfaces": 2, "quads": 4}, path, 1), files.load(path)
    assert built["bytes"] == (tmp_path / "m.npz").stat().st_size
    assert min(built["built"], built["saved"], loaded["loaded"]) > 0
    row = files_table._loaded_row("2 x 32", built, loaded)
    assert len(row) == len(files_table.LOADED)
