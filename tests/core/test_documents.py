# SPDX-License-Identifier: GPL-3.0-or-later
"""The documents keep what they promise: their Python examples print what stands below them, their links lead
somewhere, and the drawings are what their scripts draw."""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("blend_samples/**/*.md")])
EXAMPLE = re.compile(r"^```python\n(.*?)^```\n```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#]+)(#[^)]*)?\)")

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


def test_the_table_of_the_readme_is_what_the_demo_prints():
    run = subprocess.run(
        [sys.executable, ROOT / "build_model.py", ROOT / "blend_samples/haut_barr/project.toml"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    lines = [line.rstrip() for line in run.stdout.splitlines()]
    printed = lines[next(n for n, line in enumerate(lines) if line.startswith("block ")) :]  # after progress
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    shown = re.search(r"^ {4}block .*\n(?: {4}.*\n)+", readme, re.MULTILINE).group()
    assert [line[4:].rstrip() for line in shown.splitlines()] == printed


def test_there_are_examples():
    assert len(EXAMPLES) >= 3


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(document):
    for target, _ in LINK.findall(document.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (document.parent / target).exists(), f"{document.name} links to {target}"


def test_drawing_is_what_its_script_draws(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "scripts")
    drawn = runpy.run_path(str(ROOT / "scripts" / "draw_architecture.py"))["drawing"]().svg()
    committed = (ROOT / "docs" / "images" / "architecture.svg").read_text(encoding="utf-8")
    assert drawn == committed, "run scripts/draw_architecture.py"


def test_pictures_of_the_algorithm_are_what_their_script_draws(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "scripts")
    drawn = runpy.run_path(str(ROOT / "scripts" / "draw_algorithm.py"))["drawings"]()
    images = ROOT / "docs" / "images"
    assert sorted(drawn) == sorted(path.name for path in images.glob("algorithm_*.svg"))
    for name, svg in drawn.items():
        assert (images / name).read_bytes() == svg.encode(), f"{name}: run scripts/draw_algorithm.py"


def test_tables_are_what_the_registries_say():
    write_tables = runpy.run_path(str(ROOT / "scripts" / "write_tables.py"))
    text = write_tables["DOCUMENT"].read_text(encoding="utf-8")
    assert text.count("<!-- table of ") == 7
    assert write_tables["written"](text) == text, "run scripts/write_tables.py"
