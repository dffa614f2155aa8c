# SPDX-License-Identifier: GPL-3.0-or-later
"""An ensemble of the built model, made in a thread; the main thread puts it into the scene: volumes, and the
blocks of each realization on a section."""

import numpy as np

from ...core.ensembles import Realizer, section_samples
from ...core.ensembles.ensemble import realized
from ..display import cuts, ensembles, explosion, shown_models
from ..host import caches
from ..host.thread_job import ThreadJob
from ..objects import shapes
from ..project import project_settings, settings

_realizers = caches.new(most=1)  # by the stamp of the model and the seed


def realizer_of(model, stamp, seed):
    """The core's Realizer of an ensemble of the model of a scene, with what it knows of its realizations."""
    if (stamp, seed) not in _realizers:
        _realizers[stamp, seed] = Realizer(model, seed)
    return _realizers[stamp, seed]


class EnsembleJob(ThreadJob):
    """So many realizations of the model of a scene.

    line: a curve or mesh object along which the section goes; None: the section plane, or where there is
    none a plane through the middle of the model, seen from the south. `finish()` puts the ensemble into the
    scene and returns it, or raises what went wrong and leaves the scene as it was.
    """

    def __init__(self, scene, realizations, seed, line=None, depsgraph=None):
        """Raises InputRefused."""
        self._count, self._seed = realizations, seed
        self._done = 0
        self._request = shown_models.StageRequest(scene, settings.last_stage(scene))
        self._plane = self._line = None
        origin = project_settings.model_origin(scene)
        if line is not None:
            self._line = shapes.polyline(line, depsgraph) + origin[:2]
        elif cuts.plane_of(scene) is not None:
            self._plane = cuts.plane_in_model(scene)
        else:
            low, high = explosion.bounds(scene)
            self._plane = (np.asarray(low) + high) / 2 + origin, (0.0, -1.0, 0.0)

    def state(self):
        fraction, text = super().state()
        return fraction, f"{self._done} of {self._count} realizations" if self._done else text

    def _work(self, job):
        with job.part(0.0, shown_models.BUILT):
            model = self._request.make()
        with job.part(shown_models.BUILT, 1.0):
            cut = model.section(*self._plane) if self._line is None else model.fence(self._line)
            samples = section_samples(model, cut)
            blocks = []

            def each(sums):
                has_counts = sums.counts.any(axis=1)
                blocks.append(np.where(has_counts, sums.counts.argmax(axis=1), -1).astype(np.int16))
                self._done += 1

            realizer = realizer_of(model, self._request.stamp, self._seed)
            ensemble = realized(job, realizer, self._count, samples.places, each)
        return ensemble, samples, np.stack(blocks)

    def _put(self, made):
        scene = self._request.scene()
        self._request.keep()
        ensembles.put(scene, *made, self._seed)
        return made[0]
