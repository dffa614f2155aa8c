# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects with fields made coarse, for a look at what an edit does before the whole is built."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..readers.tables.observations import Observations
from ..settings.dips import SpaceDips
from ..settings.meshers import AUTO
from ..settings.series_kinds import FIELD
from .project import Project, Rock

CELLS = 1000  # of all lattices, about: they are solved and cut within about a third of a second
_MOST_FIELDS = 4  # that share the cells: with less each would show nothing
_TRIANGLES = 500  # of a planar mesh beside it


def coarsened(project: Project) -> Project | None:
    """The project with lattices of about CELLS cells, which the fields on both sides of faults share, and
    planar meshes with edges about as long; None where none of its rock masses has a finer field, or their
    files are not read."""
    cells = CELLS / min(1 + len(project.faults), _MOST_FIELDS)
    rocks = [_coarsened(rock, cells) for rock in project.rocks]
    is_same = all(one is other for one, other in zip(rocks, project.rocks, strict=True))
    return None if is_same else replace(project, rocks=rocks)


def _coarsened(rock: Rock, cells: float) -> Rock:
    is_field = [series.kind == FIELD for series in rock.series]
    extent = _extent(rock) if any(is_field) else None
    if extent is None:
        return rock
    step = float(extent.prod() / cells) ** (1.0 / 3.0)
    fine = [
        of_field and (isinstance(series.resolution, str) or series.resolution < step)
        for of_field, series in zip(is_field, rock.series, strict=True)
    ]
    if not any(fine):
        return rock
    series = [
        replace(rock_series, resolution=step) if of_field else rock_series
        for of_field, rock_series in zip(fine, rock.series, strict=True)
    ]
    length, triangles = rock.edge_length, rock.triangles
    if triangles is not None:
        triangles = min(triangles, _TRIANGLES)
    elif length is not None and length != AUTO:
        length = max(float(length), step)
    return replace(rock, series=series, edge_length=length, triangles=triangles, size=())


def _extent(rock: Rock) -> np.ndarray | None:
    """(3,) of the rock mass and its data, roughly; None where it cannot be known yet."""
    if rock.base_elevation is None or rock.region is None or rock.region_file is not None:
        return None
    if isinstance(rock.region, str):
        return None
    points = [surface.points for surface in rock.surfaces if isinstance(surface.points, np.ndarray)]
    points += [series.dips.positions for series in rock.series if isinstance(series.dips, SpaceDips)]
    points += [rock.observations.places] if isinstance(rock.observations, Observations) else []
    heights = np.concatenate([np.empty(0), *(places[:, -1] for places in points if places.shape[1] == 3)])
    if not len(heights):
        return None
    plan = np.concatenate(rock.rings())
    high = max(float(heights.max()) - min(rock.base_elevation, float(heights.min())), 0.0)
    extent = np.array([*np.ptp(plan, axis=0), 1.25 * high])
    return extent if (extent > 0).all() else None
