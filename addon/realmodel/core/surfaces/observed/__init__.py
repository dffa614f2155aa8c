# SPDX-License-Identifier: GPL-3.0-or-later
"""What observed blocks say of the surfaces over and under them.

Input: a `Rock` and its `Observations`. Output: contacts and bounds of each surface, and the observations
that are left out, with the reason.
"""
