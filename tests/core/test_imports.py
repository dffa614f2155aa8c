# SPDX-License-Identifier: GPL-3.0-or-later
"""Who imports whom in the add-on, at the top of a file, inside a function or for types alone: nobody in a
circle. The folders of core are steps, and so are those of bl (docs/dev/architecture.md): each imports from
earlier ones only."""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "addon" / "realmodel"
CORE = PACKAGE / "core"
BL = PACKAGE / "bl"


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


def _imports_of_steps(root, depth):
    """{step: steps that it imports from} of the package in a folder."""
    modules = _modules(PACKAGE)
    imports = {}
    for name, file in modules.items():
        if root in file.parents:
            steps = {_step(root, modules[found], depth) for found in _Imports(name, file, modules).found}
            step = _step(root, file, depth)
            imports.setdefault(step, set()).update(steps - {step})
    return imports


def _step(root, file, depth):
    """The folder of a file below the root; a file that is in none is a step by itself."""
    parts = file.relative_to(root).parts if root in file.parents else ("..",)
    return "/".join(parts[:-1][:depth] or parts)


def _steps_of_document(heading):
    """The steps in the first column of the table below a heading, in order."""
    text = (PACKAGE.parents[1] / "docs" / "dev" / "architecture.md").read_text()
    table = text.split(f"\n## {heading}\n")[1].split("\n| ", 1)[1].split("\n\n")[0]
    return re.findall(r"^\| `(\w+)`", table, re.MULTILINE)


def test_each_step_imports_from_steps_above_it_in_the_document():
    steps = _steps_of_document("The steps of a build")
    imports = _imports_of_steps(CORE, 1)
    assert {step for step in imports if not step.endswith(".py")} == set(steps)
    for n, step in enumerate(steps):
        assert imports[step] <= set(steps[:n]) | {"plots.py"}, step
    assert imports["plots.py"] <= set(steps)


def test_each_folder_of_bl_imports_from_folders_above_it_in_the_document():
    folders = _steps_of_document("From settings to a scene")
    imports = _imports_of_steps(BL, 1)
    assert {step for step in imports if not step.endswith(".py")} == set(folders)
    elsewhere = {"..", "__init__.py"}  # core, and bl itself for the names of its folders
    for n, folder in enumerate(folders):
        assert imports[folder] <= set(folders[:n]) | elsewhere, folder


def test_folders_within_steps_are_in_no_circle():
    assert _circle(_imports_of_steps(CORE, 2)) is None


@pytest.mark.parametrize("root", [CORE, BL], ids=["core", "bl"])
def test_a_folder_says_what_comes_in_and_goes_out(root):
    folders = {file.parent for file in root.rglob("*.py")}
    for folder in folders - {root}:
        text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text()))
        assert "Input: " in text, folder
        assert "Output: " in text, folder
    assert max(len(list(folder.glob("*.py"))) for folder in folders) <= 20


def test_scripts_find_what_they_import():
    scripts = PACKAGE.parents[1] / "scripts"
    for file in sorted(scripts.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("realmodel.core"):
                module = import_module(node.module)
                for name in (each.name for each in node.names):
                    assert hasattr(module, name) or find_spec(f"{node.module}.{name}"), (file.name, name)


def test_types_of_native_headers_have_names_of_their_own():
    native = PACKAGE.parents[1] / "native"
    headers = {}
    for file in sorted([*native.glob("src/**/*.hpp"), *native.glob("include/**/*.hpp")]):
        defined = re.findall(r"^(?:class|struct|enum class) (\w+)[^;{]*{", file.read_text(), re.MULTILINE)
        for name in defined:
            headers.setdefault(name, []).append(file.name)
    assert {name: found for name, found in headers.items() if len(found) > 1} == {}


def test_public_classes_have_names_of_their_own():
    modules = {}
    for name, file in _modules(PACKAGE).items():
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                modules.setdefault(node.name, []).append(name)
    assert {name: found for name, found in modules.items() if len(found) > 1} == {}


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
