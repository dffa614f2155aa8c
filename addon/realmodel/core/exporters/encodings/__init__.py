# SPDX-License-Identifier: GPL-3.0-or-later
"""The encodings that several formats share: rows of text, VTK's XML, NetCDF.

Input: arrays. Output: bytes in an open file.
"""
