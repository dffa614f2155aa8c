# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples that come with RealModel: project files in the folder blend_samples."""

from pathlib import Path

import bpy

from ...core import InputRefused

# Beside the add-on where it was installed, above it where it runs from its repository.
_PLACES = (Path(__file__).resolve().parents[2], Path(__file__).resolve().parents[4])
_LABELS = {
    "two_layers": ("Two Layers", "The smallest project: two surfaces from points, one erosion"),
    "haut_barr": ("Haut-Barr", "Three rocks of sandstone on a base: four rock masses, 36 layers"),
    "castle_hill": ("Castle Hill", "Eleven surfaces, divided by erosion into separate hills"),
    "gravel_plain": ("Gravel Plain", "A valley filled with gravel, from boreholes"),
    "uncertain_valley": ("Uncertain Valley", "Gravel in a buried channel, and how certain its volume is"),
    "mapped_valley": ("Mapped Valley", "A geological map, a terrain and twenty dips: no borehole"),
    "fault_blocks": (
        "Fault Blocks",
        "Faults from sticks: a branch, one that dies out, a younger cover",
    ),
    "recumbent_fold": (
        "Recumbent Fold",
        "Overturned beds below an unconformity: level sets of one field, from contacts and dips",
    ),
    "faulted_dome": ("Faulted Dome", "An inclined dome displaced by a fault: a field on each side"),
    "intrusion": ("Intrusion", "A granite and a dike in lifted layers, cut by erosion"),
    "tunnel": ("Tunnel", "A tunnel and a shaft through a hill, and the rock that they remove"),
    "canyon": ("Canyon", "Forty beds in the walls of a canyon, and a river"),
    "quarry": ("Quarry", "Benches and ramps, and the volume that they remove from each layer"),
    "block_diagram": ("Block Diagram", "Plunging folds below an unconformity, and a valley through both"),
    "rift_basin": ("Rift Basin", "Tilted fault blocks, eroded and covered; a fault that ends at another"),
    "sculpted_island": ("Sculpted Island", "A sculpted mesh as the ground of folded strata"),
}
_items = []  # Blender does not keep the texts of dynamic enums itself


def folder():
    """The folder of the examples, or None where they were not installed."""
    return next((p / "blend_samples" for p in _PLACES if (p / "blend_samples").is_dir()), None)


def enum_items(_operator, _context):
    """The enum items of the installed examples."""
    place = folder()
    names = [] if place is None else sorted(p.parent.name for p in place.glob("*/project.toml"))
    names.sort(key=lambda name: list(_LABELS).index(name) if name in _LABELS else len(_LABELS))
    _items[:] = [(name, *_LABELS.get(name, (name.replace("_", " ").capitalize(), ""))) for name in names]
    return _items or [("NONE", "No examples", "The folder blend_samples is not there")]


def label(name):
    """The label of an example."""
    return next((entry[1] for entry in enum_items(None, None) if entry[0] == name), name)


def description(name):
    """What an example shows; empty where that is not known."""
    return next((entry[2] for entry in enum_items(None, None) if entry[0] == name), "")


def project_file(name):
    """The project file of an example. Raises InputRefused."""
    place = folder()
    path = None if place is None else place / name / "project.toml"
    if path is None or not path.is_file():
        raise InputRefused(f"there is no example '{name}'", advice="open a project file instead")
    return Path(bpy.path.native_pathsep(str(path)))
