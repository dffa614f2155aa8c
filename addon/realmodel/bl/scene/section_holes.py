# SPDX-License-Identifier: GPL-3.0-or-later
"""The boreholes that a section goes through: a text with their names, in order."""

import csv
import io

import numpy as np

from ...core.base.algebra import norm
from ...core.results.sections.section_holes import line_through
from ..project import borehole_picks


def paths(scene):
    """{hole: (N, 3) its line in model coordinates} of all rock masses."""
    lines = {}
    for rock in scene.realmodel.rocks:
        for name, line in borehole_picks.named_paths(rock).items():
            lines.setdefault(name, np.array(line))
    return lines


def chosen(scene):
    """The names that are chosen."""
    rows = csv.reader(io.StringIO(scene.realmodel.view.section_holes), skipinitialspace=True)
    return [name.strip() for row in rows for name in row if name.strip()]


def choose(scene, names):
    """Chooses holes by their names, in order."""
    scene.realmodel.view.section_holes = ", ".join(map(_quoted, names))


def _quoted(name):
    """A name in quotes where it has a comma."""
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow([name])
    return text.getvalue()


def line(scene):
    """(N, 2) the line of a section through the chosen holes, in model coordinates. Raises InputRefused."""
    places = {name: path[0] for name, path in paths(scene).items()}
    names = chosen(scene)
    corners = line_through(places, names, 0.0)
    length = float(norm(np.diff(corners, axis=0)).sum())
    return line_through(places, names, 0.01 * scene.realmodel.view.section_beyond * length)
