# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks of surfaces in every degenerate position, and independent oracles for their models."""
