# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers that renders call in threads of theirs wait for the window, and leave Python as it was."""

import sys
import threading
import unittest

import bpy
import realmodel
from blender_state import empty_file
from realmodel import handlers


class Patient(unittest.TestCase):
    def test_the_switch_interval_is_the_same_afterwards(self):
        empty_file()
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        before, seen, barrier = sys.getswitchinterval(), [], threading.Barrier(2)

        @handlers._patient
        def handler(_scene):
            barrier.wait(10.0)  # both are in it
            seen.append(sys.getswitchinterval())
            if len(seen) == 1:
                raise ValueError("one of them fails")

        def call():
            try:
                handler(bpy.context.scene)
            except ValueError:
                return

        threads = [threading.Thread(target=call) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(seen), 2)
        self.assertEqual(sys.getswitchinterval(), before)
