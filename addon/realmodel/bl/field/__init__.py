# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data of a scene, datum by datum: points of surfaces, dips, observed places, logged intervals, maps.

Input: tables, maps and images of files, what is drawn, the rows of a rock mass. Output: data in the rows
and as objects that can be moved, and the list of data that the built model does not have as they say.
`data` has the `Datum` by which one of them is named.
"""
