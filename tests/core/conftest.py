# SPDX-License-Identifier: GPL-3.0-or-later
"""Small projects on disk for the tests of the core."""

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

ROOT = Path(__file__).resolve().parents[2]
for folder in (ROOT / "addon", Path(__file__).parent):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

# Hypothesis draws the same in each run, whatever the load of the machine; looking further is what stacks.hunt
# and stacks.cut_hunt are for. It would also draw numbers that it finds in the source of what is imported:
# then each change of the program, and each choice of tests, had examples of its own.
assert callable(providers._get_local_constants), "this version of Hypothesis has another name for it"
providers._get_local_constants = providers.Constants
settings.register_profile(
    "same examples",
    derandomize=True,
    deadline=None,
    database=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("same examples")

SQUARE_OFF = "OFF\n4 2 0\n0 0 {z}\n1 0 {z}\n1 1 {z}\n0 1 {z}\n3 0 1 2\n3 0 2 3\n"


@pytest.fixture
def write(tmp_path):
    """write(name, text) puts a file into the test's folder and returns its path."""

    def put(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return put


@pytest.fixture
def layers(write):
    """layers(heights) writes a project of level unit squares at these heights, oldest first."""

    def put(heights, name="layers.toml", rock_keys="", surface_keys=""):
        lines = ["format = 1", 'name = "layers"', "[[rock]]", 'name = "rock"', rock_keys]
        for number, z in enumerate(heights):
            write(f"s{number}.off", SQUARE_OFF.format(z=z))
            lines += ["[[rock.surface]]", f'name = "S{number}"', f'mesh = "s{number}.off"', surface_keys]
        return write(name, "\n".join(lines) + "\n")

    return put


@pytest.fixture
def tiles_in_this_process():
    """Tiles are built one after another, without Dask."""
    from tiled_models import in_this_process

    with in_this_process():
        yield


def grid_surface(n, height, size=1.0):
    """A surface over the square 0..size of n x n cells, two triangles each; height(x, y) in arrays."""
    x, y = np.meshgrid(np.linspace(0.0, size, n + 1), np.linspace(0.0, size, n + 1), indexing="ij")
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    z = np.broadcast_to(height(x, y), x.shape)
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), triangles.astype(np.int32)
