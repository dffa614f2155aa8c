# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts into which faults and bodies divide space, and the compartments of rock masses.

Input: shapes of faults and bodies, and which rock masses they displace. Output: `Structures`: each part
by its sides, with the compartment of each rock mass and the bodies in it.
"""
