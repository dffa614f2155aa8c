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
