# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects with fields made coarse for a quick look."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build, load_project
from realmodel.core.base.work import run
from realmodel.core.project.coarse import CELLS, coarsened
from realmodel.core.surfaces.prepare import read_rocks

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def read(name):
    project = load_project(SAMPLES / name / "project.toml")
    return replace(project, rocks=[entry.rock for entry in run(lambda work: read_rocks(work, project))])


@pytest.mark.parametrize("resolution", [20.0, "auto"])
def test_a_fold_gets_a_coarse_lattice(resolution):
    project = read("recumbent_fold")
    rock = project.rocks[0]
    rock.series[0].resolution = resolution
    coarse = coarsened(project)
    assert (rock.series[0].resolution, rock.edge_length) == (resolution, 40)  # the given one is as it was
    model = build(coarse, cells="blocks")
    counts = np.array(model.field("folded beds").lattice.counts)
    assert CELLS / 2 < np.prod(counts - 1) < 2 * CELLS
    assert model.validate().passed
    assert coarsened(coarse) is None


def test_the_fields_on_both_sides_of_a_fault_share_the_cells():
    project = read("faulted_dome")
    one, two = (
        coarsened(each).rocks[0].series[0].resolution for each in (replace(project, faults=[]), project)
    )
    assert two == pytest.approx(one * 2 ** (1 / 3), rel=1e-12)


def test_what_has_no_finer_field_stays():
    assert coarsened(load_project(SAMPLES / "two_layers" / "project.toml")) is None
    project = read("recumbent_fold")
    project.rocks[0].series[0].resolution = 500.0
    assert coarsened(project) is None
    flat = Rock("r", [Surface("a", points=np.zeros((1, 3)))], [[0, 0], [1, 0], [1, 1]], base_elevation=-1.0)
    assert coarsened(Project("p", [flat])) is None
