#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the tables of the documents that follow from the add-on: rules, methods and options from its
registries, operators from its sources. A test compares them (tests/core/test_documents.py).

    python3 scripts/write_tables.py
"""

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon" / "realmodel"
DOCUMENTS = [
    ROOT / "docs" / name
    for name in (
        "reference/project_file.md",
        "reference/output_files.md",
        "reference/operators.md",
        "guide/mesh_surfaces.md",
        "reference/panel.md",
    )
]
_NOT_GIVEN = ("filepath", "filter_glob", "files", "directory", "format", "made")  # by scripts
TABLE = re.compile(r"(<!-- table of (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def _table(headings, rows):
    lines = [headings, ["---"] * len(headings), *rows]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines).replace("|  |", "| |")


def _is_default(name, default):
    return f"`{name}` (default)" if name == default else f"`{name}`"


def _rules():
    from realmodel.core.settings.rules import DEFAULT_RULE, RULES

    yes_no = {True: "yes", False: "no"}
    return _table(
        ["rule", "cuts what is older", "protects itself from what is younger", ""],
        [
            [_is_default(name, DEFAULT_RULE), yes_no[rule.cuts], yes_no[rule.protects], rule.tip]
            for name, rule in RULES.items()
        ],
    )


def _methods():
    from realmodel.core.settings.methods import DEFAULT_METHOD, METHODS

    rows = []
    for name, method in METHODS.items():
        own = [f"`{option}`" for option in method.options if option != "extrapolate"]
        said = [", ".join(own)] if own else []
        if "extrapolate" not in method.options:
            said.append("no `extrapolate`")
        if method.instead_of_points:
            said.append(f"with `{method.instead_of_points}` no `points`")
        rows.append([_is_default(f'"{name}"', f'"{DEFAULT_METHOD}"'), "; ".join(said), method.tip])
    return _table(["`method`", "options beside `extrapolate`", ""], rows)


def _options():
    from realmodel.core.settings.methods import OPTIONS

    rows = []
    for name, option in OPTIONS.items():
        if option.default is None or option.unset != "none":
            default = option.unset
        else:
            default = f'`"{option.default}"`' if isinstance(option.default, str) else f"{option.default:g}"
        rows.append([f"`{name}`", default, "; ".join(text for text in (option.tip, option.more) if text)])
    return _table(["option", "default", ""], rows)


def _rule_labels():
    from realmodel.core.settings.rules import RULES

    return _table(["rule", ""], [[f"**{rule.label}**", rule.tip] for rule in RULES.values()])


def _written_formats():
    from realmodel.core import exporters
    from realmodel.core.exporters.formats import FORMATS

    exported = {
        "model": exporters.MODEL,
        "surfaces": exporters.SURFACES,
        "section": exporters.SECTION,
        "sheets": exporters.SHEETS,
        "mesh for simulation": exporters.MESH,
        "borehole": exporters.BOREHOLE,
        "planned hole": exporters.PLANNED_HOLE,
        "fields": exporters.FIELDS,
        "report": exporters.REPORT,
        **{f"probabilities of a {kind}": exporter for kind, exporter in exporters.SAMPLES.items()},
    }
    rows = []
    for known in FORMATS:
        names = [name for name, exporter in exported.items() if known in exporter.formats()]
        rows.append([f"`{known.ending}`", known.label, ", ".join(names), known.tip])
    return _table(["extension", "format", "written of", ""], sorted(rows, key=lambda row: row[0]))


def _read_formats():
    from realmodel.core.readers.formats import FORMATS

    rows = {}
    for known in FORMATS:
        endings = ", ".join(f"`{ending}`" for ending in known.endings)
        rows.setdefault(known.holds, []).append(f"{known.label} ({endings})")
    return _table(["files of", "formats"], [[holds, ", ".join(texts)] for holds, texts in rows.items()])


def _classes(pattern):
    """(name of the module, class) of the add-on's sources, in their order."""
    for path in sorted(ADDON.glob(pattern)):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                yield path.stem, node


def _strings(node):
    """{name: text} of what a class sets to strings."""
    found = {}
    for part in node.body:
        if isinstance(part, ast.Assign) and isinstance(part.value, ast.Constant):
            found[part.targets[0].id] = part.value.value
    return found


def _arguments(node, shared):
    """The names of an operator's properties that a script gives. shared: by name, the classes that several
    operators of a module are made from."""
    bases = [base.attr if isinstance(base, ast.Attribute) else base.id for base in node.bases]
    bodies = [
        part for base in (node, *(shared[name] for name in bases if name in shared)) for part in base.body
    ]
    names = [part.target.id for part in bodies if isinstance(part, ast.AnnAssign)]
    file = (
        ["filepath"]
        if any(base.endswith(("ImportHelper", "ExportHelper", "Exporting")) for base in bases)
        else []
    )
    return [*file, *(name for name in names if name not in _NOT_GIVEN)]


def _operators():
    rows = []
    shared = {node.name: node for _, node in _classes("operators/*.py") if node.name.startswith("_")}
    for _, node in _classes("operators/*.py"):
        said = _strings(node)
        if node.name.startswith("REALMODEL_OT_"):
            name = node.name.removeprefix("REALMODEL_OT_")
            tip = " ".join((ast.get_docstring(node) or "").split())
            rows.append([f"`{name}({', '.join(_arguments(node, shared))})`", said["bl_label"], tip])
    return _table(["`bpy.ops.realmodel.`", "label", ""], sorted(rows))


def _keys(settings, text):
    """The rows of keys: those of settings that say more are written, the others stay as they are."""
    from realmodel.core.settings.methods import OPTIONS

    rows = text.strip().splitlines()
    for key, setting in settings.items():
        if key in OPTIONS:  # in a table of their own
            continue
        place = next((n for n, row in enumerate(rows) if f"`{key}`" in row.split("|")[1]), None)
        if place is None:
            place = next((n for n, row in enumerate(rows) if f"[{key}]" in row or f".{key}]" in row), None)
        if place is None:
            raise KeyError(key)
        if not setting.more:
            continue
        words = [f'`"{word}"`: {tip}' for word, (_, tip) in setting.words.items() if key == "mesher"]
        default = [f'default `"{setting.default}"`'] if setting.words else []
        said = ". ".join([setting.tip, *words, "; ".join([setting.more, *default])])
        rows[place] = f"| `{key}` | {setting.needed} | {said} |".replace("|  |", "| |")
    return "\n".join(rows) + "\n"


def written(text):
    """The text of a document with its tables as the add-on has them. Raises KeyError for a key not there."""
    from realmodel.core.project.project import PROJECT, ROCK, SURFACE
    from realmodel.core.project.series import SERIES
    from realmodel.core.project.structure_entries import BODY, FAULT
    from realmodel.core.settings.data_files import READING

    tables = {
        "rules": _rules,
        "methods": _methods,
        "options": _options,
        "rule_labels": _rule_labels,
        "operators": _operators,
        "written_formats": _written_formats,
        "read_formats": _read_formats,
    }
    keys = {
        "project": PROJECT,
        "rock": ROCK,
        "series": SERIES,
        "surface": SURFACE,
        "fault": FAULT,
        "body": BODY,
        "reading": READING,
    }

    def table(found):
        _, name, rows, _ = found.groups()
        return f"{found[1]}\n{_keys(keys[name], rows) if name in keys else tables[name]()}\n{found[4]}"

    return TABLE.sub(table, text)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "addon"))
    for document in DOCUMENTS:
        document.write_text(written(document.read_text(encoding="utf-8")), encoding="utf-8")
