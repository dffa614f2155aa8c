# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles: many models of one project, and the probabilities of blocks when heights are uncertain.

Input: a `Model`, a number of realizations and a seed. Output: volumes of each realization, statistics of
heights, probabilities of blocks at samples, and their files.
"""

from ..exporters.section_files import draw_probabilities
from ..results.samples import Probabilities
from .ensemble import PERCENTILES, Ensemble, ensemble
from .realization import Realizer
from .sampled_blocks import borehole_samples, grid_samples, hole_samples, sample_writer, section_samples

__all__ = [
    "PERCENTILES",
    "Ensemble",
    "Probabilities",
    "Realizer",
    "borehole_samples",
    "draw_probabilities",
    "ensemble",
    "grid_samples",
    "hole_samples",
    "sample_writer",
    "section_samples",
]
