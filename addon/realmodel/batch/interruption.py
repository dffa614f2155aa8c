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
    """Called just before the files are moved into place: then it is too late to stop."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


class Interruptible:
    """Handles Ctrl-C while Blender renders or saves and the main thread runs no Python code.

    A separate thread receives the signal. If the main thread has not left after a second, this thread removes
    the outputs and ends the process.
    """

    def __init__(self, outputs):
        self.outputs = outputs
        self.left = threading.Event()

    def __enter__(self):
        if IN_BLENDER:
            self._hear, self._signals = os.pipe()
            if hasattr(os, "set_blocking"):  # Windows, from Python 3.12 on, and it does not ask for it
                os.set_blocking(self._signals, False)
            signal.set_wakeup_fd(self._signals)
            threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_error) -> None:
        self.left.set()
        if IN_BLENDER:
            signal.set_wakeup_fd(-1)
            os.close(self._signals)

    def _watch(self) -> None:
        while heard := os.read(self._hear, 1):
            status = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}.get(heard[0])
            if status is not None and not self.left.wait(_SECONDS_TO_UNWIND):
                self.outputs.drop()
                os._exit(say("interrupted: nothing was written", status))
        os.close(self._hear)
