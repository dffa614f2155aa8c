# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts that write the samples' files."""

import importlib.util
import subprocess
import sys
from pathlib import Path

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def generator(name):
    """The module that made a sample."""
    spec = importlib.util.spec_from_file_location(name, SAMPLES / name / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def written_again(name, folder):
    """Has a sample's script write its files into a folder, checks that they are those of the sample, and
    returns their names."""
    subprocess.run([sys.executable, SAMPLES / name / "generate.py", folder], check=True, timeout=120)
    written = sorted(path.name for path in folder.iterdir())
    for file in written:
        assert (folder / file).read_bytes() == (SAMPLES / name / file).read_bytes(), file
    return written
