# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of threads of native work."""

import os
import threading

from ... import preferences

_chosen = 0  # the preference, as the main thread has read it last: another thread may not


def threads(is_short=False):
    """The number in the preferences; else all (0) for short work. Otherwise one processor is left to the
    window, which would freeze for half a second without it."""
    global _chosen
    if threading.current_thread() is threading.main_thread():
        _chosen = preferences.current().threads
    return _chosen or (0 if is_short else max(1, (os.cpu_count() or 1) - 1))
