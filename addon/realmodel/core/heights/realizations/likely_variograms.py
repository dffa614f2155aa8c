# SPDX-License-Identifier: GPL-3.0-or-later
"""The variograms that few points allow: one that is fitted to them and taken for exact makes the errors of
realizations too small."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...base.elementary import exp
from ...base.work import native_module
from ...settings.variogram import Variogram
from ..from_neighbours import around_its_plane, dips_of_fit
from ..interpolation import Task
from .turning_bands import Noise

_MOST = 100  # points: more know their variogram well enough
_PART = 1 << 20  # of the noise: the numbers that choose a variogram


@dataclass(frozen=True)
class LikelyVariograms:
    """variograms: with the sill 1. shares: (V,) ascending sums of their probabilities. squares: (V,) of what
    each does not explain, and free: of so many degrees of freedom."""

    variograms: list[Variogram]
    shares: np.ndarray
    squares: np.ndarray
    free: int

    @classmethod
    def of(cls, task: Task, settings: dict, fitted: Variogram) -> LikelyVariograms | None:
        """Those of a task with the settings of a method; None where there are many points, or nearly none, or
        where the fitted one has waves. Ranges are as likely as their logarithms (Handcock and Stein 1993, "A
        Bayesian analysis of kriging", Technometrics 35)."""
        if len(task.points) > _MOST or any(part.model == "wave" for part in fitted.structures):
            return None
        drift = settings.get("drift", "constant")
        if drift == "auto":
            task, drift = around_its_plane(task), "constant"
        along = fitted.anisotropy or settings.get("anisotropy")
        rows = task.run(
            native_module().likely_variograms,
            task.points,
            (along["ratio"], along["azimuth"]) if along else (1.0, 0.0),
            drift,
            dips_of_fit(task),
            task.bounds is not None and len(task.bounds) > 0,
        )
        if not rows:
            return None
        models, ranges, nuggets, density, squares, free = zip(*rows, strict=True)
        logarithms = np.array(density)
        probable = exp(logarithms - logarithms.max())
        shapes = [
            replace(fitted, model=model, range=range_, sill=1.0, nugget=nugget, structures=())
            for model, range_, nugget in zip(models, ranges, nuggets, strict=True)
        ]
        return cls(shapes, np.cumsum(probable) / probable.sum(), np.array(squares), free[0])

    def draw(self, noise: Noise) -> Variogram:
        """One of them, with a sill that the points allow."""
        chosen, chi_square = noise.chosen(_PART, self.free)
        number = min(int(np.searchsorted(self.shares, chosen)), len(self.shares) - 1)
        sill = float(self.squares[number]) / chi_square
        shape = self.variograms[number]
        return replace(shape, sill=sill, nugget=shape.nugget * sill)
