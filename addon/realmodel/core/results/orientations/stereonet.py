# SPDX-License-Identifier: GPL-3.0-or-later
"""Stereonets of the dips of a project: which dips, their numbers, and the drawing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...base.algebra import norm
from ...base.errors import UsageError, counted
from ...drawing.charts import LINE, legend
from ...drawing.drawing import BLACK, GRAY, PAPER, Drawing, text_width
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
_SMALL, _PAD, _LINES_BELOW = 80.0, 8.0, 5  # radius and room of a net beside a model, and its lines of text
_RINGS = 40  # of the places at which densities are examined
_MOST_CIRCLES = 60  # more great circles than this hide each other
_LEVELS = 8
BLUE, RED, GREEN = (0.12, 0.42, 0.70), (0.80, 0.20, 0.15), (0.15, 0.50, 0.25)
ORANGE = (0.95, 0.55, 0.0)


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
        `plunge`, each with the half-angle `within` of its 95 % cone, all in degrees; and `eigenvalues`, which
        add up to 1: of a cluster the first is large, of a girdle the last is small. None: the data do not
        decide, as on the fold axis of equal dips."""
        axes, plane, line = self.axes, None, None
        if axes.mean is not None:
            dip, direction = dip_and_direction(axes.mean)
            plane = {"dip": dip, "dip_direction": direction, "within": axes.mean_error}
        if axes.axis is not None:
            trend, plunge = trend_and_plunge(axes.axis)
            line = {"trend": trend, "plunge": plunge, "within": axes.axis_error}
        return {
            "count": len(self),
            "mean_plane": plane,
            "fold_axis": line,
            "eigenvalues": axes.shares.tolist(),
        }

    def lines(self) -> list[str]:
        """The numbers in words."""
        numbers = self.numbers
        plane, axis = numbers["mean_plane"], numbers["fold_axis"]
        return [
            counted(len(self), "pole"),
            "mean plane: not determined"
            if plane is None
            else f"mean plane: dip {plane['dip']:.1f}° to {plane['dip_direction']:05.1f}°{_within(plane)}",
            "fold axis: not determined"
            if axis is None
            else f"fold axis: {axis['trend']:05.1f}°, plunge {axis['plunge']:.1f}°{_within(axis)}",
            "eigenvalues " + ", ".join(f"{share:.3f}" for share in numbers["eigenvalues"]),
        ]


def _within(entry: dict[str, Any]) -> str:
    return "" if entry["within"] is None else f" ± {entry['within']:.1f}°"


class DipSet(NamedTuple):
    """Dips, and the names of what all of them are of: a rock mass, a series, a surface, or a fault."""

    dips: Dips | SpaceDips
    names: tuple[str, ...]
    of_fault: bool = False

    @property
    def named(self) -> tuple[np.ndarray, ...]:
        """(N,) texts, the surface and the block of each, as of Dips."""
        return self.dips.named if isinstance(self.dips, Dips) else ()

    def all_names(self) -> list[str]:
        """Whatever some of those that are not switched off are of."""
        columns = [column[self.dips.in_use].tolist() for column in self.named]
        names = [*self.names, *(name for column in columns for name in column if name)]
        return list(dict.fromkeys(names)) if self.dips.in_use.any() else []


def dip_sets(project: Project) -> list[DipSet]:
    """The dips of a project that is read."""
    rows: list[tuple[Any, tuple[str | None, ...], bool]] = []
    for rock in project.rocks:
        rows.append((rock.dips, (rock.name,), False))
        rows += [(series.dips, (rock.name, series.name), False) for series in rock.series]
        rows += [
            (surface.dips, (rock.name, surface.name, surface.series), False) for surface in rock.surfaces
        ]
    rows += [(fault.dips, (fault.name,), True) for fault in project.faults]
    return [
        DipSet(dips, tuple(name for name in names if name is not None), of_fault)
        for dips, names, of_fault in rows
        if isinstance(dips, Dips | SpaceDips)
    ]


def dip_names(sets: Iterable[DipSet]) -> list[str]:
    """Whatever some dips that are not switched off are of."""
    return list(dict.fromkeys(name for dip_set in sets for name in dip_set.all_names()))


def normals_of(sets: Sequence[DipSet], of: str | None = None) -> np.ndarray:
    """(N, 3) the normals, of length 1, of dips but those that are switched off. of: as of Model.stereonet.
    Raises UsageError where there are none."""
    normals = np.concatenate([np.empty((0, 3)), *(_chosen(dip_set, of) for dip_set in sets)])
    if not len(normals):
        names = ", ".join(dip_names(sets))
        others = f"; there are dips of {names}" if names and of is not None else ""
        raise UsageError("there are no dips" + (f" of '{of}'" if of is not None else "") + others)
    return normals / norm(normals)[:, None]


def _chosen(dip_set: DipSet, of: str | None) -> np.ndarray:
    """(N, 3) normals of the dips of a set that are of something."""
    dips = dip_set.dips
    if isinstance(dips, SpaceDips):
        normals = np.asarray(dips.normals, np.float64)
    else:
        normals = np.column_stack([-dips.gradients, np.ones(len(dips))])
    is_chosen = dips.in_use
    if of is None and dip_set.of_fault:
        is_chosen = np.zeros(len(dips), bool)
    elif of is not None and of not in dip_set.names:
        is_chosen = is_chosen & np.any([column == of for column in dip_set.named], axis=0)
    return normals[is_chosen]


def draw_stereonet(dips: StereonetData, net: str = EQUAL_AREA) -> Drawing:
    """Poles, contours of their density, great circles (of few dips), the mean plane, and the fold axis with
    its girdle. net: "equal_area" or "equal_angle". Raises UsageError."""
    if net not in NETS:
        raise UsageError(f"there is no net {net!r}; choose from {', '.join(NETS)}")
    lines = dips.lines()
    drawing = Drawing(_LEFT + 2 * _RADIUS + _RIGHT, _BELOW + 2 * _RADIUS + 60.0)
    levels = _draw_net(drawing, dips, net, (_LEFT + _RADIUS, _BELOW + _RADIUS), _RADIUS)
    top = drawing.height - 20
    drawing.text(_LEFT, top, dips.name, _SIZE + 3, layer="Text")
    drawing.text(_LEFT, top - 1.6 * _SIZE, f"Lower hemisphere, {NETS[net]}", _SIZE, layer="Text")
    right = _LEFT + 2 * _RADIUS + 24
    for number, text in enumerate(lines, 1):
        drawing.text(right, _BELOW + 2 * _RADIUS - LINE * _SIZE * number, text, _SIZE, layer="Text")
    entries = [("mean plane and pole", BLUE)] if dips.axes.mean is not None else []
    entries += [("fold axis and girdle", RED)] if dips.axes.axis is not None else []
    if levels:
        entries.append((f"density, every {levels[0]:g} σ", GREEN))
    low = _BELOW + 2 * _RADIUS - LINE * _SIZE * (len(lines) + 2)
    legend(drawing, (right, low), "Lines", entries, _SIZE, layer="Legend")
    return drawing


def draw_beside(
    drawing: Drawing,
    dips: StereonetData,
    net: str,
    place: tuple[float, float],
    marked: np.ndarray | None = None,
) -> float:
    """Draws a small stereonet on a separate paper, whose lower right corner is at a place, with its numbers
    below; returns the left border of the paper. marked: (3,) a pole that is drawn large."""
    (x, y), radius = small_net(place)
    lines = [dips.name, *dips.lines()]
    width = 2 * _PAD + max(2 * 1.12 * radius, *(text_width(text, _SIZE) for text in lines))
    left = place[0] - width
    drawing.rectangle((left, place[1], width, y + 1.2 * radius - place[1]), PAPER, GRAY, 0.6)
    _draw_net(drawing, dips, net, (x, y), radius)
    if marked is not None:
        ((at_x, at_y),) = projected(marked[None], net == EQUAL_AREA).tolist()
        drawing.dots([(x + radius * at_x, y + radius * at_y)], 4.0, ORANGE)
    for number, text in enumerate(reversed(lines)):
        drawing.text(left + _PAD, place[1] + _PAD + LINE * _SIZE * number, text, _SIZE)
    return left


def small_net(place: tuple[float, float]) -> tuple[tuple[float, float], float]:
    """The middle and the radius of the net that draw_beside draws."""
    right, low = place
    below = 2 * _PAD + _LINES_BELOW * LINE * _SIZE + 0.12 * _SMALL
    return (right - _PAD - 1.12 * _SMALL, low + below + _SMALL), _SMALL


def _draw_net(
    drawing: Drawing, dips: StereonetData, net: str, at: tuple[float, float], radius: float
) -> list[float]:
    """Draws a net around a place with all that is in it; returns the levels of density."""
    equal_area, middle = net == EQUAL_AREA, np.array(at)

    def put(places: np.ndarray) -> np.ndarray:
        return middle + radius * places

    if len(dips) <= _MOST_CIRCLES:
        for pole in dips.normals:
            drawing.line(put(great_circle(pole, equal_area)), GRAY, 0.3, layer="Great circles")
    levels = _draw_density(drawing, put, dips, equal_area)
    drawing.dots(put(projected(dips.normals, equal_area)), max(1.2, 0.01 * radius), BLACK, layer="Poles")
    axes = dips.axes
    for pole, color, circle, name in (
        (axes.mean, BLUE, "Mean plane", "Mean pole"),
        (axes.axis, RED, "Girdle", "Fold axis"),
    ):
        if pole is not None:
            drawing.line(put(great_circle(pole, equal_area)), color, 1.4, layer=circle)
            drawing.dots(put(projected(pole[None], equal_area)), max(2.5, 0.022 * radius), color, layer=name)
    angle = np.linspace(0.0, 2 * np.pi, 181)
    drawing.polygon(put(np.column_stack([np.cos(angle), np.sin(angle)])), None, BLACK, 0.8, layer="Net")
    for text, x, y in (("N", 0, 1), ("E", 1, 0), ("S", 0, -1), ("W", -1, 0)):
        (begin,), (place,) = put(np.array([[x, y]])), middle + (radius + 9.6) * np.array([[x, y]])
        drawing.line([begin, middle + 1.03 * (begin - middle)], BLACK, 0.8, layer="Net")
        drawing.text(place[0], place[1] - 0.36 * _SIZE, text, _SIZE, anchor="middle", layer="Net")
    return levels


def _draw_density(drawing: Drawing, put: Any, dips: StereonetData, equal_area: bool) -> list[float]:
    """Draws contours of density, and returns their levels."""
    places, triangles = _places()
    values = density(dips.normals, unprojected(places, equal_area))
    step = 2.0 * max(1.0, np.ceil(values.max() / (2.0 * _LEVELS)))
    levels = [float(level) for level in np.arange(step, values.max(), step)]
    corners = np.column_stack([places, values])[triangles]
    for level in levels:
        for line in level_lines(corners, triangles, triangles, level):
            drawing.line(put(line), GREEN, 0.8, layer="Density")
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
