# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles: what was chosen in the dialog of an import, for the next file with the same header.

They are a user's own, for all .blend files: JSON in Blender's folder of settings, which can be sent to
others.
"""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import bpy

from ...core import InputRefused
from ...core.base.atomic import Outputs
from ...core.readers.tables.hole_tables import normalized_name
from ..host import caches
from ..objects.stored_arrays import file_stamp

_FORMAT = "realmodel import profiles 1"
_read = caches.new(most=4)  # by the stamp of their file


@dataclass(frozen=True)
class ImportProfile:
    """name. of: which import it is of. header: the names of the columns. columns: {meaning: column}, by name
    or by number from 1. reading: the other import options, by the keys of a project file."""

    name: str
    of: str
    header: tuple[str, ...]
    columns: dict = field(default_factory=dict)
    reading: dict = field(default_factory=dict)

    def fits(self, of, header):
        """Whether it is of an import, and a header, whatever the capitals and the signs between words."""
        return self.of == of and _plain(self.header) == _plain(header)


def _plain(header):
    return [normalized_name(name) for name in header]


def file():
    """Where they are kept."""
    return Path(bpy.utils.user_resource("CONFIG", path="realmodel")) / "import_profiles.json"


def all_of_user():
    """Those of the user, by name; none where they cannot be read."""
    try:
        stamp = file_stamp(file())
        if stamp and stamp not in _read:
            _read[stamp] = read(file())
        return list(_read[stamp]) if stamp else []
    except InputRefused:
        return []


def read(path):
    """Those of a file. Raises InputRefused."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        if content["format"] != _FORMAT:
            raise ValueError(f"its format is {content['format']!r}")
        made = [ImportProfile(**{**entry, "header": tuple(entry["header"])}) for entry in content["profiles"]]
        for profile in made:
            _check(profile)
    except OSError as error:
        raise InputRefused(error.strerror or str(error), file=path) from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise InputRefused(f"these are no import profiles: {error}", file=path) from error
    return sorted(made, key=lambda profile: profile.name.casefold())


def _check(profile):
    texts = (profile.name, profile.of, *profile.header, *profile.columns, *profile.reading)
    if not all(isinstance(text, str) for text in texts):
        raise ValueError("a name is no text")
    if not all(isinstance(column, (str, int)) for column in profile.columns.values()):
        raise ValueError("a column is neither a name nor a number")


def write(profiles, path=None):
    """Writes profiles to a file, or as those of the user: whole or not at all. Raises OutputFailed."""
    path = Path(path or file())
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {"format": _FORMAT, "profiles": [asdict(profile) for profile in profiles]}
    with Outputs() as outputs, outputs.file(path) as opened:
        opened.write(json.dumps(content, indent=1, ensure_ascii=False).encode())


def of_header(of, header):
    """The profile of the user for an import and a header; None where there is none."""
    return next((profile for profile in all_of_user() if profile.fits(of, header)), None)


def add(*new):
    """Adds profiles to those of the user, in the place of those with the same header. A name that another one
    has gets a number."""
    profiles = all_of_user()
    for profile in new:
        profiles = [other for other in profiles if not other.fits(profile.of, profile.header)]
        taken = {other.name for other in profiles}
        names = (profile.name, *(f"{profile.name} {n}" for n in range(2, len(taken) + 3)))
        name = next(name for name in names if name not in taken)
        profiles.append(ImportProfile(**{**vars(profile), "name": name}))
    write(profiles)


def rename(old, new):
    """Gives a profile of the user another name. Raises InputRefused where one has it."""
    profiles = all_of_user()
    if new != old and new in [profile.name for profile in profiles]:
        raise InputRefused(f"there is a profile '{new}' already", advice="choose another name")
    write([ImportProfile(**{**vars(p), "name": new}) if p.name == old else p for p in profiles])


def remove(name):
    """Removes a profile of the user."""
    write([profile for profile in all_of_user() if profile.name != name])
