# SPDX-License-Identifier: GPL-3.0-or-later
"""What the values of an object's strata mean for a mesh of some size. `values` are those of props_strata."""

import math

from ...core import DifferentialErosion, Strata
from ...core.filling.strata import RECUMBENT, STEEPEST, UPRIGHT


def strata_of(values, size):
    """core.Strata for a mesh of a size (3,)."""
    height, width = float(size[2]), float(max(size[:2]))
    return Strata(
        beds=values.beds,
        thickness=values.thickness * height,
        variation=values.variation,
        dip=min(math.degrees(values.dip), STEEPEST),
        dip_direction=_degrees(values.dip_direction),
        fold_amplitude=values.fold_amplitude * height,
        fold_wavelength=values.fold_wavelength * width,
        fold_axis=_degrees(values.fold_axis),
        axial_dip=min(max(round(math.degrees(values.axial_dip), 4), RECUMBENT), UPRIGHT),
        faults=values.faults,
        throw=values.throw * height,
        fault_strike=_degrees(values.fault_strike),
        unconformity=values.unconformity,
        gap=values.gap * height,
        pegs=values.pegs,
        peg_size=values.peg_size * height,
        palette=values.palette.lower(),
        seed=values.seed,
    )


def erosion_of(values):
    """core.DifferentialErosion, or None."""
    if not values.erosion:
        return None
    return DifferentialErosion(values.strength, values.joints, values.roughness, values.faces)


def _degrees(angle):
    """An azimuth, which Blender has in radians of 32 bits."""
    return round(math.degrees(angle), 4) % 360.0
