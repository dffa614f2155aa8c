# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C and SIGTERM in a batch run."""

import os
import signal
import threading

from . import IN_BLENDER, INTERRUPTED, TERMINATED, say

_SECONDS_TO_UNWIND = 1.0


def terminate(_number, _frame) -> None:
    """Handler of SIGTERM."""
    raise SystemExit(TERMINATED)


def ignore_interruption() -> None:
    """In a moment all files are there: too late to stop."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


class Interruptible:
    """Ctrl-C while Blender renders or saves, when no line of Python runs that could notice it.

    A thread of its own hears the signal. Where the main thread has not gone by then on its own, it drops
    the outputs and ends the process.
    """

    def __init__(self, outputs):
        self.outputs = outputs
        self.left = threading.Event()

    def __enter__(self):
        if IN_BLENDER:
            self._hear, self._told = os.pipe()
            if hasattr(os, "set_blocking"):  # Windows, from Python 3.12 on, and it does not ask for it
                os.set_blocking(self._told, False)
            signal.set_wakeup_fd(self._told)
            threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_error) -> None:
        self.left.set()
        if IN_BLENDER:
            signal.set_wakeup_fd(-1)
            os.close(self._told)

    def _watch(self) -> None:
        while heard := os.read(self._hear, 1):
            status = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}.get(heard[0])
            if status is not None and not self.left.wait(_SECONDS_TO_UNWIND):
                self.outputs.drop()
                os._exit(say("interrupted: nothing was written", status))
        os.close(self._hear)
