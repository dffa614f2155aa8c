# SPDX-License-Identifier: GPL-3.0-or-later
"""How many threads native work takes beside a window."""

import os


def threads(is_short=False):
    """One processor is left to the window, or it would stand still for half a second. 0: all that there are,
    for what is over sooner than that."""
    return 0 if is_short else max(1, (os.cpu_count() or 1) - 1)
