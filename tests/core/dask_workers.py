# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of Dask on this machine, and the command line beside them."""

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = ROOT / "blend_samples" / "two_layers" / "project.toml"


@contextlib.contextmanager
def local_client(workers):
    """Of a cluster of so many processes; its dashboard takes any free port."""
    import distributed

    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@contextlib.contextmanager
def processes_of_cluster(folder, **paths):
    """The address of a scheduler with one worker, as a user starts them. paths: where each of `scheduler` and
    `worker` looks for modules, the project's own by default."""
    import distributed

    file = folder / "scheduler.json"
    with contextlib.ExitStack() as ends:
        for part, *options in (
            ["scheduler", "--port", "0", "--dashboard-address", ":0"],
            ["worker", "--nthreads", "1", "--no-dashboard"],
        ):
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", part, *options, "--scheduler-file", file],
                env=os.environ | {"PYTHONPATH": str(paths.get(part, ROOT / "addon"))},
                stderr=subprocess.DEVNULL,
                cwd=folder,
            )
            ends.callback(process.wait)
            ends.callback(process.terminate)
        with distributed.Client(scheduler_file=file, timeout=30) as client:
            client.wait_for_workers(1, timeout=30)
            address = client.scheduler.address
        yield address


class KillsOne:
    """A progress function that kills a worker when it is called with a text first, which says that a task is
    done."""

    def __init__(self, client, text):
        self._client, self._text = client, text
        self.killed = None

    def __call__(self, _share, text):
        if self.killed is None and self._text in text:
            self.killed = next(iter(self._client.run(os.getpid).values()))
            os.kill(self.killed, signal.SIGKILL)


def batch(*arguments, cwd=None, project=PROJECT):
    command = [sys.executable, ROOT / "build_model.py", project, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False)
