# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults and bodies: what they are, how they are read, and the sheets of displaced surfaces."""
