# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of Dask on this machine, and the command line beside them."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
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
def one_killed(client, folder, pattern):
    """Kills a worker as soon as there is a file of this pattern in the folder; one has been killed in the
    end."""
    killed = []

    def kill():
        while not list(folder.glob(pattern)):
            time.sleep(0.02)
        pids = client.run(os.getpid)
        killed.append(next(iter(pids.values())))
        os.kill(killed[0], signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    yield
    thread.join()
    assert killed


def batch(*arguments, cwd=None):
    command = [sys.executable, ROOT / "build_model.py", PROJECT, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False)
