# SPDX-License-Identifier: GPL-3.0-or-later
"""The built model written to a file in a thread; the scene stays as it is."""

from ...core.base.atomic import Outputs
from ...core.exporters import MODEL, SURFACES, check_tolerance
from ..host.thread_job import ThreadJob


class ExportJob(ThreadJob):
    """Writes a model, or its surfaces alone, whole or not at all, and returns the path.

    model: core.Model. options: cell_size, contour_interval, tolerance, grid_layers and
    grid_azimuth, as of Model.save.
    """

    def __init__(self, model, path, surfaces_only=False, **options):
        """Raises UsageError, OutputFailed where the file cannot be written."""
        self._exporter = SURFACES if surfaces_only else MODEL
        if not surfaces_only:
            check_tolerance(path, options.get("tolerance"))
        self._exporter.target(path)
        self._model, self._path, self._options = model, path, options

    def _work(self, job):
        with job.phase(0.0, 1.0, f"writing {self._path.name}"), Outputs() as outputs:
            self._exporter.write(self._model, self._path, outputs, job.step, **self._options)
        return self._path
