# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices on the border of a tile: where points are exactly decides, in all tiles alike."""

from fractions import Fraction
from math import inf, nextafter

import numpy as np
from realmodel.core.tiles import settling
from realmodel.core.tiles.settling import BorderVertices, settled

BOX = (0.0, 0.0, 4.0, 4.0)
TINY = Fraction(1, 10**30)


def built(*places):
    """Vertices at exact places, in the form of the native build_tile."""

    def text(value):
        top, bottom = Fraction(value).as_integer_ratio()
        return f"{top:x}" if bottom == 1 else f"{top:x}/{bottom:x}"

    nearest = np.array([[float(Fraction(each)) for each in place] for place in places]).reshape(-1, 3)
    return {
        "border_vertices": np.arange(len(places), dtype=np.int32),
        "border_nearest": nearest,
        "border_exact": "".join(" ".join(map(text, place)) + "\n" for place in places).encode(),
    }


def border(*places):
    exact = dict(enumerate(built(*places)["border_exact"].splitlines()))
    return BorderVertices(np.arange(len(places)), built(*places)["border_nearest"], exact)


def test_what_is_apart_stays():
    own = border((0, 1, 5), (0, 2, 5), (0, 2, Fraction(16, 3)), (4, 4, 1))
    (at,) = settled(BOX, [own])
    assert np.array_equal(at, own.nearest)


def test_what_is_apart_needs_no_fractions(monkeypatch):
    """The same comes of them."""
    west = border((4, 1, 5), (4, Fraction(1, 3), 5), (4, Fraction(1, 3), 7), (0, 2, 5), (4, 0, 1), (2, 4, 3))
    east = border((4, Fraction(1, 3), 7), (4, 3, Fraction(5, 7)), (8, 2, 5), (4, 4, 2), (6, 4, 3))
    quick = settled(BOX, [west, east])
    monkeypatch.setattr(settling, "_are_apart", lambda *_: False)
    for one, other in zip(quick, settled(BOX, [west, east]), strict=True):
        assert np.array_equal(one, other, equal_nan=True)


def test_equal_doubles_are_made_distinct_in_exact_order():
    """By as little as possible; a double stays."""
    own = border((0, 2 + 2 * TINY, 5), (0, 2 + TINY, 5), (0, 2, 5), (0, 2 - TINY, 5))
    (at,) = settled(BOX, [own])
    up = nextafter(2.0, inf)
    assert at[:, 1].tolist() == [nextafter(up, inf), up, 2.0, nextafter(2.0, -inf)]
    assert at[:, 2].tolist() == [5.0] * 4
    own = border((0, 2, 5 + TINY), (0, 2, 5 - TINY), (0, 2, 5))
    (at,) = settled(BOX, [own])
    assert at[:, 2].tolist() == [nextafter(5.0, inf), nextafter(5.0, -inf), 5.0]


def test_all_tiles_at_a_border_find_the_same():
    west = border((4, 2, 5), (4, 2 + TINY, 5), (4, 2 + TINY, 5 + TINY), (0, 2, 5))
    east = border((4, 2 + TINY, 5), (4, 2 - TINY, 5), (4, 2 + TINY, 5 - TINY), (8, 2, 5))
    own, theirs = settled(BOX, [west, east])
    other, mine = settled((4.0, 0.0, 8.0, 4.0), [east, west])
    assert np.array_equal(own[:3], mine[:3]) and np.array_equal(other[:3], theirs[:3])
    assert np.isnan(theirs[3]).all() and np.isnan(mine[3]).all()
    assert np.array_equal(own[1], theirs[0])  # the same point
    both = np.concatenate([own[:3], theirs[:3]])
    assert len(np.unique(both, axis=0)) == 5


def test_a_corner_has_the_points_of_four_tiles():
    own, diagonal = border((4, 4, 5)), border((4, 4, 5 + TINY), (4, 4 + TINY, 5), (4, 8, 5))
    at, theirs = settled(BOX, [own, diagonal])
    assert at.tolist() == [[4.0, 4.0, 5.0]]
    assert theirs[0].tolist() == [4.0, 4.0, nextafter(5.0, inf)]
    assert np.isnan(theirs[1:]).all()  # rounded to the corner, but beyond it


def test_what_is_near_a_corner_stays_off_it():
    """Also where no vertex is in the corner."""
    (at,) = settled(BOX, [border((4, Fraction(1, 10**400), 5), (4, 4 - TINY, 5))])
    assert at[0].tolist() == [4.0, nextafter(0.0, inf), 5.0]
    assert at[1].tolist() == [4.0, nextafter(4.0, -inf), 5.0]


def test_it_comes_back_from_a_file():
    places = (0, Fraction(1, 3), 5), (8, Fraction(-1, 3), 5), (0, 2, Fraction(7, 3))
    own, again = border(*places), BorderVertices.of_arrays(BorderVertices.arrays_of(built(*places)), BOX)
    assert again.exact == {0: own.exact[0], 2: own.exact[2]}  # what is elsewhere is not asked for
    assert np.array_equal(again.nearest, own.nearest) and np.array_equal(again.numbers, own.numbers)
    assert BorderVertices.of_arrays(BorderVertices.arrays_of(built()), BOX).exact == {}
