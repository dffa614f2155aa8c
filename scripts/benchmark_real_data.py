#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds real and made stacks, passes each model through the outside check, and tabulates time and memory.

    scripts/benchmark_real_data.py [--write docs/dev/performance.md] [--case NAME]... [--repeat N]

Every build runs in a process of its own (its peak memory is that process's), once for each kind of
cells and number of threads; the least of N times is given. Needs NumPy and a built module
(scripts/build.sh); cases whose data are absent are named and left out.
"""

import argparse
import json
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "scripts", "tests/core")]

from benchmarks import page, process  # noqa: E402
from stacks import places, project_files, real_data, real_faults  # noqa: E402
from stacks.generate import sine_surface  # noqa: E402

RUNS = (("columns", 1), ("columns", 2), ("blocks", 2))


def ten_surfaces(folder):
    """10 surfaces x 7,200 triangles, each with jittered nodes of its own; sums of sines that cross."""
    rng = random.Random(7200)
    meshes = {f"S{k}": sine_surface(rng, 60, 1000.0, 12.0 * k, 15.0) for k in range(10)}
    return project_files.mesh_project(folder, "ten surfaces", meshes)


def claudius_one_mesh(folder):
    points = real_data.claudius_points()
    return project_files.points_project(folder, "claudius", points, real_data.CLAUDIUS_REGION, 60.0)


def claudius_own_meshes(folder):
    return project_files.mesh_project(folder, "claudius", real_data.claudius_on_own_meshes(60.0))


def drogon(folder):
    return project_files.mesh_project(folder, "drogon", real_data.drogon())


def pleasant(folder):
    return project_files.mesh_project(folder, "pleasant", real_data.pleasant(), base_elevation=100.0)


def shellmound(folder):
    return project_files.mesh_project(folder, "shellmound", real_data.shellmound())


# name: (what makes its project in a folder, whether it needs the real data, what it is)
CASES = {
    "claudius, one mesh": (claudius_one_mesh, True, "4 horizons of 5,200 points kriged on one region mesh"),
    "claudius, own meshes": (claudius_own_meshes, True, "the same, each horizon on a mesh of its own"),
    "drogon": (drogon, True, "4 grids of 48,125 nodes that coincide over thousands of nodes"),
    "pleasant": (pleasant, True, "4 grids with layers of 1 m, base elevation"),
    "shellmound": (shellmound, True, "5 grids, the youngest of partial extent"),
    "drogon faults": (
        real_faults.drogon,
        True,
        "4 horizons of 32,600 picks, 6 faults that die out (sticks)",
    ),
    "california faults": (
        real_faults.california,
        True,
        "3 level surfaces, 20 faults that die out (TSurf)",
    ),
    "ten surfaces": (ten_surfaces, False, "10 made surfaces x 7,200 triangles, ten triangulations"),
}


def build_once(project_path, cells, threads, exported):
    """Builds in this process; figures as a dictionary."""
    from realmodel.core import build, load_project

    project = load_project(project_path)
    start = time.perf_counter()
    model = build(project, cells=cells, threads=threads)
    seconds = time.perf_counter() - start
    peak = process.peak_resident() / 2**20
    model.save(exported)
    return {
        "surface_triangles": len(model.surface_triangles),
        "cells": len(model.cell_block),
        "faces": len(model.face_cells),
        "seconds": seconds,
        "timings": dict(model.timings),
        "peak": peak,
    }


def run_build(project_path, cells, threads, repeat):
    """The figures of the fastest of some builds, and whether check_model.py passes the model."""
    exported = project_path.with_name("model.npz")
    arguments = [sys.executable, __file__, "--build", project_path, cells, str(threads), exported]
    best = None
    for _ in range(repeat):
        output = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout
        figures = json.loads(output.splitlines()[-1])
        if best is None or figures["seconds"] < best["seconds"]:
            best = figures
    check = places.CHECK / "check_model.py"
    best["checked"] = "-"
    if check.is_file():
        done = subprocess.run([sys.executable, check, project_path, exported], capture_output=True, text=True)
        best["checked"] = "passed" if done.returncode == 0 else "FAILED"
        if done.returncode:
            print(done.stdout[:2000], file=sys.stderr)
    return best


def row_of(name, cells, threads, figures):
    return (
        f"| {name} | {figures['surface_triangles']:,} | {cells} | {threads} | {figures['cells']:,} "
        f"| {figures['faces']:,} | {figures['seconds']:.2f} | {figures['timings']['intersect']:.2f} "
        f"| {figures['peak']:,.0f} | {figures['checked']} |"
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--write", type=Path, help="Markdown file to write the table into")
    parser.add_argument("--case", action="append", choices=CASES)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--build", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.build:
        path, cells, threads, exported = given.build
        print(json.dumps(build_once(Path(path), cells, int(threads), exported)))
        return 0

    rows = [
        "| case | surface triangles | cells are | threads | cells | faces | build, s | of it the stack, s "
        "| peak memory, MiB | check_model.py |",
        "|---|---:|---|---:|---:|---:|---:|---:|---:|---|",
    ]
    print("\n".join(rows), flush=True)
    failed = False
    for name in given.case or CASES:
        make, real, _ = CASES[name]
        if real and not places.REAL_DATA.is_dir():
            print(f"{name}: left out, {places.DATA_ABSENT}", file=sys.stderr)
            continue
        with tempfile.TemporaryDirectory() as folder:
            project_path = make(Path(folder))
            for cells, threads in RUNS:
                figures = run_build(project_path, cells, threads, given.repeat)
                failed |= figures["checked"] == "FAILED"
                rows.append(row_of(name, cells, threads, figures))
                print(rows[-1], flush=True)
    if given.write:
        write_table(given.write, rows)
    return 1 if failed else 0


def write_table(path, rows):
    """Puts the table into its part of a Markdown file, with the machine and what each case is."""
    cases = [f"- **{name}**: {what}" for name, (_, _, what) in CASES.items()]
    page.write_part(path, "benchmark_real_data.py", [page.machine(), "", *rows, "", *cases])


if __name__ == "__main__":
    sys.exit(main())
