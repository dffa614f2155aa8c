# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks on the workers of Dask, or one after another in this process."""

from __future__ import annotations

import concurrent.futures
import contextlib
import os
import time
from collections.abc import Callable, Iterator, Sequence

from ..core import Cancelled, UsageError

_POLL_SECONDS = 0.2
_ANY_PORT = "127.0.0.1:0"  # None would be Dask's usual port, and a warning where this is taken
# What Dask measures of itself takes seven percent of a processor while workers are at work
_QUIET = {"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s"}
_LOST = 4  # workers at the same task, before Dask gives it up (distributed.scheduler.allowed-failures)


def connected(address: str):
    """The client of a running scheduler. Raises UsageError."""
    distributed = _distributed()
    try:
        return distributed.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise UsageError(f"no scheduler of Dask answers at {address}") from error


@contextlib.contextmanager
def client_of(given, workers: int | None = None):
    """`given`, or a client of so many processes of this machine, None: one for each processor, which end with
    it.

    They listen on free ports of this machine alone, so that several of them run beside each other."""
    if given is not None:
        yield given
        return
    distributed = _distributed()
    import dask

    with (
        dask.config.set(_QUIET),
        distributed.LocalCluster(
            n_workers=workers or os.cpu_count(),
            threads_per_worker=1,
            processes=True,
            dashboard_address=_ANY_PORT,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def in_any_order(client, function: Callable, shared, tasks: Sequence, cancel=None) -> Iterator[tuple]:
    """(task, function(shared, task)) of each task, as they are done. `shared` goes to each worker once.

    Raises what a task raises, and Cancelled; the other tasks are then given up.
    """
    distributed = _distributed()
    everywhere = client.scatter(shared, broadcast=True, hash=False)
    waiting = {client.submit(function, everywhere, task, pure=False): task for task in tasks}
    try:
        while waiting:
            if cancel is not None and cancel():
                raise Cancelled("cancelled")
            done = [future for future in waiting if future.done()]
            if not done:
                time.sleep(_POLL_SECONDS)
            for future in done:
                task = waiting.pop(future)
                yield task, _result(distributed, future)
    finally:
        client.cancel(list(waiting))


def _result(distributed, future):
    try:
        return future.result()
    except distributed.KilledWorker as error:
        text = f"workers were lost {_LOST} times at the same task: they may lack memory"
        raise UsageError(text) from error
    except (concurrent.futures.CancelledError, distributed.client.FutureCancelledError, OSError) as error:
        if isinstance(error, OSError) and future.status == "error":
            raise
        text = "the scheduler or its workers went away; start again: what is done stays"
        raise UsageError(text) from error


def _distributed():
    try:
        import distributed
    except ImportError as error:
        text = 'this needs Dask, which is not installed: pip install "dask[distributed]"'
        raise UsageError(text) from error
    return distributed
