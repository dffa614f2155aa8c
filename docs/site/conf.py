# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of the site (scripts/site.sh): Markdown, and notebooks with what they printed and drew."""

from pathlib import Path

project = "RealModel"
author = "The RealModel authors"
version = release = (Path(__file__).resolve().parents[2] / "VERSION").read_text(encoding="utf-8").strip()
html_title = f"RealModel {version}"
html_theme = "furo"
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False

extensions = ["myst_nb", "sphinxcontrib.mermaid"]
root_doc = "index"
include_patterns = [
    "index.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/*.md",
    "docs/dev/**.md",
    "docs/examples/*.md",
    "docs/guide/*.md",
    "docs/notebooks/*.ipynb",
    "docs/real_case/*.md",
    "docs/reference/*.md",
    "blend_samples/**README.md",
    "native/src/exact/README.md",
]
nb_execution_mode = "off"  # the tests run them, and their results are in them
myst_enable_extensions = ["html_image"]  # pictures with a width
myst_heading_anchors = 4  # as code hosts make them
myst_fence_as_directive = ["mermaid"]
