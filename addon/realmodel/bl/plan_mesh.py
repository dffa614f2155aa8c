# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a rock mass's region between its settings and realmodel.core: how large the triangles are to
be, where they are smaller, what lines and points the mesh must contain.

The settings keep an edge length as a number; `mesh_options` has what is said instead of one. An edge length
above 0 says more than that: scripts need to set nothing else.
"""

import json
import math

import numpy as np

from ..core import InputRefused
from ..core.mesh_sizes import AUTO
from ..core.project import rock_item
from . import live, settings, shapes, stored_arrays

KINDS = (
    ("LENGTH", "Edge Length", "A length for all edges"),
    ("AUTO", "Point Spacing", "Half the spacing of the points of the surfaces"),
    ("TRIANGLES", "Triangle Count", "A number of triangles"),
)
_USUAL_COUNT = 10_000
_WORDS = {"OUTLINE": "outline", "CONSTRAINTS": "constraints"}


def kind(row):
    """The number of the present one of KINDS."""
    given = _instead_of_length(row)
    return 1 if given.get("edge_length") == AUTO else 2 if "triangles" in given else 0


def set_kind(row, number):
    if number == kind(row):
        return
    count = triangles(row)
    if number == 0:
        area = max(row.region_area, 0.0)
        _keep(row)
        row.edge_length = math.sqrt(area / count * 4.0 / math.sqrt(3.0)) if area else 1.0
        return
    row.edge_length = 0.0
    _keep(row, **({"edge_length": AUTO} if number == 1 else {"triangles": count}))


def triangles(row):
    return _instead_of_length(row).get("triangles", _USUAL_COUNT)


def set_triangles(row, count):
    """A number of triangles; where edges go by the points it scales them."""
    row.edge_length = 0.0
    _keep(row, **{**_instead_of_length(row), "triangles": count})


def has_triangles(row):
    """Whether a number of triangles is given."""
    return "triangles" in _instead_of_length(row)


def _instead_of_length(row):
    return json.loads(row.mesh_options) if row.mesh_options and not row.edge_length > 0.0 else {}


def _keep(row, **given):
    row.mesh_options = json.dumps(given) if given else ""
    if not settings.is_filling():
        live.touch(row.id_data)


def compose(rock, row, depsgraph, origin):
    """What a rock mass's row says of its mesh goes to a realmodel.core.Rock. Raises InputRefused."""
    given = _instead_of_length(row)
    rock.edge_length, rock.triangles = given.get("edge_length"), given.get("triangles")
    if row.edge_length > 0.0:
        rock.edge_length = settings.number(row, "edge_length")
    try:
        rock.size = []
        for entry in row.sizes:
            rock.size += _sizes(entry, depsgraph, origin)
        rock.constraints = _constraints(row, depsgraph, origin)
    except InputRefused as error:
        raise error.within(rock_item(rock)) from error


def _sizes(entry, depsgraph, origin):
    """The entries of Rock.size that a row stands for: an object's lines are one each."""
    length, distance = (settings.number(entry, key) for key in ("length", "distance"))
    if entry.at == "OBJECT":
        if entry.object is None:
            advice = "choose one, or remove the entry"
            raise InputRefused("a refinement has no object", advice=advice)
        places = [(line + origin[:2]).tolist() for line in shapes.plan_lines(entry.object, depsgraph)]
    elif entry.at == "STORED":
        places = [json.loads(entry.stored or "[]")]
    else:
        places = [_WORDS[entry.at]]
    return [{"at": at, "length": length, "distance": distance} for at in places]


def _constraints(row, depsgraph, origin):
    found = list(stored_arrays.unpack(row.constraints_stored).values()) if row.constraints_stored else []
    for entry in row.constraints:
        if entry.object is not None:
            found += [line + origin[:2] for line in shapes.plan_lines(entry.object, depsgraph)]
    return found


def fill(row, rock):
    """Sets a row from a realmodel.core.Rock whose constraints are arrays."""
    instead = {}
    if isinstance(rock.edge_length, str):
        instead["edge_length"] = rock.edge_length
    elif rock.edge_length is not None:
        settings.set_number(row, "edge_length", rock.edge_length)
    if rock.triangles is not None:
        instead["triangles"] = int(rock.triangles)
    row.mesh_options = json.dumps(instead) if instead else ""
    row.mesher = rock.mesher
    for entry in rock.size:
        _fill_size(row.sizes.add(), entry)
    add_constraints(row, rock.constraints)


def take_up_sizes(row):
    """Places of shorter edges that a file of an earlier version has kept as they were get their rows."""
    kept = json.loads(row.mesh_options) if row.mesh_options else {}
    for entry in kept.pop("size", ()):
        _fill_size(row.sizes.add(), entry)
    row.mesh_options = json.dumps(kept) if kept else ""


def _fill_size(row, entry):
    at = entry["at"]
    row.at = next((key for key, word in _WORDS.items() if isinstance(at, str) and at == word), "STORED")
    if row.at == "STORED":
        row.stored = json.dumps(np.asarray(at, np.float64).tolist())
    settings.set_number(row, "length", entry["length"])
    settings.set_number(row, "distance", entry["distance"])


def add_constraints(row, lines):
    """Keeps further lines (N, 2) and points (1, 2), in model coordinates."""
    kept = list(stored_arrays.unpack(row.constraints_stored).values()) if row.constraints_stored else []
    kept += [np.asarray(line, np.float64) for line in lines]
    row.constraints_stored = (
        stored_arrays.pack(**{f"constraint{n}": line for n, line in enumerate(kept)}) if kept else ""
    )


def stored_constraints(row):
    """(lines, points): how many constraints are kept that are no objects."""
    if not row.constraints_stored:
        return 0, 0
    sizes = [len(line) for line in stored_arrays.unpack(row.constraints_stored).values()]
    return sum(size > 1 for size in sizes), sum(size == 1 for size in sizes)


def objects(row):
    """The objects of the scene that the mesh depends on."""
    found = [entry.object for entry in row.constraints]
    found += [entry.object for entry in row.sizes if entry.at == "OBJECT"]
    return [item for item in found if item is not None]
