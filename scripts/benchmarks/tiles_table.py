# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of models in tiles: beside the undivided build, on one worker and two, and by size."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .process import ROOT, Skipped, alone

BESIDE = (
    "work",
    "compared with",
    "s",
    "processors, s",
    "s of the other",
    "processors, s of the other",
    "times",
    "of processors",
    "required",
    "",
)
SIZES = (
    "triangles",
    "tiles",
    "cells",
    "s",
    "processors, s",
    "main process, s",
    "microseconds for each triangle",
    "main process, MB",
    "largest worker, MB",
    "all, MB",
    "",
)
_SURFACES = 10
_QUADS, _PARTS = 549, 4  # along the side of a stack that fits one machine, and tiles along it: 8 a worker
_TIMES = 2  # each is measured, in turn; the quicker one counts, as others use the machine, too
_OVERHEAD, _TWO_WORKERS = 1.3, 0.55  # asked
_UNIT = 316  # quads along one unit of length: a square of it has two million triangles
_TILE = 0.5**0.5  # a million triangles
_MILLIONS = (2, 6, 18, 54)
_DISK = ROOT / "build" / "tiles"  # not a folder in memory
_PATIENCE = 4 * 3600.0


def measure(quick: bool, memory: float, say: Callable[[str], None]):
    """Rows for BESIDE and SIZES; what could not be measured is SKIPPED, and why."""
    beside = _beside(100 if quick else _QUADS, 2 if quick else _PARTS, 1 if quick else _TIMES, memory)
    for row in beside:
        say(" | ".join(row))
    sizes = []
    for millions in _MILLIONS[:1] if quick else _MILLIONS:
        sizes.append(_sized(millions, memory))
        say(" | ".join(sizes[-1]))
    return beside, sizes


def _beside(quads: int, parts: int, times: int, memory: float) -> list[list[str]]:
    """Tiles beside the undivided model, and two builds of that at once beside one: what the machine loses
    when both processors are at work, whatever is done to divide a model."""
    name = _name(quads, parts)
    works = [f"{name}, one worker", f"{name}, two workers", "two undivided builds at once, for each"]
    with _Folder() as folder:

        def written(function: str, *arguments) -> dict:
            with _Folder() as out:
                return alone(f"tiles.{function}", project, out.new(), *arguments, memory=memory)

        def at_once() -> dict:
            with ThreadPoolExecutor(2) as pool:
                both = list(pool.map(lambda _: written("undivided", 1), range(2)))
            return {
                "seconds": max(found["seconds"] for found in both) / 2,
                "processor": sum(found["processor"] for found in both) / 2,
            }

        measured = [
            lambda: written("undivided", 1),
            lambda: written("undivided", 2),
            at_once,
            lambda: written("in_tiles", 1 / parts, 1, True),
            lambda: written("in_tiles", 1 / parts, 2, True),
        ]
        try:
            spec = {"surfaces": _SURFACES, "quads": quads}
            project = alone("tiles.write_project", spec, folder.new())["project"]
            rounds = [[each() for each in measured] for _ in range(times)]
        except Skipped as why:
            return [_skipped(work, why) for work in works]
    whole, on_two, each, one, two = (
        min(found, key=lambda of: of["seconds"]) for found in zip(*rounds, strict=True)
    )
    return [
        _pair(works[0], "undivided, one thread", one, whole, _OVERHEAD),
        _pair(works[1], "undivided, two threads", two, on_two, _OVERHEAD),
        _pair(works[2], "one alone", each, whole),
        _pair(works[1], "one worker", two, one, _TWO_WORKERS),
    ]


def _name(quads: int, parts: int) -> str:
    return f"{_SURFACES} x {2 * quads * quads:,} in {parts * parts} tiles"


def _skipped(work: str, why: Skipped) -> list[str]:
    return [work, "", *["-"] * 7, f"SKIPPED: {why}"]


def _pair(work: str, other: str, ours: dict, theirs: dict, asked: float | None = None) -> list[str]:
    times = {key: ours[key] / theirs[key] for key in ("seconds", "processor")}
    return [
        work,
        other,
        *(f"{each[key]:.1f}" for each in (ours, theirs) for key in ("seconds", "processor")),
        f"**{times['seconds']:.2f}**",
        f"{times['processor']:.2f}",
        "" if asked is None else f"{asked:.2f}",
        "" if asked is None else "met" if times["seconds"] <= asked else "NOT met",
    ]


def _sized(millions: int, memory: float) -> list[str]:
    quads = round((millions * 1e6 / 2 / _SURFACES) ** 0.5)
    spec = {"surfaces": _SURFACES, "quads": quads, "side": quads / _UNIT}
    with _Folder() as folder:
        try:
            made = alone("tiles.write_project", spec, folder.new(), seconds=_PATIENCE)
            found = alone(
                "tiles.in_tiles",
                made["project"],
                folder.new(),
                _TILE,
                2,
                False,
                seconds=_PATIENCE,
                memory=memory,
            )
        except Skipped as why:
            return [f"{millions},000,000", *["-"] * 9, f"SKIPPED: {why}"]
    triangles = 2 * _SURFACES * quads * quads
    return [
        f"{triangles:,}",
        str(found["tiles"]),
        f"{found['cells']:,}",
        f"{found['seconds']:.0f}",
        f"{found['processor']:.0f}",
        f"{found['lead']:.0f}",
        f"{1e6 * found['processor'] / triangles:.1f}",
        *(f"{found[key] / 1e6:,.0f}" for key in ("peak", "worker", "all")),
        "",
    ]


class _Folder:
    """Folders on the disk of the project, gone at the end."""

    def __enter__(self) -> _Folder:
        _DISK.mkdir(parents=True, exist_ok=True)
        self._all = tempfile.TemporaryDirectory(dir=_DISK)
        return self

    def __exit__(self, *_) -> None:
        self._all.cleanup()

    def new(self) -> str:
        return tempfile.mkdtemp(dir=Path(self._all.name))
