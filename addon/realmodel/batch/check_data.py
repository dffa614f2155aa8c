# SPDX-License-Identifier: GPL-3.0-or-later
"""`realmodel check-data`: lists the problems in the data of a project by file, without a build."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from . import DONE, PROGRAM, REFUSED

if TYPE_CHECKING:
    from ..core.project.project import Project


def parse(arguments: list[str]) -> argparse.Namespace:
    """The options of `check-data`. Raises SystemExit with status 2 where they are wrong."""
    parser = argparse.ArgumentParser(
        prog=f"{PROGRAM} check-data",
        description="Prints the problems in the data of a project by file and line, and how each is treated. "
        "Exit status: 1 if data are left out, else 0.",
        allow_abbrev=False,
    )
    parser.add_argument("project", metavar="PROJECT", type=Path, help="project file (.toml)")
    return parser.parse_args(arguments)


def run(options: argparse.Namespace) -> int:
    """Prints the problems. Returns the exit status. Raises RealModelError for a damaged project file."""
    from ..core import load_project

    listed, left_out = _problems(load_project(options.project))
    for file, lines in listed.items():
        print(file)
        for line in lines:
            print(f"  {line}")
    count = sum(map(len, listed.values()))
    print(f"{count} problems, {left_out} left out" if count else "no problems")
    return REFUSED if left_out else DONE


def _problems(project: Project) -> tuple[dict[str, list[str]], int]:
    """Lines about the data of a project by their file, or rock mass, and how many data are left out."""
    from ..core import InputRefused
    from ..core.readers.tables.hole_problems import LEFT_OUT, NOT_REACHED, problem_warnings
    from ..core.readers.tables.observations import left_out_of
    from ..core.surfaces.field_data import read_field_data
    from ..core.surfaces.prepare import table_warnings
    from ..core.surfaces.surface_input import SurfaceInput

    listed: dict[str, list[str]] = {}
    left_out = 0

    def warn(texts: list[str], item: str) -> None:
        for text in texts:
            file, sign, what = text.partition(": ")
            listed.setdefault(file if sign else item, []).append(what if sign else text)

    for rock in project.rocks:
        try:
            field = read_field_data(project, rock)
        except InputRefused as error:
            warn([f"{error.file or rock.item}: {error} (refused)"], rock.item)
            left_out += 1
            continue
        problems = field.picks.problems
        for problem in problems:
            listed.setdefault(str(problem.file), []).append(f"{problem.text} ({problem.action})")
        said = left_out_of(problems)
        others = [entry.text for entry in field.left_out if entry not in said]
        lost = [problem for problem in problems if problem.action == LEFT_OUT and problem.kind != NOT_REACHED]
        left_out += len(others) + len(lost)
        listed.setdefault(rock.item, []).extend(f"{text} ({LEFT_OUT})" for text in others)
        sentences = [*field.picks.warnings, *field.map_warnings, *table_warnings(rock, project.units)]
        warn([text for text in sentences if text not in problem_warnings(problems)], rock.item)
        for surface, met in field.surfaces:
            if surface.has_points:
                warn(SurfaceInput.of(rock, surface, project.units, met).read().warnings, rock.item)
    return {file: lines for file, lines in listed.items() if lines}, left_out
