# SPDX-License-Identifier: GPL-3.0-or-later
"""Stereonets of the dips of a project: which dips, their numbers, and the drawing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...base.algebra import norm
from ...base.errors import UsageError
from ...drawing.charts import LINE, legend
from ...drawing.drawing import BLACK, GRAY, Drawing
from ...notebook import ShortRepr
from ...project.project import Project
from ...settings.dips import Dips, SpaceDips
from ..contours import level_lines
from .axes import (
    Axes3,
    density,
    dip_and_direction,
    great_circle,
    principal,
    projected,
    trend_and_plunge,
    unprojected,
)

EQUAL_AREA, EQUAL_ANGLE = "equal_area", "equal_angle"
NETS = {EQUAL_AREA: "equal area (Schmidt)", EQUAL_ANGLE: "equal angle (Wulff)"}
_RADIUS, _LEFT, _BELOW, _RIGHT, _SIZE = 160.0, 24.0, 24.0, 190.0, 8.0
_RINGS = 40  # of the places at which densities are looked at
_MOST_CIRCLES = 60  # more great circles than this hide each other
_LEVELS = 8
BLUE, RED, GREEN = (0.12, 0.42, 0.70), (0.80, 0.20, 0.15), (0.15, 0.50, 0.25)


@dataclass(frozen=True, eq=False, repr=False)
class StereonetData(ShortRepr):
    """Dips on the lower hemisphere. normals: (N, 3) float64 of length 1, of the bedding. name: of what is
    shown."""

    normals: np.ndarray
    name: str = ""

    def __len__(self) -> int:
        return len(self.normals)

    @cached_property
    def axes(self) -> Axes3:
        """The mean plane and the fold axis."""
        return principal(self.normals)

    @property
    def numbers(self) -> dict[str, Any]:
        """`count`; the `mean_plane` with `dip` and `dip_direction`, the `fold_axis` with `trend` and
        `plunge`, each with the half-angle `within` of its 95 % cone (None: the data do not decide), all in
        degrees; and `eigenvalues`, which add up to 1: of a cluster the first is large, of a girdle the last
        is small."""
        axes = self.axes
        dip, direction = dip_and_direction(axes.mean)
        trend, plunge = trend_and_plunge(axes.axis)
        return {
            "count": len(self),
            "mean_plane": {"dip": dip, "dip_direction": direction, "within": axes.mean_error},
            "fold_axis": {"trend": trend, "plunge": plunge, "within": axes.axis_error},
            "eigenvalues": axes.shares.tolist(),
        }

    def lines(self) -> list[str]:
        """The numbers in words."""
        numbers = self.numbers
        plane, axis = numbers["mean_plane"], numbers["fold_axis"]
        return [
            f"{len(self):,} poles",
            f"mean plane: dip {plane['dip']:.1f}° to {plane['dip_direction']:05.1f}°{_within(plane)}",
            f"fold axis: {axis['trend']:05.1f}°, plunge {axis['plunge']:.1f}°{_within(axis)}",
            "eigenvalues " + ", ".join(f"{share:.3f}" for share in numbers["eigenvalues"]),
        ]


def _within(entry: dict[str, Any]) -> str:
    return "" if entry["within"] is None else f" ± {entry['within']:.1f}°"


def normals_of(project: Project, of: str | None = None) -> np.ndarray:
    """(N, 3) the normals, of length 1, of the dips of a project that is read, but those that are switched
    off. of: as of Model.stereonet. Raises UsageError where there are none."""
    parts = [np.empty((0, 3))]
    for rock in project.rocks:
        parts.append(_chosen(rock.dips, of, (rock.name,)))
        parts += [_chosen(series.dips, of, (rock.name, series.name)) for series in rock.series]
        parts += [
            _chosen(surface.dips, of, (rock.name, surface.name, surface.series)) for surface in rock.surfaces
        ]
    parts += [_chosen(fault.dips, of, (fault.name,)) for fault in project.faults if of is not None]
    normals = np.concatenate(parts)
    if not len(normals):
        raise UsageError("the project has no dips" + (f" of '{of}'" if of is not None else ""))
    return normals / norm(normals)[:, None]


def _chosen(dips: Any, of: str | None, names: tuple[str | None, ...]) -> np.ndarray:
    """(N, 3) normals of the dips that are of something. names: of what all of them are."""
    if not isinstance(dips, Dips | SpaceDips):
        return np.empty((0, 3))
    if isinstance(dips, SpaceDips):
        normals, named = np.asarray(dips.normals, np.float64), [np.full(len(dips), "")]
    else:
        normals = np.column_stack([-dips.gradients, np.ones(len(dips))])
        named = list(dips.named)
    is_chosen = dips.in_use
    if of is not None and of not in names:
        is_chosen = is_chosen & np.any([column == of for column in named], axis=0)
    return normals[is_chosen]


def draw_stereonet(dips: StereonetData, net: str = EQUAL_AREA) -> Drawing:
    """Poles, contours of their density, great circles (of few dips), the mean plane, and the fold axis with
    its girdle. net: "equal_area" or "equal_angle". Raises UsageError."""
    if net not in NETS:
        raise UsageError(f"there is no net {net!r}; choose from {', '.join(NETS)}")
    equal_area, lines = net == EQUAL_AREA, dips.lines()
    drawing = Drawing(_LEFT + 2 * _RADIUS + _RIGHT, _BELOW + 2 * _RADIUS + 60.0)
    middle = np.array([_LEFT + _RADIUS, _BELOW + _RADIUS])

    def at(places: np.ndarray) -> np.ndarray:
        return middle + _RADIUS * places

    if len(dips) <= _MOST_CIRCLES:
        for pole in dips.normals:
            drawing.line(at(great_circle(pole, equal_area)), GRAY, 0.3, layer="Great circles")
    levels = _draw_density(drawing, at, dips, equal_area)
    drawing.dots(at(projected(dips.normals, equal_area)), 1.6, BLACK, layer="Poles")
    axes = dips.axes
    for pole, color, name in ((axes.mean, BLUE, "Mean plane"), (axes.axis, RED, "Girdle")):
        drawing.line(at(great_circle(pole, equal_area)), color, 1.4, layer=name)
    drawing.dots(at(projected(axes.axis[None], equal_area)), 3.5, RED, layer="Fold axis")
    drawing.dots(at(projected(axes.mean[None], equal_area)), 3.5, BLUE, layer="Mean pole")
    angle = np.linspace(0.0, 2 * np.pi, 181)
    drawing.polygon(at(np.column_stack([np.cos(angle), np.sin(angle)])), None, BLACK, 0.8, layer="Net")
    for text, x, y in (("N", 0, 1), ("E", 1, 0), ("S", 0, -1), ("W", -1, 0)):
        (begin,), (place,) = at(np.array([[x, y]])), at(1.06 * np.array([[x, y]]))
        drawing.line([begin, middle + 1.03 * (begin - middle)], BLACK, 0.8, layer="Net")
        drawing.text(place[0], place[1] - 0.36 * _SIZE, text, _SIZE, anchor="middle", layer="Net")
    top = drawing.height - 20
    drawing.text(_LEFT, top, dips.name, _SIZE + 3, layer="Text")
    drawing.text(_LEFT, top - 1.6 * _SIZE, f"Lower hemisphere, {NETS[net]}", _SIZE, layer="Text")
    right = _LEFT + 2 * _RADIUS + 24
    for number, text in enumerate(lines, 1):
        drawing.text(right, _BELOW + 2 * _RADIUS - LINE * _SIZE * number, text, _SIZE, layer="Text")
    entries = [("mean plane and pole", BLUE), ("fold axis and girdle", RED)]
    if levels:
        entries.append((f"density, every {levels[0]:g} σ", GREEN))
    low = _BELOW + 2 * _RADIUS - LINE * _SIZE * (len(lines) + 2)
    legend(drawing, (right, low), "Lines", entries, _SIZE, layer="Legend")
    return drawing


def _draw_density(drawing: Drawing, at: Any, dips: StereonetData, equal_area: bool) -> list[float]:
    """Draws contours of density, and returns their levels."""
    places, triangles = _places()
    values = density(dips.normals, unprojected(places, equal_area))
    step = 2.0 * max(1.0, np.ceil(values.max() / (2.0 * _LEVELS)))
    levels = [float(level) for level in np.arange(step, values.max(), step)]
    corners = np.column_stack([places, values])[triangles]
    for level in levels:
        for line in level_lines(corners, triangles, triangles, level):
            drawing.line(at(line), GREEN, 0.8, layer="Density")
    return levels


def _places() -> tuple[np.ndarray, np.ndarray]:
    """Places (N, 2) in a circle of radius 1, on rings, and the triangles (T, 3) between them."""
    places, triangles, first = [np.zeros((1, 2))], [], 0
    for ring in range(1, _RINGS + 1):
        angle = np.arange(6 * ring) * (np.pi / (3 * ring))
        places.append(ring / _RINGS * np.column_stack([np.cos(angle), np.sin(angle)]))
        inner, outer = max(6 * (ring - 1), 1), 6 * ring
        begin = first + inner
        for sector in range(6):
            for k in range(ring):
                a, b = (begin + (sector * ring + k + step) % outer for step in (0, 1))
                c = first + (sector * (ring - 1) + k) % inner
                triangles.append((a, b, c))
                if k:
                    d = first + (sector * (ring - 1) + k - 1) % inner
                    triangles.append((a, c, d))
        first = begin
    return np.concatenate(places), np.array(triangles)
