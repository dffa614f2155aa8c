# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods that give heights: `heights` runs the requested one.

Input: points (N, 3), nodes (M, 2), a method with its options. Output: an `Interpolation`: heights of the
nodes, with variances and warnings; or heights drawn at random that the points allow.
"""

from .interpolation import Interpolation, Task
from .run import heights, left_out_heights

__all__ = ["Interpolation", "Task", "heights", "left_out_heights"]
