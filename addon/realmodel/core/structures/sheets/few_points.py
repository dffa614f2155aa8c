# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that are too few to show the shape of a surface in a compartment, and how these are interpolated on
the sheet of a neighbor, as a trend."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...base.algebra import dot, principal_axes
from ...project.project import Surface
from ...settings.methods import METHODS

_OF_A_FOLD = 6  # places that a second-order surface needs, the simplest that is bent
_OF_A_PLANE = 3
_SHARE = 0.1  # of the compartment's width: points in a narrower strip say nothing across it


def are_few(
    surface: Surface, points: np.ndarray, nodes: np.ndarray, within: Callable[[np.ndarray], np.ndarray]
) -> bool:
    """Whether points (P, 3) of a compartment do not show the shape of a surface there.

    They are fewer than six, three for a plane, not counting those at one place; or all in a strip narrower
    than a tenth of the compartment's width in that direction, as along a section or of a group of wells.
    nodes: (N, 2) of the planar mesh; within: which of points (N, 3) lie in the compartment. None are few for
    a method that only takes a height from them.
    """
    method, settings = surface.method_options()
    if not METHODS[method].has_shape or settings.get("dip") is not None:
        return False
    places = np.unique(points[:, :2], axis=0)
    if len(places) < (_OF_A_PLANE if method == "plane" else _OF_A_FOLD):
        return True
    across = principal_axes(places)[1][1]
    width, share = float(np.ptp(dot(places, across))), _SHARE * dot(nodes, across)
    if width >= np.ptp(share):  # of the whole region: no compartment is wider
        return False
    inside = within(np.column_stack([nodes, np.full(len(nodes), points[:, 2].mean())]))
    return bool(inside.any()) and width < float(np.ptp(share[inside]))


def of_residuals(surface: Surface) -> tuple[str, dict]:
    """The method, and its options, by which what few points differ from a trend is interpolated: inverse
    distance. Others would continue beyond the points with slopes that so few do not show. A plane stays."""
    return ("constant", {}) if surface.method == "plane" else ("idw", {"extrapolate": "method"})
