# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights that points allow, drawn at random: conditional realizations of an interpolated surface.

A field S with the surface's variogram is drawn without regard to the points. The surface's method
interpolates it from its values at the points. The difference is an error as the method makes it, 0 at the
points; it is added to the interpolated heights (Chiles and Delfiner 2012, "Geostatistics", section 7.3).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np

from ...base.algebra import exp
from ...base.work import native_module
from ...readers.tables.observations import Bounds
from ...settings.methods import SURFACE_OPTIONS, checked_options
from ...settings.variogram import Variogram
from .. import Interpolation, heights
from ..bounded import MethodHeights, active_bounds, consistent, holds_bounds, runner
from ..companions import Companions
from ..from_neighbors import KrigingStructure, around_its_plane, dip_use, dips_of_fit, structure, thinned
from ..interpolation import Result, Task, heights_of
from ..methods import run_method
from ..mis_ties import without_mis_ties
from ..on_mesh import within_bounds
from ..run import with_dips
from ..true_thickness import lifted, measured
from .sheet_draws import SeriesDraw, SheetField, drawn_companions, drawn_dips, nugget_noise
from .turning_bands import FieldArea, GaussianField, Noise

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


_LEAST_POINTS = 3  # fewer show no variogram: their heights count as exact


@dataclass(frozen=True)
class _Known:
    """The data of a surface that do not change between realizations: the interpolated heights, the method and
    the options that reproduce them, counts, (P,) bool, the points that they use, and the variogram. For a
    surface parallel to another one these are of its thickness, and where that is perpendicular to the other
    one, thickness: (N,) the interpolated one at the nodes. joint: of a sheet of a series, what all of them
    have in common. likely: the variograms that few points allow, of which each realization draws one."""

    result: Interpolation
    method: str
    settings: dict
    variogram: Variogram | None
    counts: np.ndarray
    thickness: np.ndarray | None = None
    joint: KrigingStructure | None = None
    likely: LikelyVariograms | None = None


@dataclass(frozen=True)
class Draw:
    """A realization of one surface. known: by points and nodes, filled as they come, shared by all
    realizations of the surface. given: the interpolated heights, where no fault displaces the surface.
    series: what the sheets of its series share in this realization, where it is in one."""

    area: FieldArea
    noise: Noise
    known: dict[bytes, _Known]
    given: Interpolation | None = None
    series: SeriesDraw | None = None

    def heights(self, method: str, task: Task) -> Interpolation:
        """As heights.heights, with a random error added, which is 0 at the points. A realization that would
        lie beyond a bound goes through it."""
        basis = self._known(method, task)
        if basis.variogram is None:
            return basis.result
        if basis.likely is not None:
            basis = self._with_drawn_variogram(task, basis)
        points = thinned(basis.method, task, without_mis_ties(task.points[basis.counts])[0])
        field = self._field_of(basis, task.companions)
        at_points, at_nodes = self._at(task, field, points[:, :2])
        plain = {**basis.settings, **dict.fromkeys(SURFACE_OPTIONS)}
        plain = {option: value for option, value in plain.items() if option in basis.settings}
        free = replace(task, points=points, settings=plain, surfaces={}, bounds=None)
        if basis.joint is not None and basis.joint.sheets is not None and task.companions is not None:
            model = basis.joint.variogram, basis.joint.sheets
            free = replace(free, companions=replace(task.companions, model=model))
        drawn = self._drawn(free, field, basis)
        z = basis.result.z
        if task.bounds is not None and len(task.bounds) and holds_bounds(basis.method):
            supports = self._supports(free, drawn, task.bounds, field, basis, at_points)
            free = replace(free, points=np.vstack([points, supports]))
            at_points = np.concatenate([at_points, field.at(task.work, supports[:, :2])])
            z = heights(basis.method, free).z
        at_data = np.column_stack([free.points[:, :2], at_points])
        error = at_nodes - heights(basis.method, replace(drawn, points=at_data)).z
        if basis.thickness is not None:
            below = heights_of(task, task.settings["to"], task.nodes, "to")
            return replace(basis.result, z=lifted(task, below, basis.thickness + error))
        z = z + error
        return replace(basis.result, z=within_bounds(replace(task, points=points), z, basis.result.z))

    def _with_drawn_variogram(self, task: Task, basis: _Known) -> _Known:
        """With one of the variograms that the points allow, and the heights that it gives."""
        assert basis.likely is not None
        variogram = basis.likely.draw(self.noise)
        settings, result = basis.settings, basis.result
        if "variogram" in settings:
            settings = {**settings, "variogram": variogram.settings()}
            result = replace(result, z=heights(basis.method, replace(task, settings=settings)).z)
        return replace(basis, variogram=variogram, settings=settings, result=result)

    def _field_of(self, basis: _Known, companions: Companions | None) -> GaussianField | SheetField:
        """S: of a sheet of a series together with those of the others."""
        anisotropy = basis.settings.get("anisotropy")
        if basis.joint is None or companions is None:
            assert basis.variogram is not None
            return GaussianField(basis.variogram, anisotropy, self.area, self.noise)
        assert self.series is not None
        return self.series.of(companions.own, self.area, basis.joint, anisotropy)

    def _drawn(self, free: Task, field: GaussianField | SheetField, basis: _Known) -> Task:
        """The task of a surface with the slopes of S where it has dips, and with S of the other sheets; its
        points are those of the surface still."""
        whole, _ = with_dips(basis.method, replace(free, settings=basis.settings))
        if basis.joint is not None:
            baseline = basis.joint.dips.baseline
        else:
            baseline = dip_use(whole, basis.variogram if "variogram" in basis.settings else None, 0).baseline
        dips, companions = None, None
        if whole.dips is not None:
            dips = drawn_dips(free.work, field, whole.dips, baseline)
        if isinstance(field, SheetField):
            companions = drawn_companions(whole, field, baseline)
        return replace(free, dips=dips, companions=companions)

    def _supports(
        self,
        free: Task,
        drawn: Task,
        bounds: Bounds,
        field: GaussianField | SheetField,
        basis: _Known,
        at_points: np.ndarray,
    ) -> np.ndarray:
        """(A, 3) the bounds that support the realization, as points. at_points: (P,) S at the points."""
        run, limits, count = runner(basis.method, free), consistent(free.points, bounds), len(at_points)
        run_drawn = runner(basis.method, drawn)
        at_bounds = field.at(free.work, limits.positions)  # a field is drawn anew for each call
        values = dict(zip(map(tuple, limits.positions.tolist()), at_bounds.tolist(), strict=True))

        def field_at(places: np.ndarray) -> np.ndarray:
            return np.array([values[tuple(place)] for place in places.tolist()])

        def realized(task: Task) -> Result:
            at_data = np.concatenate([at_points, field_at(task.points[count:, :2])])
            data = np.column_stack([task.points[:, :2], at_data])
            error = field_at(task.nodes) - run_drawn(replace(drawn, points=data, nodes=task.nodes)).z
            return Result(run(task).z + error)

        return active_bounds(free.work, free.points, limits, MethodHeights(free, realized, False))

    def _known(self, method: str, task: Task) -> _Known:
        """The data that do not change between realizations. They are not cached for a surface that depends on
        others, as those change, too."""
        if any(isinstance(task.settings.get(option), str) for option in SURFACE_OPTIONS):
            return self._of_result(method, task, heights(method, task))
        points, nodes = np.ascontiguousarray(task.points), task.nodes
        key = hashlib.sha256(points).digest() + hashlib.sha256(nodes).digest()
        if task.dips is not None:
            key += hashlib.sha256(np.hstack([task.dips.positions, task.dips.gradients])).digest()
        if task.bounds is not None:
            key += hashlib.sha256(np.column_stack([task.bounds.places, task.bounds.is_lower])).digest()
        if key not in self.known:
            self.known[key] = self._of_result(method, task, self.given or heights(method, task))
        return self.known[key]

    def _of_result(self, method: str, task: Task, result: Interpolation) -> _Known:
        points, settings = task.points, task.settings
        counts, thickness = np.ones(len(points), bool), None
        if "thickness_method" in settings:
            if settings["thickness"] is not None:
                return _Known(result, method, settings, None, counts)
            under = heights_of(task, settings["to"], np.ascontiguousarray(points[:, :2]), "to")
            counts = np.isfinite(under)
            points = points.copy()
            points[counts] = measured(task, points[counts], under[counts])
            method = settings["thickness_method"]
            settings = checked_options(method, {})
            if task.true_thickness:
                shown = replace(task, points=without_mis_ties(points[counts])[0], settings=settings)
                thickness = run_method(method, shown).z
        elif result.method != method:
            method = result.method
            settings = {**checked_options(method, {}), "extrapolate": settings["extrapolate"]}
        variogram = result.variogram
        plain, _ = without_mis_ties(points[counts])
        if variogram is None and len(np.unique(plain[:, :2], axis=0)) >= _LEAST_POINTS:
            asked = checked_options("kriging", {})
            variogram = structure(replace(task, points=plain, settings=asked)).variogram
        if variogram is not None and "variogram" in settings:
            settings = {**settings, "variogram": variogram.settings()}
            if result.neighbours is not None:
                settings["neighbours"] = result.neighbours
        if variogram is not None and variogram.sill <= 0:
            variogram = None
        joint = None
        if variogram is not None and self.series is not None and task.companions is not None:
            asked = task.settings if "variogram" in settings else checked_options("kriging", {})
            joint = structure(replace(task, points=plain, settings=asked))
            variogram = joint.variogram
        likely = None
        is_fitted = task.settings.get("variogram") is None
        if variogram is not None and joint is None and thickness is None and is_fitted and not task.error:
            likely = LikelyVariograms.of(replace(task, points=plain), settings, variogram)
        return _Known(result, method, settings, variogram, counts, thickness, joint, likely)

    def _at(
        self, task: Task, field: GaussianField | SheetField, points: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """S at points (P, 2) and the nodes; at equal positions it is equal."""
        nodes = task.nodes
        at_points, at_nodes = (field.at(task.work, places) for places in (points, nodes))
        if field.variogram.nugget > 0 and task.error > 0:  # of the points, not of the surface
            at_points = at_points + nugget_noise(self.noise, field.variogram, points)
        elif field.variogram.nugget > 0:
            noise = nugget_noise(self.noise, field.variogram, points, len(nodes))
            of_points, of_nodes = noise[: len(points)], noise[len(points) :]
            number = {tuple(point): n for n, point in enumerate(points.tolist())}
            for node in np.flatnonzero(np.isin(nodes[:, 0], points[:, 0])):
                point = number.get(tuple(nodes[node].tolist()))
                if point is not None:
                    of_nodes[node] = of_points[point]
            at_points, at_nodes = at_points + of_points, at_nodes + of_nodes
        return at_points, at_nodes
