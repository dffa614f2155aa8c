# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts that write the samples' files."""

import functools
import importlib.util
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from realmodel.core import build, load_project

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


@functools.lru_cache(maxsize=6)
def built_sample(name, cells="columns"):
    """The model of a sample; all tests of a process share it."""
    return build(load_project(SAMPLES / name / "project.toml"), cells=cells)


def coarse_sample(name, factor):
    """The project of a sample with edges of its plan meshes and lattices of its fields longer by a factor."""
    project = load_project(SAMPLES / name / "project.toml")
    rocks = [
        replace(
            rock,
            edge_length=longer(rock.edge_length, factor),
            series=[replace(each, resolution=longer(each.resolution, factor)) for each in rock.series],
        )
        for rock in project.rocks
    ]
    return replace(project, rocks=rocks)


def longer(length, factor):
    return factor * length if isinstance(length, (int, float)) else length


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
