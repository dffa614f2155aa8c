# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on a terminal, one bar that fills, or plain lines where the output goes to a file; Ctrl-C and
SIGTERM."""

from __future__ import annotations

import os
import shutil
import signal
import threading
import time
from typing import TextIO

from . import IN_BLENDER, INTERRUPTED, TERMINATED, say

_SECONDS_BETWEEN_LINES = 2.0
_SECONDS_TO_KNOW = 2.0  # before a time left is worth telling
_SHARE_TO_KNOW = 0.02


class TimeLeft:
    """ ", 40 s left", from how fast the fraction has grown since it was first known."""

    def __init__(self):
        self._first: tuple[float, float] | None = None

    def __call__(self, fraction: float, now: float) -> str:
        if self._first is None:
            self._first = fraction, now
        done, seconds = fraction - self._first[0], now - self._first[1]
        if done < _SHARE_TO_KNOW or seconds < _SECONDS_TO_KNOW or fraction >= 1.0:
            return ""
        left = round(seconds / done * (1.0 - fraction))
        if left < 1:
            return ""
        if left < 100:
            return f", {left} s left"
        minutes = round(left / 60)
        return f", {minutes} min left" if minutes < 100 else f", {round(minutes / 60)} h left"


class TerminalProgress:
    """progress(fraction, text) as text. A terminal shows a bar, redrawn in its line; a file gets a line for
    each new phase, and another every two seconds in a long one. Quiet: nothing at all. time_left: the text
    contains the remaining time."""

    def __init__(self, stream: TextIO, quiet: bool = False, time_left: bool = False):
        self.stream = stream
        self.quiet = quiet
        self.time_left = TimeLeft() if time_left else None
        self.bar = not quiet and stream.isatty()
        self._text = ""
        self._drawn = ""
        self._last = 0.0

    def __call__(self, fraction: float, text: str) -> None:
        if self.quiet:
            return
        if self.time_left is not None:
            text += self.time_left(fraction, time.monotonic())
        if self.bar:
            self._draw(fraction, text)
            return
        now = time.monotonic()
        if text and (text != self._text or now - self._last > _SECONDS_BETWEEN_LINES):
            self._text, self._last = text, now
            print(f"{100 * fraction:3.0f} %  {text}", file=self.stream, flush=True)

    def _draw(self, fraction: float, text: str) -> None:
        columns = shutil.get_terminal_size().columns
        width = max(10, min(40, columns - 40))
        filled = round(width * fraction)
        line = f"[{'#' * filled}{'.' * (width - filled)}] {100 * fraction:3.0f} %  {text}"[: columns - 1]
        if line != self._drawn:
            self.stream.write(f"\r{line.ljust(len(self._drawn))}")
            self.stream.flush()
            self._drawn = line

    def close(self) -> None:
        """Removes the bar, so that further output begins on an empty line."""
        if self.bar and self._drawn:
            self.stream.write(f"\r{' ' * len(self._drawn)}\r")
            self.stream.flush()
            self._drawn = ""


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
