# SPDX-License-Identifier: GPL-3.0-or-later
"""The built model written to a file in a thread; the scene stays as it is."""

from ..core.exporters import check_tolerance, output_target, save_model
from .thread_job import ThreadJob


class ExportJob(ThreadJob):
    """Writes a model, whole or not at all, and returns the path.

    model: core.Model. options: cell_size, contour_interval, tolerance, as of core.exporters.save_model.
    """

    def __init__(self, model, path, **options):
        """Raises UsageError, OutputFailed where the file cannot be written."""
        check_tolerance(path, options.get("tolerance"))
        output_target(path)
        self._model, self._path, self._options = model, path, options

    def _work(self, job):
        with job.phase(0.0, 1.0, f"writing {self._path.name}"):
            save_model(self._model, self._path, job.step, **self._options)
        return self._path
