# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks on the workers of Dask, or one after another in this process."""

from __future__ import annotations

import concurrent.futures
import contextlib
import importlib.util
import logging
import os
import pickle
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from ..core import Cancelled, UsageError
from ..core.base.packages import extra, missing
from ..core.base.work import native_module

_NEEDED = "a run on workers", "dask"  # of what distributed is missing for, and the extra that has it
_POLL_SECONDS = 0.2
_FETCH_SECONDS = 120.0  # for a result, before it counts as lost: its task is done again
_WITHOUT_RESULT = 600.0  # seconds, after which there must be workers
_LOST_RESULT = object()
_ANY_PORT = "127.0.0.1:0"  # None would be Dask's usual port, and a warning where this is taken
_starts = threading.Lock()  # Dask imports what it needs when it starts, which two threads cannot do at once
_SETTINGS = {
    # what Dask measures of itself takes seven percent of a processor while workers are at work
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    # after this time Dask no longer replaces a worker that it has lost, if there is none at that moment
    "distributed.deploy.lost-worker-timeout": "1 day",
}
# Dask has the C library give back memory bit by bit, and as it is it gives back each large array: a tenth of
# a processor, as the next array asks for it again. So it stays in one heap, of which the end is given back
_HEAP = {"MALLOC_ARENA_MAX": 1, "MALLOC_MMAP_THRESHOLD_": 1 << 32, "MALLOC_TRIM_THRESHOLD_": 1 << 28}
_LOGGERS = "distributed", "distributed.client"  # which Dask gives levels of their own
_LOST = 4  # workers at the same task, before Dask gives it up (distributed.scheduler.allowed-failures)


def connected(address: str) -> Any:
    """The client of a running scheduler, for a program with a one-line message if the connection is lost:
    from now on Dask logs nothing in this process. Raises UsageError."""
    distributed = _distributed()
    for name in _LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        return distributed.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise UsageError(f"no scheduler of Dask answers at {address}") from error


def require_this_version(client: Any) -> None:
    """Dask has its scheduler and its workers import what a task calls. Raises UsageError where those of a
    client cannot, or would call another version's. None: there is no client."""
    if client is None:
        return
    version = _version()
    with _connection(client):
        try:
            client.run_on_scheduler(_ready)
        except ImportError as error:
            text = f"the scheduler lacks RealModel {version} ({error}): install it there"
            raise UsageError(text) from error
        of_workers = client.run(_version, on_error="return")
    for address, answer in of_workers.items():
        if isinstance(answer, OSError):
            continue  # a worker that is lost
        if isinstance(answer, Exception):
            text = f"the worker {address} lacks RealModel {version} ({answer}): install it there"
            raise UsageError(text) from answer
        if answer != version:
            text = f"the worker {address} has RealModel {answer}: install {version} there, which this is"
            raise UsageError(text)


class Workers:
    """The workers of a client of Dask, which may be starting yet."""

    def __init__(self, starting: concurrent.futures.Future):
        self._starting = starting

    @property
    def are_up(self) -> bool:
        return self._starting.done()

    @property
    def client(self) -> Any:
        """The client; waits until it is there."""
        return self._starting.result()

    def in_any_order(
        self,
        function: Callable,
        shared: Any,
        tasks: Iterable,
        cancel: Callable[[], object] | None = None,
        *,
        following: Callable[..., Sequence] = lambda _task: (),
        here: bool = False,
    ) -> Iterator[tuple]:
        """(task, function(shared, task)) of each task, as they are done. `shared` goes to each worker once.
        following(task): tasks that can be done when this one is, before what waits. here: this process does
        tasks, too, until the workers are up.

        Raises what a task raises, and Cancelled; the other tasks are then given up.
        """
        tasks = deque(tasks)
        while here and tasks and not self.are_up:
            _check(cancel)
            task = tasks.popleft()
            yield task, function(shared, task)
            tasks.extendleft(reversed(following(task)))
        if tasks:
            yield from _on_workers(self.client, function, shared, tasks, cancel, following)


def _on_workers(
    client: Any,
    function: Callable,
    shared: Any,
    tasks: Iterable,
    cancel: Callable[[], object] | None,
    following: Callable,
) -> Iterator[tuple]:
    """As Workers.in_any_order."""
    distributed = _distributed()
    one_is_done = threading.Event()
    latest = time.monotonic()

    def submitted(function: Callable, *arguments: Any, priority: int = 0) -> Any:
        with _connection(client):
            future = client.submit(function, *arguments, pure=False, priority=priority)
        future.add_done_callback(lambda _: one_is_done.set())
        return future

    def done_of(waiting: Iterable) -> list:
        """Those of some futures that are done, after a short while at most."""
        nonlocal latest
        _check(cancel)
        if client.status == "closed":  # some futures of a client that closes are never done
            raise _gone()
        if time.monotonic() - latest > _WITHOUT_RESULT:
            latest = time.monotonic()
            with _connection(client):
                if not client.nthreads():
                    raise UsageError("Dask has no workers left; start again: finished steps are kept")
        one_is_done.wait(_POLL_SECONDS)
        one_is_done.clear()
        return [future for future in waiting if future.done()]

    with _any_size():
        # and not client.scatter: what this gives to workers is lost with them
        everywhere = submitted(pickle.loads, pickle.dumps(shared))
    while not done_of([everywhere]):
        pass
    with contextlib.suppress(Exception):  # workers that lack it ask others for it, but then they wait for it
        client.replicate(everywhere)
    waiting = {submitted(function, everywhere, task): task for task in tasks}
    try:
        while waiting:
            for future in done_of(waiting):
                result = _result(distributed, future)
                if result is _LOST_RESULT:
                    continue
                task = waiting.pop(future)
                yield task, result
                for next_one in following(task):
                    waiting[submitted(function, everywhere, next_one, priority=1)] = next_one
                latest = time.monotonic()
    finally:
        for future in waiting:
            future.release()  # and not client.cancel, which waits for an answer


def _check(cancel: Callable[[], object] | None) -> None:
    if cancel is not None and cancel():
        raise Cancelled("cancelled")


def no_workers() -> contextlib.AbstractContextManager[Workers]:
    """Some that never come up: for tasks that this process can do."""
    return contextlib.nullcontext(Workers(concurrent.futures.Future()))


@contextlib.contextmanager
def workers_of(client: Any, count: int | None = None) -> Iterator[Workers]:
    """The workers of a client, or None: so many processes of this machine (None: one for each processor),
    which end with it. They start while the caller continues.

    They listen on free ports of this machine alone, so that several of them run beside each other."""
    starting: concurrent.futures.Future = concurrent.futures.Future()
    if client is not None:
        starting.set_result(client)
        yield Workers(starting)
        return
    if importlib.util.find_spec("distributed") is None:
        raise missing("distributed", *_NEEDED)
    with contextlib.ExitStack() as ends, concurrent.futures.ThreadPoolExecutor(1) as apart:

        def start() -> Any:
            with _starts:
                distributed = _distributed()
                ends.enter_context(_settings())
                cluster = distributed.LocalCluster(
                    n_workers=count or os.cpu_count(),
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=_ANY_PORT,
                    silence_logs=logging.CRITICAL,  # what tasks raise comes here; the rest Dask repairs
                )
            ends.enter_context(cluster)
            client = distributed.Client(cluster)
            ends.callback(client.close)
            client.run(_ready)
            return client

        yield Workers(apart.submit(start))


def _settings() -> contextlib.AbstractContextManager:
    """The settings of Dask while workers start and run."""
    import dask

    environment = dask.config.get("distributed.nanny.pre-spawn-environ", {})
    environment = {name: value for name, value in environment.items() if not name.startswith("MALLOC_")}
    environment |= _HEAP
    return dask.config.set({**_SETTINGS, "distributed.nanny.pre-spawn-environ": environment})


def _any_size() -> contextlib.AbstractContextManager:
    """Dask warns of more than 10 MB in a task."""
    import dask

    return dask.config.set({"distributed.admin.large-graph-warning-threshold": 1 << 62})


def _ready() -> None:
    """On a worker: what all tasks import is there when this is."""


def _version() -> str:
    return native_module().VERSION


@contextlib.contextmanager
def _connection(client: Any) -> Iterator[None]:
    """Raises UsageError where a client has lost its scheduler or is closed, for what it raises then."""
    try:
        yield
    except Exception as error:  # its type is another one in each version of Dask
        if client.status == "running" and not isinstance(error, OSError):
            raise
        raise _gone() from error


def _result(distributed: Any, future: Any) -> Any:
    """Of a task that is done. _LOST_RESULT: its worker was lost before the result was fetched, and Dask has
    the task done again."""
    try:
        return future.result(_FETCH_SECONDS)
    except distributed.KilledWorker as error:
        text = f"workers were lost {_LOST} times at the same task: they may lack memory"
        raise UsageError(text) from error
    except (concurrent.futures.CancelledError, distributed.client.FutureCancelledError, OSError) as error:
        if isinstance(error, OSError) and future.status == "error":
            raise
        if isinstance(error, distributed.TimeoutError):
            return _LOST_RESULT
        raise _gone() from error


def _gone() -> UsageError:
    return UsageError("the scheduler or its workers were lost; start again: finished steps are kept")


def _distributed() -> Any:
    return extra("distributed", *_NEEDED)
