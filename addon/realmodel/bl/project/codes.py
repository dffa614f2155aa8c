# SPDX-License-Identifier: GPL-3.0-or-later
"""The codes of units in the field data of a rock mass, and the imports that brought them: when a code gets
another meaning, their files are read again."""

import json
from fnmatch import fnmatchcase
from pathlib import Path

from . import settings


def imports(rock):
    """[{"properties", "codes"}] of the imports of a rock mass: how the operator was called, and [code, holes,
    rows, length] of each of its codes."""
    try:
        return json.loads(rock.imports) if rock.imports else []
    except ValueError:  # a damaged file
        return []


def record(rock, properties, counts, units):
    """Keeps an import: the properties of its operator, realmodel.core's CodeCounts, and the UnitNames that it
    was read with. One of the same files takes the place of the earlier one."""
    files = files_of(properties)
    entries = [entry for entry in imports(rock) if files_of(entry["properties"]) != files]
    counted = [[count.code, count.holes, count.rows, count.length] for count in counts]
    entries.append({"properties": properties, "codes": counted})
    rock.imports = json.dumps(entries)
    with settings.filling():
        _fill(rock, [count for entry in entries for count in entry["codes"]], units)


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


def names(rock):
    """`names` of the codes of a rock mass: {code: unit}, "" for nothing."""
    return {row.name: row.unit for row in rock.codes if row.unit != row.name}


def fitting(rock, pattern):
    """The codes that a pattern fits, whatever the capitals: several, with commas, of * and ?."""
    parts = [part.strip().casefold() for part in pattern.split(",") if part.strip()]
    return [row for row in rock.codes if any(fnmatchcase(row.name.casefold(), part) for part in parts)]


def rename(rock, old, new):
    """A surface or a body has another name: codes go on to mean it."""
    for row in rock.codes:
        row.unit = new if row.unit == old else row.unit
