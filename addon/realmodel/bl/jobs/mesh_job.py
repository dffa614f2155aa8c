# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh for simulation of the built model, made and written in a thread; the scene stays as it is."""

from ...core.base.atomic import Outputs
from ..host.thread_job import ThreadJob

_SHARE = 0.9  # of the progress that making it takes


class MeshJob(ThreadJob):
    """Makes a simulation mesh, writes it, and returns it.

    model: core.Model. request: core.simulation.mesh_request.MeshRequest. unit: of the model's lengths.
    """

    def __init__(self, model, request, unit):
        """Raises UsageError, OutputFailed where the file cannot be written."""
        request.exporter.target(request.path)
        self._model, self._request, self._unit = model, request, unit

    def _work(self, job):
        mesh = self._request.make(self._model, self._threads)
        with job.phase(_SHARE, 1.0, f"writing {self._request.path.name}"), Outputs() as outputs:
            self._request.write(mesh, outputs, self._unit, lambda *_: job.check())
        return mesh
