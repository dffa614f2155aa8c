# SPDX-License-Identifier: GPL-3.0-or-later
"""Random models with series of folds, judged by closed forms."""
