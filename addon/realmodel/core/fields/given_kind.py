# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a random function of which errors and the range are given, in place of those that the data
make likely."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..base.algebra import norm
from .lattice import Lattice

_ROUNDS = 12  # in which the variance is found, on which the errors depend
_NEAR = 0.02  # of the variance: then it is found
_LONGEST = math.log(100.0)  # step of the logarithm of the variance
# Of Matern's covariance with smoothness 7/2 the distance where it is 0.05, in units of its length.
_PRACTICAL = 6.88
_LEAST_ERRORS = 1e-10, 1e-8  # of values and slopes with a range: less would be singular to rounding
_NOTHING = 1e6  # of the variance of errors: so little of it is nothing
_ONE_WAVE = [1.0] * 7  # normal numbers that make its frequency; its size is 0


class Kind(NamedTuple):
    """A kind of random function as the native module has it; lengths in units of half of the lattice's
    diagonal, variances of errors per unit of the kernel, whose variance is `scale`."""

    anisotropy: tuple[Any, Any]
    order: int
    value_error: float
    slope_error: float
    lift: float
    throws: list
    scale: float
    gaps: list
    centers: list
    left_out: list
    even: list
    even_error: float

    def with_range(self, length: float) -> Kind:
        """That of the fifth order, as smooth in all directions, which tells nothing beyond a length."""
        ratio = _PRACTICAL / length
        smoothest = max(self.anisotropy[1])
        return self._replace(
            anisotropy=(np.eye(3).tolist(), [ratio] * 3), order=5, lift=self.lift * ratio / smoothest
        )

    def with_errors(self, values: float, slopes: float) -> Kind:
        """With variances of errors, of values and slopes."""
        least = _LEAST_ERRORS if self.order == 5 else (0.0, 0.0)
        return self._replace(
            value_error=max(values / self.scale, least[0]), slope_error=max(slopes / self.scale, least[1])
        )

    def without_chance(self, slits: int, dips: int) -> tuple:
        """The argument of the native module for the field that is not drawn but the mean of all."""
        steps = np.zeros(16)
        steps[: len(_ONE_WAVE)] = _ONE_WAVE if self.order == 5 else 0.0
        return tuple(self), np.eye(3 + slits)[0], steps, np.zeros(2 * dips + len(self.even))


Solve = Callable[[Kind], dict[str, Any]]


def solved_as_given(
    likely: dict[str, Any], lattice: Lattice, dip_error: float, length: float | None, solve: Solve
) -> dict[str, Any]:
    """The solution with a range (`length`) in model units, None: that of the data; and with dips that may be
    off by dip_error, a standard deviation in degrees, or by more where the data show it. likely: the solution
    that the data make likely. solve: makes that of a kind.

    What is likely has the errors as variances of f, which stay. The solver wants them per unit of the kernel,
    whose variance depends on them: both are found in rounds.
    """
    found = Kind(*likely["kind"])
    values = found.value_error * found.scale
    slopes = max(found.slope_error * found.scale, math.tan(math.radians(dip_error)) ** 2)
    kind = found._replace(even=[])
    if length is not None:
        low, high = lattice.corners
        kind = kind.with_range(length / (0.5 * float(norm(high - low))))
        kind = kind._replace(value_error=_LEAST_ERRORS[0], slope_error=_LEAST_ERRORS[1])
        kind = kind._replace(scale=solve(kind)["kind"][6])
    if kind.scale == 0.0:  # the drift alone meets all data, and is the field whatever is given
        return likely
    solution, kind = with_variance(kind, values, slopes, solve)
    if found.even and kind.scale > 0.0:
        even_error = found.even_error * found.scale / kind.scale
        solution = solve(kind._replace(even=found.even, even_error=even_error))
        solution["kind"] = tuple(Kind(*solution["kind"])._replace(scale=kind.scale))
    return solution


def with_variance(kind: Kind, values: float, slopes: float, solve: Solve) -> tuple[dict[str, Any], Kind]:
    """The solution of a kind with these variances of errors, and its kind with the variance of the kernel
    that follows from them: by secants of the logarithms of what goes into a round and what comes out. Where
    errors explain all that the data show, it falls until nothing but the drift is left."""
    last: tuple[float, float] | None = None  # a logarithm, and by how much another came out
    for _ in range(_ROUNDS):
        before = math.log(kind.scale)
        solution = solve(kind.with_errors(values, slopes))
        kind = Kind(*solution["kind"])
        if kind.scale == 0.0:
            break
        step = off = math.log(kind.scale) - before
        if last is not None and (off - last[1]) * (before - last[0]) < 0:
            step = -off * (before - last[0]) / (off - last[1])
        elif last is not None:
            step = math.copysign(_LONGEST, off)
        step = max(-_LONGEST, min(_LONGEST, step))
        kind = kind._replace(scale=math.exp(before + step))
        if abs(step) < _NEAR or kind.scale * _NOTHING < values:
            break
        last = before, off
    return solution, kind
