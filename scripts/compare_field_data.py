#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
import sys, time
from pathlib import Path
import numpy as np
ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "scripts")]
from field_data.histories import HISTORIES
from field_data.measured import measure, project, random_points
from realmodel.core import build
from realmodel.core.base.work import run
from realmodel.core.proof.closed_form import closed_forms

def named_blocks(model, points):
    form = closed_forms(model)[0]
    numbers = run(lambda work: form.blocks_at(work, points))
    names = np.array([b.name for b in model.blocks] + [""])
    return names[numbers]

for history in HISTORIES:
    if len(sys.argv) > 1 and history.name not in sys.argv[1:]: continue
    data = measure(history)
    points, block = random_points(history)
    true = np.array([f"B{b}" for b in block])
    said = []
    for alone in (True, False):
        t = time.time()
        model = build(project(history, data, alone))
        said.append(f"{np.mean(named_blocks(model, points) == true):.4f} ({time.time()-t:.1f} s)")
    o = model.observed()
    print(history.name, *said, o.summary(), np.bincount(block).tolist(), flush=True)
