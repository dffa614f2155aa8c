# SPDX-License-Identifier: GPL-3.0-or-later
"""Indices of any width reach the native part whole, or are refused."""

import numpy as np
import pytest
from realmodel import _native

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def built(triangles):
    upper = VERTICES + np.array([0, 0, 1])
    return _native.build_stack([(VERTICES, triangles), (upper, TRIANGLES.astype(np.int32))])


@pytest.mark.parametrize("kind", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"])
def test_every_whole_number_type_is_taken(kind):
    assert len(built(TRIANGLES.astype(kind))["cell_block"]) == 2


def test_columns_and_strides_do_not_matter():
    wide = np.zeros((2, 6), np.int64)
    wide[:, ::2] = TRIANGLES
    assert len(built(wide[:, ::2])["cell_block"]) == 2
    assert len(built(np.asfortranarray(TRIANGLES))["cell_block"]) == 2


@pytest.mark.parametrize(
    ("kind", "value"),
    [("int64", 2**32), ("int64", -(2**40)), ("uint32", 2**32 - 1), ("uint64", 2**63 + 1), ("int64", 2**31)],
)
def test_what_32_bits_do_not_hold_is_refused(kind, value):
    """2**32 would wrap around to vertex 0."""
    triangles = TRIANGLES.astype(kind)
    triangles[1, 0] = value
    with pytest.raises(_native.InputError, match=str(value)) as refused:
        built(triangles)
    assert (refused.value.kind, refused.value.items) == ("too_large", [1])


@pytest.mark.parametrize("triangles", [TRIANGLES + 0.5, TRIANGLES.astype(complex), TRIANGLES.astype(bool)])
def test_what_is_no_whole_number_is_refused(triangles):
    with pytest.raises(TypeError):
        built(triangles)


def test_an_index_beyond_the_vertices_is_still_a_bad_index():
    triangles = TRIANGLES.astype(np.int64)
    triangles[0, 0] = 4
    with pytest.raises(_native.InputError) as refused:
        built(triangles)
    assert refused.value.kind == "bad_index"
