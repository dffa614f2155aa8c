# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on a terminal: one bar that fills, or plain lines where the output goes to a file."""

from __future__ import annotations

import shutil
import time
from typing import TextIO

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
