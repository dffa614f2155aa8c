# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether progress is true, how soon cancelling answers, and whether memory is given back."""

from __future__ import annotations

import gc
import threading
import time

import numpy as np
from realmodel.core import Cancelled, Project, Rock, Surface, build, estimate

from .made_stacks import StackSpec
from .process import peak_resident, resident


def project(spec: StackSpec) -> Project:
    surfaces = [
        Surface(f"S{k}", vertices=vertices, triangles=triangles)
        for k, (vertices, triangles) in enumerate(spec.make())
    ]
    return Project("benchmark", [Rock("rock", surfaces)])


def _grown(before: int) -> int:
    gc.collect()
    return resident() - before


def progress(spec: dict, cells: str, threads: int) -> dict:
    """Builds once and compares each fraction that was told with the share of the time that had passed.

    Returns `seconds`, `bytes` taken, `bound` and `expected` (bytes and seconds that estimate() says),
    `deviation` (the greatest difference, 0 .. 1), `worked` (the same for processor time of the process, which
    other processes do not change), `halfway` (the fraction told at half of the time), `gap` (the longest time
    without a call), `calls`, `told` [[share of the time, fraction, text], ...].
    """
    given = project(StackSpec(**spec))
    told, spent = [], []
    said = estimate(given, cells, threads=threads)
    resident_before = resident()

    def tell(share: float, text: str) -> None:
        told.append((time.perf_counter() - began, share, text))
        spent.append(time.process_time())

    began, before = time.perf_counter(), time.process_time()
    model = build(given, cells, threads, progress=tell)
    seconds = time.perf_counter() - began
    times = np.array([at for at, _, _ in told])
    shares = np.array([share for _, share, _ in told])
    passed = times / seconds
    worked = (np.array(spent) - before) / (spent[-1] - before)
    return {
        "seconds": seconds,
        "bytes": peak_resident() - resident_before,
        "bound": said.memory,
        "expected": said.seconds,
        "cells": len(model.cell_block),
        "timings": model.timings,
        "deviation": float(np.abs(shares - passed).max()),
        "worked": float(np.abs(shares - worked).max()),
        "halfway": float(np.interp(0.5, passed, shares)),
        "gap": float(np.diff(times, prepend=0.0, append=seconds).max()),
        "calls": len(told),
        "told": [[round(at / seconds, 4), round(share, 4), text] for at, share, text in told],
    }


def cancelling(spec: dict, cells: str, threads: int, moments: int, seconds: float) -> dict:
    """Cancels a build at random moments of its `seconds`.

    Returns `latency` [seconds from cancel() saying so to Cancelled, ...] with `at` [share of the time],
    `gone` [seconds until the stopped work had ended], and `kept`, bytes that the process then holds more
    than before the first build, after each.
    """
    given = project(StackSpec(**spec))
    random = np.random.default_rng(moments)
    before = resident()
    at, latency, gone, kept = [], [], [], []
    for moment in random.uniform(0.0, 1.0, moments):
        began = time.perf_counter()
        said = []

        def cancel(until=began + moment * seconds, said=said) -> bool:
            if time.perf_counter() < until:
                return False
            said.append(time.perf_counter())
            return True

        try:
            build(given, cells, threads, cancel=cancel)
        except Cancelled:
            latency.append(time.perf_counter() - said[0])
            at.append(float(moment))
        for thread in threading.enumerate():
            if thread is not threading.current_thread():
                thread.join()
        gone.append(time.perf_counter() - (said[0] if said else time.perf_counter()))
        kept.append(_grown(before))
    return {"at": at, "latency": latency, "gone": gone, "kept": kept}
