# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of properties: read, and refused with the line."""

import pytest
from realmodel.core import InputRefused, Library, Property, load_library


def test_every_key(write):
    library = load_library(
        write(
            "library.toml",
            '[[property]]\nid = 3\nname = "Grès vosgien"\nrock = "sandstone"\nage = "Olenekian"\n'
            'structure = "cross-bedded"\ncolor = "#B04030"\ndensity = 2.35\n'
            "porosity = 0.2\npermeability = 35.5\n"
            'look = "sandstone"\nlook_scale = 2.5\nlook_seed = 4\nhardness = 0.7\n'
            'description = """two\nlines"""\n[[property]]\nid = 1\nname = "Granite"\n',
        )
    )
    entry = library.get(3)
    assert (entry.name, entry.rock, entry.age) == ("Grès vosgien", "sandstone", "Olenekian")
    assert (entry.structure, entry.density, entry.description) == ("cross-bedded", 2.35, "two\nlines")
    assert (entry.porosity, entry.permeability) == (0.2, 35.5)
    assert (entry.look, entry.look_scale, entry.look_seed, entry.hardness) == ("sandstone", 2.5, 4, 0.7)
    assert library.get(1).look is None
    assert entry.rgb == pytest.approx((0xB0 / 255, 0x40 / 255, 0x30 / 255))
    assert [entry.id for entry in library] == [3, 1]
    assert 1 in library
    assert 2 not in library
    assert library.get(2) is None
    assert library.get(1).rgb is None


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("title = 1\n", 1, "unknown key 'title'"),
        ('[[property]]\nid = 1\nname = "a"\ncolour = "#000000"\n', 4, "did you mean 'color'"),
        ('[[property]]\nname = "a"\n', 1, "'id' is missing"),
        ("[[property]]\nid = 1\n", 1, "'name' is missing"),
        ('[[property]]\nid = 1.0\nname = "a"\n', 2, "whole number"),
        (
            '[[property]]\nid = 1\nname = "a"\n[[property]]\nid = 1\nname = "b"\n',
            5,
            "another property has this id",
        ),
        ('[[property]]\nid = 1\nname = "a"\ncolor = "red"\n', 4, "#rrggbb"),
        ('[[property]]\nid = 1\nname = "a"\ncolor = 3\n', 4, "text"),
        ('[[property]]\nid = 1\nname = "a"\ndensity = -1\n', 4, "above 0"),
        ('[[property]]\nid = 1\nname = "a"\ndensity = nan\n', 4, "finite"),
        (
            '[[property]]\nid = 1\nname = "a"\nlook = "marbel"\n',
            4,
            "look 'marbel' is unknown; choose from auto, flat",
        ),
        ('[[property]]\nid = 1\nname = "a"\nlook = 3\n', 4, "text"),
        ('[[property]]\nid = 1\nname = "a"\nlook_scale = 0\n', 4, "above 0"),
        ('[[property]]\nid = 1\nname = "a"\nlook_seed = -1\n', 4, "from 0"),
        ('[[property]]\nid = 1\nname = "a"\nhardness = 1.5\n', 4, "at most 1"),
        ('[[property]]\nid = 1\nname = "a"\nporosity = 25\n', 4, "at most 1"),
        ('[[property]]\nid = 1\nname = "a"\npermeability = 0\n', 4, "above 0"),
        ('[[property]]\nid = 9999999999\nname = "a"\n', 2, "32-bit"),
    ],
)
def test_refused(write, text, line, words):
    path = write("library.toml", text)
    with pytest.raises(InputRefused) as raised:
        load_library(path)
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_a_library_may_be_empty(write):
    """Its properties come later; whatever names one is refused until then."""
    library = load_library(write("library.toml", "# none yet\n"))
    assert list(library) == [] and 1 not in library


def test_libraries_made_in_python_are_checked_too():
    with pytest.raises(InputRefused, match="another property has this id"):
        Library([Property(1, "a"), Property(1, "b")])
    with pytest.raises(InputRefused, match="#rrggbb"):
        Library([Property(1, "a", color="#12345")])
