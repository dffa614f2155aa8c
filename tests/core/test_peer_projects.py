# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects from what users of GemPy and LoopStructural have: small reconstructions of the shapes of their
examples, and the blocks that those programs give there."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Fault,
    InputRefused,
    Project,
    Rock,
    SpaceDips,
    Surface,
    UsageError,
    build,
    from_gempy,
    from_loop,
    load_project,
)

BOX = (0.0, 1000.0, 0.0, 800.0, 0.0, 600.0)
PLAN = np.array([(x, y) for x in (50.0, 350.0, 650.0, 950.0) for y in (50.0, 400.0, 750.0)])


def table(surfaces, **more):
    """Points as GemPy's tables have them. surfaces: (N, 3) by name."""
    places = np.concatenate(list(surfaces.values()))
    names = [name for name, points in surfaces.items() for _ in points]
    return {"X": places[:, 0], "Y": places[:, 1], "Z": places[:, 2], "formation": names, **more}


def upright(places, name, dip=0.0, azimuth=0.0):
    count = len(places)
    return table({name: np.asarray(places, float)}) | {
        "azimuth": [azimuth] * count,
        "dip": [dip] * count,
        "polarity": [1] * count,
    }


def joined(*tables):
    return {key: np.concatenate([np.asarray(each[key]) for each in tables]) for key in tables[0]}


def on(height):
    return np.column_stack([PLAN, height(*PLAN.T)])


def level(z):
    return on(lambda x, y: 0 * x + z)


def agreement(model, truth, seed=5):
    """The share of random points of the box in the block that truth(x, y, z) names."""
    low, high = np.array(BOX).reshape(3, 2).T
    points = np.random.default_rng(seed).uniform(low, high, (4000, 3))
    names = np.array([*(block.name for block in model.blocks), "none"])
    return (names[model.block_at(points)] == truth(*points.T)).mean()


def layer_cake():
    points = table({"sand": level(400.0), "shale": level(200.0)})
    return points, upright([(500, 400, 300)], "sand"), {"beds": ("sand", "shale")}


def faulted(throw=100.0):
    """One vertical fault at x = 500, its points in no order, in one line."""

    def height(base):
        return lambda x, y: base - throw * (x > 500)

    fault = np.array([(500.0, 400.0, z) for z in (300.0, 100.0, 500.0, 200.0)])
    points = table({"fault": fault, "sand": on(height(400.0)), "shale": on(height(250.0))})
    dips = joined(
        upright([(500, 400, 300)], "fault", dip=90, azimuth=90),
        upright([(200, 400, 300), (800, 400, 200)], "sand"),
    )
    return points, dips, {"Fault_Series": "fault", "Strat": ("sand", "shale")}


def test_layer_cake_is_filled_from_base_to_top():
    points, dips, stack = layer_cake()
    model = build(from_gempy(points, dips, stack=stack, extent=BOX))
    assert [block.name for block in model.blocks] == ["basement", "shale", "sand"]
    # as in GemPy, a surface is the base of the unit of its name
    at = model.block_at([(500, 400, 100), (500, 400, 300), (500, 400, 599), (500, 400, 601)])
    assert at.tolist() == [0, 1, 2, -1]
    assert at.dtype == np.int32
    assert sum(block.volume for block in model.blocks) == pytest.approx(1000 * 800 * 600)
    assert model.validate().passed


def test_fold():
    def height(x, y):
        return 300 + 80 * np.sin(x / 160)

    places = np.array([(x, y) for x in np.linspace(0, 1000, 21) for y in (100.0, 400.0, 700.0)])
    z = height(*places.T)
    points = table({"rock": np.column_stack([places, z])})
    slopes = 0.5 * np.cos(places[:, 0] / 160)
    dips = table({"rock": np.column_stack([places, z])})
    dips |= {"G_x": -slopes, "G_y": 0 * slopes, "G_z": 0 * slopes + 1}
    model = build(from_gempy(points, dips, stack={"s": ["rock"]}, extent=BOX))
    assert agreement(model, lambda x, y, z: np.where(z > height(x, y), "rock", "basement")) > 0.97


def unconformable(relation):
    """A level surface over beds that dip 20 degrees: eroded by it, or onlapped."""
    slope = np.tan(np.radians(20))

    def bed(base):
        return lambda x, y: base + slope * (x - 500)

    beds = {name: on(bed(base)) for name, base in (("old2", 380.0), ("old1", 200.0))}
    seen = {name: points[points[:, 2] < 290] for name, points in beds.items()}
    points = table({"young": level(300.0), **(seen if relation == "erode" else beds)})
    dips = joined(
        upright([(500, 400, 300)], "young"), upright([(500, 400, 200)], "old1", dip=20, azimuth=270)
    )
    stack = {"Young": "young", "Old": ("old2", "old1")}
    project = from_gempy(points, dips, stack=stack, extent=BOX, relations={"Young": relation})

    def truth(x, y, z):
        in_old = np.where(z > bed(380)(x, y), "old2", np.where(z > bed(200)(x, y), "old1", "basement"))
        if relation == "erode":
            return np.where(z > 300, "young", in_old)
        # GemPy: what onlaps lies above the youngest surface of the older group, which stays as it is
        return np.where((z > 300) & (z > bed(380)(x, y)), "young", in_old)

    return build(project), truth


@pytest.mark.parametrize("relation", ["erode", "onlap"])
def test_unconformities(relation):
    model, truth = unconformable(relation)
    assert agreement(model, truth) > 0.985
    assert model.validate().passed


def displaced(throw):
    def truth(x, y, z):
        up = z + throw * (x > 500)
        return np.where(up > 400, "sand", np.where(up > 250, "shale", "basement"))

    return truth


@pytest.mark.parametrize("throw", [100.0, -60.0])
def test_fault_from_points_in_one_line_and_one_orientation(throw):
    points, dips, stack = faulted(throw)
    model = build(from_gempy(points, dips, stack=stack, faults=["Fault_Series"], extent=BOX))
    assert agreement(model, displaced(throw)) > 0.99
    assert model.validate().passed


def test_fault_below_a_group_does_not_displace_it():
    points, dips, stack = faulted()
    points = joined(points, table({"cover": level(500.0)}))
    dips = joined(dips, upright([(500, 400, 500)], "cover"))
    stack = {"Cover": "cover", **stack}
    model = build(from_gempy(points, dips, stack=stack, faults=["Fault_Series"], extent=BOX))
    old = displaced(100.0)
    assert agreement(model, lambda x, y, z: np.where(z > 500, "cover", old(x, y, z))) > 0.99
    with pytest.raises(InputRefused, match="displaces nothing"):
        from_gempy(
            points,
            dips,
            stack={"Cover": ["cover", "sand", "shale"], "Fault_Series": "fault"},
            faults=["Fault_Series"],
            extent=BOX,
        )


def test_graben_of_two_faults():
    def down(x):
        return 100.0 * ((x > 300) & (x < 700))

    faults = {
        name: np.array([(at, y, z) for y in (100.0, 700.0) for z in (500.0, 100.0)])
        for name, at in (("west", 300.0), ("east", 700.0))
    }
    places = np.array([(x, y) for x in (50.0, 200.0, 400.0, 600.0, 800.0, 950.0) for y in (100.0, 700.0)])
    sand = np.column_stack([places, 400 - down(places[:, 0])])
    points = table({**faults, "sand": sand})
    dips = joined(
        upright([(300, 400, 300)], "west", 90, 90),
        upright([(700, 400, 300)], "east", 90, 270),
        upright([(100, 400, 400), (500, 400, 300), (900, 400, 400)], "sand"),
    )
    stack = {"F1": "west", "F2": "east", "beds": "sand"}
    model = build(from_gempy(points, dips, stack=stack, faults=["F1", "F2"], extent=BOX))
    truth = lambda x, y, z: np.where(z + down(x) > 400, "sand", "basement")  # noqa: E731
    assert agreement(model, truth) > 0.99


@given(seed=st.integers(0, 10_000))
@settings(max_examples=3, derandomize=True, deadline=None)
def test_order_of_rows_does_not_matter(seed):
    points, dips, stack = faulted()
    random = np.random.default_rng(seed)
    shuffled = [
        {key: np.asarray(values)[order] for key, values in rows.items()}
        for rows in (points, dips)
        for order in [random.permutation(len(rows["X"]))]
    ]
    one, other = (
        build(from_gempy(*tables, stack=stack, faults=["Fault_Series"], extent=BOX))
        for tables in ((points, dips), shuffled)
    )
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.face_vertices, other.face_vertices)


def write(file, rows):
    body = zip(*(np.asarray(values).tolist() for values in rows.values()), strict=True)
    lines = [",".join(rows), *(",".join(map(str, row)) for row in body)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def test_files_and_frames_and_saved_projects_are_the_same(tmp_path):
    pandas = pytest.importorskip("pandas")
    points, dips, stack = faulted()
    more = {"stack": stack, "faults": ["Fault_Series"], "extent": BOX}
    files = write(tmp_path / "points.csv", points), write(tmp_path / "orientations.csv", dips)
    frames = pandas.DataFrame(points), pandas.DataFrame(dips)
    of_dict = from_gempy(points, dips, **more)
    assert of_dict == from_gempy(*files, **more) == from_gempy(*frames, **more)
    path = of_dict.save(tmp_path / "saved" / "twice")
    assert path.name == "project.toml"
    models = [build(of_dict), *(build(load_project(where)) for where in (path, path.parent))]
    for model in models[1:]:
        assert [b.name for b in model.blocks] == [b.name for b in models[0].blocks]
        np.testing.assert_array_equal(model.vertices, models[0].vertices)
        np.testing.assert_array_equal(model.face_cells, models[0].face_cells)


def test_grid_is_the_block_at_the_centers():
    model, _ = unconformable("erode")
    blocks = model.grid((7, 5, 4))
    assert blocks.shape == (7, 5, 4)
    assert blocks.dtype == np.int32
    low, high = np.array(BOX).reshape(3, 2).T
    index = np.indices((7, 5, 4)).reshape(3, -1).T
    centers = low + (index + 0.5) / (7, 5, 4) * (high - low)
    np.testing.assert_array_equal(blocks.ravel(), model.block_at(centers))
    shares = np.bincount(model.grid((40, 32, 60)).ravel(), minlength=len(model.blocks)) / (40 * 32 * 60)
    np.testing.assert_allclose(shares, [b.volume / model.volume for b in model.blocks], atol=0.005)
    for wrong in ((2, 3), (0, 1, 1), (2.5, 1, 1), 4):
        with pytest.raises(UsageError, match="three numbers of cells"):
            model.grid(wrong)


def test_order_within_a_group_follows_the_data_with_a_warning():
    points, dips, _ = layer_cake()
    with pytest.warns(UserWarning, match="'sand' and 'shale', youngest first"):
        project = from_gempy(points, dips, stack={"beds": ("shale", "sand")}, extent=BOX)
    assert project.rocks[0].block_names() == ["basement", "shale", "sand"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        from_gempy(points, dips, stack={"beds": ("sand", "shale")}, extent=BOX)


def test_orientations_of_a_group_and_a_named_basement():
    points, _, _ = layer_cake()
    dips = upright([(500, 400, 300)], "beds")
    stack = {"beds": ("sand", "shale"), "deep": "granite"}
    project = from_gempy(points, dips, stack=stack, extent=BOX)
    assert project.rocks[0].block_names() == ["granite", "shale", "sand"]
    assert len(project.rocks[0].series) == 1


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"stack": {"beds": ("sand",)}}, "in no group of the stack"),
        ({"stack": {"beds": ("sand", "clay", "shale")}}, "'clay' of the stack has no points"),
        ({"stack": {"beds": ("sand", "shale", "sand")}}, "twice"),
        ({"extent": (0, 1, 0, 1)}, "six numbers"),
        ({"extent": (0, 0, 0, 1, 0, 1)}, "must be a box"),
        ({"faults": ["other"]}, "no group 'other'"),
        ({"relations": {"beds": "overlap"}}, "unknown relation"),
        ({"points": "missing.csv"}, "file not found"),
        ({"points": {"X": [1.0], "Y": [1.0], "formation": ["sand"]}}, "no column Z"),
        ({"points": {"X": [1.0], "Y": [1.0], "Z": [1.0]}}, "no column formation"),
        ({"points": table({"sand": np.array([(1.0, np.nan, 2.0)])})}, "not finite"),
        ({"orientations": table({"sand": level(4.0)})}, "no azimuth and dip"),
        ({"orientations": upright([(1, 1, 1)], "clay")}, "not in the stack"),
    ],
)
def test_refusals(change, text):
    points, dips, stack = layer_cake()
    arguments = {"points": points, "orientations": dips, "stack": stack, "extent": BOX, **change}
    first = arguments.pop("points"), arguments.pop("orientations")
    with pytest.raises(InputRefused, match=text):
        from_gempy(*first, **arguments)


# --- LoopStructural ---------------------------------------------------------------------------------------

BOUNDS = np.array(BOX).reshape(3, 2).T


def loop_rows(points, feature, val=np.nan, coord=np.nan, normal=(np.nan,) * 3):
    """Rows as LoopStructural's tables have them."""
    points = np.asarray(points, float)
    columns = dict(zip(("X", "Y", "Z"), points.T, strict=True))
    columns |= {"feature_name": np.full(len(points), feature), "val": np.full(len(points), float(val))}
    columns["coord"] = np.full(len(points), float(coord))
    return columns | {
        axis: np.full(len(points), float(n)) for axis, n in zip(("nx", "ny", "nz"), normal, strict=True)
    }


UP = (0.0, 0.0, 1.0)


def loop_beds(names=("sand", "shale"), values=(0, 0)):
    return joined(
        loop_rows(level(400.0), names[0], values[0]),
        loop_rows(level(200.0), names[1], values[1]),
        loop_rows([(500, 400, 300)], names[0], normal=UP),
    )


@pytest.mark.parametrize(
    ("data", "column"),
    [
        (loop_beds(), [["sand", "shale"], ["basement"]]),
        (loop_beds(("s", "s"), (2, 1)), [["sand", "shale"]]),
        (loop_beds(("s", "s"), (2, 1)), {"s": {"sand": {"min": 2}, "shale": {"min": 1}, "basement": {}}}),
        (loop_beds(values=(2, 1)), [["sand", "shale"]]),
    ],
)
def test_beds_of_loop(data, column):
    model = build(from_loop(data, column, bounds=BOUNDS))
    assert [block.name for block in model.blocks] == ["basement", "shale", "sand"]
    assert model.block_at([(500, 400, 100), (500, 400, 300), (500, 400, 599)]).tolist() == [0, 1, 2]


def test_values_of_one_feature_are_its_units():
    project = from_loop(loop_beds(("s", "s"), (2, 1)), [["s"]], bounds=BOUNDS)
    assert project.rocks[0].block_names() == ["basement", "s 1", "s 2"]


@given(seed=st.integers(0, 10_000))
@settings(max_examples=3, derandomize=True, deadline=None)
def test_fault_of_loop_from_its_coordinate(seed):
    fault = [(500.0, y, z) for y in (100.0, 700.0) for z in (100.0, 500.0)]
    data = joined(
        loop_rows(np.random.default_rng(seed).permutation(fault), "f", 0, 0),
        loop_rows([(500, 400, 300)], "f", coord=0, normal=(1.0, 0.0, 0.0)),
        loop_rows([(500, 400, 300)], "f", coord=1, normal=UP),
        loop_rows([(500, 0, 300), (500, 800, 300)], "f", val=1, coord=2),
        loop_rows(on(lambda x, y: 400 - 100.0 * (x > 500)), "sand", 0),
        loop_rows(on(lambda x, y: 250 - 100.0 * (x > 500)), "shale", 0),
        loop_rows([(200, 400, 300), (800, 400, 200)], "sand", normal=UP),
    )
    model = build(from_loop(data, [["sand", "shale"]], faults=["f"], bounds=BOUNDS))
    assert agreement(model, displaced(100.0)) > 0.99


def test_groups_of_loop_erode_what_is_older():
    slope = np.tan(np.radians(20))
    old = on(lambda x, y: 200 + slope * (x - 500))
    data = joined(
        loop_rows(level(300.0), "young", 0),
        loop_rows([(500, 400, 300)], "young", normal=UP),
        loop_rows(old[old[:, 2] < 290], "old", 0),
        loop_rows([(500, 400, 200)], "old", normal=(-slope, 0.0, 1.0)),
    )
    model = build(from_loop(data, [["young"], ["old"]], bounds=BOUNDS))
    truth = lambda x, y, z: np.where(  # noqa: E731
        z > 300, "young", np.where(z > 200 + slope * (x - 500), "old", "basement")
    )
    assert agreement(model, truth) > 0.985


@pytest.mark.parametrize(
    ("data", "column", "text"),
    [
        (loop_beds(), [["clay"], ["sand", "shale"]], "data have no feature 'clay'"),
        (loop_beds(("s", "s"), (2, 1)), [["one", "two", "three", "four"]], "2 values for the"),
        (loop_beds(("s", "s"), (2, 1)), {"s": {"sand": {"min": 5}}}, "have the value 5"),
        (loop_beds(("s", "s"), (np.nan, np.nan)), [["s"]], "no points with a value"),
        (
            {**loop_beds(), "intrusion_contact_type": ["roof"] * 25},
            [["sand", "shale"]],
            "is an intrusion",
        ),
    ],
)
def test_refusals_of_loop(data, column, text):
    with pytest.raises(InputRefused, match=text):
        from_loop(data, column, bounds=BOUNDS)


# --- faults from points and dips, by hand ------------------------------------------------------------------


def with_fault(fault):
    box = [(0, 0), (1000, 0), (1000, 800), (0, 800)]
    sheet = [np.array([(x, y, z) for x, y in box], float) for z in (0.0, 300.0)]
    surfaces = [
        Surface(name, vertices=points, triangles=[(0, 1, 2), (0, 2, 3)])
        for name, points in zip(("low", "high"), sheet, strict=True)
    ]
    return build(Project("p", [Rock("r", surfaces, region=np.array(box, float))], faults=[fault]))


@given(seed=st.integers(0, 10_000), is_sticks=st.booleans())
@settings(max_examples=6, derandomize=True, deadline=None)
def test_points_of_a_fault_in_any_order_give_the_same_valid_model(seed, is_sticks):
    random = np.random.default_rng(seed)
    sticks = [
        np.array([(400 + z / 3 + y / 10, y, z) for z in np.linspace(-50, 350, 9)])
        for y in (-50.0, 200.0, 450.0, 850.0)
    ]
    mixed = [random.permutation(stick) for stick in random.permutation(sticks)]
    one, other = (
        with_fault(Fault("f", points=points if is_sticks else np.concatenate(points), extend=100.0))
        for points in (sticks, mixed)
    )
    np.testing.assert_array_equal(one.vertices, other.vertices)
    assert one.validate().passed
    assert len(one.compartment_names) == 2


@given(order=st.permutations(range(7)))
@settings(max_examples=12, derandomize=True, deadline=None)
def test_points_of_a_trace_in_another_order_are_refused(order):
    x = np.array([-100.0, 100, 300, 500, 700, 900, 1100])
    trace = np.column_stack([x, 400 + 0.0004 * (x - 500) ** 2])
    fault = Fault("f", trace=trace[list(order)], dip=70.0, dip_direction="S", elevation=300.0)
    if list(order) in (sorted(order), sorted(order, reverse=True)):
        with_fault(fault)
    else:
        with pytest.raises(InputRefused, match=r"not in order along it|crosses itself"):
            with_fault(fault)


def test_one_point_and_a_dip_make_a_plane():
    dips = SpaceDips(np.array([[500.0, 400.0, 150.0]]), np.array([[-1.0, 0.0, 1.0]]))
    model = with_fault(Fault("f", points=np.array([[500.0, 400.0, 150.0]]), dips=dips, extend=2000.0))
    vertices = model.structures.faults[0].vertices
    np.testing.assert_allclose(vertices[:, 2] - vertices[:, 0], -350.0, atol=1e-6)
    assert model.validate().passed


@pytest.mark.parametrize(
    ("points", "dips", "text"),
    [
        ([[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]], None, "in one line"),
        ([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]], "right angles"),
        ([[5.0, 5.0, 5.0]], [[1.0, 0.0, 0.0]], "in one place"),
    ],
)
def test_refused_points_of_faults(points, dips, text):
    at = np.zeros((1, 3))
    dips = None if dips is None else SpaceDips(at, np.array(dips))
    with pytest.raises(InputRefused, match=text):
        with_fault(Fault("f", points=np.array(points), dips=dips))
