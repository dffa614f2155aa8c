# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts that help to judge a surface: its variogram, cross-validation, and the quality of its mesh.

from realmodel.core import interpolate, plots
from realmodel.core.drawing import save_drawing
save_drawing(plots.variogram(interpolate(points, nodes).variogram), "variogram.svg")
"""

from __future__ import annotations

import numpy as np

from .base.units import METERS, length_text, number_text
from .drawing import Drawing
from .drawing.charts import LINE, Axes, left_margin
from .drawing.drawing import BLACK, GRAY
from .heights.cross_validation import CrossValidation
from .settings.variogram import VARIOGRAMS, Variogram

__all__ = ["cross_validation", "mesh_quality", "smallest_angles", "variogram"]

BLUE, RED = (0.12, 0.42, 0.70), (0.80, 0.20, 0.15)
_PAGE = (260.0, 220.0)  # points, without the words above
_RIGHT, _BELOW = 10.0, 32.0
_SIZE = 8.0
_MANY = 300  # points, beyond which their dots become smaller
_MOST_DOTS = 4000
_FAR = 10_000.0  # meters, from which on lengths are in kilometers or miles
_BINS = np.arange(0.0, 61.0, 2.0)  # degrees


def variogram(
    fitted: Variogram, unit: str = "", page: tuple[float, float] = _PAGE, words: bool = True
) -> Drawing:
    """The semivariance over distance: the curve, and where it was fitted to points the experimental values as
    dots, the larger the more pairs of points they have. unit: of lengths. page: width and height in points;
    words: whether the figures stand above, as in all charts here."""
    longest = 1.5 * fitted.range
    dots = radii = np.empty(0)
    if fitted.fitted and len(fitted.experimental()[0]):
        lags, gamma, pairs = fitted.experimental()
        longest = float(lags[-1]) * 1.05
        dots = np.column_stack([lags, gamma])
        radii = 1.6 + 2.2 * np.sqrt(pairs / pairs.max())
    distance = np.linspace(longest / 400, longest, 400)  # not from 0, where a nugget makes a step
    curve = np.column_stack([distance, fitted.semivariance(distance)])
    highest = max(curve[:, 1].max(), dots[:, 1].max() if len(dots) else 0.0) or 1.0
    axes = _axes((0.0, longest), (0.0, 1.08 * highest), variogram_lines(fitted, unit), page, words)
    axes.frame(_with_unit("Distance", unit), _with_unit("Semivariance", unit and f"{unit}²"))
    if len(dots):
        axes.drawing.dots(axes.at(dots), radii, BLUE)
    axes.drawing.line(axes.at(curve), RED, 1.2)
    return axes.drawing


def variogram_lines(fitted: Variogram, unit: str = "") -> list[str]:
    """The values of a variogram in words, a line for each of its structures."""
    square = f" {unit}²" if unit else ""
    origin = "fitted" if fitted.fitted else "given"
    if not fitted.structures:
        texts = (f"range {_length(fitted.range, unit)}", f"sill {number_text(fitted.sill)}{square}")
        lines = [
            f"{VARIOGRAMS[fitted.model][0]}, {origin}:",
            ", ".join([*texts, f"nugget {number_text(fitted.nugget)}{square}"]),
        ]
    else:
        lines = [f"Nested, {origin}: nugget {number_text(fitted.nugget)}{square}"]
        lines += [
            f"{VARIOGRAMS[part.model][0]}: range {_length(part.range, unit)}, "
            f"sill {number_text(part.sill)}{square}"
            for part in fitted.structures
        ]
    if fitted.anisotropy:
        ratio, azimuth = fitted.anisotropy["ratio"], fitted.anisotropy["azimuth"]
        lines.append(f"anisotropy {ratio:.3g}, azimuth {azimuth:.0f}°")
    if fitted.fitted:
        lines.append("best in cross-validation: the dots may lie off it")
    return lines


def _length(value: float, unit: str) -> str:
    if unit in METERS and value * float(METERS[unit]) >= _FAR:
        return length_text(value, unit)
    return f"{number_text(value)} {unit}".rstrip()


def cross_validation(
    result: CrossValidation, unit: str = "", page: tuple[float, float] = _PAGE, words: bool = True
) -> Drawing:
    """The estimated over the measured elevations of the points of a result of cross_validate; where the
    method has a variance, in two colors, for errors within two standard deviations and beyond. unit, page,
    words: as of `variogram`."""
    is_known = np.isfinite(result.errors)
    places = np.column_stack([result.points[is_known, 2], result.z[is_known]])
    low, high = (float(places.min()), float(places.max())) if len(places) else (0.0, 1.0)
    margin = 0.04 * (high - low) or 0.5
    limits = (low - margin, high + margin)
    axes = _axes(limits, limits, cross_validation_lines(result, unit), page, words)
    axes.frame(_with_unit("Measured", unit), _with_unit("Estimated", unit))
    axes.drawing.line(axes.at([(limits[0], limits[0]), (limits[1], limits[1])]), GRAY, 0.8)
    beyond = np.zeros(len(places), bool)
    if result.standardized is not None:
        beyond = np.abs(result.standardized[is_known]) > 2
    radius = 2.2 * max(min(1.0, _MANY / max(len(places), 1)), 0.1) ** 0.5
    for chosen, color in ((~beyond, BLUE), (beyond, RED)):
        some = places[chosen][:: max(1, int(np.ceil(chosen.sum() / _MOST_DOTS)))]
        axes.drawing.dots(axes.at(some), radius, color)
    return axes.drawing


def cross_validation_lines(result: CrossValidation, unit: str = "") -> list[str]:
    """The figures of a cross-validation in words."""
    end = f" {unit}" if unit else ""
    left = int((~np.isfinite(result.errors)).sum())
    lines = [
        f"{len(result.errors) - left:,} points" + (f" ({left:,} more cannot be estimated)" if left else ""),
        f"RMSE {result.rmse:.4g}{end}, MAE {result.mean_absolute_error:.4g}{end}",
        f"mean error {result.mean_error:.3g}{end}, correlation {result.correlation:.4f}",
    ]
    if result.within_two_deviations is not None:
        lines.append(
            f"{100 * result.within_two_deviations:.1f} % within two standard deviations, the rest in red"
        )
    return lines


def smallest_angles(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(T,) float64: the smallest angle in plan of triangles (T, 3) of vertices (V, 2 or 3), degrees; 60 for
    an equilateral triangle, 0 for one without area."""
    corners = np.asarray(vertices, np.float64)[:, :2][np.asarray(triangles)]
    sides = np.roll(corners, -1, axis=1) - corners
    onward, back = sides, -np.roll(sides, 1, axis=1)
    cross = np.abs(onward[..., 0] * back[..., 1] - onward[..., 1] * back[..., 0])
    return np.degrees(np.arctan2(cross, (onward * back).sum(axis=2)).min(axis=1))


def mesh_quality(angles: np.ndarray, page: tuple[float, float] = _PAGE, words: bool = True) -> Drawing:
    """A histogram of the smallest angles of triangles. angles: as of smallest_angles."""
    counts, edges = np.histogram(angles, _BINS)
    axes = _axes((0.0, 60.0), (0.0, 1.08 * max(counts.max(), 1)), mesh_quality_lines(angles), page, words)
    axes.frame("Smallest angle (°)", "Triangles")
    for count, left, right in zip(counts.tolist(), edges[:-1], edges[1:], strict=True):
        if count:
            corners = [(left, 0), (right, 0), (right, count), (left, count)]
            axes.drawing.polygon(axes.at(corners), BLUE, BLACK, 0.3)
    return axes.drawing


def mesh_quality_lines(angles: np.ndarray) -> list[str]:
    """The smallest angles of triangles in words."""
    return [
        f"{len(angles):,} triangles",
        f"smallest angle {angles.min():.1f}°, on average {angles.mean():.1f}°",
    ]


def _axes(
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    lines: list[str],
    page: tuple[float, float],
    words: bool,
) -> Axes:
    """Axes on a separate page, with lines of text above if requested."""
    above = LINE * _SIZE * len(lines) if words else 0.0
    drawing = Drawing(page[0], page[1] + above)
    height = page[1] - _BELOW - _SIZE
    left = left_margin(y_range, height, _SIZE)
    if words:
        for number, text in enumerate(lines, 1):
            drawing.text(left, drawing.height - LINE * _SIZE * number, text, _SIZE)
    box = (left, _BELOW, page[0] - left - _RIGHT, height)
    return Axes(drawing, box, x_range, y_range, _SIZE)


def _with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name
