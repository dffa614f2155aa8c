# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as callers have it: built, cut, saved.

Input: a `Project`. Output: a `Model`, a `SurfaceSet`, a `Cut`, a `Section`, each with what can be made
of it, or an `Estimate` before anything is built.
"""
