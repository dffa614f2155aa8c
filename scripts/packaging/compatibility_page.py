# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/reference/compatibility.md from what scripts/test_blender_versions.sh found.

    python3 compatibility_page.py RESULTS PAGE

RESULTS: a folder for each version of Blender, with STEP.status, STEP.log and walk.json.
"""

import json
import re
import sys
from pathlib import Path

SOURCES = {
    "3.4": "Debian 12",
    "4.3": "Debian 13, in a chroot",
    "4.5": "PyPI, module `bpy`",
    "5.2": "Debian unstable, in a chroot",
}
PAGE = """<!-- SPDX-License-Identifier: GPL-3.0-or-later -->
# Which Blender RealModel runs in

Blender 3.4 to 5.2 on Linux x86-64 that has Python 3.11, 3.13 or 3.14 inside, and NumPy 1.24 or newer (1.x and
2.x), on a system with glibc 2.35 and GCC 11's libstdc++ or newer (Debian 12, Ubuntu 22.04, Fedora 36 and
what came after them).

## What was tried

The zip that `scripts/package.sh` makes, in each Blender that can be had from Debian and PyPI. This table
was written by `scripts/test_blender_versions.sh`; run as root, it does all of it again.

{table}

- *zip valid*: `blender --command extension validate`, which Blender has from 4.2 on.
- *installed*: as a user does, into an empty home: Preferences > Add-ons > Install and a tick as an add-on;
  `blender --command extension install-file` as an extension. Then Blender is started again.
- *first use*: open an example, build, volumes as those of the exact model to 1e-4, export, a picture that
  shows the layers, save, open, clear, build again, disable: nothing is left.
- *without module*: the native modules taken away: the add-on enables, its panel says what is missing and
  what to do, opening and building refuse with the same words and change nothing, the rest works.
- *tests*: `tests/blender`, run on what was in the zip.
{compiled}
## Differences between the versions

They are all in `addon/realmodel/bl/versions.py`, each with the version it begins at.

## What was not tried

- Official builds of Blender from blender.org. Those of 4.1 and newer have Python 3.11 or 3.13 inside, and
  modules for both are in the zip. Those of 3.4 to 4.0 have Python 3.10, which RealModel does not run in:
  the add-on refuses to be enabled there and says so; Debian's 3.4 has 3.11.
- Windows and macOS. The zip has no modules for them. CMake should get through there - options of Linux's
  linker are given on Linux only, what reads `/proc` does without it - but it was run neither there nor with
  their compilers. It asks for g++ or clang++ (on Windows of MinGW or LLVM): the exact arithmetic needs
  numbers of 128 bits, which MSVC does not have. On Windows, where `long` has 32 bits, compiling then stops at
  a `static_assert` that says what has to be written first.
"""


def status(folder, step):
    """ "yes", "**no**", or "" where the step was not run."""
    path = folder / f"{step}.status"
    if not path.is_file():
        return ""
    return "yes" if path.read_text().strip() == "0" else "**no**"


def tests(folder):
    """What the tests' last line counts, e.g. "61 passed"."""
    log = folder / "suite.log"
    counts = (
        re.findall(r"Blender .*: (\d+) passed, (\d+) failed, (\d+) skipped", log.read_text())
        if log.is_file()
        else []
    )
    if not counts:
        return "**did not run**"
    passed, failed, skipped = counts[-1]
    words = [f"{passed} passed"]
    words += [f"**{failed} failed**"] if failed != "0" else []
    words += [f"{skipped} skipped"] if skipped != "0" else []
    return ", ".join(words)


def row(version, folder):
    """The cells of one version."""
    walk = folder / "walk.json"
    found = json.loads(walk.read_text(encoding="utf-8")) if walk.is_file() else {}
    as_what = "extension" if "." in found.get("installed_as", "") else "add-on"
    return [
        found.get("blender", version),
        SOURCES[version],
        found.get("python", "?"),
        found.get("numpy", "?"),
        found.get("glibc", "?"),
        status(folder, "validate") or "-",
        as_what if status(folder, "install") == "yes" else "**no**",
        status(folder, "walk") or "**no**",
        status(folder, "without_native") or "**no**",
        tests(folder),
    ]


def compiled(folder):
    """The sentence about compiling with unstable's compiler, where that was done."""
    log = folder / "compile.log"
    if not log.is_file():
        return ""
    compiler = re.search(r"^g\+\+ .* (\S+)$", log.read_text(), re.MULTILINE)
    passed = re.search(r"(\d+)% tests passed, (\d+) tests failed out of (\d+)", log.read_text())
    if compiler is None or passed is None:
        return "\n**The native part does not compile in Debian unstable.**\n"
    failed, total = int(passed[2]), int(passed[3])
    return (
        "\nThe native part, its bindings and its tests compile in Debian unstable too, warnings as errors:\n"
        f"with g++ {compiler[1]} and the libraries there {total - failed} of {total} tests passed.\n"
    )


def main(results, page):
    head = ["Blender", "from", "Python", "NumPy", "glibc", "zip valid"]
    head += ["installed", "first use", "without module", "tests"]
    folders = {version: Path(results) / version for version in SOURCES}
    rows = [row(version, folder) for version, folder in folders.items() if folder.is_dir()]
    lines = ["| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *rows]]
    text = PAGE.format(table="\n".join(lines), compiled=compiled(folders["5.2"]))
    Path(page).write_text(text, encoding="utf-8")
    print(f"Wrote {page}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
