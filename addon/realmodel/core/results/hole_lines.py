# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in plan through boreholes, for sections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.algebra import begins_run, norm
from ..base.errors import InputRefused, UsageError, number_list
from ..project.project import Project

_BEYOND = 0.05  # of its length: how far a line goes on at both ends, where nothing is given


def hole_places(project: Project) -> dict[str, np.ndarray]:
    """(3,) where each borehole of a project begins: its collar, or the highest of its data. Of two holes of
    one name that of the first rock mass."""
    found: dict[str, np.ndarray] = {}
    for rock in project.rocks:
        for name, (collar, picks) in rock.hole_picks.items():
            place = collar if collar is not None else picks[0][1] if picks else None
            if place is not None:
                found.setdefault(name, np.asarray(place, np.float64))
        for name, log in ({} if rock.observed is None else rock.observed.logs()).items():
            found.setdefault(name, log.places[0])
    return found


def line_through(places: Mapping[str, np.ndarray], holes: Sequence[str], extend: float | None = None):
    """(N, 2) float64: a line in plan through holes, in their order, that goes on by `extend` at both ends;
    None: by a twentieth of its length. places: where the holes are. Raises InputRefused for a hole that is
    not there, or holes at fewer than two places, UsageError."""
    if extend is not None and not (np.isfinite(extend) and extend >= 0):
        raise UsageError(f"extend must be 0 or more, not {extend!r}")
    if unknown := [name for name in holes if name not in places]:
        known = number_list(sorted(places)) if places else "there are none"
        raise InputRefused(f"there is no hole {number_list(unknown)}", advice=f"holes: {known}")
    line = np.array([places[name][:2] for name in holes], np.float64).reshape(-1, 2)
    line = line[begins_run(line)]
    if len(line) < 2:
        raise InputRefused(
            "a section needs holes at two places at least", advice="name two holes that are apart"
        )
    steps = norm(np.diff(line, axis=0))
    length = _BEYOND * float(steps.sum()) if extend is None else extend
    first = line[0] + (line[0] - line[1]) * (length / steps[0])
    last = line[-1] + (line[-1] - line[-2]) * (length / steps[-1])
    return np.vstack([[first], line[1:-1], [last]])
