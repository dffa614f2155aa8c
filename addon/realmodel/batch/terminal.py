# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on a terminal: one bar that fills, or plain lines where the output goes to a file."""

from __future__ import annotations

import shutil
import time
from typing import TextIO

_SECONDS_BETWEEN_LINES = 2.0


class TerminalProgress:
    """progress(fraction, text) for people. A terminal sees a bar, drawn again in its line; a file gets a
    line for each new phase, and another every two seconds of a long one. Quiet: nothing at all."""

    def __init__(self, stream: TextIO, quiet: bool = False):
        self.stream = stream
        self.quiet = quiet
        self.bar = not quiet and stream.isatty()
        self._text = ""
        self._drawn = ""
        self._last = 0.0

    def __call__(self, fraction: float, text: str) -> None:
        if self.quiet:
            return
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
        """Takes the bar away, so that what follows begins on a clean line."""
        if self.bar and self._drawn:
            self.stream.write(f"\r{' ' * len(self._drawn)}\r")
            self.stream.flush()
            self._drawn = ""
