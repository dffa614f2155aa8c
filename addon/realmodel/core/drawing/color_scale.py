# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of values."""

from __future__ import annotations

import numpy as np

# Cividis (Nunez, Anderton, Renslow 2018, PLoS ONE 13): even in lightness, also for the color-blind; and blue
# over white to red (ColorBrewer's RdBu, Harrower and Brewer 2003). sRGB from 0 to 1, the lowest first.
_RISING = [(0, 34, 78), (55, 68, 108), (106, 107, 115), (158, 148, 119), (213, 194, 102), (254, 232, 55)]
_DIVERGING = [
    (5, 97, 166),
    (103, 169, 207),
    (209, 229, 240),
    (247, 247, 247),
    (253, 219, 199),
    (239, 138, 98),
]
RISING = np.array(_RISING) / 255.0
DIVERGING = np.array([*_DIVERGING, (178, 24, 43)]) / 255.0
UNKNOWN = (0.5, 0.5, 0.5)


def colors(values: np.ndarray, limits: tuple[float, float], scale: np.ndarray = RISING) -> np.ndarray:
    """(N, 4) float32 sRGB colors of values (N,) between limits; those that are NaN are gray."""
    share = (np.asarray(values, np.float64) - limits[0]) / ((limits[1] - limits[0]) or 1.0)
    rgba, steps = np.ones((len(share), 4), np.float32), np.linspace(0.0, 1.0, len(scale))
    for channel in range(3):
        channel_values = np.interp(share, steps, scale[:, channel])
        rgba[:, channel] = np.where(np.isfinite(share), channel_values, UNKNOWN[channel])
    return rgba
