# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about contacts that a younger surface removes, and so lie on no surface of the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.errors import place_text
from ..base.work import Work
from ..surfaces.observed.kept_contacts import observed_contacts
from ..surfaces.observed.succession import Succession
from ..surfaces.rock_input import RockInput
from ..surfaces.wrong_sides import WrongPoints
from .closed_form import ClosedForm

_KEPT = "it is a ready mesh, or other data of it lie below them"
_NOT_KEPT = "if they are observed = true, it cuts none"


def warn_of_eroded_contacts(work: Work, inputs: Sequence[RockInput], forms: Sequence[ClosedForm]) -> None:
    """Adds these warnings to rock masses whose surfaces are made. Of surfaces that are not observed surveys
    and grids are left out, which are often given as they were before erosion, and what ready meshes remove:
    these stay as they are."""
    for entry, form in zip(inputs, forms, strict=True):
        rock, surfaces = entry.rock, entry.rock.surfaces
        succession = Succession([surface.rule for surface in surfaces])
        for number, surface in enumerate(surfaces):
            data = entry.data[number]
            if not surface.has_points or not (rock.is_level_set(surface) or len(data.tied_points(surface))):
                continue
            points = data.known_points
            is_observed = bool(len(points)) and len(observed_contacts(surface, data)) == len(points)
            for cutter in succession.cut_later(number) if len(points) else ():
                if not (is_observed or surfaces[cutter].has_points):
                    continue
                # infinite: a level set is nowhere in the compartment
                above = np.nan_to_num(-form.above(work, cutter, points), posinf=0.0, neginf=0.0)
                wrong = WrongPoints.of(points, above, cutter, np.arange(len(points)))
                if wrong is None or (wrong.is_part_of_survey(len(points)) and not is_observed):
                    continue
                text = (
                    f"it erodes {len(wrong.items)} of the {len(points)} contacts of '{surface.name}', the "
                    f"farthest lies {wrong.by:.4g} above it: point {data.row(wrong.worst)} at "
                    f"{place_text(wrong.place)}; {_KEPT if is_observed else _NOT_KEPT}"
                )
                cutter_name = surfaces[cutter].name  # a stage without it has no such warning
                entry.warnings.append(
                    BuildWarning(text, "eroded", entry.rock.name, cutter_name, wrong.rows(data))
                )
