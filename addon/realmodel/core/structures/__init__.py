# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults and bodies: their entries, their files, and the sheets of displaced surfaces."""
