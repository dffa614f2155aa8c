# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a separate thread, while the caller's thread reports progress and checks for cancellation.

Only the caller's thread calls progress() and cancel(): in Blender these touch the window, and Ctrl-C
reaches the main thread alone.
"""

from __future__ import annotations

import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, ParamSpec, Protocol, TypeVar, cast

from . import packages
from .errors import BuildFailed, Cancelled
from .packages import extra

if TYPE_CHECKING:
    from ..._native import Native

Reporter = Callable[[float, str], None]  # of the share that is done, and what is being done
Progress = Reporter | Literal[True]  # True: a bar
Cancel = Callable[[], bool]
Item = TypeVar("Item")
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

POLL_SECONDS = 0.04
_PACKAGE = __package__.removesuffix(".core.base")  # "realmodel", or the name of the extension in Blender
_SECONDS_TO_LEAVE = 0.1  # with one poll before it, an answer to cancel() stays within 0.2 s


class NativeError(Protocol):
    """An InputError of the native module, or the same with the numbers of something else. kind: of the input,
    as the bindings name it; surface: its number, -1 for none; items: triangles or points of it."""

    kind: str
    surface: int
    items: list[int]
    place: tuple[float, float, float] | None


class OpenDevice(Protocol):
    """A Device of `_native_cuda`: functions, for an Execution, and what it has to say since the last call: it
    left something to the CPU, or did it in parts."""

    functions: Any

    def messages(self) -> list[str]: ...


def on_threads(threads: int) -> Native.Execution:
    """How a native call is run. threads: 0 for as many as there are."""
    return native_module().Execution(threads)


class Work:
    """What a working thread runs on: its progress, the request to cancel it, and how many threads (0: as many
    as there are) and which device native calls may take."""

    def __init__(self, threads: int = 0, device: OpenDevice | None = None):
        self.threads = threads
        self.device = device
        self._lock = threading.Lock()
        self._execution: Native.Execution | None = None
        self._works: list[Work] = []  # of the items of `each`, while it runs
        self._start, self._end = 0.0, 1.0  # of the present phase, in the present part
        self._part = 0.0, 1.0
        self._share = 0.0
        self._reported = 0.0
        self._text = ""
        self._has_steps = False
        self._cancelled = False

    # -- in the working thread

    @contextmanager
    def phase(self, start: float, end: float, text: str, has_steps: bool = False) -> Iterator[None]:
        """A phase of work: the progress goes from `start` to `end`, both between 0 and 1. has_steps: its
        native call reports its own text."""
        self.check()
        with self._lock:
            self._start, self._end, self._share, self._text = start, end, 0.0, text
            self._has_steps = has_steps
        yield
        self.step(1.0)

    @contextmanager
    def part(self, start: float, end: float) -> Iterator[None]:
        """Within it the phases, from 0 to 1, take the progress from `start` to `end` only: for a job, or a
        step that has its own phases, as a part of another."""
        before = self._part
        low, high = before
        with self._lock:
            self._part = low + (high - low) * start, low + (high - low) * end
            self._start, self._end, self._share = 0.0, 1.0, 0.0
        try:
            yield
        finally:
            with self._lock:
                self._part = before
                self._start, self._end, self._share = start, end, 1.0

    @property
    def stretch(self) -> tuple[float, float]:
        """The progress that the present phase begins and ends at."""
        return self._start, self._end

    def share_out(self, items: Sequence[Item]) -> Iterator[Item]:
        """The items one after the other, each with an equal part of the progress: its phases go from 0 to
        1."""
        for number, item in enumerate(items):
            with self.part(number / len(items), (number + 1) / len(items)):
                yield item

    def step(self, share: float) -> None:
        """Sets the progress of the present phase, 0 to 1. Raises Cancelled if the caller has cancelled."""
        self.check()
        with self._lock:
            self._share = min(max(share, self._share), 1.0)

    def check(self) -> None:
        if self._cancelled:
            raise Cancelled("cancelled")

    def native(
        self, function: Callable[Arguments, Result], *arguments: Arguments.args, **options: Arguments.kwargs
    ) -> Result:
        """Calls a native function that takes an `execution`, as the present phase."""
        native, call = native_module(), cast(Callable[..., Result], function)
        execution = native.Execution(self.threads, self.device)
        with self._lock:
            self._execution = execution
        try:
            self.check()
            return call(*arguments, **options, execution=execution)
        except native.Cancelled as error:
            raise Cancelled("cancelled") from error
        except MemoryError as error:
            doing = execution.text or self._text
            step = f" ({doing})" if doing else ""
            raise BuildFailed(
                f"not enough memory for this model{step}; use fewer triangles or a longer edge length"
            ) from error
        except RuntimeError as error:  # what the native part takes for impossible
            raise BuildFailed(
                f"RealModel has a defect: {error}; please report it, with the input that shows it"
            ) from error
        finally:
            with self._lock:
                self._execution = None

    def each(self, task: Callable[[Work, Item], Result], items: Iterable[Item]) -> list[Result]:
        """[task(work, item) for item in items] as the present phase, several items in parallel where the
        threads allow it. Each item has its own Work, whose phases go from 0 to 1, with a share of the
        threads. Raises the error of the first item that failed."""
        items, threads = list(items), self.threads
        all_threads = threads or os.cpu_count() or 1
        at_once = min(len(items), all_threads)
        if at_once > 1:
            # twice as many threads as there are: while one item keeps one thread busy, another uses the rest
            threads = -(-2 * all_threads // at_once)
        works = [Work(threads, self.device) for _ in items]

        def done(number: int) -> Result:
            before = getattr(_current, "work", None)
            _current.work = works[number]
            try:
                return task(works[number], items[number])
            except BaseException:
                for later in works[number + 1 :]:  # their results are not wanted any more
                    later.cancel()
                raise
            finally:
                _current.work = before

        with self._lock:
            self._works = works
        try:
            self.check()
            if at_once < 2:
                return [done(number) for number in range(len(items))]
            with ThreadPoolExecutor(at_once, "realmodel work") as pool:
                futures = [pool.submit(done, number) for number in range(len(items))]
            return [future.result() for future in futures]
        finally:
            with self._lock:
                self._works = []

    # -- in the caller's thread

    def state(self) -> tuple[float, str]:
        """(fraction of the whole, never falling; what is being done)."""
        with self._lock:
            share = self._share
            if self._execution is not None:
                share = max(share, self._execution.fraction)
            steps = self._execution.text if self._execution is not None and self._has_steps else ""
            text = steps or self._text
            if self._works:
                states = [work.state() for work in self._works]
                share = max(share, sum(fraction for fraction, _ in states) / len(states))
                text = next((text for fraction, text in states if text and fraction < 1.0), text)
            low, high = self._part
            share = self._start + (self._end - self._start) * share
            self._reported = max(self._reported, low + (high - low) * share)
            return self._reported, text

    def cancel(self) -> None:
        with self._lock:
            self._cancelled = True
            if self._execution is not None:
                self._execution.cancel()
            for work in self._works:
                work.cancel()


class Job:
    """A task in a separate thread, under way. Only the thread that started it looks after it."""

    def __init__(self, task: Callable[[Work], Result], threads: int = 0):
        self._work = Work(threads)
        self._ended = threading.Event()
        self._leaves_at: float | None = None  # when a stopped task is no longer waited for
        self._result: Any = None
        self._error: BaseException | None = None
        _leaving[:] = [thread for thread in _leaving if thread.is_alive()]
        # not a daemon: at its end Python must not tear native work out of its thread
        self._thread = threading.Thread(
            target=self._run, args=(task, list(_leaving)), name="realmodel work", daemon=False
        )
        self._thread.start()

    def _run(self, task: Callable[[Work], Any], leaving: list[threading.Thread]) -> None:
        try:
            for thread in leaving:  # so that only one holds memory at a time
                thread.join()
            _current.work = self._work
            self._result = task(self._work)
        except BaseException as error:  # raised by result() in the other thread
            self._error = error
        finally:
            self._ended.set()

    def state(self) -> tuple[float, str]:
        """(fraction done, never falling; what is being done)."""
        return self._work.state()

    def cancel(self) -> None:
        """Asks the task to stop. result() waits for it only briefly: freeing the memory of a large model may
        take seconds. The thread continues alone, and later jobs wait for it."""
        if self._leaves_at is None:
            self._leaves_at = time.monotonic() + _SECONDS_TO_LEAVE
            _leaving.append(self._thread)
        self._work.cancel()

    @property
    def done(self) -> bool:
        """Whether result() answers at once."""
        return self._ended.is_set() or (self._leaves_at is not None and time.monotonic() >= self._leaves_at)

    @property
    def succeeded(self) -> bool:
        """Whether the task has ended, and result() returns what it has returned."""
        return self._ended.is_set() and self._leaves_at is None and self._error is None

    def wait(self, seconds: float | None = None) -> bool:
        """Waits until the job is done, at most so many seconds; returns whether it is."""
        if self._leaves_at is not None:
            left = max(0.0, self._leaves_at - time.monotonic())
            seconds = left if seconds is None else min(seconds, left)
        self._ended.wait(seconds)
        return self.done

    def result(self) -> Any:
        """The result of the task, once it is done; raises its error, or Cancelled."""
        self.wait()
        if self._leaves_at is not None:
            raise Cancelled("cancelled")
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._result


def start(task: Callable[[Work], Result], threads: int = 0) -> Job:
    """Starts task(work) in a new thread. Calls of `run` within the task become parts of it. threads: of
    native calls."""
    return Job(task, threads)


def report_nothing(_share: float, _text: str) -> None:
    """A Reporter for a caller that wants none."""


@contextmanager
def progress_bar() -> Iterator[Reporter]:
    """progress(fraction, text) as a bar of tqdm: a widget in a notebook that has ipywidgets, else text.

    Raises UsageError where tqdm is missing.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # without ipywidgets it warns, and shows text
        tqdm = extra("tqdm.auto", "progress=True").tqdm
    form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
    with tqdm(total=1.0, bar_format=form) as bar:

        def progress(fraction: float, text: str) -> None:
            bar.set_description_str(text, refresh=False)
            bar.update(fraction - bar.n)

        yield progress
        bar.update(1.0 - bar.n)  # it is done, whatever was reported last


def run(
    task: Callable[[Work], Result],
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    threads: int = 0,
) -> Result:
    """Runs task(work) in a separate thread and returns what it returns. threads: of native calls.

    progress(fraction, text) and cancel() are called from this thread every 40 ms. Whatever they raise,
    KeyboardInterrupt included, stops the work and passes on. progress=True shows a bar of tqdm. Raises
    Cancelled where cancel() returned True before the work was done, UsageError where tqdm is missing.

    Within a job, and without these two, the task is done at once as a part of that job, with its threads
    unless `threads` is given.
    """
    if progress is True:
        with progress_bar() as bar:
            return run(task, bar, cancel, threads)
    work = getattr(_current, "work", None)
    if work is not None and progress is None and cancel is None:
        before, work.threads = work.threads, threads or work.threads
        try:
            return task(work)
        finally:
            work.threads = before
    job = start(task, threads)
    try:
        while not job.wait(POLL_SECONDS):
            if progress is not None:
                progress(*job.state())
            if cancel is not None and cancel():
                job.cancel()
                job.wait()
    except BaseException:
        job.cancel()
        while not job.done:
            with suppress(KeyboardInterrupt):  # however often Ctrl-C is pressed meanwhile
                job.wait()
        raise
    result = job.result()
    if progress is not None:
        progress(*job.state())
    return result


def wait_for_stopped() -> None:
    """Waits until tasks that were asked to stop have ended: they use what their caller gave them."""
    for thread in _leaving:
        if thread is not threading.current_thread():
            thread.join()


_current = threading.local()  # work: of the job that this thread does
_leaving: list[threading.Thread] = []  # asked to stop, but perhaps still running


@contextmanager
def _waiting_threads_sleep() -> Iterator[None]:
    """Has OpenMP's threads sleep while they have nothing to do, unless the user said otherwise.

    GNU's spin by default: on a busy machine they then take the time of those that work, and small
    parallel loops get slower by far. The library reads this once, when it is loaded; by Debian's Blender it
    is loaded before.
    """
    name = "OMP_WAIT_POLICY"
    if name in os.environ or "GOMP_SPINCOUNT" in os.environ:
        yield
        return
    was_loaded = _has_loaded("libgomp")
    os.environ[name] = "PASSIVE"
    try:
        yield
    finally:
        os.environ.pop(name, None)
    if was_loaded:
        sys.modules[f"{_PACKAGE}._native"].keep_waiting_threads_asleep()


def _has_loaded(library: str) -> bool:
    """Whether this process has loaded a library, by a part of its file's name; False if that is not known."""
    try:
        return library in Path("/proc/self/maps").read_text(errors="replace")
    except OSError:
        return False


@contextmanager
def refused_as(refusal: Callable[[NativeError], Exception]) -> Iterator[Native]:
    """The native module; its InputErrors within are raised as what `refusal` makes of them."""
    native = native_module()
    try:
        yield native
    except native.InputError as error:
        raise refusal(error) from error


def native_module() -> Native:
    """The compiled part. Raises BuildFailed with the way to get it where it is missing."""
    loaded = sys.modules.get(f"{_PACKAGE}._native")
    if loaded is None:
        try:
            with _waiting_threads_sleep():
                from ... import _native as loaded
        except ImportError as error:
            raise BuildFailed(packages.explanation(error)) from error
    return cast("Native", loaded)
