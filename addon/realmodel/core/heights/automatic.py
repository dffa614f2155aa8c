# SPDX-License-Identifier: GPL-3.0-or-later
"""The method "auto": chooses a method by the number of points, their spread, and cross-validation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import principal_axes
from ..base.work import native_module
from ..settings.methods import METHODS, checked_options
from . import bounded, from_neighbors
from .interpolation import Result, Task
from .left_out_places import in_turn, places_of
from .methods import run_method

_FEW = 10  # points: too few for a variogram
_LEFT_OUT = 2000  # about as many points are left out and estimated, where there are so many
_FOLDS = 10
_AS_GOOD = 1.02  # a ratio of errors below this is insignificant: then a method with a variance is preferred
_ROUNDING = 1e-12  # of the highest point: smaller errors are rounding errors, and insignificant, too
_IN_LINE = 1e-3  # of the greatest spread: points of less spread across it are in one line


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
    Candidate("universal_kriging", {}),
    Candidate("spline", {"neighbours": 32}),
    Candidate("natural_neighbour", {}),
)
_OF_DIPS = Candidate("spline", {})  # of few points
_OF_FEW = (Candidate("plane", {}), _OF_DIPS, Candidate("idw", {}))


@dataclass(frozen=True)
class Trial:
    """A candidate with its settings for some points. known: for kriging, the variogram fitted to all of
    them."""

    candidate: Candidate
    settings: dict
    known: from_neighbors.KrigingStructure | None

    def run(self, task: Task, points: np.ndarray, nodes: np.ndarray) -> Result:
        task = replace(task, points=points, nodes=nodes, settings=self.settings, bounds=None)
        if self.known is not None:
            return from_neighbors.krige(task, self.known)
        return run_method(self.candidate.method, task)

    def error(self, task: Task, points: np.ndarray, left_out: list[np.ndarray]) -> float:
        """The root mean square error at points that are left out. left_out: (P,) bool, which at a time."""
        errors = []
        for out in left_out:
            task.work.check()
            others, places = np.ascontiguousarray(points[~out]), np.ascontiguousarray(points[out, :2])
            errors.append(self.run(task, others, places).z - points[out, 2])
        return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def automatic(task: Task) -> tuple[str, str, Result]:
    """The chosen method, the reason, and its result."""
    trial, reason = choose(task)
    if task.bounds is None:
        return trial.candidate.method, reason, trial.run(task, task.points, task.nodes)
    task = replace(task, settings=trial.settings)
    return trial.candidate.method, reason, bounded.interpolated(trial.candidate.method, task)


def choose(task: Task) -> tuple[Trial, str]:
    """The chosen candidate, and the reason in one sentence."""
    places = np.unique(task.points[:, :2], axis=0)
    if len(places) <= 2 and task.dips is not None:
        return _trial(task, _OF_DIPS), f"there are {len(places)} points, and it uses dips"
    if len(places) == 1:
        return _trial(task, Candidate("constant", {})), "only one point"
    if len(places) == 2:
        why = "there are two points only: the slope between them is all they show"
        return _trial(task, Candidate("plane", {})), why
    spread, _ = principal_axes(places)
    if len(places) < _FEW and spread[1] < _IN_LINE * spread[0] and task.dips is None:
        why = f"there are {len(places)} points, nearly in one line"
        return _trial(task, Candidate("plane", {})), why
    native_module().mean_spacing(task.points)  # refuses points that contradict others, by their own numbers
    points = np.ascontiguousarray(task.points[np.sort(np.unique(task.points, axis=0, return_index=True)[1])])
    able = [entry for entry in (_OF_FEW if len(places) < _FEW else _CANDIDATES) if _is_able(entry, task)]
    if len(able) == 1:
        return _trial(task, able[0]), "there are few points, and it uses dips"
    trials = [_trial(task, candidate) for candidate in able]
    left_out = _left_out(task, points)
    errors = [trial.error(task, points, left_out) for trial in trials]
    significant = np.maximum(errors, _ROUNDING * np.abs(points[:, 2]).max())
    least = significant.min()
    best = next(
        (
            trial
            for trial, error in zip(trials, significant, strict=True)
            if error <= _AS_GOOD * least and trial.known is not None
        ),
        trials[int(np.argmin(significant))],
    )
    said = [f"{trial.candidate.name} {error:.4g}" for trial, error in zip(trials, errors, strict=True)]
    return best, f"of {len(points)} points, root mean square errors of left-out ones: {', '.join(said)}"


def _left_out(task: Task, points: np.ndarray) -> list[np.ndarray]:
    """(P,) bool, which points are left out at a time: every tenth, or one of few; of clustered points those
    at every tenth place."""
    places = places_of(task.work, points[:, :2])
    if places is not None:
        return in_turn(places, _FOLDS)
    step = max(_FOLDS, len(points) // _LEFT_OUT)
    every = in_turn(np.arange(len(points)), len(points) if len(points) < _FEW else step)
    return every[:1] if step > _FOLDS else every


def _is_able(candidate: Candidate, task: Task) -> bool:
    """Whether a candidate uses all that is known: dips, and how far heights may be off."""
    method = METHODS[candidate.method]
    return (task.dips is None or method.is_constrained) and (not task.error or "variogram" in method.options)


def _trial(task: Task, candidate: Candidate) -> Trial:
    settings = checked_options(candidate.method, candidate.options)
    structure = None
    if "kriging" in candidate.method:
        structure = from_neighbors.structure(replace(task, settings=settings))
    return Trial(candidate, settings, structure)
