#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the native code has outgrown its ceilings (scripts/ceilings.txt): lines of code of each folder,
without blank lines and comments, and files. Also refused are headers that one file alone includes, and
folders and files that are too large. A folder that has shrunk lowers its ceiling; one that must grow raises
it in the commit that needs it, with the reason.

    scripts/check_sizes.py            the exit status is 1 if a ceiling is wrong
    scripts/check_sizes.py --lower    lowers ceilings to what is there
"""

import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CEILINGS = Path(__file__).with_name("ceilings.txt")
MOST_FILES_OF_A_FOLDER = 25
MOST_LINES_OF_A_FILE = 1000
LINES_OF_ONE_TOPIC = 600  # a header with one user belongs there, unless the file would be longer
FILES = "files of native/src"
SPARE = 20  # lines that a ceiling may be above what is there


def lines_of_code(path):
    text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    lines = [line.strip() for line in text.split("\n")]
    return sum(1 for line in lines if line and not line.startswith("//"))


def sources(folder):
    return sorted(path for end in ("cpp", "hpp") for path in (ROOT / folder).rglob(f"*.{end}"))


def sizes():
    """Lines of each folder of native/src and native/include, and all files of native/src."""
    found = Counter()
    for path in sources("native/src") + sources("native/include"):
        found[path.parent.relative_to(ROOT).as_posix()] += lines_of_code(path)
    return {**found, FILES: len(sources("native/src"))}


def length(path):
    return len(path.read_text(encoding="utf-8").splitlines())


def headers_with_one_user():
    users = defaultdict(set)
    for path in sources("native"):
        for name in re.findall(r'^#include "([^"]+)"', path.read_text(encoding="utf-8"), re.MULTILINE):
            users[name].add(path)
    for path in sources("native/src"):
        own = path.with_suffix(".cpp")
        others = users[path.relative_to(ROOT / "native/src").as_posix()] - {own}
        is_for_tests = own.exists() and {user.relative_to(ROOT).parts[1] for user in others} == {"tests"}
        joined = sum(length(each) for each in {path, own, *others} if each.exists())
        if path.suffix == ".hpp" and len(others) < 2 and not is_for_tests and joined <= LINES_OF_ONE_TOPIC:
            yield path, others


def failures(found, ceilings):
    for name in sorted(found.keys() | ceilings.keys()):
        size, ceiling = found.get(name, 0), ceilings.get(name, 0)
        if size > ceiling:
            yield f"{name}: {size}, and the ceiling is {ceiling}"
        elif ceiling > size + SPARE * (name != FILES) or not size:
            yield f"{name}: {size}; lower the ceiling of {ceiling} (scripts/check_sizes.py --lower)"
    for folder, count in Counter(path.parent for path in sources("native/src")).items():
        if count > MOST_FILES_OF_A_FOLDER:
            yield f"{folder.relative_to(ROOT)}: {count} files, at most {MOST_FILES_OF_A_FOLDER} are allowed"
    for path in sources("native"):
        if (lines := length(path)) > MOST_LINES_OF_A_FILE:
            yield f"{path.relative_to(ROOT)}: {lines} lines, at most {MOST_LINES_OF_A_FILE} are allowed"
    for path, users in headers_with_one_user():
        where = ", ".join(str(user.relative_to(ROOT)) for user in users) or "nobody"
        yield f"{path.relative_to(ROOT)}: included by {where} alone; it belongs there"


def main():
    ceilings = {}
    for line in CEILINGS.read_text(encoding="utf-8").splitlines():
        name, number = line.rsplit(" ", 1)
        ceilings[name] = int(number)
    found = sizes()
    if sys.argv[1:] == ["--lower"]:
        lower = {name: min(ceilings.get(name, size), size) for name, size in found.items()}
        CEILINGS.write_text("".join(f"{name} {lower[name]}\n" for name in sorted(lower)), encoding="utf-8")
        ceilings = lower
    wrong = list(failures(found, ceilings))
    for line in wrong:
        print(line)
    print(f"{sum(found.values()) - found[FILES]} lines of code in native/src and native/include")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
