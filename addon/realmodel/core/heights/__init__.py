# SPDX-License-Identifier: GPL-3.0-or-later
"""What each method does with points, nodes and its options: `heights` runs the one that is asked for."""

from .interpolation import Interpolation
from .run import chosen, heights, left_out_heights

__all__ = ["Interpolation", "chosen", "heights", "left_out_heights"]
