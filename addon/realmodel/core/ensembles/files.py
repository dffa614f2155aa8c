# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of an ensemble: a report, a table of volumes, and all arrays."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..base.atomic import Outputs
from ..exporters.model_arrays import texts, write_arrays
from ..exporters.report import versions
from .ensemble import PERCENTILES, Ensemble

REPORT, VOLUMES, ARRAYS = "ensemble.json", "volumes.csv", "ensemble.npz"
_SCHEMA = 1
_BINS = 20


def write_ensemble(
    ensemble: Ensemble,
    folder: str | Path,
    also: Callable[[Ensemble, Outputs], None] | None = None,
) -> None:
    """Writes ensemble.json, volumes.csv and ensemble.npz, and what also(ensemble, outputs) writes; all of
    them or none. Raises OutputFailed."""
    folder = Path(folder)
    with Outputs(ensemble.model.project.input_files()) as outputs:
        with outputs.file(folder / REPORT) as file:
            file.write((json.dumps(_report(ensemble), indent=2, ensure_ascii=False) + "\n").encode())
        with outputs.file(folder / VOLUMES) as file:
            file.write(_volumes(ensemble).encode())
        with outputs.file(folder / ARRAYS) as file:
            write_arrays(_arrays(ensemble), file)
        if also is not None:
            also(ensemble, outputs)


def _report(ensemble: Ensemble) -> dict:
    """Volumes in model units cubed, heights in model units."""
    percentiles = ensemble.percentiles()
    blocks = []
    deviations = ensemble.volume_deviations().tolist()
    for number, block in enumerate(ensemble.model.blocks):
        drawn = ensemble.volumes[:, number]
        counts, edges = np.histogram(drawn, _BINS)
        blocks.append(
            {
                "name": block.name,
                "rock": ensemble.model.project.rocks[block.rock].name,
                "interpolated": block.volume,
                "mean": float(drawn.mean()),
                "deviation": deviations[number] if np.isfinite(deviations[number]) else None,
                **{f"p{p}": float(percentiles[row, number]) for row, p in enumerate(PERCENTILES)},
                "histogram": {"edges": edges.tolist(), "counts": counts.tolist()},
            }
        )
    surfaces = []
    for name, deviation in zip(ensemble.model.surface_names, ensemble.surface_deviation, strict=False):
        if deviation is not None:
            values = deviation[np.isfinite(deviation)]
            surfaces.append(
                {
                    "name": name,
                    "deviation_mean": float(values.mean()) if len(values) else None,
                    "deviation_largest": float(values.max()) if len(values) else None,
                }
            )
    return {
        "schema": _SCHEMA,
        "project": ensemble.model.project.name,
        "realizations": len(ensemble.volumes),
        "seed": ensemble.seed,
        "correlation": ensemble.correlation,
        "blocks": blocks,
        "surfaces": surfaces,
        "warnings": [str(warning) for warning in ensemble.model.warnings],
        "versions": versions(),
    }


def _volumes(ensemble: Ensemble) -> str:
    """A line for each realization, a column for each block."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["realization", *ensemble.block_names])
    for number, row in enumerate(ensemble.volumes):
        table.writerow([number, *map(repr, row.tolist())])
    return text.getvalue()


def _arrays(ensemble: Ensemble) -> dict[str, np.ndarray]:
    pairs = zip(ensemble.surface_mean, ensemble.surface_deviation, strict=True)
    surfaces = {}
    for number, (mean, deviation) in enumerate(pairs):
        if mean is not None and deviation is not None:
            surfaces[f"surface_mean_{number}"] = mean
            surfaces[f"surface_deviation_{number}"] = deviation
    return {
        "block_names": texts(ensemble.block_names),
        "surface_names": texts(ensemble.model.surface_names),
        "volumes": ensemble.volumes,
        "interpolated_volumes": np.array([block.volume for block in ensemble.model.blocks]),
        "percent": np.array(PERCENTILES, np.int32),
        "percentiles": ensemble.percentiles(),
        "places": ensemble.places,
        "probability": ensemble.probability,
        "entropy": ensemble.entropy(),
        **surfaces,
    }
