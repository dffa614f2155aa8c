# SPDX-License-Identifier: GPL-3.0-or-later
"""Peers that are programs of their own, fed with binary files: gstat in R, and GMT's surface.

What they take is told with the heights: of gstat the seconds in memory, of GMT those with its files.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from .process import Skipped

_R = """
suppressMessages({library(sp); library(gstat)})
numbers <- function(file, columns) {
    size <- file.info(file)$size / 8
    as.data.frame(matrix(readBin(file, "double", size), ncol = columns, byrow = TRUE))
}
given <- commandArgs(trailingOnly = TRUE)
known <- numbers(given[1], 3); names(known) <- c("x", "y", "z"); coordinates(known) <- ~x+y
nodes <- numbers(given[2], 2); names(nodes) <- c("x", "y"); coordinates(nodes) <- ~x+y
model <- vgm(5000, given[4], as.numeric(given[5]), kappa = as.numeric(given[6]))
trend <- if (given[8] == "linear") z ~ x + y else z ~ 1
seconds <- system.time(
    told <- krige(trend, known, nodes, model = model, nmax = as.integer(given[7]), debug.level = 0)
)["elapsed"]
writeBin(c(seconds, told$var1.pred, told$var1.var), given[3])
"""


def gstat(points, nodes, model: str, extent: float, kappa: float, neighbours: int, drift: str = "constant"):
    """Heights, variances and seconds of kriging; extent and kappa as gstat has them."""
    if shutil.which("Rscript") is None:
        raise Skipped("R with gstat is not there: apt-get install r-cran-gstat")
    with tempfile.TemporaryDirectory(prefix="realmodel_") as folder:
        given, asked, out = (Path(folder) / name for name in ("points", "nodes", "out"))
        script = Path(folder) / "krige.R"
        script.write_text(_R, encoding="utf-8")
        middle = points.mean(axis=0)
        np.ascontiguousarray(points - middle).tofile(given)
        np.ascontiguousarray(nodes - middle[:2]).tofile(asked)
        _run(["Rscript", script, given, asked, out, model, extent, kappa, neighbours, drift])
        told = np.fromfile(out)
    count = len(nodes)
    return told[1 : count + 1] + middle[2], told[count + 1 :], float(told[0])


_LEAST_SIDE = 1000  # nodes along a side of the grid that heights at a few places are taken from


def gmt_surface(points, nodes):
    """Heights by continuous curvature splines without tension (Smith and Wessel 1990), on a grid over the
    points and nodes of as many nodes as asked for, at least a million; and the seconds of making it."""
    if shutil.which("gmt") is None:
        raise Skipped("GMT is not there: apt-get install gmt")
    side = max(_LEAST_SIDE, int(np.sqrt(len(nodes))))
    plan = np.concatenate([points[:, :2], nodes])
    middle = points.mean(axis=0)
    half = float(np.abs(plan - middle[:2]).max()) * 1.001
    step = 2 * half / side
    region = f"-R{-half}/{half}/{-half}/{half}"
    with tempfile.TemporaryDirectory(prefix="realmodel_") as folder:
        given, thinned, grid, asked = (str(Path(folder) / n) for n in ("points", "means", "z.grd", "nodes"))
        np.ascontiguousarray(points - middle).tofile(given)
        np.ascontiguousarray(nodes - middle[:2]).tofile(asked)
        began = time.perf_counter()
        means = _run(["gmt", "blockmean", given, "-bi3d", "-bo3d", region, f"-I{step}"], folder)
        Path(thinned).write_bytes(means)
        _run(["gmt", "surface", thinned, "-bi3d", region, f"-I{step}", f"-G{grid}", "-T0"], folder)
        seconds = time.perf_counter() - began
        told = _run(["gmt", "grdtrack", asked, "-bi2d", "-bo3d", f"-G{grid}", "-nc"], folder)
    z = np.frombuffer(told).reshape(-1, 3)[:, 2] + middle[2]
    return z, None, seconds


def _run(command: list, folder: str | None = None) -> bytes:
    done = subprocess.run([str(part) for part in command], capture_output=True, check=False, cwd=folder)
    if done.returncode:
        raise Skipped(f"{command[0]} failed: {done.stderr.decode(errors='replace').strip()[-200:]}")
    return done.stdout
