# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of the files that geologists bring: points, meshes, regions."""

from .off import read_off
from .point_input import read_point_file
from .points import read_points
from .region import read_region

__all__ = ["read_off", "read_point_file", "read_points", "read_region"]
