# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data of a scene, datum by datum: points of surfaces, dips, observed places, logged intervals.

data     what there is: `groups`, and the `Datum` by which one of them is named
edits    a datum is switched off or on, or moved
handle   the active datum: an object at its place, which moves it
heights  where data without a height are shown
shown    contacts, dips and misfits as bodies
misfits  the list of data that the built model does not have as they say
"""
