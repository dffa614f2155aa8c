# SPDX-License-Identifier: GPL-3.0-or-later
"""The public names of realmodel: each is documented with its arguments and errors, examples run, and the page
of all of them is up to date."""

import ast
import doctest
import inspect
import json
import re
import runpy
import textwrap
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import build
from sample_models import three_layers

ROOT = Path(__file__).resolve().parents[2]
API = runpy.run_path(str(ROOT / "scripts" / "write_api.py"))
SHARED = {"threads", "progress", "cancel"}  # the head of the page says what they are
MAIN = {
    "build",
    "cross_validate",
    "estimate",
    "interpolate",
    "intersect",
    "mesh_region",
    "Model.block_table",
    "Model.borehole",
    "Model.borehole_table",
    "Model.contours",
    "Model.cut_by_plane",
    "Model.cut_by_surface",
    "Model.eroded",
    "Model.fence",
    "Model.geological_map",
    "Model.report",
    "Model.section",
    "Model.simulation_mesh",
    "Model.stage",
    "Model.surfaces_to_pyvista",
    "Model.to_pyvista",
    "Model.to_xarray",
    "Model.validate",
    "Report.table",
    "ensembles.ensemble",
}
EVIDENT = {"path", "name"}
NAMES = {
    f"{package}.{name}": item
    for package in API["PACKAGES"]
    for name, item in API["names_of"](package).items()
}
CLASSES = {name: item for name, item in NAMES.items() if inspect.isclass(item)}
MEMBERS = {
    f"{name}.{member}": function
    for name, cls in CLASSES.items()
    for member, (_, function) in API["members_of"](cls).items()
}
ERRORS = {cls.__name__ for cls in CLASSES.values() if issubclass(cls, Exception)}
FUNCTIONS = {name: item for name, item in NAMES.items() if inspect.isfunction(item)} | MEMBERS


def test_the_page_is_up_to_date():
    message = "run PYTHONPATH=addon build/venv/bin/python scripts/write_api.py"
    assert API["PAGE"].read_text(encoding="utf-8") == API["page"](), message


def says(text, name):
    return re.search(rf"\b{re.escape(name)}\b", text or "") is not None


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_says_what_it_takes_and_raises(name):
    function = FUNCTIONS[name]
    text = function.__doc__
    assert text
    tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    taken = {each.arg for each in (*tree.args.args, *tree.args.kwonlyargs)} - {"self", "cls"}
    if name in MEMBERS:
        taken.discard(tree.args.args[0].arg)  # what stands for self
    calls = (
        node.exc.func for node in ast.walk(tree) if isinstance(node, ast.Raise) and hasattr(node.exc, "func")
    )
    raised = {call.id for call in calls if isinstance(call, ast.Name)} & ERRORS
    as_another = re.search(r"\b[Aa]s (?:of )?[\w.]+", text)
    of_class = NAMES[name.rpartition(".")[0]].__doc__ or "" if name in MEMBERS else ""
    missing = {
        each for each in taken - SHARED - EVIDENT if not says(text, each) and f"`{each}`" not in of_class
    }
    assert not missing or as_another, f"{name} says nothing of {sorted(missing)}"
    raised = {each for each in raised if not says(text, each)}
    assert not raised or as_another, f"{name} does not say that it raises {sorted(raised)}"


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_says_what_its_fields_are(name):
    cls = CLASSES[name]
    assert vars(cls)["__doc__"] and not vars(cls)["__doc__"].startswith(f"{cls.__name__}(")
    texts = " ".join(base.__doc__ or "" for base in cls.__mro__ if base.__module__.startswith("realmodel"))
    missing = [each.name for each in API["fields_of"](cls) if not says(texts, each.name)]
    assert not missing, f"{name} says nothing of {missing}"


def examples():
    finder = doctest.DocTestFinder(recurse=False)
    for name, item in (FUNCTIONS | CLASSES).items():
        yield from (test for test in finder.find(item, name, globs={}) if test.examples)


@pytest.mark.parametrize("example", examples(), ids=lambda test: test.name)
def test_an_example_prints_what_the_docstring_shows(example):
    for module in ("pandas", "pyvista", "xarray"):
        pytest.importorskip(module, reason=f"{module} is not installed")
    names = {name.rpartition(".")[2]: NAMES[name] for name in reversed(NAMES)}  # those of core come last
    example.globs.update(names, model=build(three_layers()), np=np)
    failures = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(example, out=failures.append)
    assert not failures, "".join(failures)


def test_the_main_names_have_examples():
    with_example = {test.name.rpartition("core.")[2] for test in examples()}
    assert with_example >= MAIN, sorted(MAIN - with_example)


def imports_in_documents():
    """(file, module, name) of all that documents and notebooks import of realmodel."""
    for path in sorted({*ROOT.glob("docs/**/*.md")} - {API["PAGE"]}):
        for code in re.findall(r"^```python\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S):
            yield from ((path, *found) for found in imported(code))
    for path in sorted(ROOT.glob("docs/notebooks/*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        for cell in cells:
            if cell["cell_type"] == "code":
                yield from ((path, *found) for found in imported("".join(cell["source"])))


def imported(code):
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and node.module.partition(".")[0] == "realmodel":
            yield from ((node.module, each.name) for each in node.names)


def test_documents_import_public_names_alone():
    found = list(imports_in_documents())
    assert len(found) > 20
    for path, module, name in found:
        known = f"{module}.{name}" in NAMES or f"{module}.{name}" in API["PACKAGES"]
        assert known, f"{path.name}: {module}.{name} is not public"
