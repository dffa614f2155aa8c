# SPDX-License-Identifier: GPL-3.0-or-later
"""What docs/validation.md shows: measurements, and the tables and figures that are made of them."""
