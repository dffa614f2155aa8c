# SPDX-License-Identifier: GPL-3.0-or-later
"""The validation of a model, and the block at any place without building it.

Input: `ModelData`, or sheets and rules alone. Output: a report of tests that all hold, or of how
far observations are met, or numbers of blocks.
"""
