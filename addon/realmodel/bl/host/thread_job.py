# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread while the main thread shows its progress."""

from ...core.base import work
from .threads import threads


class ThreadJob:
    """Base of the jobs of the panel.

    `start()` runs `_work(job)` of the subclass in a thread; native work there gets `_threads` threads. `done`
    says whether it has ended, `state()` how far it is; `cancel()` stops it. Once it is done, the main thread
    calls `hand_over(seconds)` until that returns True, then `finish()`.
    """

    _threads = 0
    _job = None

    def run(self):
        """Works in this thread; returns as `finish`."""
        self._threads = threads()
        return self._put(work.run(self._work, threads=self._threads))

    def start(self, is_short=False):
        """Starts the work. is_short: it is expected to take less than half a second."""
        self._threads = threads(is_short)
        self._job = work.start(self._work, self._threads)

    @property
    def done(self):
        return self._job.done

    def state(self):
        """(fraction done, text)."""
        return self._job.state()

    def cancel(self):
        self._job.cancel()

    def wait(self):
        """Waits until the work has ended or, if it was cancelled, for a moment."""
        self._job.wait()

    def hand_over(self, _seconds):
        """Prepares data-blocks for about so many seconds; the scene does not change. Returns whether `finish`
        may be called. Here there is nothing to prepare."""
        return True

    def leave(self):
        """Removes the data-blocks that `hand_over` prepared."""

    def finish(self):
        """Puts the result into the scene, and returns it as `_put` does. Raises Cancelled, and the errors of
        `_work(job)`."""
        return self._put(self._job.result())

    def _put(self, made):
        """Puts the result of `_work(job)` into the scene, in the main thread. Here it is only returned."""
        return made
