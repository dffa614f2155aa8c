# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pictures of panels in the guide show: which example, what is active in it, which panels.

`draw_guide.py` takes the pictures and writes to RECORD what each of these panels has. A test compares that
with the panels as they are, so that a picture that is out of date is noticed.
"""

import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "docs" / "images" / "guide" / "panels.json"
EXAMPLE = "castle_hill"
PANELS = ("build", "results", "view", "surfaces", "rocks", "library")  # each a picture of this name
PARTS = {"build": ("build_options",)}  # shown open in these pictures
HEADERS = {  # shown folded
    "results": ("results_compartments", "ensemble", "hole_validation", "planned_holes"),
    "view": ("view_properties", "view_section", "view_camera", "view_picture", "view_coordinates"),
    "surfaces": ("surface_method", "quality", "series", "surface_reading"),
    "rocks": ("rock_mesh",),
}
START = "start"  # the picture of the tab in an empty file: of all of its panels


def choose_rows(group):
    """Makes the rows of the lists active that the pictures show."""
    group.active_result = len(group.results) - 4
    group.rocks[0].active_surface = 2
    group.active_property = 3
    group.library[3].look = "SANDSTONE"


def shown(context, name):
    """Sorted texts: the operators, settings and labels that a panel has; of START all panels of the tab."""
    import bpy
    import recording_layout

    if name == START:
        drawing = recording_layout.draw_tab(context, "RealModel")
    else:
        drawing = recording_layout.Drawing()
        for part in (name, *PARTS.get(name, ())):
            recording_layout.draw(getattr(bpy.types, f"REALMODEL_PT_{part}"), context, drawing)
    labels = {text for text in drawing.labels if text and not any(letter.isdigit() for letter in text)}
    return sorted({*drawing.operators, *drawing.properties, *drawing.menus, *labels})


def keep(found):
    """Writes what panels have into the record, beside what others have there. found: {name: texts}."""
    kept = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.is_file() else {}
    RECORD.write_text(json.dumps(kept | found, indent=1, sort_keys=True) + "\n", encoding="utf-8")
