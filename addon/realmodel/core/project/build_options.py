# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the options of build() and estimate()."""

from __future__ import annotations

from typing import Any

from ..base.errors import UsageError
from .project import Project

CELL_KINDS = ("columns", "blocks")


def check_cells(cells: object) -> None:
    """Raises UsageError for an unknown kind of cells."""
    if cells not in CELL_KINDS:
        raise UsageError(f"cells must be 'columns' or 'blocks', not {cells!r}")


def check_stage(project: Project, stage: Any) -> None:
    """Raises UsageError for a stage that no rock mass has."""
    youngest = max(len(rock.surfaces) for rock in project.rocks) - 1
    if isinstance(stage, bool) or not hasattr(stage, "__index__") or not 0 <= int(stage) <= youngest:
        raise UsageError(
            f"stage {stage} does not exist: stages run from 0 to {youngest}, the youngest surface"
        )


def check_memory(memory: Any) -> None:
    """Raises UsageError for a limit of memory that is no number of bytes."""
    if memory is None:
        return
    if isinstance(memory, bool) or not hasattr(memory, "__index__") or int(memory) <= 0:
        raise UsageError(f"memory must be a number of bytes above 0, not {memory!r}")
