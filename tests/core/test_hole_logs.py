# SPDX-License-Identifier: GPL-3.0-or-later
"""Logs of boreholes: curves of LAS files as values along the holes, and beside them on sections."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from las_files import las_text
from realmodel import core
from realmodel.core import Boreholes, InputRefused, Model, UsageError, build, load_project
from realmodel.core.drawing.drawing import FilledRings, Text
from realmodel.core.readers.borehole_input import read_picks
from realmodel.core.readers.hole_values import read_interval_values
from realmodel.core.readers.tables.interval_values import IntervalValues
from realmodel.core.results.sections.hole_curves import seen_values
from realmodel.core.results.sections.section_drawing import draw_section

COLLARS = "hole,x,y,z,end\nA-1,30,50,100,60\nB 2,70,50,100,60\n"
LOGS = "hole,from,to,block\nA-1,0,20,clay\nA-1,20,50,sand\nB 2,0,30,clay\nB 2,30,50,sand\n"
PROJECT = """format = 1
name = "logs"
[[rock]]
name = "rock"
region = [[0, 0], [100, 0], [100, 100], [0, 100]]
edge_length = 20
base_elevation = 0
boreholes = { collars = "c.csv", intervals = "i.csv", logs = ["a.las", "b.las"] }
[[rock.surface]]
name = "sand"
[[rock.surface]]
name = "clay"
"""


def tables(folder, logs, **keys):
    (folder / "c.csv").write_text(COLLARS)
    (folder / "i.csv").write_text(LOGS)
    for name, text in logs.items():
        (folder / name).write_text(text)
    files = {"collars": folder / "c.csv", "intervals": folder / "i.csv"}
    return Boreholes(**files, logs=[folder / name for name in logs], **keys)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(2, 60),
    unit=st.sampled_from([("M", 1.0), ("FT", 0.3048), ("F", 0.3048), ("m", 1.0)]),
    version=st.sampled_from(["1.2", "2.0"]),
    wrap=st.booleans(),
    null=st.sampled_from([-999.25, -9999.0, 0.5]),
)
def test_values_come_back_at_their_depths(tmp_path_factory, seed, count, unit, version, wrap, null):
    rng = np.random.default_rng(seed)
    depths = np.round(np.sort(rng.uniform(0.0, 150.0, count)), 3)
    depths = np.unique(depths).tolist()
    curves = {f"C{n}.U{n}": np.round(rng.normal(50, 20, len(depths)), 4) for n in range(3)}
    for array in curves.values():
        array[rng.random(len(array)) < 0.2] = np.nan
    text = las_text("a_1", depths, curves, unit[0], null, version, wrap)
    log = read_picks(tables(tmp_path_factory.mktemp("las"), {"a.las": text})).logs
    if len(depths) < 2:
        return
    assert set(log.holes.tolist()) == {"A-1"}
    middles = 0.5 * (np.array(depths)[1:] + np.array(depths)[:-1])
    bounds = np.column_stack([[depths[0], *middles], [*middles, depths[-1]]]) * unit[1]
    assert np.allclose(log.depths, bounds)
    assert np.allclose(log.begins, np.column_stack([np.full((len(depths), 2), (30, 50)), 100 - bounds[:, 0]]))
    assert np.allclose(log.ends[:, 2], 100 - bounds[:, 1])
    for name, array in curves.items():
        mnemonic, of = name.split(".")
        assert np.array_equal(log.columns[f"{mnemonic} ({of})"], array, equal_nan=True)


def test_a_unit_that_the_file_says_is_obeyed_with_a_word(tmp_path):
    text = las_text("A-1", [0.0, 10.0], {"GR.GAPI": [1.0, 2.0]}, "FT")
    picks = read_picks(tables(tmp_path, {"a.las": text}))
    assert np.isclose(picks.logs.depths[-1, 1], 3.048)
    assert any("its depths are in ft" in text for text in picks.warnings)
    picks = read_picks(tables(tmp_path, {"a.las": text}, units={"z": "ft"}))
    assert picks.logs.depths[-1, 1] == 10.0 and np.isclose(picks.logs.ends[-1, 2], 90 * 0.3048)
    assert not any("its depths" in text for text in picks.warnings)
    bad = las_text("A-1", [0.0, 10.0], {"GR.GAPI": [1.0, 2.0]}, "US/F")
    with pytest.raises(InputRefused, match="not a unit of length"):
        read_picks(tables(tmp_path, {"a.las": bad}))


def test_wells_are_found_by_name_and_by_number(tmp_path):
    curve = {"GR.GAPI": [1.0, 2.0]}
    for well, uwi in (("b-2", ""), ("Smith 7", "B_2"), ("B 2", "A-1")):
        given = tables(tmp_path, {"a.las": las_text(well, [0.0, 10.0], curve, uwi=uwi)})
        assert set(read_picks(given).logs.holes.tolist()) == {"B 2"}
    logs = {"a.las": las_text("Smith 7", [0.0, 10.0], curve), "b.las": las_text("A-1", [0.0, 9.0], curve)}
    with pytest.raises(InputRefused, match=r"no hole is called 'Smith 7'.*A-1 and B 2") as caught:
        read_picks(tables(tmp_path, logs))
    assert caught.value.file.name == "a.las"
    (tmp_path / "x.las").write_text("depth,GR\n")
    with pytest.raises(InputRefused, match="not a LAS file"):
        read_picks(Boreholes(collars=tmp_path / "c.csv", logs=tmp_path / "x.las"))


def test_curves_stand_beside_the_columns_of_intervals(tmp_path):
    logs = {
        "a.las": las_text("A-1", [0.0, 4.0, 10.0], {"GR.GAPI": [1.0, np.nan, 2.0], "GR.": [3.0, 4.0, 5.0]})
    }
    values = read_interval_values(tables(tmp_path, logs))
    assert list(values.columns) == ["block", "GR (GAPI)", "GR"]
    assert values.has("GR (GAPI)").tolist() == [False] * 4 + [True, False, True]
    alone = Boreholes(collars=tmp_path / "c.csv", logs=tmp_path / "a.las")
    alone.check()
    assert list(read_interval_values(alone).columns) == ["GR (GAPI)", "GR"]
    assert read_picks(alone).warnings == []


def test_python_has_logs_as_a_table(tmp_path):
    given = tables(tmp_path, {"a.las": las_text("A-1", [0.0, 10.0], {"GR.GAPI": [1.0, 2.0]}, "FT")})
    found = core.read_boreholes(collars=given.collars, intervals=given.intervals, logs=given.logs, units="ft")
    assert found.logs["to"].tolist() == [5.0, 10.0] and found.logs["GR (GAPI)"].tolist() == [1.0, 2.0]
    assert set(found.logs["hole"].tolist()) == {"A-1"} and found.warnings == []
    assert len(core.read_boreholes(collars=given.collars, intervals=given.intervals).logs["from"]) == 0


def test_deviated_holes_have_their_logs_along_them(tmp_path):
    given = tables(tmp_path, {"a.las": las_text("A-1", [0.0, 20.0], {"GR.GAPI": [1.0, 2.0]})})
    (tmp_path / "s.csv").write_text("hole,depth,azimuth,dip\nA-1,0,90,-45\nB 2,0,0,-90\n")
    log = read_picks(replace(given, survey=tmp_path / "s.csv"))
    assert np.allclose(log.logs.ends[-1], [30 + 20 / np.sqrt(2), 50, 100 - 20 / np.sqrt(2)])


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(4, 40), st.integers(1, 120))
def test_what_is_seen_of_many_values(seed, most, count):
    """Stretches meet as the intervals did, and have the least and the greatest value."""
    rng = np.random.default_rng(seed)
    bounds = np.cumsum(rng.uniform(0.1, 1.0, count + 1))
    gap = rng.random(count) < 0.05
    array = np.where(gap, np.nan, np.round(rng.normal(size=count), 3))
    depths = np.column_stack([bounds[:-1], bounds[1:]])
    places = np.column_stack([np.zeros((count + 1, 2)), -bounds])
    order = rng.permutation(count)
    values = IntervalValues(
        np.full(count, "A"), places[:-1][order], places[1:][order], depths[order], {"v": array[order]}
    )
    seen = seen_values(values, "v", most)
    known = values.some(values.has("v"))
    lengths = [np.ptp(part.depths, axis=1).sum() for part in (seen, known)]
    assert np.isclose(*lengths)
    assert np.allclose(-seen.begins[:, 2], seen.depths[:, 0])
    assert (seen.depths[1:, 0] >= seen.depths[:-1, 1]).all()
    if len(known.holes):
        assert seen.columns["v"].min() == known.columns["v"].min()
        assert seen.columns["v"].max() == known.columns["v"].max()
    if not gap.any():
        assert len(seen.holes) <= max(most, 2)
        if count <= most:
            assert np.array_equal(seen.columns["v"], array)


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    folder = tmp_path_factory.mktemp("project")
    depths = np.arange(0.0, 50.5, 0.5).tolist()
    curve = {"GR.GAPI": np.linspace(10.0, 120.0, len(depths)), "RHOB.G/C3": np.full(len(depths), 2.5)}
    tables(folder, {"a.las": las_text("A-1", depths, curve), "b.las": las_text("B 2", depths, curve)})
    (folder / "project.toml").write_text(PROJECT)
    return build(load_project(folder / "project.toml"))


def test_models_keep_their_logs(model, tmp_path):
    model.save(tmp_path / "m.npz")
    for one in (model, Model.load(tmp_path / "m.npz")):
        values = one.section((0, 50, 0), (0, -1, 0)).hole_values
        assert list(values.columns) == ["GR (GAPI)", "RHOB (G/C3)"] and len(values.holes) == 202
    names = [file.name for file in load_project(model.project.path).input_files()]
    assert names[-4:] == ["a.las", "b.las", "c.csv", "i.csv"]


def test_sections_have_curves_beside_the_holes(model, tmp_path):
    section = model.section((0, 50, 0), (0, -1, 0))
    drawing = draw_section(section, hole_width=1.0, hole_column="GR")
    bars = [item for item in drawing.items if item.layer == "Curves" and isinstance(item, FilledRings)]
    assert len(bars) == 202
    widths = np.array([np.ptp(bar.rings[0][:, 0]) for bar in bars]).reshape(2, -1)
    assert np.allclose(widths, np.linspace(0.0, 36.0, 101))
    heights = np.array([np.ptp(bar.rings[0][:, 1]) for bar in bars]).reshape(2, -1)
    assert np.allclose(heights[:, 1:-1], 0.5 * drawing.scale)
    texts = [item.text for item in drawing.items if isinstance(item, Text)]
    assert "GR (GAPI)" in texts and {"10.0", "120.0"} <= set(texts)
    for ending in ("svg", "dxf", "png"):
        section.save(tmp_path / f"s.{ending}", hole_width=1.0, hole_column="gr (gapi)")
    assert "GR (GAPI)" in (tmp_path / "s.svg").read_text()
    fence = model.fence([[10, 50], [50, 50], [90, 50]])
    drawing = draw_section(fence, hole_width=1.0, hole_column="RHOB")
    assert sum(item.layer == "Curves" and isinstance(item, FilledRings) for item in drawing.items) == 202
    with pytest.raises(UsageError, match=r"no column 'X'.*GR \(GAPI\) and RHOB"):
        draw_section(section, hole_width=1.0, hole_column="X")
    with pytest.raises(UsageError, match="give hole_width"):
        draw_section(section, hole_column="GR")
