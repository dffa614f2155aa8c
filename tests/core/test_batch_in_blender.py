# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py in Blender, stopped while Blender renders and no line of Python runs."""

import os
import random
import shutil
import signal
import subprocess
import time

import pytest
from conftest import ROOT

BLENDER = shutil.which("blender", path="/usr/bin:/usr/local/bin") or shutil.which("blender")
pytestmark = pytest.mark.skipif(
    BLENDER is None, reason="Blender is not installed: scripts/test.sh installs it"
)


def rendering(project, out, scratch):
    """build_model.py in Blender, from the moment that it begins to render."""
    command = [
        BLENDER,
        "-b",
        "--factory-startup",
        "--python-exit-code",
        "1",
        "-P",
        ROOT / "build_model.py",
        "--",
    ]
    command += [project, "--export", out / "m.npz", "--blend", out / "m.blend", "--render", out / "m.png"]
    # Debian's Blender takes NumPy from the python3 that is first on PATH
    environment = {**os.environ, "PATH": "/usr/bin:/bin", "TMPDIR": str(scratch)}
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    shown = []
    while "rendering" not in (shown[-1] if shown else ""):
        line = process.stdout.readline()
        assert line, "".join(shown) + process.stderr.read()
        shown.append(line)
    return process


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_stopped_while_it_renders(layers, tmp_path, number, status):
    project = layers([0, 1])
    out = tmp_path / "out"
    scratch = tmp_path / "scratch"
    out.mkdir()
    scratch.mkdir()
    latest = 1.0
    while True:
        process = rendering(project, out, scratch)
        time.sleep(random.Random(int(number)).uniform(0.0, latest))
        process.send_signal(number)
        _, errors = process.communicate(timeout=600)
        if process.returncode != 0:
            break
        latest /= 3  # a machine that renders in less: it was too late to stop
        assert latest > 0.01, "it cannot be stopped"
        for path in out.iterdir():
            path.unlink()
    assert process.returncode == status
    assert len(errors.splitlines()) <= 1, errors
    assert list(out.iterdir()) == []
    if number == signal.SIGINT:
        assert errors == "build_model.py: interrupted: nothing was written\n"
        assert [path for path in scratch.iterdir() if path.name.startswith("realmodel")] == []
