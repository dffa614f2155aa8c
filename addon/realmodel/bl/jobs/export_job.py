# SPDX-License-Identifier: GPL-3.0-or-later
"""The built model written to a file in a thread; the scene stays as it is."""

from ...core.exporters import check_tolerance, output_target, save_model
from ...core.exporters.surfaces import surface_writer_for
from ..host.thread_job import ThreadJob


class ExportJob(ThreadJob):
    """Writes a model, or its surfaces alone, whole or not at all, and returns the path.

    model: core.Model. options: cell_size, contour_interval, tolerance, as of core.exporters.save_model.
    """

    def __init__(self, model, path, surfaces_only=False, **options):
        """Raises UsageError, OutputFailed where the file cannot be written."""
        if surfaces_only:
            surface_writer_for(path)
        else:
            check_tolerance(path, options.get("tolerance"))
        output_target(path)
        self._model, self._path, self._options = model, path, options
        self._surfaces_only = surfaces_only

    def _work(self, job):
        with job.phase(0.0, 1.0, f"writing {self._path.name}"):
            if self._surfaces_only:
                self._model.save_surfaces(self._path)
                return self._path
            save_model(self._model, self._path, job.step, **self._options)
        return self._path
