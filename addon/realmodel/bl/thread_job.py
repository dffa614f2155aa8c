# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread of its own beside a window that stays alive."""

import os
import threading

from .. import preferences
from ..core import Cancelled

_chosen = 0  # the preference, as the main thread has read it last: another thread may not


def threads(is_short=False):
    """How many threads native work may take: as the preferences say, else all (0) for what is over at once.
    Otherwise one is left to the window, or it would stand still for half a second."""
    global _chosen
    if threading.current_thread() is threading.main_thread():
        _chosen = preferences.current().threads
    return _chosen or (0 if is_short else max(1, (os.cpu_count() or 1) - 1))


class ThreadJob:
    """One piece of work that has begun.

    task(job) touches nothing of Blender. It may ask `job.cancelled` and tell how far it is by
    `job.tell(fraction, text)`.
    """

    def __init__(self, name, task):
        threads()
        self.cancelled = False
        self._told = (0.0, "starting")
        self._result = self._error = None
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, args=(task,), name=f"realmodel {name}")
        self._thread.start()

    def _work(self, task):
        try:
            self._result = task(self)
        except BaseException as error:  # handed to the main thread, which raises it
            self._error = error
        finally:
            self._ended.set()

    def tell(self, fraction, text):
        self._told = (fraction, text)

    def state(self):
        """(fraction done, what is being done)."""
        return self._told

    @property
    def done(self):
        return self._ended.is_set()

    @property
    def succeeded(self):
        """Whether the task has ended, and `result` will return what it has returned."""
        return self.done and not self.cancelled and self._error is None

    def cancel(self):
        self.cancelled = True

    def wait(self, seconds=None):
        """Waits for the thread to end."""
        self._thread.join(seconds)

    def result(self):
        """What the task has returned, once it has; raises what it has raised, and Cancelled."""
        self.wait()
        if self.cancelled:
            raise Cancelled("cancelled")
        if self._error is not None:
            raise self._error
        return self._result
