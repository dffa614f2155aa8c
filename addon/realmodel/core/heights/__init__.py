# SPDX-License-Identifier: GPL-3.0-or-later
"""The implementations of the methods: `heights` runs the requested one on points, nodes and options."""

from .interpolation import Interpolation
from .run import chosen, heights, left_out_heights

__all__ = ["Interpolation", "chosen", "heights", "left_out_heights"]
