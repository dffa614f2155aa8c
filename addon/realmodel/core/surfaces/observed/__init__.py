# SPDX-License-Identifier: GPL-3.0-or-later
"""What observed blocks say of the surfaces over and under them.

Comes in: a `Rock` and its `Observations`. Goes out: contacts and bounds of each surface, and the observations
that are left out, with the reason.
"""
