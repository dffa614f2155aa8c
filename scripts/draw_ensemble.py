#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/ensembles.md and the README: a section of the example uncertain_valley in the mean
colors of its blocks, with the interfaces of many realizations (the cloud), those of the interpolated model
(thicker), and the boreholes beside it.

    PYTHONPATH=addon python scripts/draw_ensemble.py [FOLDER]      (default: docs/images)

Needs the built module.
"""

import csv
import sys
from pathlib import Path

import numpy as np
from realmodel.core import build, load_project
from realmodel.core.drawing import save_drawing
from realmodel.core.drawing.drawing import Drawing
from realmodel.core.ensembles import Realizer, blocks_at, draw_probabilities, section_samples
from realmodel.core.ensembles.places import Probabilities
from realmodel.core.results.section_drawing import block_outlines, flattened

ROOT = Path(__file__).resolve().parents[1]
SAMPLE = ROOT / "blend_samples" / "uncertain_valley"
PLANE = (1530.0, 1000.0, 0.0), (1.0, 0.0, 0.0)
REALIZATIONS, EXAGGERATION = 100, 8.0
NEAR = 40.0  # of the plane: boreholes that are drawn
CLOUD = (0.1, 0.1, 0.1, 0.08)


def draw(path):
    """Writes the picture."""
    model = build(load_project(SAMPLE / "project.toml"), cells="blocks")
    samples = section_samples(model, model.section(*PLANE), (4.0, 0.5))
    realizer = Realizer(model, seed=1)
    blocks, sections = [], []
    for number in range(REALIZATIONS):
        realization = realizer.realization(number)
        blocks.append(blocks_at(realization, samples.places))
        sections.append(realization.section(*PLANE))
    names = [block.name for block in model.blocks]
    shares = [(np.array(blocks) == number).mean(axis=0) for number in range(len(names))]
    drawing = draw_probabilities(samples, Probabilities(names, np.stack(shares, axis=1)), EXAGGERATION)
    last = max(n for n, item in enumerate(drawing.items) if item.layer == "Cells") + 1
    above = Drawing(drawing.width, drawing.height)
    for section in sections:
        for block in np.unique(section.block)[:-1].tolist():  # what lies on the youngest is the ground
            for ring in block_outlines(section, flattened(section), block):
                above.polygon([on_paper(drawing, ring)], None, CLOUD, 0.5)
    for y, top, bottom in boreholes(model):
        above.line(on_paper(drawing, np.array([[y, top], [y, bottom]])), width=1.6)
    drawing.items[last:last] = above.items
    add_legend(drawing)
    save_drawing(drawing, path)


def add_legend(drawing):
    """What lines mean, below the legend of the blocks."""
    x, y = 0.843 * drawing.width, 0.5 * drawing.height
    drawing.width += 30.0
    for color, width, text in (
        ((0.1, 0.1, 0.1, 0.5), 0.5, f"{REALIZATIONS} realizations"),
        ((0.0, 0.0, 0.0), 1.0, "interpolated"),
        ((0.0, 0.0, 0.0), 1.8, "boreholes"),
    ):
        drawing.line([(x, y + 3.0), (x + 16.0, y + 3.0)], color, width)
        drawing.text(x + 21.0, y, text, 9.0)
        y -= 15.0


def on_paper(drawing, places):
    """(N, 2) points of the page of distances and heights."""
    return np.asarray(drawing.origin) + places * drawing.scale * np.array([1.0, EXAGGERATION])


def boreholes(model):
    """(distance, top, bottom) of those near the plane."""
    with (SAMPLE / "collars.csv").open() as file:
        for row in csv.DictReader(file):
            x, y = float(row["x"]), float(row["y"])
            if abs(x - PLANE[0][0]) < NEAR:
                rock = next(i for i in model.borehole(x, y) if model.blocks[i.block].name == "Bedrock")
                yield y, float(row["z"]), rock.top


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images"
    draw(folder / "ensemble.png")
