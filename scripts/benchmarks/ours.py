# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel's own measurements, each to be run in a process of its own (process.alone)."""

from __future__ import annotations

import time

from realmodel.core.base.work import native_module

from .made_stacks import StackSpec


def stack(spec: dict, cells: str, threads: int, base: float | None = None) -> dict:
    """Seconds of the stack builder alone, from arrays in memory to arrays in memory: the first build of a
    process that has loaded its modules, and loaded ours as the package does (waiting threads sleep)."""
    native = native_module()
    surfaces = StackSpec(**spec).make()
    began = time.perf_counter()
    built = native.build_stack(
        surfaces, base_elevation=base, cells=cells, execution=native.Execution(threads)
    )
    seconds = time.perf_counter() - began
    return {
        "seconds": seconds,
        "cells": len(built["cell_block"]),
        "faces": len(built["face_cells"]),
        "triangles": sum(len(triangles) for _, triangles in surfaces),
        "volume": float(built["volumes"].sum()),
    }
