# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of keys in TOML texts, however these are written."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core.base.toml_table import key_lines


def lines_of(text):
    tomllib.loads(text)
    return key_lines(text)


def test_tables_and_arrays_of_tables():
    lines = lines_of(
        "format = 1\n"
        "\n"
        "[[rock]]\n"
        'name = "a"\n'
        "  [[rock.surface]]\n"
        '  name = "S0"\n'
        "  [rock.surface.variogram]\n"
        "  range = 5\n"
        "  [[rock.surface]]\n"
        '  name = "S1"\n'
        "[[rock]]\n"
        "[[rock.surface]]\n"
        '"strange key" = 1\n'
    )
    assert lines[("format",)] == 1
    assert lines[("rock",)] == 3
    assert lines[("rock", 0)] == 3
    assert lines[("rock", 0, "surface", 0, "name")] == 6
    assert lines[("rock", 0, "surface", 0, "variogram", "range")] == 8
    assert lines[("rock", 0, "surface", 1)] == 9
    assert lines[("rock", 1)] == 11
    assert lines[("rock", 1, "surface", 0)] == 12
    assert lines[("rock", 1, "surface", 0, "strange key")] == 13


def test_inline_tables_dotted_keys_and_long_arrays():
    lines = lines_of(
        "a.b.c = 1 # c = 2\n"
        "region = [ # [[x]]\n"
        "  [0, 1], [2, 3],\n"
        "\n"
        '  ["]", "# no comment"],\n'
        "]\n"
        "v = {model = 'sph#erical', range.x = 6, list = [1,\n 2]}\n"
        "z = 1\n"
    )
    assert lines[("a", "b", "c")] == 1
    assert lines[("region",)] == 2
    assert lines[("region", 0)] == lines[("region", 1)] == 3
    assert lines[("region", 2)] == 5
    assert lines[("v", "model")] == lines[("v", "range", "x")] == lines[("v", "list", 0)] == 7
    assert lines[("v", "list", 1)] == 8
    assert lines[("z",)] == 9


@pytest.mark.parametrize(
    "value",
    [
        '"""\n[a]\n# \\" """',
        '"""two quotes at the end"""""',
        '"""one"\n"""',
        '""""""',
        "'''\nb = 1\n''\n'''",
        "'''ends with one''''",
        "''",
        r'"a \" # [ \\"',
        "1979-05-27 07:32:00",
        "[\n# ]\n'''\n]''',\n]",
    ],
)
def test_lines_after_every_kind_of_value(value):
    text = f"a = {value} # x = 1\nlast = true\n"
    assert lines_of(text)[("last",)] == 2 + value.count("\n")


def test_comment_without_line_end_and_blank_file():
    assert lines_of("a = 1\n# nothing") == {("a",): 1}
    assert lines_of("") == {}


values = st.recursive(
    st.one_of(
        st.integers().map(str),
        st.sampled_from(['"#"', "'[x]'", '"""a\nb"""', "'''\n\n'''", '"\\"]"', "true", "1.5e3", '"{"']),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: "[\n" + ",\n".join(items) + "\n]"),
        st.lists(inner, max_size=3).map(
            lambda items: "{" + ", ".join(f"k{i} = {item}" for i, item in enumerate(items)) + "}"
        ),
    ),
    max_leaves=6,
)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.sampled_from(["pair", "table", "array", "inner"]), values), max_size=8))
def test_every_key_of_any_text_is_found(entries):
    """Each key is written with its line in its name, so that the answer is known."""
    text, arrays = "", 0
    for kind, value in entries:
        line = text.count("\n") + 1
        if kind == "pair":
            text += f"line{line} = {value}\n"
        elif kind == "table":
            text += f"[line{line}]  # comment\n"
        elif kind == "array":
            text += "[[many]]\n"
            arrays += 1
        elif arrays:
            text += f"[many.line{line}]\n"
    lines = lines_of(text)
    found = {path: line for path, line in lines.items() if str(path[-1]).startswith("line")}
    assert len(found) == text.count("line")
    for path, line in found.items():
        assert path[-1] == f"line{line}"
