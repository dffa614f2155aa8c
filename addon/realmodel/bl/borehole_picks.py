# SPDX-License-Identifier: GPL-3.0-or-later
"""The picks of boreholes, stored in the row of their rock mass for display."""

import json


def keep(row, holes):
    """Adds holes, as realmodel.core's Picks.holes, to those that a rock mass has."""
    if not holes:
        return
    known = of_rock(row)
    for name, (collar, picks) in holes.items():
        given = [[surface, [float(value) for value in place]] for surface, place in picks]
        known[name] = [None if collar is None else [float(value) for value in collar], given]
    row.hole_picks = json.dumps(known)


def rename(row, old, new):
    """Gives the picks of a surface of a rock mass its new name."""
    picks = of_rock(row)
    for _, met in picks.values():
        for pick in met:
            pick[0] = new if pick[0] == old else pick[0]
    if picks:
        row.hole_picks = json.dumps(picks)


def of_rock(row):
    """{hole: [collar or None, [[surface, place], ...]]} in model coordinates, the highest pick first."""
    return json.loads(row.hole_picks) if row.hole_picks else {}
