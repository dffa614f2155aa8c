# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a rock mass's region between its settings and realmodel.core: how large the triangles are to
be, where they are smaller, what lines and points the mesh must contain.
"""

import math

import numpy as np

from ...core import InputRefused
from ...core.base.errors import naming
from ...core.settings.meshers import AUTO, SIZE
from ..objects import shapes
from . import method_settings, settings

KINDS = (  # each with the number by which Blender stores it
    ("AUTO", "Point Spacing", "Half the spacing of the points of the surfaces", "", 1),
    ("LENGTH", "Edge Length", "A length for all edges", "", 0),
    ("TRIANGLES", "Triangle Count", "A number of triangles", "", 2),
)
_WORDS = {"OUTLINE": "outline", "CONSTRAINTS": "constraints"}


def propose_edge_length(row, points):
    """An edge length of 1, 2 or 5 times a power of ten by the extent of points (P, 3), where none is given:
    some ten thousand triangles."""
    extent = math.hypot(*np.ptp(points[:, :2], axis=0)) if len(points) else 0.0
    if row.edge_length > 0.0 or row.edges_by != "LENGTH" or not extent > 0.0:
        return
    least = extent / 100.0
    power = 10.0 ** math.floor(math.log10(least))
    with settings.filling():
        settings.set_number(row, "edge_length", next(n * power for n in (1, 2, 5, 10) if n * power >= least))


def propose_base(row, points, is_of_map=False):
    """A flat base below points (P, 3), where none is given. is_of_map: they lie on the ground alone."""
    if row.use_base:
        return
    with settings.filling():
        settings.set_number(row, "base_elevation", base_below(points, is_of_map))
        row.use_base = True


def base_below(points, is_of_map=False):
    """A round elevation below points (P, 3): by a fifth of the range of their heights or, of a map, by a
    tenth of its extent at least."""
    if not len(points):
        return 0.0
    *extent, height = np.ptp(points, axis=0)
    below = 0.2 * float(height) or 1.0
    if is_of_map:
        below = max(below, 0.1 * math.hypot(*extent))
    step = 10.0 ** math.floor(math.log10(below))
    return math.floor((float(points[:, 2].min()) - below) / step) * step


def compose(rock, row, depsgraph, origin):
    """Transfers the mesh settings of a rock mass's row to a realmodel.core.Rock. Raises InputRefused."""
    if row.edges_by != "LENGTH":
        rock.edge_length = AUTO if row.edges_by == "AUTO" else None
    if row.edges_by != "AUTO":
        rock.triangles = row.triangles if row.edges_by == "TRIANGLES" else None
    with naming(rock.item):
        rock.size = []
        for entry in row.sizes:
            rock.size += _sizes(entry, depsgraph, origin)
        rock.constraints = _constraints(row, depsgraph, origin)


def _sizes(entry, depsgraph, origin):
    """The entries of Rock.size that a row stands for: an object's lines are one each."""
    length, distance = (method_settings.value(entry, key, SIZE) for key in SIZE)
    if entry.at == "OBJECT":
        if entry.object is None:
            advice = "choose one, or remove the entry"
            raise InputRefused("a refinement has no object", advice=advice)
        places = [(line + origin[:2]).tolist() for line in shapes.plan_lines(entry.object, depsgraph)]
    elif entry.at == "STORED":
        places = [entry.stored["values"].tolist() if entry.stored else []]
    else:
        places = [_WORDS[entry.at]]
    return [{"at": at, "length": length, "distance": distance} for at in places]


def _constraints(row, depsgraph, origin):
    constraints = list(row.constraints_stored.values())
    for entry in row.constraints:
        if entry.object is not None:
            constraints += [line + origin[:2] for line in shapes.plan_lines(entry.object, depsgraph)]
    return constraints


def fill(row, rock):
    """Sets a row from a realmodel.core.Rock whose constraints are arrays."""
    by_points = isinstance(rock.edge_length, str)
    row.edges_by = "AUTO" if by_points else "LENGTH" if rock.triangles is None else "TRIANGLES"
    for entry in rock.size:
        _fill_size(row.sizes.add(), entry)
    add_constraints(row, rock.constraints)


def _fill_size(row, entry):
    at = entry["at"]
    row.at = next((key for key, word in _WORDS.items() if isinstance(at, str) and at == word), "STORED")
    if row.at == "STORED":
        row.stored = {"values": np.asarray(at, np.float64)}
    for key in SIZE:
        settings.set_number(row, key, entry[key])


def add_constraints(row, lines):
    """Stores further lines (N, 2) and points (1, 2), in model coordinates."""
    constraints = [*row.constraints_stored.values(), *(np.asarray(line, np.float64) for line in lines)]
    row.constraints_stored = {f"constraint{n}": line for n, line in enumerate(constraints)}


def stored_constraints(row):
    """(lines, points): how many constraints are kept that are no objects."""
    sizes = [row.constraints_stored.count(name) for name in row.constraints_stored]
    return sum(size > 1 for size in sizes), sum(size == 1 for size in sizes)


def objects(row):
    """The objects of the scene that the mesh depends on."""
    candidates = [entry.object for entry in row.constraints]
    candidates += [entry.object for entry in row.sizes if entry.at == "OBJECT"]
    return [obj for obj in candidates if obj is not None]
