# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles: statistics of many realizations of a model: volumes, heights, and probabilities of blocks."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..base.errors import UsageError
from ..base.named import keyword_only
from ..base.work import Cancel, Progress, Work, run
from ..model.build import build
from ..model.model import Model
from ..model.planned_hole import PlannedHole
from ..project.project import Project
from ..results.samples import Probabilities
from ..results.volumes import missing_deviations, without_deviation
from .realization import Realizer, differences, heights
from .sampled_blocks import hole_of_realizations

BATCH = (
    8  # realizations that are summed before others are added: so sums do not depend on the number of workers
)
PERCENTILES = (10, 50, 90)
Places = np.ndarray | Callable[[Model], np.ndarray]


@dataclass
class Sums:
    """Of some realizations, in order. volumes: (K, B) float64 of the blocks. heights, squares: for each
    surface the sum of differences (V,) from its interpolated heights, and of their squares; None for ready
    meshes. counts: (N, B) int32: how often each block is at each place."""

    volumes: np.ndarray
    heights: list[np.ndarray | None]
    squares: list[np.ndarray | None]
    counts: np.ndarray

    def plus(self, other: Sums) -> Sums:
        def sums(first: list, second: list) -> list:
            return [None if a is None else a + b for a, b in zip(first, second, strict=True)]

        return Sums(
            np.concatenate([self.volumes, other.volumes]),
            sums(self.heights, other.heights),
            sums(self.squares, other.squares),
            self.counts + other.counts,
        )


def batches(realizations: int) -> list[range]:
    """The numbers of the realizations in each batch."""
    return [range(n, min(n + BATCH, realizations)) for n in range(0, realizations, BATCH)]


def sums_of(realizer: Realizer, number: int, places: np.ndarray, threads: int = 0) -> Sums:
    """The sums of one realization. places: (N, 3)."""
    model = realizer.realization(number, threads=threads)
    changes = differences(realizer.model, model, threads)
    blocks = model.block_at(places, threads=threads)
    return Sums(
        np.array([[block.volume for block in model.blocks]]),
        changes,
        [None if change is None else change**2 for change in changes],
        (blocks[:, None] == np.arange(len(model.blocks))).astype(np.int32),
    )


def added(parts: Iterable[Sums]) -> Sums:
    """The sum of parts, in their order."""
    return functools.reduce(Sums.plus, parts)


@dataclass(eq=False)
class Ensemble:
    """Realizations of a model.

    seed, correlation: as of `ensemble`. model: with the interpolated heights. volumes: (R, B) float64, of
    each block in each realization. surface_mean, surface_deviation: for each surface (V,) float64 at the
    nodes of the planar mesh, or where faults divide the rock mass at the vertices of its sheets, the mean of
    the heights and their standard deviation, NaN where not all realizations have a height, and the deviation
    where the data show no variogram; None for ready meshes and level sets. places: (N, 3). probability:
    (N, B) float64, of each block at each place.
    """

    model: Model
    seed: int
    correlation: float
    volumes: np.ndarray
    surface_mean: list[np.ndarray | None] = field(repr=False)
    surface_deviation: list[np.ndarray | None] = field(repr=False)
    places: np.ndarray = field(repr=False)
    probability: np.ndarray = field(repr=False)

    @classmethod
    def of(cls, realizer: Realizer, sums: Sums, places: np.ndarray) -> Ensemble:
        """The ensemble of the sums over its realizations. places: (P, 3), where probabilities are
        computed."""
        count = len(sums.volumes)
        means: list[np.ndarray | None] = []
        deviations: list[np.ndarray | None] = []
        model, lacking = realizer.model, missing_deviations(realizer.model)
        for number, (z, total, squares) in enumerate(
            zip(heights(model), sums.heights, sums.squares, strict=True)
        ):
            if z is None or total is None or squares is None:
                means.append(None)
                deviations.append(None)
                continue
            means.append(z + total / count)
            if model.surface_names[number] in lacking:
                deviations.append(np.full(len(z), np.nan))
                continue
            rest = np.maximum(squares - total**2 / count, 0.0)
            deviations.append(np.sqrt(rest / max(1, count - 1)))
        result = cls(
            realizer.model,
            realizer.seed,
            realizer.correlation,
            sums.volumes,
            means,
            deviations,
            places,
            sums.counts / count,
        )
        result._realizer = realizer
        return result

    @cached_property
    def _realizer(self) -> Realizer:
        """That made its realizations, or makes them again for the first hole."""
        return Realizer(self.model, self.seed, self.correlation)

    @property
    def block_names(self) -> list[str]:
        """(B,) the names of the blocks, as of the model."""
        return [block.name for block in self.model.blocks]

    def volume_deviations(self) -> np.ndarray:
        """(B,) float64: the standard deviation of each block's volume; NaN of one realization, and where the
        data of a surface that bounds the block show no variogram."""
        if len(self.volumes) < 2:
            return np.full(len(self.model.blocks), np.nan)
        deviations = self.volumes.std(axis=0, ddof=1)
        deviations[without_deviation(self.model)] = np.nan
        return deviations

    def percentiles(self, percent: Iterable[float] = PERCENTILES) -> np.ndarray:
        """(len(percent), B) float64: volumes that so many percent of the realizations do not exceed."""
        return np.percentile(self.volumes, list(percent), axis=0)

    def at(self, begin: int = 0, end: int | None = None) -> Probabilities:
        """The probability of each block at places[begin:end]."""
        return Probabilities(self.block_names, self.probability[begin:end])

    def entropy(self) -> np.ndarray:
        """(N,) float64, bits, as of Probabilities, at each place."""
        return self.at().entropy()

    @keyword_only
    def planned_hole(
        self,
        collar: tuple[float, float, float],
        azimuth: float = 0.0,
        dip: float = 90.0,
        length: float = 100.0,
        *,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> PlannedHole:
        """The result of Model.planned_hole, with the probability of each block along the hole, and the
        standard deviation of the depth of each contact in the realizations that have it. Their surfaces are
        drawn again for it, but not built.

        Raises as Model.planned_hole, Cancelled.
        """
        self.model.require_project("an ensemble")
        hole = self.model.planned_hole(collar, azimuth, dip, length)
        realizer = self._realizer
        count = len(self.volumes)
        return run(
            lambda work: hole_of_realizations(work, realizer, count, hole),
            progress,
            cancel,
            threads=self.model.threads,
        )


def ensemble(
    project: Project,
    realizations: int = 200,
    seed: int = 0,
    *,
    correlation: float = 0.0,
    places: Places | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Ensemble:
    """Builds a project, and realizations of it: models whose interpolated heights and fields are drawn at
    random, as the data and each surface's variogram allow. The result depends on the seed alone.

    correlation: of the errors of each surface with those of the next older one, -1 to 1, for surfaces without
    a correlation. places: (N, 3) points of which the probability of each block is wanted, or a function that
    gives them for the built model. Other arguments as `build`. Raises as `build`; UsageError.

    >>> points = [[0, 0, 1], [4, 0, 2], [4, 4, 2], [0, 4, 1], [2, 2, 3]]
    >>> ground = Surface("ground", points=points, method="kriging", block="soil")
    >>> square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    >>> rock = Rock("hill", [ground], region=square, edge_length=1, base_elevation=-9)
    >>> found = ensemble(Project("hill", [rock]), realizations=10, seed=1)
    >>> found.volumes.shape, found.percentiles([10, 90]).shape
    ((10, 1), (2, 1))
    """
    check_request(realizations, seed, correlation)

    def task(work: Work) -> Ensemble:
        built = 1.0 / (realizations + 1)
        with work.part(0.0, built):
            model = build(project, cells="blocks", threads=threads)
        with work.part(built, 1.0):
            realizer = Realizer(model, seed, correlation)
            return realized(work, realizer, realizations, places_of(model, places))

    return run(task, progress, cancel, threads=threads)


def realized(
    work: Work,
    realizer: Realizer,
    realizations: int,
    points: np.ndarray,
    each: Callable[[Sums], None] | None = None,
) -> Ensemble:
    """An ensemble of a built model, in this thread. points: (N, 3). each: is called with the sums of each
    realization, in their order."""
    steps = np.linspace(0.0, 1.0, realizations + 1)

    def one(number: int) -> Sums:
        with work.part(*steps[number : number + 2]):
            sums = sums_of(realizer, number, points, work.threads)
        if each is not None:
            each(sums)
        return sums

    return Ensemble.of(realizer, added(added(map(one, n)) for n in batches(realizations)), points)


def places_of(model: Model, places: Places | None) -> np.ndarray:
    """(N, 3) float64: the given ones, or the result of a function of the model."""
    points = places(model) if callable(places) else places
    return np.zeros((0, 3)) if points is None else np.asarray(points, np.float64).reshape(-1, 3)


def check_request(realizations: int, seed: int, correlation: float) -> None:
    """Raises UsageError."""
    if realizations < 1:
        raise UsageError(f"an ensemble needs at least one realization, not {realizations}")
    if seed < 0:
        raise UsageError(f"the seed must be a whole number from 0, not {seed}")
    if not -1.0 <= correlation <= 1.0:
        raise UsageError(f"the correlation must lie between -1 and 1, not {correlation:g}")
