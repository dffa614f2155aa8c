#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/guide/share.md: the page of a sample, cut, in Debian's chromium.

PYTHONPATH=addon python scripts/draw_page.py [FOLDER]      (default: docs/images)
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from draw_guide import shrink
from realmodel.core import build, load_project

ROOT = Path(__file__).resolve().parents[1]
SIZE = 1200, 760
VIEW = "s=y,0.55,1&t=light"
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


def draw(page: Path, view: str, picture: Path) -> None:
    """Writes the picture of a page. view: what its address has behind #."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        subprocess.run(
            [
                *("chromium", *FLAGS, "--hide-scrollbars", f"--user-data-dir={profile}"),
                *(f"--window-size={SIZE[0]},{SIZE[1]}", "--virtual-time-budget=20000"),
                *(f"--screenshot={picture}", f"{page.resolve().as_uri()}#{view}"),
            ],
            check=True,
            stderr=subprocess.DEVNULL,
        )
    shrink(picture, picture)


if __name__ == "__main__":
    images = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images"
    model = build(load_project(ROOT / "blend_samples" / "castle_hill" / "project.toml"))
    with tempfile.TemporaryDirectory() as made:
        model.save(Path(made) / "castle_hill.html")
        draw(Path(made) / "castle_hill.html", VIEW, images / "page.png")
