# SPDX-License-Identifier: GPL-3.0-or-later
"""The documents keep what they promise: their Python examples print what stands below them, their commands
run, their links lead somewhere, labels and messages that they name exist, drawings are what scripts draw."""

import ast
import functools
import itertools
import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from realmodel.batch.options import OPTIONS

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("blend_samples/**/*.md")])
EXAMPLE = re.compile(r"^```python\n(.*?)^```\n```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#]*)(#[^)]*)?\)")
COMMAND = re.compile(
    r"^ {4}(?:\$ )?((?:scripts/|python3 |blender |build/|cmake )(?:[^\n]*\\\n)*[^\n#]*)", re.MULTILINE
)
LABEL = re.compile(r"\*\*([^*\n]+)\*\*")

EXAMPLES = [
    pytest.param(code, output, id=f"{document.relative_to(ROOT)}-{number}")
    for document in DOCUMENTS
    for number, (code, output) in enumerate(EXAMPLE.findall(document.read_text(encoding="utf-8")), 1)
]


@pytest.mark.parametrize(("code", "output"), EXAMPLES)
def test_example_prints_what_the_document_shows(code, output):
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "addon")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout == output


def test_the_table_of_haut_barr_is_what_the_demo_prints():
    run = subprocess.run(
        [sys.executable, ROOT / "build_model.py", ROOT / "blend_samples/haut_barr/project.toml"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    lines = [line.rstrip() for line in run.stdout.splitlines()]
    printed = lines[next(n for n, line in enumerate(lines) if line.startswith("block ")) :]  # after progress
    page = (ROOT / "docs" / "haut_barr.md").read_text(encoding="utf-8")
    shown = re.search(r"^ {4}block .*\n(?: {4}.*\n)+", page, re.MULTILINE).group()
    assert [line[4:].rstrip() for line in shown.splitlines()] == printed


OUTSIDE = re.compile(r"\[([^\]]+)\]\((https?://[^)]*)\)([^\n]{0,60}(?:\n[^\n]{0,60})?)")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_outside_links_have_a_title_and_a_version(document):
    for title, address, after in OUTSIDE.findall(document.read_text(encoding="utf-8")):
        assert "://" not in title, address
        assert re.search(r"\d", title + after), f"{document.name}: {address} has no version or year"


def test_there_are_examples():
    assert len(EXAMPLES) >= 3


@functools.cache
def anchors(document):
    """The anchors of the headings of a document, as code hosts make them."""
    text = re.sub(r"^```.*?^```$", "", document.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(document):
    text = document.read_text(encoding="utf-8")
    for picture in re.findall(r'<img src="([^"]*)"', text):
        assert (document.parent / picture).exists(), f"{document.name} shows {picture}"
    for path, anchor in LINK.findall(text):
        if "://" in path:
            continue
        target = document.parent / path if path else document
        assert target.exists(), f"{document.name} links to {path}"
        if anchor:
            assert anchor[1:] in anchors(target.resolve()), f"{document.name} links to {path}{anchor}"


@functools.cache
def nodes():
    """The syntax trees of the add-on's sources, node by node."""
    files = (path for path in (ROOT / "addon" / "realmodel").rglob("*.py") if "vendor" not in path.parts)
    return [node for path in files for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))]


@functools.cache
def texts():
    """All strings of the add-on, the parts of f-strings too."""
    values = (node.value for node in nodes() if isinstance(node, ast.Constant))
    return {value for value in values if isinstance(value, str)}


@functools.cache
def forms():
    """What f-strings of the add-on may become, such as f"Save {name}..."."""
    found = set()
    for node in nodes():
        if isinstance(node, ast.JoinedStr):
            parts = [part.value if isinstance(part, ast.Constant) else None for part in node.values]
            if sum(len(part.strip()) for part in parts if part) > 3:
                found.add("".join(".+" if part is None else re.escape(part) for part in parts))
    return found


def is_label(text):
    return text in texts() or any(re.fullmatch(form, text) for form in forms())


@pytest.mark.parametrize(
    "document", sorted((ROOT / "docs" / "guide").glob("*.md")), ids=lambda path: path.name
)
def test_labels_in_the_guide_exist(document):
    """Labels are bold; a path to one, such as **Open Example > Two Layers**, has several."""
    labels = LABEL.findall(document.read_text(encoding="utf-8"))
    missing = {part for label in labels for part in label.split(" > ") if not is_label(part)}
    assert not missing, f"{document.name}: no such label: {sorted(missing)}"


@functools.cache
def panels():
    """{label: the labels of its parents} of the panels of the tab."""
    found = {}
    for path in (ROOT / "addon" / "realmodel" / "ui").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and "_PT_" in node.name:
                given = {
                    part.targets[0].id: part.value.value
                    for part in node.body
                    if isinstance(part, ast.Assign) and isinstance(part.value, ast.Constant)
                }
                found[node.name] = given.get("bl_label"), given.get("bl_parent_id")
    parents = {}
    for label, parent in found.values():
        parents.setdefault(label, set()).add(found[parent][0] if parent in found else None)
    return parents


def test_paths_in_the_guide_lead_from_panel_to_panel():
    paths = 0
    for document in (ROOT / "docs" / "guide").glob("*.md"):
        for label in LABEL.findall(document.read_text(encoding="utf-8")):
            parts = label.split(" > ")
            for outer, inner in itertools.pairwise(parts):
                if {outer, inner} <= set(panels()):
                    paths += 1
                    assert outer in panels()[inner], f"{document.name}: {inner} is not in {outer}"
    assert paths > 10


def test_messages_in_the_guide_exist():
    guide = (ROOT / "docs" / "guide" / "troubleshooting.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \|", guide, re.MULTILINE)
    assert len(rows) > 20
    for row in rows:
        for message in re.findall(r"`([^`]+)`", row):
            for part in filter(None, (part.strip() for part in message.split("..."))):
                assert any(part in text for text in texts()), f"no message has '{part}'"


@functools.cache
def sources():
    folders = ("addon", "native", "scripts", "tests", "blend_samples")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.*")]
    return ["/" + path.relative_to(ROOT).as_posix() for path in [*files, *ROOT.glob("*.py")]]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_sources_that_are_named_exist(document):
    text = document.read_text(encoding="utf-8")
    names = re.findall(r"`([\w./]+\.(?:py|cpp|hpp|sh|inl))`", text)
    names = [name for name in names if "NAME" not in name and "shared" not in name]
    names = [name for name in names if f"`{name}`:\n\n```" not in text]  # the document gives it in full
    missing = {name for name in names if not any(path.endswith("/" + name) for path in sources())}
    assert not missing, f"{document.name} names {sorted(missing)}"


def commands(document):
    for text in COMMAND.findall(document.read_text(encoding="utf-8")):
        yield shlex.split(text.replace("\\\n", " "))


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_scripts_and_options_in_commands_exist(document):
    for command in commands(document):
        files = [
            word for word in command if re.match(r"(scripts|tests|blend_samples)/|build_model\.py$", word)
        ]
        for name in files:
            assert (ROOT / name.split("=")[0]).exists(), f"{document.name}: {name}"
            if name.endswith((".sh", "build_model.py")):
                source = (ROOT / name).read_text(encoding="utf-8")
                if name == "build_model.py":
                    source = " ".join(f"--{option.name}" for option in OPTIONS)
                after = command[command.index(name) + 1 :]
                for option in (word for word in after if re.match(r"--\w", word)):
                    assert option in source, f"{document.name}: {name} has no {option}"


def table_of(document):
    """The lines of the table of blocks that a document shows, which its first command prints."""
    shown = re.search(
        r"^```text\n(block .*?)^```", document.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    return [line.rstrip() for line in shown[1].splitlines()] if shown else []


RUNNABLE = [
    pytest.param(command, table_of(document) if number == 1 else [], id=f"{document.name}-{number}")
    for document in DOCUMENTS
    for number, command in enumerate(commands(document), 1)
    if command[:2] == ["python3", "build_model.py"] and command[2].startswith("blend_samples/")
]


@pytest.mark.parametrize(("command", "table"), RUNNABLE)
def test_commands_run(command, table, tmp_path):
    (tmp_path / "blend_samples").symlink_to(ROOT / "blend_samples")
    (tmp_path / "build_model.py").symlink_to(ROOT / "build_model.py")
    if "--ensemble" in command and not table:  # what it writes does not depend on how many there are
        command = [*command]
        command[command.index("--ensemble") + 1] = "4"
    run = subprocess.run(
        [sys.executable, *command[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert run.returncode == 0, run.stderr
    assert len(list(tmp_path.iterdir())) > 2, "it wrote nothing"
    assert set(table) <= {line.rstrip() for line in run.stdout.splitlines()}


def test_the_project_that_is_shown_is_the_example():
    shown = (ROOT / "docs" / "reference" / "project_file.md").read_text(encoding="utf-8")
    project = (ROOT / "blend_samples" / "two_layers" / "project.toml").read_text(encoding="utf-8")
    written = "\n".join(line for line in project.splitlines() if not line.startswith("#")).strip()
    assert f"```toml\n{written}\n```" in shown


def test_tables_are_what_the_add_on_says():
    write_tables = runpy.run_path(str(ROOT / "scripts" / "write_tables.py"))
    texts = {path.name: path.read_text(encoding="utf-8") for path in write_tables["DOCUMENTS"]}
    assert sum(text.count("<!-- table of ") for text in texts.values()) == 15
    for name, text in texts.items():
        assert write_tables["written"](text) == text, f"{name}: run scripts/write_tables.py"
