# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread of its own, while the caller's thread shows progress and listens.

Only the caller's thread calls progress() and cancel(): in Blender these touch the window, and Ctrl-C
reaches the main thread alone.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import contextmanager, suppress
from typing import TypeVar

from . import missing_native
from .errors import BuildFailed, Cancelled

Progress = Callable[[float, str], None]
Cancel = Callable[[], bool]
Result = TypeVar("Result")

POLL_SECONDS = 0.04
_PACKAGE = __package__.rpartition(".")[0]  # "realmodel", or what Blender calls an extension
_SECONDS_TO_LEAVE = 0.1  # with one poll before it, an answer to cancel() stays within 0.2 s


class Work:
    """What the working thread tells of itself, and how it learns that it should stop."""

    def __init__(self):
        self._lock = threading.Lock()
        self._control = None
        self._start, self._end = 0.0, 1.0
        self._share = 0.0
        self._told = 0.0
        self._text = ""
        self._cancelled = False

    # -- in the working thread

    @contextmanager
    def phase(self, start: float, end: float, text: str):
        """Work that takes the progress from `start` to `end`, both between 0 and 1."""
        self.check()
        with self._lock:
            self._start, self._end, self._share, self._text = start, end, 0.0, text
        yield
        self.step(1.0)

    def step(self, share: float) -> None:
        """Tells the share done of the present phase. Raises Cancelled where the caller asked to stop."""
        self.check()
        with self._lock:
            self._share = min(max(share, self._share), 1.0)

    def check(self) -> None:
        if self._cancelled:
            raise Cancelled("cancelled")

    def native(self, function: Callable[..., Result], *arguments, **options) -> Result:
        """Calls a native function that takes a `control`, as the present phase."""
        native = native_module()
        control = native.Control()
        with self._lock:
            self._control = control
        try:
            self.check()
            return function(*arguments, control=control, **options)
        except native.Cancelled as error:
            raise Cancelled("cancelled") from error
        except MemoryError as error:
            raise BuildFailed(
                "not enough memory for this model; use fewer triangles or a longer edge length"
            ) from error
        finally:
            with self._lock:
                self._control = None

    # -- in the caller's thread

    def state(self) -> tuple[float, str]:
        """(fraction of the whole, never falling; what is being done)."""
        with self._lock:
            share = self._share
            if self._control is not None:
                share = max(share, self._control.fraction)
            self._told = max(self._told, self._start + (self._end - self._start) * share)
            return self._told, self._text

    def cancel(self) -> None:
        with self._lock:
            self._cancelled = True
            if self._control is not None:
                self._control.cancel()


def run(
    task: Callable[[Work], Result], progress: Progress | None = None, cancel: Cancel | None = None
) -> Result:
    """Runs task(work) in a thread of its own and returns what it returns.

    progress(fraction, text) and cancel() are called from this thread every 40 ms. Whatever they raise,
    KeyboardInterrupt included, stops the work and passes on. Raises Cancelled where cancel() returned True
    before the work was done. Work that was stopped is waited for, but not for long: freeing what a large
    model has taken so far may need seconds, and goes on in its own thread, which later work waits for.
    """
    work = Work()
    done = threading.Event()
    outcome: list = [None, None]

    def target() -> None:
        try:
            _join_leaving()
            outcome[0] = task(work)
        except BaseException as error:  # handed to the caller's thread, which raises it
            outcome[1] = error
        finally:
            done.set()

    # not a daemon: at its end Python must not tear native work out of its thread
    thread = threading.Thread(target=target, name="realmodel work")
    thread.start()
    try:
        while not done.wait(POLL_SECONDS):
            if progress is not None:
                progress(*work.state())
            if cancel is not None and cancel():
                work.cancel()
                _wait(thread)
                break
    except BaseException:
        work.cancel()
        _wait(thread)
        raise
    if not done.is_set():
        raise Cancelled("cancelled")
    thread.join()
    if outcome[1] is not None:
        raise outcome[1]
    if progress is not None:
        progress(*work.state())
    return outcome[0]


_leaving: list[threading.Thread] = []  # told to stop, but not gone yet


def _join_leaving() -> None:
    """Waits for stopped work to end, so that two never hold memory at once."""
    for thread in list(_leaving):
        thread.join()
        with suppress(ValueError):  # other work, which waited as well, has taken it away
            _leaving.remove(thread)


def _wait(thread: threading.Thread) -> None:
    """Waits a moment for a thread that was told to stop, however often Ctrl-C is pressed meanwhile."""
    until = time.monotonic() + _SECONDS_TO_LEAVE
    while thread.is_alive() and time.monotonic() < until:
        with suppress(KeyboardInterrupt):
            thread.join(max(0.0, until - time.monotonic()))
    if thread.is_alive():
        _leaving.append(thread)


@contextmanager
def _waiting_threads_sleep():
    """Has OpenMP's threads sleep while they have nothing to do, unless the user said otherwise.

    GNU's spin by default: on a busy machine they then take the time of those that work, and small
    parallel loops get slower by far. The library reads this once, when it is loaded.
    """
    name = "OMP_WAIT_POLICY"
    if f"{_PACKAGE}._native" in sys.modules or name in os.environ or "GOMP_SPINCOUNT" in os.environ:
        yield
        return
    os.environ[name] = "PASSIVE"
    try:
        yield
    finally:
        os.environ.pop(name, None)


def native_module():
    """The compiled part. Raises BuildFailed with the way to get it where it is missing."""
    try:
        with _waiting_threads_sleep():
            from .. import _native
    except ImportError as error:
        raise BuildFailed(missing_native.explanation(error)) from error
    return _native
