# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/benchmark.sh stands on: its inputs, its page, its fit, and the guard round its processes."""

import ast
import sys

import numpy as np
import pytest
from conftest import ROOT
from realmodel import _native
from realmodel.core import mesh_region

sys.path.insert(0, str(ROOT / "scripts"))

from benchmarks import fitting, hard_outlines, meshing, page, peers, process
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


def test_figures_of_a_mesh_that_can_be_told_by_hand():
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


def test_the_fit_finds_what_was_put_in():
    rows = np.random.default_rng(6).uniform(1, 9, (12, 4))
    found = fitting.least_squares(rows, rows @ [3.0, 0.0, 5.0, 0.0])
    assert found == pytest.approx([3.0, 0.0, 5.0, 0.0], abs=1e-9)
    assert (fitting.least_squares(rows, rows @ [3.0, -1.0, 0.0, 4.0]) >= 0).all()


def a_case(ratio, seconds, whole=False):
    return {"seconds": seconds, "sample": {"corners": ratio, "built": 1, "seconds": 1.0, "whole": whole}}


@pytest.mark.parametrize("growth", [0.8, 0.9, 1.0, 1.1])
def test_the_growth_that_was_put_in_is_found(growth):
    cases = [a_case(ratio, 0.6 * ratio**growth) for ratio in (0.5, 4, 40, 200)]
    assert fitting.scale([*cases, a_case(1, 99.0, whole=True)]) == {"pace": 0.6, "growth": growth}


def test_no_case_is_missed_by_more_than_it_has_to_be():
    assert fitting.scale([a_case(8, 8.0), a_case(8, 4 * 8.0)]) == {"pace": 2.0, "growth": 1.0}
    cases = [{"triangles": 1, "vertices": 0, "faces": 0, "corners": 0, "bytes": size} for size in (100, 900)]
    assert fitting.sizes(cases)["triangles"] == 300.0


def test_a_pace_rises_where_counting_jumps_and_stands_still():
    told = [[0.0, 0.0], [0.2, 0.5], [0.4, 0.5], [0.6, 0.5], [0.9, 0.6], [1.0, 1.0]]
    knots = fitting.knots([{"told": told}])
    shares = [share for _, share in knots]
    assert knots[0] == [0.0, 0.0]
    assert knots[-1] == [1.0, 1.0]
    assert shares == sorted(shares)
    middle = dict(map(tuple, knots))[0.5]
    assert 0.2 <= middle <= 0.6


def test_small_and_large_stacks_have_a_pace_each():
    slow, fast = [[0.0, 0.0], [0.5, 0.2], [1.0, 1.0]], [[0.0, 0.0], [0.5, 0.8], [1.0, 1.0]]
    small = {"spec": {"surfaces": 10, "quads": 100}, "told": slow}
    large = {"spec": {"surfaces": 10, "quads": 700}, "told": fast}
    curves = fitting.pace([large, small])
    assert [curve["triangles"] for curve in curves] == [200_000, 9_800_000]
    assert curves[0]["knots"] == fitting.knots([small])
    assert len(fitting.pace([small])) == 1


def test_constants_are_written_as_python_that_reads_back():
    costs = {"read": 1.5e-08, "columns": {"bytes": {"faces": 3.0}, "pace_own": []}}
    costs["columns"]["pace_own"] = [{"triangles": 7, "knots": [[0.0, 0.0], [1.0, 1.0]]}]
    assert ast.literal_eval(fitting.literal(costs)) == costs


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
