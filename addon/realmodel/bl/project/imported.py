# SPDX-License-Identifier: GPL-3.0-or-later
"""What was imported into a rock mass: how, its codes, and the problems of its boreholes. When a code gets
another meaning, or a repair is refused, the files are read again."""

import json
import math
from pathlib import Path

from ...core.readers.tables.unit_names import fits
from . import settings

_MOST_PROBLEMS = 1000  # of an import


def imports(rock):
    """[{"properties", "codes", "problems"}] of the imports of a rock mass: how the operator was called,
    [code, holes, rows, length] of each of its codes, and the properties of a row for each problem."""
    try:
        return json.loads(rock.imports) if rock.imports else []
    except ValueError:  # a damaged file
        return []


def record(rock, properties, counts, problems, units):
    """Keeps an import: the properties of its operator, realmodel.core's CodeCounts and HoleProblems, and the
    UnitNames that it was read with. One of the same files takes the place of the earlier one."""
    files = files_of(properties)
    entries = [entry for entry in imports(rock) if files_of(entry["properties"]) != files]
    counted = [[count.code, count.holes, count.rows, count.length] for count in counts]
    listed = [_problem(problem) for problem in problems[:_MOST_PROBLEMS]]
    entries.append({"properties": properties, "codes": counted, "problems": listed})
    rock.imports = json.dumps(entries)
    with settings.filling():
        _fill(rock, [count for entry in entries for count in entry["codes"]], units)
        rock.hole_problems.clear()
        for listed in (problem for entry in entries for problem in entry["problems"]):
            row = rock.hole_problems.add()
            for name, content in listed.items():
                setattr(row, name, content)


def _problem(problem):
    depth = "" if math.isnan(problem.depth) else f"{problem.depth:.6g}"
    texts = {name: getattr(problem, name) for name in ("kind", "line", "hole", "text", "action")}
    return {**texts, "file": problem.file.name, "depth": depth}


def files_of(properties):
    """The paths of the files of an import."""
    names = [str(Path(properties["directory"]) / file["name"]) for file in properties["files"]]
    return sorted(names) or [properties["filepath"]]


def _fill(rock, counted, units):
    chosen = {row.name for row in rock.codes if row.chosen}
    rock.codes.clear()
    for code, *numbers in counted:
        row = rock.codes.get(code)
        if row is None:
            row = rock.codes.add()
            row.name, row.chosen = code, code in chosen
            row.unit = "" if units.says_nothing(code) else (units.block(code) or units.surface(code))
        row.holes, row.rows = row.holes + numbers[0], row.rows + numbers[1]
        row.length += numbers[2]


def names(rock, changed):
    """`names` of the codes of a rock mass: {code: unit}, "" for nothing; some `changed`."""
    units = {row.name: row.unit for row in rock.codes} | changed
    return {code: unit for code, unit in units.items() if unit != code}


def unit_text(rock, row):
    """What a code means, as people say it: the block beneath its surface, or a body; "nothing"."""
    surface = rock.surfaces.get(row.unit)
    return (surface is not None and surface.block) or row.unit or "nothing"


def fitting(rock, pattern):
    """The codes that a pattern fits: several of * and ?, with commas, or one regular expression between
    slashes. Raises InputRefused for what is none."""
    is_regular = pattern.strip().startswith("/")
    parts = [pattern.strip()] if is_regular else [part.strip() for part in pattern.split(",") if part.strip()]
    return [row for row in rock.codes if any(fits(part, row.name) for part in parts)]


def rename(rock, old, new):
    """A surface or a body has another name: codes go on to mean it."""
    for row in rock.codes:
        row.unit = new if row.unit == old else row.unit


def decide(rock, file, row, decision):
    """Keeps what is to become of a row, "collars.csv:17", of a file of this name where it is imported again:
    "REPAIR", "WRITTEN" or "LEFT_OUT"."""
    entries = imports(rock)
    for entry in entries:
        properties = entry["properties"]
        of_import = (*files_of(properties), properties.get("collars", ""), properties.get("survey", ""))
        if file not in [Path(name).name for name in of_import]:
            continue
        for key, word in (("unrepaired", "WRITTEN"), ("left_out", "LEFT_OUT")):
            others = [name for name in rows_of(properties.get(key, "")) if name != row]
            properties[key] = "; ".join([*others, row] if decision == word else others)
    rock.imports = json.dumps(entries)


def rows_of(text):
    """The rows of a text such as "collars.csv:17; survey.csv:3"."""
    return [part.strip() for part in text.split(";") if part.strip()]
