# SPDX-License-Identifier: GPL-3.0-or-later
"""The rock masses of a finished model as the stack builder takes them."""

from __future__ import annotations

from ..surfaces.planar_mesh import triangulate_rings
from .model_data import ModelData


def native_rocks(model: ModelData, stage: int | None = None) -> list[tuple]:
    """For each rock mass (surfaces, region, base elevation, rules), the surfaces up to `stage` only where it
    is given; regions as triangulations. Models that were put together from arrays know their project only."""
    rocks, first = [], 0
    for number, rock in enumerate(model.project.rocks):
        count = len(rock.surfaces)
        end = count if stage is None else min(count, stage + 1)
        surfaces = [model.surface(first + k) for k in range(end)]
        if model.rock_inputs:
            meshed = model.rock_inputs[number].region
            region = None if meshed is None else meshed.arrays
        else:
            region = triangulate_rings(rock.rings()) if rock.region is not None else None
        rules = [surface.rule for surface in rock.surfaces[:end]]
        rocks.append((surfaces, region, rock.base_elevation, rules))
        first += count
    return rocks
