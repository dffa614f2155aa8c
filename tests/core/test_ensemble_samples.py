# SPDX-License-Identifier: GPL-3.0-or-later
"""The probability of each block along sections, fences and boreholes and on a grid, and files with it."""

import csv
import io

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, UsageError, build
from realmodel.core.ensembles import (
    Probabilities,
    borehole_samples,
    draw_probabilities,
    ensemble,
    grid_samples,
    hole_samples,
    sample_writer,
    section_samples,
)
from realmodel.core.ensembles.sampled_blocks import MOST_PLACES
from realmodel.core.results.model_holes import HoleAxis
from realmodel.core.results.sections.section_drawing import flat_of, flattened, is_vertical

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 80.0], [0.0, 80.0]])
POINTS = np.random.default_rng(3).uniform([2, 2, 8], [98, 78, 12], (12, 3))


@pytest.fixture(scope="module")
def model():
    """Two layers of about 10 each on a level base."""
    surfaces = [Surface("Low", points=POINTS), Surface("High & dry", points=POINTS + np.array([0, 0, 10.0]))]
    return build(
        Project("m", [Rock("r", surfaces, region=SQUARE, edge_length=10.0, base_elevation=0.0)]),
        cells="blocks",
    )


SECTIONS = {
    "vertical": lambda model: model.section((30, 40, 5), (1, 0, 0)),
    "diagonal": lambda model: model.section((30, 40, 5), (1, 2, 0)),
    "level": lambda model: model.section((30, 40, 5), (0, 0, 2)),
    "inclined": lambda model: model.section((30, 40, 5), (1, -0.5, 2)),
    "fence": lambda model: model.fence([[5, 5], [60, 30], [95, 75]]),
}


@pytest.mark.parametrize("kind", SECTIONS)
def test_places_of_sections_lie_in_them(model, kind):
    section = SECTIONS[kind](model)
    found = section_samples(model, section)
    assert len(found.places) == len(found.flat) and len(found.places) % found.columns == 0
    assert abs(found.columns - 200) < 3
    if kind == "fence":
        on_line = np.abs(found.distance[: found.columns] - 60.0).argmin()
        at = found.places[on_line, :2] - [5, 5]
        assert abs(at[0] * 25 - at[1] * 55) < 1e-9
        assert found.flat[:, :, 0].max() == pytest.approx(section.length)
    else:
        point, normal = map(np.array, section.plane)
        assert np.abs((found.corners - point) @ normal).max() < 1e-9 * 100
    # a drawing has them where it has the section
    drawn = flattened(section)
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    beyond = [0.0, 0.05 if is_vertical(section) else 0.0] * (high - low)
    cells = found.flat.reshape(-1, 2)
    if kind != "fence":
        assert flat_of(section, found.corners.reshape(-1, 3)) == pytest.approx(cells, abs=1e-9)
        assert cells.min(axis=0) == pytest.approx(low - beyond, abs=1e-9)
    assert cells.max(axis=0)[1] == pytest.approx((high + beyond)[1])


def test_cells_have_the_size_that_is_given(model):
    found = section_samples(model, SECTIONS["vertical"](model), (5, 2))
    width, height = np.ptp(found.flat, axis=1).mean(axis=0)
    assert width == pytest.approx(5) and height == pytest.approx(2, rel=0.1)
    grid = grid_samples(model, (10, 20, 2))
    assert grid.counts[:2] == (10, 4) and grid.origin[2] < 0
    assert grid.places[1].tolist() == [15, 10, grid.origin[2] + 1]
    hole = borehole_samples(model, 30, 40, 0.5)
    assert (np.diff(hole.places[:, 2]) < 0).all() and hole.height == pytest.approx(0.5, rel=0.05)


def test_cells_along_a_planned_hole(model):
    axis = HoleAxis((30, 40, 30), 90, 60, 20)
    samples = hole_samples(model, axis, 2)
    assert samples.depths.tolist() == [2 * k + 1 for k in range(10)]
    assert np.array_equal(samples.places, axis.places(samples.depths))
    assert len(hole_samples(model, axis).places) == 100
    found = ensemble(model.project, 4, places=samples.places).at()
    file = io.BytesIO()
    sample_writer("h.csv", "borehole")(samples, found, file)
    rows = list(csv.DictReader(file.getvalue().decode().splitlines()))
    kept = found.probability.sum(axis=1) > 0
    assert [float(row["depth"]) for row in rows] == samples.depths[kept].tolist() and kept.any()
    file = io.BytesIO()
    sample_writer("h.npz", "borehole")(samples, found, file)
    with np.load(io.BytesIO(file.getvalue())) as arrays:
        assert np.array_equal(arrays["depth"], samples.depths)


def test_what_is_refused(model):
    with pytest.raises(UsageError, match="does not meet the model"):
        section_samples(model, model.section((0, 500, 0), (0, 1, 0)))
    with pytest.raises(UsageError, match=f"the {MOST_PLACES // 2} that an ensemble takes"):
        grid_samples(model, 0.01)
    with pytest.raises(UsageError, match=r"probabilities of a borehole are not written as '\.vtu'"):
        sample_writer("a.vtu", "borehole")


def test_probabilities():
    found = Probabilities(["A", "B"], np.array([[1, 0], [0.5, 0.5], [0.25, 0], [0, 0]]))
    assert found.likeliest().tolist() == [0, 0, -1, -1]
    assert found.entropy() == pytest.approx([0, 1, 0.25 * 2 + 0.75 * np.log2(4 / 3), 0])
    colors = found.colors(np.array([[1.0, 0, 0], [0, 0, 1.0]]))
    assert colors == pytest.approx(np.array([[1, 0, 0], [0.5, 0, 0.5], [1, 0.75, 0.75], [1, 1, 1]]))


@pytest.fixture(scope="module")
def found(model):
    """Samples of each kind, and an ensemble that was asked there."""
    kinds = {
        "section": section_samples(model, SECTIONS["fence"](model), (4, 1)),
        "grid": grid_samples(model, (10, 10, 2)),
        "borehole": borehole_samples(model, 30, 40),
    }
    places = np.concatenate([samples.places for samples in kinds.values()])
    result = ensemble(model.project, 6, places=lambda _: places)
    parts, begin = {}, 0
    for kind, samples in kinds.items():
        parts[kind] = samples, result.at(begin, begin + len(samples.places))
        begin += len(samples.places)
    return parts


def written(path, kind, found):
    file = io.BytesIO()
    sample_writer(path, kind)(*found[kind], file)
    return file.getvalue()


@pytest.mark.parametrize("kind", ["section", "grid", "borehole"])
def test_tables(found, kind):
    samples, probabilities = found[kind]
    rows = list(csv.DictReader(io.StringIO(written("a.csv", kind, found).decode())))
    kept = probabilities.probability.sum(axis=1) > 0
    assert 0 < len(rows) == kept.sum() < len(samples.places)
    assert ("distance" in rows[0]) == (kind == "section")
    low = np.array([float(row["probability base block"]) for row in rows])
    assert low == pytest.approx(probabilities.probability[kept, 0])
    assert [float(row["z"]) for row in rows] == samples.places[kept, 2].tolist()
    assert {row["block"] for row in rows} <= {"base block", "High & dry block", ""}


@pytest.mark.parametrize("kind", ["section", "grid", "borehole"])
def test_arrays(found, kind):
    samples, probabilities = found[kind]
    with np.load(io.BytesIO(written("a.npz", kind, found))) as arrays:
        assert np.array_equal(arrays["places"], samples.places)
        assert np.array_equal(arrays["probability"], probabilities.probability)
        assert np.array_equal(arrays["entropy"], probabilities.entropy())


@pytest.mark.parametrize(("kind", "ending"), [("section", ".vtu"), ("grid", ".vti")])
def test_cells_for_paraview(found, kind, ending, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    samples, probabilities = found[kind]
    path = tmp_path / f"a{ending}"
    path.write_bytes(written(path, kind, found))
    read = pyvista.read(path)
    assert read.n_cells == len(samples.places)
    assert np.allclose(read.cell_centers().points, samples.places)
    assert np.array_equal(read["probability High & dry block"], probabilities.probability[:, 1])
    assert np.array_equal(read["entropy"], probabilities.entropy())
    assert np.array_equal(read["block"], probabilities.likeliest())


def test_drawings(found):
    samples, probabilities = found["section"]
    drawing = draw_probabilities(samples, probabilities, 2.0)
    cells = [item for item in drawing.items if item.layer == "Cells"]
    assert 0 < len(cells) < len(samples.places)
    assert all(item.fill is None for item in drawing.items if item.layer == "base block")
    assert written("a.png", "section", found).startswith(b"\x89PNG")
    assert b"</svg>" in written("a.svg", "section", found)
