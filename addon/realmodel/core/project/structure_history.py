# SPDX-License-Identifier: GPL-3.0-or-later
"""The rock masses that a fault displaces and that a body is in, and since when."""

from __future__ import annotations

from collections.abc import Sequence

from .project import Project
from .structure_entries import Body, Fault


def displaced_surfaces(project: Project, fault: Fault) -> dict[int, int]:
    """For each rock mass that a fault may displace, by its number: the youngest surface that it displaces."""
    return _numbers(project, fault.rocks, fault.youngest)


def body_times(project: Project, body: Body) -> dict[int, int]:
    """For each rock mass that a body may be in, by its number: the surface after which it came."""
    return _numbers(project, () if body.rock is None else (body.rock,), body.after)


def _numbers(project: Project, names: Sequence[str], surface: str | None) -> dict[int, int]:
    numbers = {}
    for number, rock in enumerate(project.rocks):
        if names and rock.name not in names:
            continue
        surfaces = [rock_surface.name for rock_surface in rock.surfaces]
        if surface is None:
            numbers[number] = rock.youngest_in_rock
        elif surface in surfaces:
            numbers[number] = surfaces.index(surface)
    return numbers
