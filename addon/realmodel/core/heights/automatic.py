# SPDX-License-Identifier: GPL-3.0-or-later
"""The method that suits some points: by their number, their spread, and how well each tells others."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .interpolation import Result, Task

_FEW = 10  # points: below this a variogram shows nothing
_TOLD = 2000  # points that are left out and told, where there are so many
_FOLDS = 10
_AS_GOOD = 1.02  # errors this near tell nothing: then a method with a variance is better
_IN_LINE = 1e-3  # of the greatest spread: points of less across it show no slope there


@dataclass(frozen=True)
class Candidate:
    method: str
    options: dict

    @property
    def name(self) -> str:
        said = ", ".join(f"{key} = {value}" for key, value in self.options.items())
        return f"{self.method} ({said})" if said else self.method


_CANDIDATES = (
    Candidate("kriging", {}),
    Candidate("kriging", {"neighbours": 32}),
    Candidate("universal_kriging", {"neighbours": 32}),
    Candidate("spline", {"neighbours": 32}),
    Candidate("natural_neighbour", {}),
)
_OF_FEW = (Candidate("plane", {}), Candidate("spline", {}), Candidate("idw", {}))


def automatic(task: Task) -> tuple[str, str, Result]:
    """The method chosen, why, and what it gives."""
    candidate, reason = choose(task)
    return candidate.method, reason, _run(task, candidate, task.points, task.nodes)


def choose(task: Task) -> tuple[Candidate, str]:
    """The candidate, and why in one sentence."""
    places = np.unique(task.points[:, :2], axis=0)
    if len(places) == 1:
        return Candidate("constant", {}), "there is one point only"
    if len(places) == 2:
        return Candidate("plane", {}), "there are two points only: the slope between them is all they show"
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if len(places) < _FEW and spread[1] < _IN_LINE * spread[0]:
        return Candidate("plane", {}), f"there are {len(places)} points, nearly in one line"
    points = np.ascontiguousarray(task.points[np.sort(np.unique(task.points, axis=0, return_index=True)[1])])
    candidates = _OF_FEW if len(places) < _FEW else _CANDIDATES
    errors = [_error(task, candidate, points) for candidate in candidates]
    least = min(errors)
    best = next(
        (
            number
            for number, candidate in enumerate(candidates)
            if errors[number] <= _AS_GOOD * least and "kriging" in candidate.method
        ),
        int(np.argmin(errors)),
    )
    said = [f"{candidate.name} {error:.4g}" for candidate, error in zip(candidates, errors, strict=True)]
    return candidates[
        best
    ], f"of {len(points)} points, root mean square errors of left-out ones: {', '.join(said)}"


def _error(task: Task, candidate: Candidate, points: np.ndarray) -> float:
    """Root of the mean squared error at points that are left out; the same ones for every candidate."""
    folds = len(points) if len(points) < _FEW else _FOLDS
    step = max(folds, len(points) // _TOLD)
    needed = 1 if step > folds else folds
    errors = []
    for fold in range(needed):
        task.work.check()
        out = np.zeros(len(points), bool)
        out[fold::step] = True
        others, places = np.ascontiguousarray(points[~out]), np.ascontiguousarray(points[out, :2])
        errors.append(_run(task, candidate, others, places).z - points[out, 2])
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _run(task: Task, candidate: Candidate, points: np.ndarray, nodes: np.ndarray) -> Result:
    from .run import RUNS, settings_of  # this method runs others

    settings = settings_of(candidate.method, candidate.options)
    return RUNS[candidate.method](replace(task, points=points, nodes=nodes, settings=settings))
