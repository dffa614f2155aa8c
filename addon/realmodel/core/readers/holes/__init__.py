# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold all tables of boreholes."""
