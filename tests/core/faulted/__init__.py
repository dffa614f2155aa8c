# SPDX-License-Identifier: GPL-3.0-or-later
"""Random models with faults and bodies, judged by the contract in exact arithmetic."""
