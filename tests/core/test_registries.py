# SPDX-License-Identifier: GPL-3.0-or-later
"""What is in the add-on's registries is there: functions of methods, rules and meshers of the native part."""

import re
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import (
    Body,
    Boreholes,
    DipFile,
    Fault,
    InputRefused,
    MapFile,
    MapLayer,
    MeshFile,
    ObservationFile,
    PointFile,
    Project,
    Property,
    Rock,
    Series,
    Surface,
    build,
    exporters,
    mesh_region,
)
from realmodel.core.exporters.formats import FORMATS
from realmodel.core.heights.methods import FUNCTIONS
from realmodel.core.readers.mesh_input import read_mesh
from realmodel.core.settings.meshers import MESHERS
from realmodel.core.settings.method_options import checked
from realmodel.core.settings.methods import METHODS, OPTIONS
from realmodel.core.settings.rules import RULES
from realmodel.core.settings.setting import declarations

ENTRIES = (
    *(Project, Rock, Surface, Series, Fault, Body, Property),
    *(PointFile, MeshFile, MapLayer, MapFile, Boreholes, DipFile, ObservationFile),
)
PLAN = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def test_each_method_that_chooses_no_other_has_its_function():
    assert set(FUNCTIONS) == {name for name, method in METHODS.items() if not method.chooses}


def test_each_format_is_written_by_an_exporter_and_is_the_only_one_there():
    values = [*vars(exporters).values(), *exporters.SAMPLES.values()]
    views = {view for value in values if isinstance(value, exporters.Exporter) for view in value.views}
    pairs = [(known.ending, content) for known in FORMATS for content in known.takes]
    assert {content for _, content in pairs} == views
    assert len(set(pairs)) == len(pairs)


def test_options_of_one_name_look_alike():
    for method in METHODS.values():
        for name, option in method.options.items():
            shown = OPTIONS[name]
            assert (option.kind, option.label, option.tip) == (shown.kind, shown.label, shown.tip), name


@pytest.mark.parametrize("rule", RULES)
def test_the_native_part_knows_a_rule(rule):
    """A level at 1, then a surface at 2 with the rule, then an erosional one at 1.5 over both."""

    def surface(name, height, its_rule="erosional"):
        return Surface(name, np.column_stack([PLAN, np.full(4, height)]), TRIANGLES, rule=its_rule)

    surfaces = [surface("bottom", 1.0), surface("ruled", 2.0, rule), surface("top", 1.5)]
    model = build(Project("p", [Rock("r", surfaces)]))
    assert model.volume == pytest.approx(16.0 if RULES[rule].protects else 8.0)


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.__name__)
def test_the_check_of_a_setting_returns_the_value_as_it_is_used(entry):
    for part in declarations(entry):
        if not part.is_needed and part.setting.kind != "options":
            assert checked(part.key, part.setting, part.default) == part.default, part.key


@pytest.mark.parametrize("mesher", MESHERS)
def test_the_native_part_knows_a_mesher(mesher):
    vertices, triangles = mesh_region(PLAN, edge_length=1.0, mesher=mesher)
    first, second, third = vertices[triangles].transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (second - first).T, (third - first).T
    assert (ux * vy - uy * vx).sum() == pytest.approx(2 * 16)


def test_any_method_that_spreads_thickness_may_serve_parallel():
    spreading = {name for name, method in METHODS.items() if method.spreads_thickness}
    assert set(METHODS["parallel"].options["thickness_method"].words) == spreading


def test_the_content_says_the_format_of_a_mesh(tmp_path):
    file = tmp_path / "mesh.dat"
    file.write_text("# a comment\nOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert read_mesh(file).triangles.tolist() == [[0, 1, 2]]


def test_a_mesh_of_no_known_format_is_refused(tmp_path):
    file = tmp_path / "mesh.dat"
    file.write_text("xyz\n")
    with pytest.raises(InputRefused, match="nor its extension is that of a mesh"):
        read_mesh(file)


def test_the_document_names_the_program_that_checks_each_format():
    root = Path(__file__).resolve().parents[2]
    text = (root / "docs" / "dev" / "formats.md").read_text(encoding="utf-8")
    written = text[text.index("## Written") : text.index("## Read")]
    for known in FORMATS:
        assert f"`{known.ending}`" in written, known.ending
    for line in text.splitlines():
        if line.startswith("| ") and not line.startswith(("| format", "|---")):
            tests = re.findall(r"`(test_\w+\.py)`", line)
            assert tests, line
            assert all((root / "tests" / "core" / name).is_file() for name in tests), line
