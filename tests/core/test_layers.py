# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of the native part point down only: a folder includes what the table in docs/dev/architecture.md
says that it knows, and what that knows, and no two folders know each other."""

import functools
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "native" / "src"
TABLE = re.findall(
    r"^\| `native/src/(\w+)` \|.*\|([^|]*)\|$",
    (ROOT / "docs" / "dev" / "architecture.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)
FOLDERS = sorted(folder.name for folder in SOURCE.iterdir() if folder.is_dir())
KNOWS = {folder: set(re.findall(r"\w+", known)) & set(FOLDERS) for folder, known in TABLE}
STEPS = ("tiling", "repair", "overlay", "conform", "cells")  # folders of strata, from below


@functools.cache
def reach(folder):
    """What a folder may include: itself, what it knows, and what that may include."""
    return {folder}.union(*(reach(other) for other in KNOWS[folder]))


def includes(folder):
    """(file, folder of what it includes, the rest of its path) of all files in a folder of the sources."""
    for path in sorted([*folder.rglob("*.hpp"), *folder.rglob("*.cpp")]):
        text = path.read_text(encoding="utf-8").replace('#include "realmodel/complex.hpp"', "")
        for other, rest in re.findall(r'^#include "(?:realmodel/)?(\w+)/(.*)"', text, re.MULTILINE):
            yield str(path.relative_to(SOURCE)), other, rest


def test_every_folder_is_in_the_table():
    assert sorted(KNOWS) == FOLDERS


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_includes_what_it_knows(folder):
    assert [found for found in includes(SOURCE / folder) if found[1] not in reach(folder)] == []


def test_no_two_folders_know_each_other():
    for folder in FOLDERS:
        assert not [other for other in KNOWS[folder] if folder in reach(other)]


@pytest.mark.parametrize("step", STEPS)
def test_a_step_of_the_stack_includes_steps_below_it(step):
    above = STEPS[STEPS.index(step) + 1 :]
    assert [found for found in includes(SOURCE / "strata" / step) if found[2].startswith(above)] == []
