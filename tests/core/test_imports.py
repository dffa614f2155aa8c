# SPDX-License-Identifier: GPL-3.0-or-later
"""Who imports whom in the add-on, at the top of a file, inside a function or for types alone: nobody in a
circle. The folders of core are steps (docs/dev/architecture.md), and each imports from earlier ones only."""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "addon" / "realmodel"
CORE = PACKAGE / "core"


def _modules(package):
    """{dotted name: file} of a package without what it brings along of others."""
    found = {}
    for file in sorted(package.rglob("*.py")):
        parts = file.relative_to(package.parent).with_suffix("").parts
        if "vendor" not in parts:
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


class _Imports(ast.NodeVisitor):
    """The modules that a module imports."""

    def __init__(self, name, file, modules):
        self.package = name if file.name == "__init__.py" else name.rpartition(".")[0]
        self.modules, self.found = modules, set()
        self.visit(ast.parse(file.read_text()))

    def visit_ImportFrom(self, node):
        if not node.level:
            return
        base = ".".join(
            self.package.split(".")[: self.package.count(".") + 2 - node.level]
            + ([node.module] if node.module else [])
        )
        for alias in node.names:
            name = f"{base}.{alias.name}"
            if name in self.modules:
                self.found.add(name)
            elif "_native" not in (alias.name, node.module):
                self.found.add(base)


def _cycle(package):
    """The modules of one circle, or None."""
    modules = _modules(package)
    return _circle({name: _Imports(name, file, modules).found for name, file in modules.items()})


def _circle(imports):
    """The first circle in {name: names}, or None."""
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return error.args[1]
    return None


def _imports_of_steps(depth):
    """{step: steps that it imports from} of core."""
    modules = _modules(PACKAGE)
    imports = {}
    for name, file in modules.items():
        if CORE in file.parents:
            steps = {_step(modules[found], depth) for found in _Imports(name, file, modules).found}
            imports.setdefault(_step(file, depth), set()).update(steps - {_step(file, depth)})
    return imports


def test_each_step_imports_from_steps_above_it_in_the_document():
    text = (PACKAGE.parents[1] / "docs" / "dev" / "architecture.md").read_text()
    steps = re.findall(r"^\| `(\w+)`", text.split("| step |")[1].split("\n\n")[0], re.MULTILINE)
    imports = _imports_of_steps(1)
    assert {step for step in imports if not step.endswith(".py")} == set(steps)
    for n, step in enumerate(steps):
        assert imports[step] <= set(steps[:n]) | {"plots.py"}, step
    assert imports["plots.py"] <= set(steps)


def test_folders_within_steps_are_in_no_circle():
    assert _circle(_imports_of_steps(2)) is None


def _step(file, depth):
    """The folder of a file in core; a file that is in none is a step by itself."""
    parts = file.relative_to(CORE).parts if CORE in file.parents else ("..",)
    return "/".join(parts[:-1][:depth] or parts)


def test_a_folder_of_the_core_says_what_comes_in_and_goes_out():
    folders = {file.parent for file in CORE.rglob("*.py")}
    for folder in folders - {CORE}:
        text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text()))
        assert "Comes in: " in text, folder
        assert "Goes out: " in text, folder
    assert max(len(list(folder.glob("*.py"))) for folder in folders) <= 20


def test_no_module_imports_itself_through_others():
    assert _cycle(PACKAGE) is None


@pytest.mark.parametrize(
    "text",
    [
        "from . import a",
        "def f():\n    from . import a",
        "from .a import x",
        "if TYPE_CHECKING:\n    from . import a",
    ],
)
def test_a_circle_would_be_found(tmp_path, text):
    package = tmp_path / "sample"
    package.mkdir()
    (package / "__init__.py").write_text("from . import a\n")
    (package / "a.py").write_text("from .b import f\n")
    (package / "b.py").write_text(f"{text}\n")
    assert set(_cycle(package)) == {"sample.a", "sample.b"}
