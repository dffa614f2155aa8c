# SPDX-License-Identifier: GPL-3.0-or-later
"""Looking at the model: section, standard views, capture, coordinates."""

CLASSES = ()
