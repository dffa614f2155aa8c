# SPDX-License-Identifier: GPL-3.0-or-later
"""Where field data are shown that have no height, and how large all of them are."""

import numpy as np

from ...core.results.layer_values import at_places
from ..display import explosion
from ..objects import built_models
from ..project import settings
from . import data


def of_dips(scene, rock, names, places):
    """(N,) heights of dips of surfaces, by their names (N,), at places (N, 3): where there are none yet,
    those of the surface as it is built, or else the mean height of its points."""
    z = np.array(places, np.float64)[:, 2]
    for name in dict.fromkeys(np.asarray(names)[np.isnan(z)].tolist()):
        mask = np.isnan(z) & (names == name)
        built = _built(scene, rock, name, places[mask])
        z[mask] = np.where(np.isnan(built), _mean(scene, rock, name), built)
    return z


def over_the_ground(scene, rock, places):
    """(N,) the heights of places (N, 3) on the ground of a rock mass, not below its youngest surface as it is
    built, whose triangles may be larger than those of the data."""
    youngest = [surface.name for row, surface in settings.surface_rows(scene) if row.name == rock][-1:]
    z = np.array(places, np.float64)[:, 2]
    return np.fmax(z, _built(scene, rock, youngest[0], places)) if youngest else z


def extent(scene):
    """The size of all data, or of the model."""
    if len(scene.realmodel.results):
        low, high = explosion.bounds(scene)
        return float(np.linalg.norm(np.asarray(high) - low))
    places = [group.places for group in data.groups(scene)]
    if not places:
        return 1.0
    places = np.concatenate(places)
    return float(np.linalg.norm(np.ptp(places, axis=0)[np.isfinite(places).all(axis=0)])) or 1.0


def _built(scene, rock, surface, places):
    model = built_models.current(scene)
    names = [(r.name, s.name) for r, s in settings.surface_rows(scene)]
    if model is None or (rock, surface) not in names or len(model.surface_names) < len(names):
        return np.full(len(places), np.nan)
    return at_places(*model.surface(names.index((rock, surface))), places[:, :2])


def _mean(scene, rock, surface):
    """Of the points of a surface; where it has none, of all."""
    groups = [group for group in data.groups(scene) if group.kind not in data.DIPS and group.rock == rock]
    parts = [group.places[group.names == surface, 2] for group in groups]
    for heights in (np.concatenate(parts), *(group.places[:, 2] for group in groups)) if groups else ():
        if len(heights):
            return float(heights.mean())
    return 0.0
