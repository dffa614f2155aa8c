# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages for the panel: settings by their labels; the warnings of a build short, equal ones merged. A range
beyond the points changes no height and is usual where beds dip: the quality of the surface has it."""

import re
from pathlib import Path

from ...core.base.errors import number_list
from ...core.project.project import ROCK, SURFACE
from ...core.project.series import SERIES
from ...core.project.structure_entries import BODY, FAULT
from ...core.settings.variogram import RANGE_BEYOND

# By the keys of project files: the labels of settings, and of their words.
_SETTINGS = [pair for table in (SERIES, BODY, FAULT, ROCK, SURFACE) for pair in table.items()]
_LABELS = {key: setting.label for key, setting in _SETTINGS if setting.label}
_WORDS = {(key, word): texts[0] for key, setting in _SETTINGS for word, texts in setting.words.items()}
_KEY = "|".join(sorted(_LABELS, key=len, reverse=True))
_GIVEN = re.compile(
    rf"(?:\b(?:say|write|give|set) )?\b({_KEY})"
    + r' = (".*?"|\[.*?\]|\{.*?\}|[^\s,;]+)'
    + r'(?: or (".*?"))?'
)
_QUOTED = re.compile(
    r"((?:surface|fault|body|rock|mass|block|column|object|layer|method|names) )?" + rf"'({_KEY})'"
)
_PLAIN = re.compile(r"(?<![\w'/.-])(" + "|".join(key for key in _LABELS if "_" in key) + r")(?![\w'/-]|\.\w)")
_BODY = re.compile(r"write \[\[body\]\]")
_NO_ACTION = {"joined", "ends"}  # the kinds of warnings after which nothing is to be done
_PATH = re.compile(r"(?<!\S)/(?:[^\s:]+/)+([^\s:/]+\.\w+)")


def of_model(model):
    """The text that `scene.realmodel.warnings` keeps of a model's warnings: one line for each that differs in
    more than its surface and its numbers."""
    alike = {}
    several = len(model.project.rocks) > 1
    for warning in shown(model):
        if warning.kind in _NO_ACTION:
            continue
        alike.setdefault(re.sub(r"\d[\d.,e+-]*", "0", warning.text), []).append(warning)
    lines = []
    for group in alike.values():
        names = []
        for warning in group:
            whole = [warning.rock] if warning.rock and (several or not warning.surface) else []
            names.append(" / ".join([*whole, *([warning.surface] if warning.surface else [])]))
        names = [name for name in dict.fromkeys(names) if name]
        where = f"{number_list(names)}: " if names else ""
        lines.append(" ".join(f"{where}{in_panel_words(group[0].text)}".split()))
    return "\n".join(lines)


def shown(model):
    """The warnings of a model that say something about its blocks."""
    return [warning for warning in model.warnings if RANGE_BEYOND not in warning.text]


def read(kept):
    """The lines that `of_model` made."""
    return kept.split("\n") if kept else []


def in_panel_words(text):
    """A message with the labels of the panel in the place of the keys of project files, and files by name."""
    text = _BODY.sub("add it as a body", _GIVEN.sub(_setting, text))
    text = _QUOTED.sub(lambda match: match[0] if match[1] else _LABELS[match[2]], text)
    text = _PLAIN.sub(lambda match: _LABELS[match[1]], text)
    return _PATH.sub(lambda match: Path(match[0]).name, text)


def _setting(match):
    values = [_value(match[1], value) for value in match.groups()[1:] if value]
    return f"set {_LABELS[match[1]]} to {' or '.join(values)}"


def _value(key, value):
    value = value.strip('"[]{} ').replace('"', "")
    return _WORDS.get((key, value), value or "nothing")
