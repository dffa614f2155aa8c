# SPDX-License-Identifier: GPL-3.0-or-later
"""Where field data are shown that have no height, and how large all of them are."""

import numpy as np

from ...core.results.layer_values import at_places
from .. import built_models, settings
from ..display import explosion
from . import data


def of_dips(scene, rock, surface, places):
    """(N,) heights of dips of a surface at places (N, 3): where there are none yet, those of the surface as
    it is built, or else the mean height of its points."""
    z = np.array(places, np.float64)[:, 2]
    if np.isnan(z).any():
        known = _built(scene, rock, surface, places[np.isnan(z)])
        z[np.isnan(z)] = np.where(np.isnan(known), _mean(scene, rock, surface), known)
    return z


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
    found = [
        group.places[:, 2]
        for group in data.groups(scene)
        if group.kind != data.DIP and group.rock == rock and surface in group.names
    ]
    return float(np.mean(np.concatenate(found))) if found else 0.0
