# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of axes in space: of poles of planes, whose two ends mean the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.algebra import dot, hypot, norm, principal_axes

_WITHIN = -2.0 * float(np.log(0.05))  # of chi squared of two degrees of freedom: 95 %
SIGMA = 3.0  # standard deviations by which a density differs from an even one where Kamb's circle is as wide


@dataclass(frozen=True, eq=False)
class Axes3:
    """The principal axes of N poles (Woodcock 1977, GSA Bulletin 88, 1231-1236).

    mean: (3,) the pole of the mean plane, the axial mean of Bingham (1974, Annals of Statistics 2, 1201);
    axis: (3,) that of the fold, at right angles to the best-fit girdle. Both point down. shares: (3,) the
    normalized eigenvalues of the orientation tensor, the largest first. mean_error, axis_error: degrees, the
    wider half-angle of the elliptic 95 % cone of confidence for large samples (Fisher, Lewis and Embleton
    1987, Statistical analysis of spherical data, section 6.3). Each is None where the data do not decide, as
    on the fold axis of equal dips.
    """

    mean: np.ndarray | None
    axis: np.ndarray | None
    shares: np.ndarray
    mean_error: float | None
    axis_error: float | None


def principal(poles: np.ndarray) -> Axes3:
    """Of unit vectors (N, 3), N from 1."""
    spread, axes = principal_axes(np.concatenate([poles, -poles]))  # whose mean is 0
    shares = spread**2 / (spread**2).sum()
    (mean, mean_error), (axis, axis_error) = (_with_error(poles, axes, shares, which) for which in (0, 2))
    return Axes3(mean, axis, shares, mean_error, axis_error)


def _with_error(
    poles: np.ndarray, axes: np.ndarray, shares: np.ndarray, which: int
) -> tuple[np.ndarray | None, float | None]:
    """One of the axes by its end that points down, and the half-angle in degrees of the cone around it: it
    changes with the tensor by sums over the others, each divided by the difference of their eigenvalues."""
    others = [k for k in range(3) if k != which]
    apart = shares[which] - shares[others]
    if (np.abs(apart) < 1e-9).any():
        return None, None
    down = downward(axes[which, None])[0]
    if len(poles) < 3:
        return down, None
    along = dot(poles[:, None], axes)
    parts = along[:, others] * along[:, which, None] / apart
    (a, c), b = (parts**2).sum(axis=0).tolist(), float((parts[:, 0] * parts[:, 1]).sum())
    spread = ((a + c) / 2 + float(hypot((a - c) / 2, b))) / len(poles) ** 2  # the largest eigenvalue
    sine = float(np.sqrt(_WITHIN * spread))
    return down, float(np.degrees(np.arcsin(sine))) if sine < 1 else None


def downward(axes: np.ndarray) -> np.ndarray:
    """Axes (N, 3) by their ends that point down."""
    return np.where(axes[:, 2:] > 0, -axes, axes)


def density(poles: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(M,) the density of poles (N, 3) at places (M, 3) on the sphere, in standard deviations of that of as
    many poles without order: Kamb's method with exponential weights (Vollmer 1995, Computers & Geosciences
    21, 31-49), with a smoothing of 3 standard deviations."""
    count = len(poles)
    sharpness = 2.0 * (1.0 + count / SIGMA**2)
    deviation = np.sqrt(count * (sharpness / 2.0 - 1.0) / sharpness**2)
    step = max(1, (1 << 20) // max(count, 1))
    sums = [
        np.exp(sharpness * (np.abs(dot(places[k : k + step, None], poles)) - 1.0)).sum(axis=1)
        for k in range(0, len(places), step)
    ]
    return (np.concatenate(sums) - 0.5) / deviation


def trend_and_plunge(axis: np.ndarray) -> tuple[float, float]:
    """Degrees clockwise from north, and below the horizontal, of an axis (3,)."""
    x, y, z = downward(np.asarray(axis, np.float64)[None])[0].tolist()
    return float(np.degrees(np.arctan2(x, y)) % 360.0), float(np.degrees(np.arctan2(-z, np.hypot(x, y))))


def dip_and_direction(pole: np.ndarray) -> tuple[float, float]:
    """Dip and dip direction in degrees of the plane of a pole (3,)."""
    trend, plunge = trend_and_plunge(pole)
    return 90.0 - plunge, (trend + 180.0) % 360.0


def projected(axes: np.ndarray, equal_area: bool = True) -> np.ndarray:
    """(N, 2) the places of axes (N, 3) in a net of radius 1, x to the east, y to the north: in the lower
    hemisphere, of equal area (Schmidt), or of equal angles (Wulff)."""
    down = downward(axes)
    scale = 1.0 / np.sqrt(1.0 - down[:, 2:]) if equal_area else 1.0 / (1.0 - down[:, 2:])
    return down[:, :2] * scale


def unprojected(places: np.ndarray, equal_area: bool = True) -> np.ndarray:
    """(N, 3) unit vectors that point down, of places (N, 2) in a net."""
    squared = dot(places, places)[:, None]
    if equal_area:
        return np.column_stack([places * np.sqrt(np.maximum(2.0 - squared, 0.0)), squared - 1.0])
    return np.column_stack([2.0 * places, squared - 1.0]) / (1.0 + squared)


def great_circle(pole: np.ndarray, equal_area: bool = True, count: int = 181) -> np.ndarray:
    """(count, 2) the plane of a pole (3,) in a net, from border to border."""
    pole = downward(np.asarray(pole, np.float64)[None])[0]
    level = np.array([-pole[1], pole[0], 0.0])
    level = level / norm(level) if norm(level) > 1e-12 else np.array([1.0, 0.0, 0.0])
    down = np.cross(pole, level)
    down = down if down[2] < 0 else -down
    angle = np.linspace(0.0, np.pi, count)[:, None]
    return projected(
        np.cos(angle) * level + np.sin(angle) * np.minimum(down, [np.inf, np.inf, 0.0]), equal_area
    )
