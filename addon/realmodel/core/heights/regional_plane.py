# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane around which heights are kriged where nothing is said of their drift: as steep as the data show.

Least squares of few or rough contacts give a slope by chance. Slopes are taken to vary around 0 by as much as
the fitted one is steeper than chance makes it, and the likeliest is taken (empirical Bayes: Efron and Morris
1973, "Stein's estimation rule and its competitors"): across a line of contacts, where they show little, it is
close to 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import dot
from ..base.elementary import atan2, cos, sin
from ..base.mapped_arrays import in_pieces
from ..settings.dips import Dips

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
