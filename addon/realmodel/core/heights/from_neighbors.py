# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods whose height at a node depends on the points near it: kriging, inverse distances and others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from ..base.algebra import are_among, atan2, cos, dot, sin
from ..base.mapped_arrays import in_pieces
from ..base.work import native_module
from ..settings.dips import Dips
from ..settings.methods import DEFAULT_NEIGHBOURS, METHODS, NEIGHBOURS_OF_FITTED
from ..settings.variogram import Variogram, fit_warnings, missing_data
from .companions import (
    MOST_AT_ONCE,
    MOST_NEIGHBOURS,
    Alike,
    Companions,
    JointData,
    SheetModel,
    first_offsets,
    likeliest,
    likeliest_model,
    plain_model,
    pooled,
)
from .interpolation import Result, Task

# Of the squared spread along the points, across them: with less they lie in one line. Three contacts show no
# error, and how far they may be from a line.
_IN_LINE, _NEAR_LINE = 1e-12, 1e-2


@dataclass(frozen=True, eq=False)
class RegionalPlane:
    """slope: (2,) dz/dx and dz/dy; error: (2, 2) its covariance; center: (2,), where its height is 0."""

    slope: np.ndarray
    error: np.ndarray
    center: np.ndarray

    def at(self, plan: np.ndarray) -> np.ndarray:
        """(N,) its heights at places (N, 2)."""
        return dot(plan - self.center, self.slope)

    def taken_from(self, points: np.ndarray) -> np.ndarray:
        """(P, 3) points with their heights above it."""
        return np.column_stack([points[:, :2], points[:, 2] - self.at(points[:, :2])])

    def slopes_from(self, dips: Dips | None) -> Dips | None:
        """Dips of what lies above it."""
        return None if dips is None else replace(dips, gradients=dips.gradients - self.slope)

    def variance(self, away: np.ndarray) -> np.ndarray:
        """(N,) of a height so far (N, 2) away from where it is known, by the error of the slope."""
        (xx, xy), (_, yy) = self.error.tolist()
        x, y = away.T
        return xx * x * x + 2 * xy * x * y + yy * y * y


def plane_of(
    points: Sequence[np.ndarray], dips: Sequence[tuple[np.ndarray, float] | None]
) -> RegionalPlane | None:
    """The plane that points (P, 3) and dips of parallel surfaces show; None where they show none. dips: of
    each surface the slopes (D, 2), and the length over which one counts as a difference of heights."""
    squares, products, total, free = np.zeros(3), np.zeros(2), 0.0, -2
    center = None
    for part, dip_data in zip(points, dips, strict=True):
        if len(part):
            mean = sum(piece.sum(axis=0) for piece in in_pieces(part)) / len(part)
            center = mean[:2] if center is None else center
            free += len(part) - 1
            for piece in in_pieces(part):
                x, y, z = (piece - mean).T
                squares += [(x * x).sum(), (x * y).sum(), (y * y).sum()]
                products += [(x * z).sum(), (y * z).sum()]
                total += float((z * z).sum())
        if dip_data is not None:
            slopes, length = dip_data
            free += 2 * len(slopes)
            squares += np.array([1, 0, 1]) * len(slopes) * length**2
            products += length**2 * slopes.sum(axis=0)
            total += length**2 * float((slopes * slopes).sum())
    if center is None:
        return None
    xx, xy, yy = squares.tolist()
    angle = float(atan2(np.array([2 * xy]), np.array([xx - yy]))[0]) / 2
    c, s = float(cos(angle)), float(sin(angle))
    axes = np.array([[c, s], [-s, c]])
    spread = np.array([c * c * xx + 2 * c * s * xy + s * s * yy, s * s * xx - 2 * c * s * xy + c * c * yy])
    shown = spread > (_IN_LINE if free > 0 else _NEAR_LINE) * spread.max()
    along = np.where(shown, spread, 1.0)
    fitted = np.where(shown, dot(axes, products) / along, 0.0)
    gain = float((along * fitted * fitted).sum())
    error = max(total - gain, 0.0) / free if free > 0 else 0.0
    varies = (gain - 2 * error) / float(spread.sum() or 1.0)
    if not varies > 0:
        return None
    shrinkage = np.where(shown, along * varies / (along * varies + error), 0.0)
    slope = axes.T[:, 0] * (shrinkage * fitted)[0] + axes.T[:, 1] * (shrinkage * fitted)[1]
    variances = np.where(shown, error * shrinkage / along, varies)
    c2, s2, cs = c * c, s * s, c * s
    p, q = variances.tolist()
    covariance = np.array([[c2 * p + s2 * q, cs * (p - q)], [cs * (p - q), s2 * p + c2 * q]])
    return RegionalPlane(slope, covariance, center)


Beside = TypeVar("Beside", bound=Alike)


def _neighborhood(settings: dict, neighbours: int) -> tuple[int, int, float]:
    return neighbours, settings["octants"], settings["radius"] or 0.0


@dataclass(frozen=True)
class DipUse:
    """How dips count. baseline: a slope is that between the heights at its ends. neighbours: so many of the
    nearest count at a node, 0: all."""

    baseline: float
    neighbours: int

    def native(self, dips: Dips | None) -> tuple | None:
        """The argument of native functions."""
        return None if dips is None else (dips.positions, dips.gradients, self.baseline, self.neighbours)


_TERMS = {"constant": 0, "linear": 2, "quadratic": 5}  # of a drift, beside its mean
_FEWEST_DIPS = 2
_MOST_WITH_ERRORS = 1000  # points with errors that all count at each node
_COARSER = 1.25  # cells by which points are thinned out, from one attempt to the next
_BESIDE = 1e-12  # model units: from a point at 0; its square is no 0


def dip_use(task: Task, variogram: Variogram | None, neighbours: int) -> DipUse:
    """How the dips of a task count, of which at a node `neighbours` points count.

    The baseline is that of the native dip_baseline for a variogram. With a spline (variogram None) a slope at
    a point would have an infinite variance, if only by a logarithm: the slope is that over the mean spacing
    of points and dips. Of as many dips as lie among the nearest points, on average, but no more than of
    these, the nearest count.
    """
    dips, points = task.dips, task.points
    if dips is None:
        return DipUse(1.0, 0)
    baseline = _spacing(points, dips)
    if variogram is not None:
        baseline = native_module().dip_baseline(variogram.native(task.settings["anisotropy"]), baseline)
    share = -(-neighbours * len(dips) // max(len(points), 1))
    return DipUse(baseline, min(max(share, _FEWEST_DIPS), neighbours) if neighbours else 0)


def dips_of_fit(task: Task) -> tuple | None:
    """The dips of a task as the native functions that fit variograms take them."""
    return None if task.dips is None else DipUse(_spacing(task.points, task.dips), 0).native(task.dips)


def _spacing(points: np.ndarray, dips: Dips) -> float:
    """The mean spacing of points and dips together."""
    every = np.vstack([points, np.column_stack([dips.positions, np.zeros(len(dips))])])
    return native_module().mean_spacing(every, are_apart=True)


@dataclass(frozen=True)
class KrigingStructure:
    """The variogram of kriging, its number of neighbors, how dips count, and warnings. sheets: of surfaces
    that are kriged together. plane: around which heights are kriged; None: around their mean. missing: why no
    variance follows from the variogram, or None."""

    variogram: Variogram
    neighbours: int
    dips: DipUse
    warnings: tuple[str, ...] = ()
    sheets: SheetModel | None = None
    plane: RegionalPlane | None = None
    missing: str | None = None


def structure(task: Task) -> KrigingStructure:
    """The variogram of the settings, or fitted to the points."""
    if task.settings.get("drift") == "auto":
        plane = _regional_plane(task)
        return replace(structure(_around(task, plane)), plane=plane)
    if task.companions is not None:
        return _joint_structure(task, task.companions)
    settings = task.settings
    asked, preset = settings["neighbours"], settings["variogram"]
    if preset is not None:
        variogram = Variogram.from_settings(preset)
        neighbours = DEFAULT_NEIGHBOURS if asked is None else asked
        return KrigingStructure(variogram, neighbours, dip_use(task, variogram, neighbours))
    anisotropy = settings["anisotropy"]
    along = None if anisotropy is None else (anisotropy["ratio"], anisotropy["azimuth"])
    has_bounds = task.bounds is not None and len(task.bounds) > 0
    fitted, data = None, ([task.points], [task.dips])
    if native_module().fits_by_likelihood(len(task.points), task.dips is not None, has_bounds, task.error):
        fitted = _fitted_alike(task, along)
        data = data if fitted is None or task.alike is None else task.alike.data(task.points, task.dips)
    fitted = fitted or task.run(
        native_module().fit_variogram,
        task.points,
        anisotropy=along,
        drift=settings.get("drift", "constant"),
        neighbours=min(asked or NEIGHBOURS_OF_FITTED, NEIGHBOURS_OF_FITTED),
        dips=dips_of_fit(task),
        has_bounds=has_bounds,
        error=task.error,
    )
    neighbours = _neighbours_of_fitted(task) if asked is None else asked
    variogram = Variogram.from_fit(fitted, anisotropy is None).with_least_nugget(task.error)
    has_trend = "drift" in settings or task.error > 0  # with errors ranges are those of trends
    warnings = tuple(fit_warnings(variogram, task.points, has_trend, task.dips is not None))
    use, missing = dip_use(task, variogram, neighbours), _missing(task.settings, variogram, *data)
    return KrigingStructure(variogram, neighbours, use, warnings, missing=missing)


def _missing(
    settings: dict, variogram: Variogram, points: Sequence[np.ndarray], dips: Sequence[Dips | None]
) -> str | None:
    """missing_data of the data of surfaces that vary alike: each has a mean, and they have one slope."""
    terms = len([part for part in points if len(part)]) + _TERMS[settings.get("drift", "constant")]
    count = sum(len(slopes) for slopes in dips if slopes is not None)
    return missing_data(variogram, sum(map(len, points)), count, terms)


def _regional_plane(task: Task) -> RegionalPlane | None:
    """The plane that the data of a task show together with those of surfaces that are parallel to its own;
    None for many points: they show what is near, and heights depend on what is near alone."""
    if len(task.points) > MOST_AT_ONCE:
        return None
    points, dips = [task.points], [task.dips]
    if (beside := task.companions or task.alike) is not None:
        points, dips = beside.data(task.points, task.dips)
    each_way = [
        None if slopes is None else (slopes.gradients, _spacing(part, slopes) if len(part) else 1.0)
        for part, slopes in zip(points, dips, strict=True)
    ]
    return plane_of(points, each_way)


def _around(task: Task, plane: RegionalPlane | None) -> Task:
    """A task whose heights are those above a plane, with a constant drift."""
    task = replace(task, settings={**task.settings, "drift": "constant"})
    if plane is None:
        return task

    def above(beside: Beside) -> Beside:
        points = [plane.taken_from(part) for part in beside.points]
        return replace(beside, points=points, dips=[plane.slopes_from(slopes) for slopes in beside.dips])

    bounds = task.bounds and replace(task.bounds, places=plane.taken_from(task.bounds.places))
    return replace(
        task,
        points=plane.taken_from(task.points),
        dips=plane.slopes_from(task.dips),
        bounds=bounds,
        companions=task.companions and above(task.companions),
        alike=task.alike and above(task.alike),
    )


def around_its_plane(task: Task) -> Task:
    """A task with the drift "auto" as ordinary kriging takes it: what lies above its plane."""
    return _around(task, _regional_plane(task))


def _around_plane(task: Task, kriging: KrigingStructure) -> Result:
    """krige around the plane of a structure."""
    plane = kriging.plane
    above = _around(task, plane)
    result = krige(above, replace(kriging, plane=None))
    if plane is None:
        return result
    places = task.points[:, :2] if task.left_out else task.nodes
    z, variance = result.z + plane.at(places), result.variance
    if not task.left_out:
        _honor_exactly(task, above.points, result.z, z)
    if task.companions is not None or (variance is None and not task.left_out):
        return replace(result, z=z)
    away = np.column_stack([_from_neighbours(task, kriging, axis) for axis in np.eye(2)])
    if task.left_out:
        without = [_regional_plane(_without(task, number)) for number in range(len(task.points))]
        slopes = np.array([np.zeros(2) if other is None else other.slope for other in without])
        z = z + dot(slopes - plane.slope, away)
    return replace(result, z=z, variance=None if variance is None else variance + plane.variance(away))


def _honor_exactly(task: Task, above: np.ndarray, kriged: np.ndarray, z: np.ndarray) -> None:
    """Gives nodes on points the points' heights where these were met above the plane, without rounding."""
    points, nodes = task.points, task.nodes
    near = np.flatnonzero(np.isin(nodes[:, 0], points[:, 0]))
    rows = np.flatnonzero(np.isin(points[:, 0], nodes[near, 0]))
    number = {tuple(place): at for place, at in zip(points[rows, :2].tolist(), rows.tolist(), strict=True)}
    for node in near.tolist():
        at = number.get(tuple(nodes[node].tolist()))
        if at is not None and kriged[node] == above[at, 2]:
            z[node] = points[at, 2]


def _from_neighbours(task: Task, kriging: KrigingStructure, axis: np.ndarray) -> np.ndarray:
    """(N,) how far nodes, or points left out, lie along an axis from where their neighbors put them: so much
    of an error of the slope is theirs."""
    steps = RegionalPlane(axis, np.zeros((2, 2)), task.points[0, :2])
    data = np.column_stack([task.points[:, :2], steps.at(task.points[:, :2])])
    dips = task.dips and replace(task.dips, gradients=np.tile(axis, (len(task.dips), 1)))
    flat = replace(task, points=data, dips=dips, settings={**task.settings, "drift": "constant"}, bounds=None)
    return (
        steps.at(task.points[:, :2] if task.left_out else task.nodes)
        - krige(flat, replace(kriging, plane=None)).z
    )


def _without(task: Task, number: int) -> Task:
    return replace(task, points=np.delete(task.points, number, axis=0))


def thinned(method: str, task: Task, points: np.ndarray) -> np.ndarray:
    """The points (P, 3) that count for a surface of a task by a method. Of many with errors one in each cell
    of a grid is enough, as errors along a line are alike, and near ones alone do not show what is between
    lines."""
    is_asked = task.settings.get("neighbours") is not None
    if not (task.error and METHODS[method].may_be_kriged) or is_asked or len(points) <= _MOST_WITH_ERRORS:
        return points
    plan = points[:, :2] - points[:, :2].min(axis=0)
    cell = float(np.hypot(*plan.max(axis=0))) / _MOST_WITH_ERRORS
    while True:
        _, first = np.unique(np.floor(plan / cell), axis=0, return_index=True)
        if len(first) <= _MOST_WITH_ERRORS:
            return np.ascontiguousarray(points[np.sort(first)])
        cell *= _COARSER


def _neighbours_of_fitted(task: Task) -> int:
    """How many points count at a node. Errors of near ones may be alike, as those along a line of a map: all
    points count, or more of them."""
    if not task.error:
        return NEIGHBOURS_OF_FITTED
    return 0 if len(task.points) <= _MOST_WITH_ERRORS else MOST_NEIGHBOURS


def _fitted_alike(task: Task, along: tuple[float, float] | None) -> dict | None:
    """What native fit_alike finds for the surface of a task in the data of all that vary alike; None where
    there are no others, or these show nothing."""
    if task.alike is None:
        return None
    points, dips = task.alike.data(task.points, task.dips)
    drift = task.settings.get("drift", "constant")
    surfaces = [
        (part, None if slopes is None else (slopes.positions, slopes.gradients, _spacing(part, slopes), 0))
        for part, slopes in zip(points, dips, strict=True)
    ]
    arrays = [*points, *(array for _, of_dips in surfaces if of_dips is not None for array in of_dips[:2])]
    error = task.alike.error
    fits = task.alike.fitted(
        (along, drift, error, [of_dips is not None for _, of_dips in surfaces]),
        arrays,
        lambda: task.run(native_module().fit_alike, surfaces, along, drift, error),
    )
    return fits[task.alike.own] if fits else None


def _joint_structure(task: Task, companions: Companions) -> KrigingStructure:
    """structure of the sheets of a series: the likeliest one. Where a part of many points has shown it, what
    sheets lie apart is estimated from all data."""
    points, dips = companions.data(task.points, task.dips)
    data = JointData.of(points, dips, np.zeros(len(points)), 0)
    alone = replace(task, companions=None, bounds=None)
    alone = replace(alone, dips=None if data.dips is None else data.dips.merged()[0])
    count = len(data.points) + 2 * len(data.of_dips)
    if companions.model is not None:
        return _of_model(alone, *companions.model, points, count)
    preset = task.settings["variogram"]

    def with_missing(kriging: KrigingStructure) -> KrigingStructure:
        if preset is not None:
            return kriging
        return replace(kriging, missing=_missing(task.settings, kriging.variogram, points, dips))

    spacing = 1.0 if alone.dips is None else _spacing(pooled(points, np.zeros(len(points))), alone.dips)
    fitted = likeliest(alone.run, alone.settings, companions, data, spacing)
    if fitted is not None and fitted["sill"] > 0:  # data in one plane leave nothing
        variogram = Variogram.from_fit(fitted, task.settings["anisotropy"] is None)
        variogram = variogram if preset is None else Variogram.from_settings(preset)
        model = likeliest_model(fitted, variogram, int(np.argmax([len(part) for part in points])))
        joint = _of_model(alone, variogram, model, points, count)
        if fitted["points"] == len(data.points):
            return with_missing(joint)
        offsets = mean_offsets(alone, joint, points, dips)
        return with_missing(replace(joint, sheets=replace(model, offsets=offsets)))
    offsets = first_offsets(task.work, points)
    variogram = structure(replace(alone, points=pooled(points, offsets))).variogram
    return with_missing(_of_model(alone, variogram, plain_model(offsets, variogram), points, count))


def _of_model(
    task: Task, variogram: Variogram, model: SheetModel, points: Sequence[np.ndarray], count: int
) -> KrigingStructure:
    """The structure of sheets with a variogram and a model. count: of all data."""
    together = replace(task, points=pooled(points, model.offsets))
    asked, fitted = task.settings["neighbours"], task.settings["variogram"] is None
    neighbours = (
        (_neighbours_of_fitted(together) if fitted else DEFAULT_NEIGHBOURS) if asked is None else asked
    )
    kriging = KrigingStructure(variogram, neighbours, dip_use(together, variogram, neighbours), sheets=model)
    return _of_all_sheets(kriging, task, len(points), count)


def _of_all_sheets(kriging: KrigingStructure, task: Task, sheets: int, count: int) -> KrigingStructure:
    """With as many neighbors as sheets that are kriged together have. count: of all data."""
    if task.settings["neighbours"] is not None:
        return kriging
    neighbours = 0 if count <= MOST_AT_ONCE else min(kriging.neighbours * sheets, MOST_NEIGHBOURS)
    use = replace(kriging.dips, neighbours=min(kriging.dips.neighbours * sheets, neighbours))
    return replace(kriging, neighbours=neighbours, dips=use)


def mean_offsets(
    task: Task, known: KrigingStructure, points: Sequence[np.ndarray], dips: Sequence[Dips | None]
) -> np.ndarray:
    """(S,) what each sheet lies above that with the most points: by how much it differs from what the others
    predict at its points, on average; those with the smaller variance count more."""
    assert known.sheets is not None
    offsets, base = known.sheets.offsets.copy(), int(np.argmax([len(part) for part in points]))
    for number, sheet_points in enumerate(points):
        if number == base or not len(sheet_points):
            continue
        others = [part if n != number else part[:0] for n, part in enumerate(points)]
        data = JointData.of(others, dips, offsets, number)
        plan = np.ascontiguousarray(sheet_points[:, :2])
        arguments = _joint_arguments(task, known, data, number)
        z, variance, _ = task.run(native_module().krige, data.points, plan, *arguments)
        weight = 1 / np.maximum(variance, 1e-6 * known.variogram.sill)
        offsets[number] = np.average(sheet_points[:, 2] - z, weights=weight)
    return offsets


def _joint_arguments(task: Task, kriging: KrigingStructure, data: JointData, sheet: int) -> tuple:
    settings = task.settings
    assert kriging.sheets is not None
    return (
        kriging.variogram.native(settings["anisotropy"]),
        _neighborhood(settings, kriging.neighbours),
        settings.get("drift", "constant"),
        kriging.dips.native(data.dips),
        kriging.sheets.native(data.sheets, data.of_dips, sheet, settings["anisotropy"]),
    )


def _cokrige(
    task: Task, companions: Companions, kriging: KrigingStructure
) -> tuple[np.ndarray, np.ndarray, int]:
    """Heights of one sheet at the nodes, or at its own points, each left out; their variances, and how many
    have no point within the radius."""
    assert kriging.sheets is not None
    points, dips = companions.data(task.points, task.dips)
    sheet, offset = companions.own, kriging.sheets.offsets[companions.own]
    data = JointData.of(points, dips, kriging.sheets.offsets, sheet)
    arguments = _joint_arguments(task, kriging, data, sheet)
    native = native_module()
    if task.left_out:
        z, variance, alone = task.run(native.krige_left_out, data.points, *arguments)
        return z[: len(task.points)] + offset, variance[: len(task.points)], alone
    z, variance, alone = task.run(native.krige, data.points, _free_nodes(task), *arguments)
    return z + offset, _of_surface(task, variance, kriging), alone


def _of_surface(task: Task, variance: np.ndarray, kriging: KrigingStructure) -> np.ndarray:
    """(N,) variances of the surface, of those of points at nodes: where points have errors, the nugget is
    theirs, and no part of the surface."""
    return np.maximum(variance - kriging.variogram.nugget, 0.0) if task.error > 0 else variance


def _free_nodes(task: Task) -> np.ndarray:
    """(N, 2) the nodes at which heights are requested: where the surface is tied afterwards, or does not pass
    through its points as these have errors, those at points lie beside them, as a nugget would make spikes at
    them, and none at other points."""
    nodes, plan = task.nodes, task.points[:, :2]
    if not (task.ties or task.error > 0):
        return nodes
    near = np.flatnonzero(np.isin(nodes[:, 0], plan[:, 0]))
    at = near[are_among(nodes[near], plan[np.isin(plan[:, 0], nodes[near, 0])])]
    nodes = np.array(nodes)
    nodes[at, 0] += np.maximum(np.spacing(np.abs(nodes[at, 0])), _BESIDE)
    return nodes


def krige(task: Task, known: KrigingStructure | None = None) -> Result:
    """Ordinary kriging; universal kriging where the settings have a drift. known: the result of
    `structure`."""
    native = native_module()
    settings = task.settings
    if known is None:
        known = structure(task)
    if settings.get("drift") == "auto":
        return _around_plane(task, known)
    warnings = list(known.warnings)
    if task.companions is not None:
        z, variance, alone = _cokrige(task, task.companions, known)
        warnings += without_near_points(alone, len(z))
        return _result(z, variance, known, warnings)
    arguments = (
        known.variogram.native(settings["anisotropy"]),
        _neighborhood(settings, known.neighbours),
        settings.get("drift", "constant"),
        known.dips.native(task.dips),
    )
    if task.left_out:
        z, variance, alone = task.run(native.krige_left_out, task.points, *arguments)
        warnings += without_near_points(alone, len(z))
    else:
        z, variance, _ = task.run(native.krige, task.points, _free_nodes(task), *arguments)
        variance = _of_surface(task, variance, known)
        warnings += _beyond_radius(task)
    return _result(z, variance, known, warnings)


def _result(z: np.ndarray, variance: np.ndarray, kriging: KrigingStructure, warnings: list[str]) -> Result:
    """The variances only where the data show the variogram that they follow from."""
    if kriging.missing is not None:
        warnings = [*warnings, kriging.missing]
    shown = variance if kriging.missing is None else None
    return Result(z, shown, kriging.variogram, warnings, neighbours=kriging.neighbours)


def without_near_points(alone: int, nodes: int) -> list[str]:
    """The warning about nodes without a point within the radius. alone: their number."""
    if not alone:
        return []
    return [
        f"{100 * alone / nodes:.3g} % of the nodes have no point within the radius: there only "
        "the nearest point is used"
    ]


def _beyond_radius(task: Task) -> list[str]:
    radius = task.settings.get("radius")
    if radius is None or not len(task.nodes):
        return []
    away = task.run(native_module().nearest_distance, task.points, task.nodes)
    return without_near_points(int((away > radius).sum()), len(task.nodes))


def nearest_heights(task: Task, nodes: np.ndarray) -> np.ndarray:
    """(N,) heights of the points nearest to nodes."""
    return task.run(native_module().idw, task.points, nodes, neighborhood=(1, 0, 0.0))


def inverse_distance(task: Task) -> Result:
    native = native_module()
    arguments = task.settings["power"], _neighborhood(task.settings, task.settings["neighbours"])
    if task.left_out:
        return Result(task.run(native.idw_left_out, task.points, *arguments))
    z = task.run(native.idw, task.points, task.nodes, *arguments)
    return Result(z, warnings=_beyond_radius(task))


def thin_plate(task: Task, spacing: float = 0.0) -> Result:
    """Thin-plate splines. spacing: the mean spacing of all points, where the task has a part of them; 0: it
    has all."""
    settings = task.settings
    neighbours = settings["neighbours"]
    near, dips = _neighborhood(settings, neighbours), dip_use(task, None, neighbours).native(task.dips)
    z = task.run(native_module().spline, task.points, task.nodes, settings["smoothing"], near, spacing, dips)
    return Result(z, warnings=_beyond_radius(task))
