# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a proposed project is as it is, as rows of a scene."""

import math

from . import settings


def keep(scene, proposal):
    """Lists a realmodel.core Proposal: what contradicts it and what is not decided first."""
    uncertain = proposal.uncertain
    count = len(proposal.warnings) - len(uncertain)
    rows = [
        {"kind": type(part).__name__.lower(), "name": _name(part), "text": text, **_place(part)}
        for part, text in zip(uncertain, proposal.warnings[count:], strict=True)
    ]
    rows += [{"kind": "warning", "name": "Data", "text": text} for text in proposal.warnings[:count]]
    order = f"By which lies over which, the oldest first: {', '.join(proposal.order)}"
    rows.append({"kind": "choice", "name": "Order", "text": order})
    rows += [
        {"kind": "rule", "name": f"{rule.unit} top", "text": f"{rule.rule}: {rule.reason}"}
        for rule in proposal.rules
    ]
    rows += [
        {"kind": "choice", "name": key.replace("_", " ").title(), "text": text}
        for key, text in proposal.reasons.items()
    ]
    with settings.filling():
        scene.realmodel.proposal.clear()
        scene.realmodel.active_reason = 0
        for entries in rows:
            row = scene.realmodel.proposal.add()
            for key, text in entries.items():
                setattr(row, key, text)


def _name(part):
    """What an Alternative, a Conflict, a Lens or a Repeat is about."""
    if hasattr(part, "younger"):
        return f"{part.younger} / {part.older}"
    if hasattr(part, "upper"):
        return f"{part.upper} / {part.lower}"
    return part.name if hasattr(part, "host") else " / ".join(part.units)


def _place(part):
    """The hole and the depth of a Conflict or a Repeat."""
    if not hasattr(part, "depth"):
        return {}
    return {"hole": part.hole, "depth": "" if math.isnan(part.depth) else f"{part.depth:.6g}"}
