# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults and bodies, and the sheets of the surfaces that faults displace.

Input: a `Project` and its `RockInput`s. Output: `Structures`, and `RockInput`s whose surfaces have a
sheet for each compartment. Faults whose border ends inside the rock are continued first, or refused
(`gaps.py`).
"""
