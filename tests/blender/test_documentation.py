# SPDX-License-Identifier: GPL-3.0-or-later
"""The way from the tab to the user guide."""

import unittest.mock
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import bpy
from panel_case import PanelCase


def opened(operator, **arguments):
    """The file that an operator opens in the web browser."""
    with unittest.mock.patch.object(webbrowser, "open") as browser:
        operator(**arguments)
    ((address,), _) = browser.call_args
    return Path(url2pathname(urlsplit(address).path))


class Documentation(PanelCase):
    def test_the_button_opens_the_guide(self):
        page = opened(bpy.ops.realmodel.documentation)
        self.assertIn("RealModel user guide", page.read_text(encoding="utf-8"))

    def test_the_manual_of_a_button_is_the_page_of_the_panel(self):
        for name in ("realmodel.build", "RealModelRock.region"):
            page = opened(bpy.ops.wm.doc_view_manual, doc_id=name)
            self.assertIn("Every control of the tab", page.read_text(encoding="utf-8"), name)
