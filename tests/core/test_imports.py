# SPDX-License-Identifier: GPL-3.0-or-later
"""Who imports whom in the add-on, at the top of a file or inside a function: nobody in a circle."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "addon" / "realmodel"


def _modules(package):
    """{dotted name: file} of a package without what it brings along of others."""
    found = {}
    for file in sorted(package.rglob("*.py")):
        parts = file.relative_to(package.parent).with_suffix("").parts
        if "vendor" not in parts:
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


class _Imports(ast.NodeVisitor):
    """The modules that a module imports, but for the checker of types alone."""

    def __init__(self, name, file, modules):
        self.package = name if file.name == "__init__.py" else name.rpartition(".")[0]
        self.modules, self.found = modules, set()
        self.visit(ast.parse(file.read_text()))

    def visit_If(self, node):
        if not (isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"):
            self.generic_visit(node)

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
            elif alias.name != "_native":
                self.found.add(base)


def _cycle(package):
    """The modules of one circle, or None."""
    modules = _modules(package)
    imports = {name: _Imports(name, file, modules).found for name, file in modules.items()}
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return error.args[1]
    return None


def test_no_module_imports_itself_through_others():
    assert _cycle(PACKAGE) is None


@pytest.mark.parametrize("text", ["from . import a", "def f():\n    from . import a", "from .a import x"])
def test_a_circle_would_be_found(tmp_path, text):
    package = tmp_path / "sample"
    package.mkdir()
    (package / "__init__.py").write_text("from . import a\n")
    (package / "a.py").write_text("from .b import f\n")
    (package / "b.py").write_text(f"{text}\n")
    assert set(_cycle(package)) == {"sample.a", "sample.b"}
