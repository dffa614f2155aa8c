# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects in files: what comes back, and that no file runs code."""

import io
import json
import pickle
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import BuildWarning, Fault, InputRefused, Surface
from realmodel.core.base.stored_objects import NamedArrays, StoredClasses, fits
from realmodel.core.base.triangles import Sheet
from realmodel.core.cells.model_record import RECORDED
from realmodel.core.surfaces.rock_structure import FaultShape

STORED = StoredClasses(RECORDED)


def stored(value):
    arrays = NamedArrays({})
    return STORED.read(STORED.write(value, arrays), arrays)


def test_objects_come_back_with_their_types_and_identities():
    corners, triangles = np.arange(9.0).reshape(3, 3), np.array([[0, 1, 2]], np.int32)
    fault = Fault("F", corners, triangles, ends_at=("G",))
    shape = FaultShape(corners, triangles, True)
    given = {"fault": fault, 3: [shape, (shape, None)], (1, 2): Path("a/b"), "x": [0.1, np.inf, np.int64(7)]}
    found = stored(given)
    assert list(found) == ["fault", 3, (1, 2), "x"]
    assert type(found["fault"]) is Fault and found["fault"].ends_at == ("G",)
    first, (second, nothing) = found[3]
    assert first is second and nothing is None and type(first) is FaultShape and first.dies_out is True
    assert first.vertices is found["fault"].vertices
    assert first.triangles.dtype == np.int32
    np.testing.assert_array_equal(first.vertices, corners)
    assert found[(1, 2)] == Path("a/b")
    assert found["x"] == [0.1, np.inf, 7]


def test_errors_of_surfaces_come_back():
    """RockInput.overlapping."""
    error = InputRefused("it folds", file=Path("s.csv"), advice="smooth it", place=(1.0, 2.0))
    found = stored({3: error})[3]
    assert type(found) is InputRefused
    assert vars(found) == vars(error)
    assert str(found.within("surface 'S'")) == str(error.within("surface 'S'"))


def test_objects_of_others_are_not_written():
    with pytest.raises(TypeError, match="StringIO"):
        STORED.write([io.StringIO()], NamedArrays({}))


class Harmful:
    def __reduce__(self):
        return Path.touch, (Path("harmed"),)


def test_a_pickle_is_refused_and_not_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"utf-8|Expecting"):
        STORED.read(pickle.dumps(Harmful()), {})
    assert not (tmp_path / "harmed").exists()


@pytest.mark.parametrize(
    "kind",
    ["os:system", "Path", "Project", "PolyData", ".core.model.model:Model", "realmodel.core.Surface"],
)
def test_only_classes_of_models_are_made(kind):
    with pytest.raises(ValueError, match=r"Project has no name|damaged"):
        STORED.read(json.dumps([[[kind, []]], [0]]).encode(), {})


SURFACE = StoredClasses((Surface, Sheet, BuildWarning))


def written(value):
    arrays = NamedArrays({})
    return SURFACE.write(value, arrays), arrays


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'["name", "S"]', b'["name", 3]'),
        (b'["rule", "erosional"]', b'["rule", null]'),
        (b'["property", 0]', b'["property", 0.5]'),
        (b'["property", 0]', b'["property", true]'),
        (b'["property", 0]', b'["proper", 0]'),
        (b'["name", "S"], ', b""),
    ],
)
def test_fields_have_the_types_of_their_class(old, new):
    text, arrays = written(Surface("S"))
    assert SURFACE.read(text, arrays) == Surface("S") and old in text
    with pytest.raises(ValueError, match=r"Surface|damaged"):
        SURFACE.read(text.replace(old, new), arrays)


@pytest.mark.parametrize(
    ("value", "hint", "does"),
    [
        (3, float, True),
        (True, int, False),
        ((1, 2), tuple[int, ...], True),
        ((1, "2"), tuple[int, ...], False),
        ((1, "2"), tuple[int, str], True),
        ((1,), tuple[int, str], False),
        ([[1], ["x"]], list[list[int]], False),
        ({1: {"a": np.zeros(2)}}, dict[int, dict[str, np.ndarray]], True),
        ({1: {"a": 2}}, dict[int, dict[str, np.ndarray]], False),
        (np.zeros(2), Sequence[str], True),
        (None, str | None, True),
        (2, str | None, False),
    ],
)
def test_what_fits_a_type(value, hint, does):
    assert fits(value, hint) is does


def test_a_field_that_a_file_lacks_gets_its_default_and_some_are_not_stored():
    text, arrays = written(BuildWarning("text", "kind"))
    assert SURFACE.read(text.replace(b', ["kind", "kind"]', b""), arrays) == BuildWarning("text")
    found = SURFACE.read(*written(Surface("S", source=object())))
    assert found.source is None


def test_equal_arrays_are_stored_once_and_known_ones_only_named():
    known = {"elsewhere": np.arange(6.0).reshape(2, 3)}
    arrays = NamedArrays(known, "a_")
    sheet = Sheet(known["elsewhere"].copy(), np.zeros((1, 3), np.int32))
    other = Sheet(np.array([[0.0, np.nan, -0.0]]), np.zeros((1, 3), np.int32), np.array(["x", "yz"]))
    text = SURFACE.write([sheet, other, np.empty((0, 2))], arrays)
    assert [arrays[name].shape for name in arrays] == [(1, 3), (1, 3), (2,), (0, 2)]
    first, second, _ = SURFACE.read(text, {**known, **arrays})
    assert first.vertices is known["elsewhere"] and first.triangles is second.triangles
    again = NamedArrays(known, "a_")
    assert SURFACE.write([first, second, np.empty((0, 2))], again) == text


def test_arrays_that_begin_alike_are_told_apart():
    arrays = NamedArrays({})
    rows = [np.append(np.zeros(20), last) for last in (1.0, 2.0, 1.0)]
    assert [arrays.name_of(row) for row in rows] == ["0", "1", "0"]
