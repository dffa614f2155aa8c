# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of a new model is asked of it in the thread that builds it, not in that of the window."""

import gc
import threading
import time
import weakref
from contextlib import ExitStack
from unittest import mock

from panel_case import PanelCase, ops
from realmodel.bl.display import residuals
from realmodel.bl.field import misfits
from realmodel.bl.host import caches
from realmodel.bl.objects import viewports
from realmodel.bl.scene import planned_holes
from realmodel.bl.scene.build_job import BuildJob


def recorded(function, threads):
    def asked(*given):
        threads.append(threading.current_thread())
        return function.__wrapped__(*given)

    return caches.of_model(asked)


class Ahead(PanelCase):
    def test_misfits_residuals_and_planned_holes_of_a_build(self):
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()
        self.model.view.show_misfits = self.model.view.show_residuals = True
        ops.planned_hole_add()
        threads = []
        with ExitStack() as stack:
            for module, name in ((misfits, "_of_model"), (residuals, "_of_model"), (planned_holes, "_met")):
                function = recorded(getattr(module, name), threads)
                stack.enter_context(mock.patch.object(module, name, function))
            job = BuildJob(self.scene, viewports.updated_layer(self.scene).depsgraph, "blocks")
            job.start()
            while not job.done:
                time.sleep(0.01)
            while not job.hand_over(1.0):
                pass
            job.finish()
        self.assertEqual(len(threads), 3)
        self.assertNotIn(threading.main_thread(), threads)
        self.assertTrue(self.model.planned_holes[0].result)

    def test_answers_end_with_the_model(self):
        class Model:
            pass

        asked = []
        of_model = caches.of_model(lambda model, number: asked.append(number) or number)
        model = Model()
        self.assertEqual([of_model(model, number) for number in (1, 2, 1)], [1, 2, 1])
        self.assertEqual(asked, [1, 2])
        gone = weakref.ref(model)
        del model
        gc.collect()
        self.assertIsNone(gone())
