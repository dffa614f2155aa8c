# SPDX-License-Identifier: GPL-3.0-or-later
"""Models saved and loaded again: everything that can be made of the loaded one is the same, byte for byte."""

import dataclasses
import io
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from damages import damaged_bytes
from realmodel.core import (
    Fault,
    InputRefused,
    Model,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.cells.model_record import record_arrays
from realmodel.core.ensembles.realization import Realizer
from realmodel.core.exporters import MODEL
from realmodel.core.exporters.model_arrays import write_arrays
from realmodel.core.exporters.report import model_report
from realmodel.core.readers import read_mesh
from realmodel.core.results.sections.section_holes import hole_places
from realmodel.core.results.surface_quality import residuals
from sample_scripts import built_sample, coarse_sample
from structure_cases import plane_fault

ROOT = Path(__file__).resolve().parents[2]
OLD = ROOT / "tests" / "data" / "models" / "0.1.npz"
# of a run or of the folder, and so not in a file
_OF_THE_RUN = {"timings", "threads", "seconds", "build_seconds", "peak_memory", "source", "path", "file"}


def plain(value):
    """A value as numbers, texts, tuples, and dicts, with the bytes of its arrays."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items() if key not in _OF_THE_RUN}
    if isinstance(value, (list, tuple)):
        return tuple(plain(each) for each in value)
    if isinstance(value, Path):
        return value.name
    if isinstance(value, str):
        return re.sub(rf"{re.escape(str(ROOT))}/blend_samples/\w+/", "", value)
    if dataclasses.is_dataclass(value):
        return plain({each.name: getattr(value, each.name) for each in dataclasses.fields(value)})
    if value is None or isinstance(value, (bool, int, float, bytes)):
        return value
    if isinstance(value, Exception):
        return str(value)
    return plain(vars(value))


def files_of(folder):
    """{name: bytes} of all files in a folder."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def side(model):
    """The longest side of a model."""
    return float(np.ptp(model.vertices, axis=0).max())


def saved(model, tmp_path):
    for known in MODEL.formats():
        size = {"cell_size": side(model) / 20} if "cell_size" in known.options else {}
        try:
            model.save(tmp_path / f"m{known.ending}", **size)
        except UsageError as error:
            assert known.ending == ".disu" and "is inclined" in str(error)
    return files_of(tmp_path)


def saved_surfaces(model, tmp_path):
    for ending in (".npz", ".vtu", ".obj", ".ts"):
        model.save_surfaces(tmp_path / f"s{ending}")
    return files_of(tmp_path)


def sections_saved(model, tmp_path):
    """Files of a section and a fence, with drawings."""
    middle = model.vertices.mean(axis=0)
    for ending in (".npz", ".svg", ".png", ".dxf", ".vtu"):
        model.section(middle, (1, 0.3, 0)).save(tmp_path / f"s{ending}")
        model.fence([middle[:2] - 20, middle[:2], middle[:2] + 20]).save(tmp_path / f"f{ending}")
    return files_of(tmp_path)


def sloping(model):
    """A surface that divides a model."""
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    size, middle = high - low, (low + high) / 2
    corners = [[-1, -1, -0.1], [1, -1, -0.1], [1, 1, 0.1], [-1, 1, 0.1]]
    return middle + np.array(corners) * size, np.array([[0, 1, 2], [0, 2, 3]])


def last_surface(model):
    return max(len(rock.surfaces) for rock in model.project.rocks) - 1


def left_out_holes(model):
    """Of models with holes what others say of these, else why there is nothing."""
    try:
        return model.cross_validate_holes(2)
    except InputRefused as refusal:
        return str(refusal)


def fence_through_holes(model, _):
    names = list(hole_places(model.project))
    return model.fence_through_holes(names) if len(names) > 1 else None


# What is made of a model by each of its methods; properties are compared as they are.
MADE = {
    "block_boundary": lambda m, _: [m.block_boundary(n) for n, block in enumerate(m.blocks) if block.cells],
    "borehole": lambda m, _: m.borehole(*m.vertices.mean(axis=0)[:2]),
    "planned_hole": lambda m, _: m.planned_hole(m.vertices.max(axis=0), 225.0, 45.0).rows(),
    "cleaned_cells": lambda m, _: m.cleaned_cells(side(m) / 1000),
    "contours": lambda m, _: m.contours(),
    "cross_validate_holes": lambda m, _: left_out_holes(m),
    "cut_by_block": lambda m, _: m.cut_by_block(m, 0),
    "cut_by_plane": lambda m, _: m.cut_by_plane(m.vertices.mean(axis=0), (0.2, 1, 0.1)),
    "cut_by_surface": lambda m, _: m.cut_by_surface(*sloping(m)),
    "eroded": lambda m, _: m.eroded(),
    "face_corners": lambda m, _: m.face_corners(np.arange(20), np.arange(20) % 2 == 0),
    "field": lambda m, _: [m.field(own.name) for entry in m.rock_inputs for own in entry.fields],
    "fence": lambda m, _: m.fence(m.vertices[:, :2].mean(axis=0) + np.array([[-20, 0], [20, 5]])),
    "fence_through_holes": fence_through_holes,
    "geological_map": lambda m, _: m.geological_map(),
    "native": lambda m, _: m.native(),
    "of": lambda m, _: Model.of(m),
    "observed": lambda m, _: m.observed(),
    "misfits": lambda m, _: m.misfits(),
    "require_project": lambda m, _: m.require_project("nothing"),
    "save": saved,
    "save_surfaces": saved_surfaces,
    "section": sections_saved,
    "sheet_triangles": lambda m, _: [m.sheet_triangles(k) for k in range(len(m.surface_names))],
    "simulation_mesh": lambda m, _: m.simulation_mesh(side(m) / 20, side(m) / 200, elements="tetrahedra"),
    "stage": lambda m, _: [m.stage(k) for k in range(last_surface(m) + 1)],
    "surface": lambda m, _: [m.surface(k) for k in range(len(m.surface_names))],
    "surface_attributes": lambda m, _: [m.surface_attributes(k) for k in range(len(m.surface_names))],
    "validate": lambda m, _: m.validate(),
}
PUBLIC = sorted(name for name in dir(Model) if not name.startswith("_") and name != "load")


@pytest.fixture(scope="module", params=["two_layers", "tunnel", "faulted"])
def both(request, tmp_path_factory):
    """A built model, and the one loaded from its file."""
    made = {"faulted": old_project, "tunnel": lambda: coarse_sample("tunnel", 3)}
    model = build(made.get(request.param, lambda: coarse_sample(request.param, 1))(), threads=2)
    file = tmp_path_factory.mktemp(request.param) / "m.npz"
    model.save(file)
    return model, Model.load(file, threads=2)


@pytest.mark.parametrize("name", PUBLIC)
def test_whatever_is_made_of_a_loaded_model_is_the_same(both, name, tmp_path):
    made = MADE.get(name, lambda model, _: getattr(model, name))
    found = []
    for number, model in enumerate(both):
        folder = tmp_path / str(number)
        folder.mkdir()
        found.append(plain(made(model, folder)))
    assert found[0] == found[1]


def test_fields_reports_residuals_and_realizations_are_the_same(both):
    built, loaded = (
        [
            plain(model),
            plain(model_report(model)),
            plain(residuals(model)),
            plain(Realizer(model, seed=3).realization(1)),
        ]
        for model in both
    )
    assert built == loaded
    assert loaded[1]["project"]["name"] == both[0].project.name


def test_a_half_is_loaded_as_a_half(both, tmp_path):
    half = both[0].cut_by_plane(both[0].vertices.mean(axis=0), (1, 0, 0)).below
    half.save(tmp_path / "half.npz")
    loaded = Model.load(tmp_path / "half.npz")
    assert loaded.is_cut and plain(loaded) == plain(half)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_file_has_the_same_bytes_wherever_it_is_built(cells, tmp_path):
    """For any number of threads, also in another folder, and of the loaded model."""
    sample = ROOT / "blend_samples" / "gravel_plain"
    copied = tmp_path / "elsewhere" / "copy"
    copied.mkdir(parents=True)
    for file in sample.iterdir():
        if file.is_file():
            (copied / file.name).write_bytes(file.read_bytes())
    build(load_project(sample / "project.toml"), cells=cells, threads=1).save(tmp_path / "a.npz")
    build(load_project(copied / "project.toml"), cells=cells, threads=2).save(tmp_path / "b.npz")
    Model.load(tmp_path / "a.npz").save(tmp_path / "c.npz")
    first = (tmp_path / "a.npz").read_bytes()
    assert first == (tmp_path / "b.npz").read_bytes() == (tmp_path / "c.npz").read_bytes()
    assert str(tmp_path).encode() not in first and str(ROOT).encode() not in first


def test_a_model_may_replace_its_own_file(layers, tmp_path):
    file = tmp_path / "m.npz"
    build(load_project(layers((0, 1)))).save(file)
    before = file.read_bytes()
    Model.load(file).save(file)
    assert file.read_bytes() == before


# Files of RealModel 0.1


def old_project():
    """That of the file: compressed by numpy.savez_compressed, as `save` did before files had a record."""
    plan = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)

    def level(name, heights, plan=plan, **given):
        return Surface(name, np.column_stack([plan, heights]), triangles, **given)

    ready = [
        level(f"S{k}", heights, property=k, block=f"layer {k}")
        for k, heights in enumerate(([0, 0, 0, 0], [2, 2, 2, 2], [1, 5, 5, 1]))
    ]
    points = np.array([[1.0, 1, 6], [9, 2, 7], [5, 8, 6.5], [2, 7, 7]])
    soil = Surface("S3", points=points, method="kriging", property=3, tie=False)  # as it was made
    east = Rock("east", [*ready, soil], region=plan.tolist(), edge_length=4.0, base_elevation=-1.0)
    west = Rock("west", [level(f"T{k}", np.full(4, 10.0 + k), plan - (10.0, 0.0)) for k in range(2)])
    return Project("old", [east, west], faults=[Fault("F", *plane_fault(lean=0.2))])


def test_a_file_without_a_project_is_read_as_far_as_it_goes(tmp_path):
    old = Model.load(OLD)
    new = build(old_project())
    assert [(b.name, b.property) for b in old.blocks] == [(b.name, b.property) for b in new.blocks]
    volumes = [[block.volume for block in model.blocks] for model in (old, new)]
    np.testing.assert_allclose(*volumes, rtol=1e-15)  # added up in another order since
    assert old.surface_names == new.surface_names
    assert [rock.name for rock in old.project.rocks] == [rock.name for rock in new.project.rocks]
    assert [s.block for s in old.project.rocks[0].surfaces] == [b.name for b in new.blocks[:4]]
    assert old.compartment_names == new.compartment_names
    for model, name in ((old, "old"), (new, "new")):
        model.save(tmp_path / f"{name}.csv")
    assert (tmp_path / "old.csv").read_bytes() == (tmp_path / "new.csv").read_bytes()
    old.save(tmp_path / "old.vtu")  # faces at the fault have other corners in new ones
    assert f'NumberOfPoints="{len(old.vertices)}"'.encode() in (tmp_path / "old.vtu").read_bytes()
    old.save(tmp_path / "old.ply")
    corners = np.unique(read_mesh(tmp_path / "old.ply").vertices, axis=0)  # of the boundaries of blocks
    assert 100 < len(corners) <= len(old.vertices)
    assert set(map(tuple, corners.tolist())) <= set(map(tuple, old.vertices.tolist()))
    at = new.vertices.mean(axis=0)
    assert old.section(at, (1, 0, 0)).area == pytest.approx(new.section(at, (1, 0, 0)).area, rel=1e-12)
    assert plain(old.cut_by_plane(at, (0, 1, 0)).below.blocks) == plain(
        new.cut_by_plane(at, (0, 1, 0)).below.blocks
    )
    assert plain(old.surface_attributes(1)) == plain(new.surface_attributes(1))
    assert old.validate(places=0).passed


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda m: m.stage(0), "a stage"),
        (lambda m: m.eroded(), "eroded"),
        (lambda m: m.validate(), "closed form"),
        (model_report, "report"),
        (residuals, "residual"),
        (Realizer, "ensemble"),
        (record_arrays, ".npz"),
        (
            lambda m: m.cut_by_plane(m.vertices.mean(axis=0), (1, 0, 0)).below.validate(1) and m.stage(0),
            "stage",
        ),
    ],
)
def test_what_a_file_without_a_project_lacks_is_said(make, word):
    with pytest.raises(InputRefused, match="build it from its project and save it again") as caught:
        make(Model.load(OLD))
    assert caught.value.file == OLD and word in str(caught.value)


# Damaged files and other files


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """The bytes of a small model with a fault, and its arrays."""
    project = load_project(ROOT / "blend_samples" / "two_layers" / "project.toml")
    file = tmp_path_factory.mktemp("small") / "m.npz"
    build(project, cells="blocks").save(file)
    with np.load(file) as arrays:
        return file.read_bytes(), dict(arrays)


def test_damaged_files_are_refused_or_read_as_they_were(small, tmp_path):
    """Bytes of a zip that mean nothing may be changed; else it is refused, in one line with the file."""
    whole, file = small[0], tmp_path / "m.npz"
    file.write_bytes(whole)
    as_it_was, refused = plain(Model.load(file)), 0
    for raw in damaged_bytes(whole):
        file.write_bytes(raw)
        try:
            model = Model.load(file)
        except InputRefused as error:
            assert error.file == file and len(str(error).splitlines()) == 1 and error.advice
            refused += 1
        else:
            assert plain(model) == as_it_was
    assert refused > 250


def changed(arrays, **new):
    file = io.BytesIO()
    write_arrays({**arrays, **new}, file)
    return file.getvalue()


def test_arrays_that_do_not_fit_one_another_are_refused(small, tmp_path):
    """Each array shorter, of another type, and with numbers of nothing; the table of the record as well."""
    _, arrays = small
    file, free = tmp_path / "m.npz", {"record_0", "block_property", "block_names", "block_volume"}
    free |= {"block_cells", "block_components", "surface_variance", "surface_distance"}
    free |= {"surface_triangle_sheet", *(name for name in arrays if name.startswith("record"))}
    wrong = []
    for name, array in arrays.items():
        if array.ndim and not name.startswith("record_"):
            wrong += [{name: array[:-1]}, {name: array.astype("c16" if array.dtype.kind != "U" else "S9")}]
        if array.dtype.kind in "fi" and name not in free:
            bad = array.copy()
            bad.flat[-1] = np.nan if array.dtype.kind == "f" else 1 << 30
            low = array.copy()
            low.flat[0] = -np.inf if array.dtype.kind == "f" else -9
            wrong += [{name: bad}, {name: low}]
    text = arrays["record"].tobytes()
    for old, new in (
        (b'"Project"', b'"Popen"'),
        (b'"rocks"', b'"socks"'),
        (b"[[", b"["),
        (b'"erosional"', b"7"),
        (b'"record_0"', b'"record_x"'),
        (b'"Two layers"', b"[9999]"),
    ):
        assert old in text
        wrong.append({"record": np.frombuffer(text.replace(old, new, 1), np.uint8)})
    for each in wrong:
        file.write_bytes(changed(arrays, **each))
        with pytest.raises(InputRefused) as caught:
            Model.load(file)
        assert caught.value.file == file and len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "check the path"),
        (b"", "not an .npz file"),
        (b"OFF\n0 0 0\n", "not an .npz file"),
        ("section", "not a model of RealModel: it has no array"),
        ("pickle", "not an .npz file, or a damaged one"),
    ],
)
def test_other_files_are_refused(content, words, small, tmp_path):
    file = tmp_path / "m.npz"
    if content == "section":
        model = built_sample("two_layers")
        model.section(model.vertices.mean(axis=0), (1, 0, 0)).save(file)
    elif content == "pickle":
        np.savez(file, **{**small[1], "vertices": np.array([{}], object)})
    elif content is not None:
        file.write_bytes(content)
    with pytest.raises(InputRefused, match=words) as caught:
        Model.load(file)
    assert caught.value.file == file


def test_a_compressed_copy_is_read(small, tmp_path):
    np.savez_compressed(tmp_path / "m.npz", **small[1])
    assert zipfile.ZipFile(tmp_path / "m.npz").infolist()[0].compress_type == zipfile.ZIP_DEFLATED
    assert Model.load(tmp_path / "m.npz").volume > 0
