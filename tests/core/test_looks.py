# SPDX-License-Identifier: GPL-3.0-or-later
"""Which look suits a rock by its name."""

import pytest
from realmodel.core.project.looks import DEFAULT, LOOKS, look_of


@pytest.mark.parametrize(
    ("names", "look"),
    [
        (["sandstone"], "SANDSTONE"),
        (["Sand"], "SAND"),
        (["sandy clay"], "CLAY"),
        (["Rock salt"], "SALT"),
        (["basalt flow"], "BASALT"),  # not salt
        (["mudstone"], "SHALE"),  # not mud
        (["", "Granite basement"], "GRANITE"),
        (["gravel", "Salt Street Gravel"], "GRAVEL"),  # the lithology comes first
        (["", ""], DEFAULT),
        (["Unit 7"], DEFAULT),
    ],
)
def test_look_of_a_rock(names, look):
    assert look_of(*names) == look


def test_every_look_but_flat_is_found_by_its_words():
    for key, look in LOOKS.items():
        assert bool(look.words) == (key != "FLAT")
        for word in look.words:
            assert look_of(word.upper()) == key, word
