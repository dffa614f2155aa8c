# SPDX-License-Identifier: GPL-3.0-or-later
"""The throws of faults that the contacts on their sides show, fitted together with what these have in common.

The heights of a surface are a plane, a step at each fault, and a random field that continues across the
faults. Surfaces that lie on one another share the field, or a part of it. The steps are those of generalized
least squares (Chiles and Delfiner 2012, "Geostatistics", section 3.4), with the field that is the likeliest
one (restricted maximum likelihood). Where a field that differs from side to side is likelier, blocks are
turned or bent differently, and no step is what their surfaces differ by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from ...base.algebra import exp, norm
from ...base.work import Work
from ...heights.on_mesh import BOUNDS
from ...settings.methods import METHODS
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import Steps
from ...surfaces.surface_heights import needed_surfaces
from .families import keys_of
from .points_at_faults import contradicting, point_sides

_MOST = 150  # points of a surface: more show how it continues to the fault; and of all fitted at once
_FREE = 2  # points more than unknowns
_RANGES = (0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2, 2.0)  # of the field, of the extent of the points
_NUGGETS = (1e-4, 1e-2, 0.1, 0.5, 1.0)  # of its sill
_SHARES = (0.0, 0.1, 0.5, 1.0)  # of it that is a surface's own, or a compartment's
_INDEPENDENT = 1e-6  # of the length of a column: what is left of it beside the others
_ROUNDING = 1e-6  # of the range of heights: smaller errors are taken to be so large
_LEAST = 1e-100  # the least variance of an error where heights are equal
_LIMIT = 1000  # of an exponent
_BETTER = 1.0 + 1e-6  # times: so much the square of a likelihood has to be greater
_SIGNIFICANT = 15.0  # the same, 95 % (a ratio of likelihoods with one more parameter, at its bound)
_PLAIN = tuple(product(_RANGES, _NUGGETS))
_ALIKE = 5.0  # times the expected one: so large a mean square of what throws of several surfaces differ by


class _Field(NamedTuple):
    """range: of the extent; nugget: of the sill; of_surface, of_block: the shares that a surface and a
    compartment do not have in common with others."""

    range: float
    nugget: float
    of_surface: float
    of_block: float


@dataclass(frozen=True)
class _Fit:
    """Of the columns (Q,) of a model the coefficients and the variances; square: the sum of the squares of
    the errors, of `free` degrees; columns: (Q,) the numbers of those that are independent."""

    coefficients: np.ndarray
    variances: np.ndarray
    square: float
    free: int


@dataclass(frozen=True)
class _Data:
    """points: (P, 3), plan in units of their extent; surface, block: (P,) numbers; sides: (P, F) half the
    side of each fault that parts the data, 0 where it is not there."""

    points: np.ndarray
    surface: np.ndarray
    block: np.ndarray
    sides: np.ndarray

    def model(self, steps: Sequence[np.ndarray]) -> tuple[np.ndarray, list[int]]:
        """(P, Q) columns, as far as they are independent: a constant of each surface, steps, and a slope of
        each surface; and which of the steps are among them."""
        constants = [(self.surface == surface).astype(np.float64) for surface in np.unique(self.surface)]
        slopes = [self.points[:, 0], self.points[:, 1]]
        columns: list[np.ndarray] = []
        units: list[np.ndarray] = []
        step_numbers = []
        for number, column in enumerate([*constants, *steps, *slopes]):
            left = column
            for unit in units:
                left = left - (left * unit).sum() * unit
            if norm(left) > _INDEPENDENT * norm(column):
                columns.append(column)
                units.append(left / norm(left))
                if len(constants) <= number < len(constants) + len(steps):
                    step_numbers.append(number - len(constants))
        return np.column_stack(columns), step_numbers

    def systems(self, columns: np.ndarray, fields: Sequence[_Field]) -> np.ndarray:
        """(K, P + Q + 1, P + Q + 1) covariances of the points in some fields, beside the columns and the
        heights."""
        away = norm(self.points[:, None, :2] - self.points[None, :, :2])
        others = [
            (numbers[:, None] != numbers[None]).astype(np.float64) for numbers in (self.surface, self.block)
        ]
        size, values = len(self.points), np.column_stack([columns, self.points[:, 2]])
        systems = np.zeros((len(fields), size + values.shape[1], size + values.shape[1]))
        for system, field in zip(systems, fields, strict=True):
            lag = np.sqrt(5.0) * away / field.range
            covariance = (1.0 + lag + lag * lag / 3.0) * exp(-lag)  # Matern, 5/2
            covariance *= 1.0 - field.of_surface * others[0]
            covariance *= 1.0 - field.of_block * others[1]
            system[:size, :size] = (1.0 - field.nugget) * covariance + field.nugget * np.eye(size)
            system[:size, size:], system[size:, :size] = values, values.T
        return systems

    @property
    def least(self) -> float:
        """The least variance of an error."""
        return max(float((_ROUNDING * np.ptp(self.points[:, 2])) ** 2), _LEAST)

    def likeliest(self, columns: np.ndarray) -> _Field:
        """Of fields on a grid. One with a share of compartments has to be significantly likelier."""
        common = self._searched(columns, (0.0,))
        return self._first_of_likeliest(columns, [common, self._searched(columns, _SHARES[1:])], _SIGNIFICANT)

    def _searched(self, columns: np.ndarray, of_block: Sequence[float]) -> _Field:
        """The shares that are likeliest with the likeliest range and nugget, and these again."""
        first = of_block[0]
        best = self._first_of_likeliest(columns, [_Field(*plain, 0.0, first) for plain in _PLAIN])
        shares = product(of_block, _SHARES, _NUGGETS)
        fields = [_Field(best.range, nugget, surface, block) for block, surface, nugget in shares]
        best = self._first_of_likeliest(columns, fields)
        return self._first_of_likeliest(columns, [_Field(*plain, *best[2:]) for plain in _PLAIN])

    def _first_of_likeliest(
        self, columns: np.ndarray, fields: Sequence[_Field], better: float = _BETTER
    ) -> _Field:
        """The first field than which none is so many times likelier. The square of a likelihood is 1 over
        two determinants and the errors' variance to the power of their degrees of freedom."""
        size, count = columns.shape
        systems = self.systems(columns, fields)
        value, power = _eliminate(systems, size + count)
        square = np.maximum(np.abs(systems[:, -1, -1]) / (size - count), self.least)
        for _ in range(size - count):
            value, more = np.frexp(value * square)
            power = power + more
        best = 0
        for number in range(1, len(fields)):
            if np.ldexp(value[number], min(power[number] - power[best], _LIMIT)) * better < value[best]:
                best = number
        return fields[best]

    def fit(self, columns: np.ndarray, field: _Field) -> _Fit:
        size, count = columns.shape
        system = self.systems(columns, [field])
        _eliminate(system, size)
        normal = -system[0, size:, size:]
        inverse = np.zeros((1, 2 * count, 2 * count))
        inverse[0, :count, :count] = normal[:count, :count]
        inverse[0, :count, count:] = inverse[0, count:, :count] = np.eye(count)
        _eliminate(inverse, count)
        inverse = -inverse[0, count:, count:]
        coefficients = (inverse * normal[:count, -1]).sum(axis=1)
        square = max(float(normal[-1, -1] - (coefficients * normal[:count, -1]).sum()), 0.0)
        variance = max(square / (size - count), self.least)
        return _Fit(coefficients, variance * np.diagonal(inverse), square, size - count)


def _eliminate(systems: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Eliminates the first rows and columns of symmetric matrices (K, M, M), in place, without a
    library whose last digits differ between processors. Returns the products of the pivots' sizes, as
    np.frexp does."""
    value, power = np.ones(len(systems)), np.zeros(len(systems), np.int64)
    for k in range(count):
        pivot, row = systems[:, k, k].copy(), systems[:, k, k + 1 :].copy()
        value, more = np.frexp(value * np.abs(pivot))
        power += more
        systems[:, k + 1 :, k + 1 :] -= row[:, :, None] * (row / pivot[:, None])[:, None]
    return value, power


def fit_throws(work: Work, entry: RockInput) -> dict[int, Steps]:
    """Of the interpolated surfaces of a RockInput with faults whose compartments differ by steps alone, what
    these are; none where they differ otherwise."""
    structure = entry.divided()
    numbers = [number for number in range(len(entry.rock.surfaces)) if _takes_part(entry, number)]
    parts = {number: columns for number in numbers if (columns := _parted(work, entry, number)) is not None}
    if not parts:
        return {}
    points, keys = (np.concatenate(arrays) for arrays in zip(*parts.values(), strict=True))
    surface = np.repeat(list(parts), [len(surface_points) for surface_points, _ in parts.values()])
    extent = float(np.ptp(points[:, :2], axis=0).max())
    origin = np.array([*points[:, :2].mean(axis=0), points[:, 2].mean()])
    points = (points - origin) / np.array([extent, extent, 1.0])
    _, block = np.unique(keys, axis=0, return_inverse=True)
    every = -(-len(points) // _MOST)
    data = _Data(*(array[::every] for array in (points, surface, block.ravel(), keys / 2.0)))
    steps, deviations = _fitted(data, list(parts), len(structure.faults))
    return {
        number: Steps(steps[row], deviations[row])
        for row, number in enumerate(parts)
        if np.isfinite(steps[row]).any()
    }


def _fitted(data: _Data, numbers: list[int], faults: int) -> tuple[np.ndarray, np.ndarray]:
    """(S, F) the steps of some surfaces and their standard deviations: NaN where they are not shown; 0 where
    a step is smaller than its deviation."""
    steps, deviations = np.full((2, len(numbers), faults), np.nan)
    in_surface = np.array([data.surface == number for number in numbers])
    parts = [[(row, fault)] for fault in range(faults) for row in range(len(numbers))]
    together = [[(row, fault) for row in range(len(numbers))] for fault in range(faults)]

    def model(unknown: list[list[tuple[int, int]]]) -> tuple[np.ndarray, list[int]]:
        """The columns of steps, each of a fault in some surfaces."""
        of = [
            np.where(in_surface[[row for row, _ in places]].any(axis=0), data.sides[:, places[0][1]], 0.0)
            for places in unknown
        ]
        return data.model(of)

    shared, independent = model(together)
    unknown = [together[number] for number in independent]
    if not unknown or len(shared) - shared.shape[1] < _FREE:
        return steps, deviations
    field = data.likeliest(shared)
    apart, of_parts = model(parts)
    if len(of_parts) > len(independent) and len(apart) - apart.shape[1] >= _FREE:
        common = field._replace(of_block=0.0)
        bound, free = data.fit(shared, common), data.fit(apart, common)
        expected = max(bound.square / bound.free, data.least) * (bound.free - free.free)
        if bound.square - free.square > _ALIKE * expected:
            unknown, field = [parts[number] for number in of_parts], data.likeliest(apart)
    if field.of_block > 0.0:
        return steps, deviations
    while unknown:
        columns, independent = model(unknown)
        unknown = [unknown[number] for number in independent]
        first = len(np.unique(data.surface))
        fitted = data.fit(columns, field)
        values = fitted.coefficients[first : first + len(unknown)]
        errors = np.sqrt(fitted.variances[first : first + len(unknown)])
        for places, value, error in zip(unknown, values, errors, strict=True):
            for place in places:
                steps[place], deviations[place] = value, error
        least = int((np.abs(values) / errors).argmin())
        if not np.abs(values[least]) < errors[least]:
            break
        for place in unknown.pop(least):
            steps[place] = 0.0
    return steps, deviations


def _takes_part(entry: RockInput, number: int) -> bool:
    """Whether a surface is one of few points that faults part which do not die out, and nothing else says
    what it is."""
    surface, data, faults = entry.rock.surfaces[number], entry.data[number], entry.divided().faults
    if not entry.rock.is_interpolated(surface) or not 0 < len(data.points) <= _MOST:
        return False
    method, settings = surface.method_options()
    dies_out = np.array(faults.dies_out, bool)[faults.active(number)]
    return (
        METHODS[method].has_shape
        and METHODS[method].has_contacts
        and all(settings.get(option) is None for option in ("dip", *BOUNDS))
        and surface.tie
        and surface.minimum_thickness is None
        and data.dips is None
        and not len(data.bounds)
        and not needed_surfaces(entry.rock, number)
        and not dies_out.any()
    )


def _parted(work: Work, entry: RockInput, number: int) -> tuple[np.ndarray, np.ndarray] | None:
    """The points (P, 3) of a surface whose sides are known by their places, and the keys (P, F) of their
    families; None where these are one."""
    points, contacts = entry.data[number].points, entry.data[number].contacts
    structure = entry.divided()
    sides, moved, *_ = point_sides(work, points, entry, number)
    rows = np.where(structure.faults.active(number), sides, 0)
    is_kept = ~(contradicting(points, rows, contacts) | moved.any(axis=1))
    keys = keys_of(structure, number, sides[is_kept])
    return (points[is_kept], keys) if len(np.unique(keys, axis=0)) > 1 else None
