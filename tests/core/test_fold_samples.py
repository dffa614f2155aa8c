# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples with series: their scripts write them, and their models are what they were made of."""

import numpy as np
import pytest
from realmodel.core import Model
from realmodel.core.base.work import native_module
from sample_scripts import built_sample, generator, written_again


def test_their_files_are_those_of_their_scripts(tmp_path):
    beds = ["lower_bed.csv", "middle_bed.csv", "upper_bed.csv"]
    expected = {
        "recumbent_fold": sorted([*beds, "dips.csv", "ground.csv", "unconformity.csv"]),
        "faulted_dome": [*(f"bed_{k}.csv" for k in range(1, 5)), "dips.csv", "fault.off"],
    }
    for name, files in expected.items():
        (tmp_path / name).mkdir()
        assert written_again(name, tmp_path / name) == files


def true_block(name, made, point):
    if name == "recumbent_fold" and point[2] > made.unconformity(*point[:2]):
        return 4
    return int(np.searchsorted(list(made.BEDS.values()), made.bedding(*point)))


@pytest.mark.parametrize(
    ("name", "least", "high"),
    [("recumbent_fold", 0.99, (1000, 800, 40)), ("faulted_dome", 0.96, (1000, 1000, 0))],
)
def test_the_model_is_what_its_files_were_made_of(name, least, high, tmp_path):
    model = built_sample(name)
    report = model.validate()
    assert report.passed, report.failure()
    made = generator(name)
    points = np.random.default_rng(2).uniform((0, 0, made.BASE), high, (2000, 3))
    cells = native_module().cells_at(model.native(), points)
    inside = cells >= 0
    said = model.cell_block[cells[inside]]
    true = np.array([true_block(name, made, point) for point in points[inside].tolist()])
    assert (said == true).mean() > least
    model.save(tmp_path / "m.npz")
    loaded = Model.load(tmp_path / "m.npz")
    series = model.project.rocks[0].series[0].name
    for compartment in (
        [None] if name == "recumbent_fold" else [each for each in model.compartment_names if "fault" in each]
    ):
        one, other = (each.field(series, compartment) for each in (model, loaded))
        np.testing.assert_array_equal(one.values, other.values)
        assert one.lattice == other.lattice
