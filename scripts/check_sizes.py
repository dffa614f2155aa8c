#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the native code or the add-on has outgrown its ceilings (scripts/ceilings.txt): lines of code of
each folder, without blank lines and comments, and files. Also refused are headers that one file alone
includes, and native folders and files that are too large. A folder that has shrunk lowers its ceiling; one
that must grow raises it in the commit that needs it, with the reason.

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
ENDINGS = {"native": ("cpp", "hpp"), "addon": ("py",)}
WHOLES = {  # what has a sum of lines, and a ceiling of files
    "native/src and native/include": ("native/src", "native/include"),
    "addon/realmodel": ("addon/realmodel",),
}
FILES = "files of "
SPARE = 20  # lines that a ceiling may be above what is there


def lines_of_code(path):
    text, comment = path.read_text(encoding="utf-8"), "#"
    if path.suffix != ".py":
        text, comment = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL), "//"
    lines = [line.strip() for line in text.split("\n")]
    return sum(1 for line in lines if line and not line.startswith(comment))


def sources(folder):
    paths = (path for end in ENDINGS[folder.split("/")[0]] for path in (ROOT / folder).rglob(f"*.{end}"))
    return sorted(path for path in paths if "vendor" not in path.relative_to(ROOT).parts)


def sizes():
    """Lines of each folder of the native code and of the add-on, and the files of each."""
    lines, files = Counter(), Counter()
    for folders in WHOLES.values():
        for folder in folders:
            for path in sources(folder):
                lines[path.parent.relative_to(ROOT).as_posix()] += lines_of_code(path)
                files[FILES + folder] += 1
    del files[FILES + "native/include"]
    return {**lines, **files}


def length(path):
    return len(path.read_text(encoding="utf-8").splitlines())


def headers_with_one_user():
    users = defaultdict(set)
    for path in sources("native"):
        for name in re.findall(r'^#include "([^"]+)"', path.read_text(encoding="utf-8"), re.MULTILINE):
            users[name].add(path)
    for path in sources("native/src"):
        source = path.with_suffix(".cpp")
        others = users[path.relative_to(ROOT / "native/src").as_posix()] - {source}
        is_for_tests = source.exists() and {user.relative_to(ROOT).parts[1] for user in others} == {"tests"}
        joined = sum(length(file) for file in {path, source, *others} if file.exists())
        if path.suffix == ".hpp" and len(others) < 2 and not is_for_tests and joined <= LINES_OF_ONE_TOPIC:
            yield path, others


def failures(measured, ceilings):
    for name in sorted(measured.keys() | ceilings.keys()):
        size, ceiling = measured.get(name, 0), ceilings.get(name, 0)
        if size > ceiling:
            yield f"{name}: {size}, and the ceiling is {ceiling}"
        elif ceiling > size + SPARE * (not name.startswith(FILES)) or not size:
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
    measured = sizes()
    if sys.argv[1:] == ["--lower"]:
        lower = {name: min(ceilings.get(name, size), size) for name, size in measured.items()}
        CEILINGS.write_text("".join(f"{name} {lower[name]}\n" for name in sorted(lower)), encoding="utf-8")
        ceilings = lower
    wrong = list(failures(measured, ceilings))
    for line in wrong:
        print(line)
    for whole, folders in WHOLES.items():
        lines = sum(size for name, size in measured.items() if name.startswith(folders))
        print(f"{lines} lines of code in {whole}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
