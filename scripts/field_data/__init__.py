# SPDX-License-Identifier: GPL-3.0-or-later
"""Histories in closed form and real field data, by which compare_field_data.py judges models."""
