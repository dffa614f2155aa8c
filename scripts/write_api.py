#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/reference/api.md: every public name with its types, of the docstrings. A test compares it
(tests/core/test_api.py).

    PYTHONPATH=addon build/venv/bin/python scripts/write_api.py
"""

import ast
import dataclasses
import importlib
import inspect
import re
import subprocess
import sys
import textwrap
from functools import cached_property
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reference" / "api.md"
# What users import; the public names of each are its __all__.
PACKAGES = (
    "realmodel.core",
    "realmodel.core.ensembles",
    "realmodel.core.plots",
    "realmodel.core.drawing",
    "realmodel.distributed",
)
WIDTH = "88"  # of signatures
MARK = "# ----"
INPUT = (
    "realmodel.core.project.",
    "realmodel.core.settings.",
)  # of these classes the fields are public alone
WITH_METHODS = ("Library", "Property", "Variogram")  # but of these
INTERNAL = ("native", "of", "source")
HEAD = """<!-- SPDX-License-Identifier: GPL-3.0-or-later -->
<!-- written by scripts/write_api.py -->
# Python API

Every public name, with its types, shapes, units and errors. [python.md](python.md) shows how they are used
together; in the examples here `model` is that of [its first chapter](python.md#a-model-from-arrays): clay,
sand and soil on a square of 4 m by 4 m, `np` is NumPy, and names are imported from their packages.

Lengths are in model units (`Project.units`). V, T, F, C, B and S are the numbers of vertices, triangles,
faces, cells, blocks and surfaces. `threads`: how many, 0 for all that there are; the result is the same for
any number. `progress`: a function of a fraction (0 to 1) and a text, or `True` for a bar. `cancel`: a
function that returns `True` to stop, which raises `Cancelled`.
"""


def names_of(package):
    """{name: object} of the public names of a package."""
    module = importlib.import_module(package)
    return {name: getattr(module, name) for name in module.__all__}


def members_of(cls):
    """{name: (whether it is a property, function)} of the public properties and methods of a class that are
    ours, inherited ones too."""
    found = {}
    if cls.__module__.startswith(INPUT) and cls.__name__ not in WITH_METHODS:
        return found
    for name in dir(cls):
        owner = next(base for base in cls.__mro__ if name in vars(base))
        if name.startswith("_") or name in INTERNAL or not owner.__module__.startswith("realmodel"):
            continue
        member = vars(owner)[name]
        if isinstance(member, property | cached_property):
            found[name] = True, member.fget if isinstance(member, property) else member.func
        elif isinstance(member, classmethod | staticmethod) or inspect.isfunction(member):
            found[name] = False, getattr(member, "__func__", member)
    return found


def fields_of(cls):
    """The public fields of a dataclass; none of other classes."""
    found = [
        each
        for each in (dataclasses.fields(cls) if dataclasses.is_dataclass(cls) else ())
        if not each.name.startswith("_") and each.name not in INTERNAL
    ]
    if cls.__module__.startswith(INPUT) and cls.__name__ not in WITH_METHODS:
        found = [each for each in found if each.compare]  # the others are what a build notes
    return found


def _stub(name, function, of_class, decorator=""):
    """The definition of a function without its body. of_class: without what stands for `self`."""
    node = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    if of_class:
        (node.args.posonlyargs or node.args.args).pop(0)
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{decorator}def {name}({ast.unparse(node.args)}){result}: ..."


def _class_stub(cls):
    """A class with its fields, or with what it is made of."""
    bases = [base.__name__ for base in cls.__bases__ if issubclass(base, Exception | dict)]
    head = f"class {cls.__name__}({', '.join(bases)})" if bases else f"class {cls.__name__}"
    lines = [f"    {each.name}: {each.type}{_default(each)}" for each in fields_of(cls)]
    if "__init__" in vars(cls) and issubclass(cls, Exception):
        lines = ["    " + _stub("__init__", cls.__init__, False)]
    return "\n".join([f"{head}:", *(lines or ["    ..."])])


def _default(field):
    if field.default_factory is not dataclasses.MISSING:
        made = field.default_factory
        return {list: " = []", dict: " = {}"}.get(made, " = ...")
    if field.default is dataclasses.MISSING:
        return ""
    return f" = {field.default!r}"


def _text(documented):
    """A docstring as Markdown: examples become code."""
    lines, is_example = [], False
    for line in (inspect.getdoc(documented) or "").splitlines():
        if line.startswith(">>>") and not is_example:
            lines.append("```python")
            is_example = True
        elif is_example and not line:
            lines.append("```")
            is_example = False
        lines.append(line if is_example else re.sub(r"<(?=\w)", r"\\<", line))
    return "\n".join([*lines, "```"] if is_example else lines)


def _entries():
    """(heading, definition, text) of each entry of the page; the definition of what is no code is empty."""
    for package in PACKAGES:
        yield f"## {package}", "", _text(importlib.import_module(package)).split("\n\n")[0]
        for name, item in sorted(names_of(package).items(), key=lambda entry: entry[0].lower()):
            if inspect.isfunction(item):
                yield f"### {name}", _stub(name, item, False), _text(item)
            elif inspect.isclass(item):
                yield f"### {name}", _class_stub(item), _text(item)
                for member, (is_property, function) in members_of(item).items():
                    decorator = "@property\n" if is_property else ""
                    stub = _stub(member, function, True, decorator)
                    yield f"#### {name}.{member}", stub, _text(function)
            else:
                yield f"### {name}", "", f"`{' '.join(repr(item).split())}`"


def page():
    """The text of the page."""
    entries = list(_entries())
    code = f"\n{MARK}\n".join(definition or "pass" for _, definition, _ in entries)
    command = [sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", WIDTH, "-"]
    code = subprocess.run(command, input=code, capture_output=True, text=True, check=True).stdout
    parts = [HEAD]
    for (heading, definition, text), stub in zip(entries, code.split(f"{MARK}\n"), strict=True):
        shown = stub.strip().removesuffix(": ...") if definition.startswith(("def", "@")) else stub.strip()
        shown = f"\n```python\n{shown}\n```\n" if definition else ""
        parts.append(f"{heading}\n{shown}\n{text}\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
