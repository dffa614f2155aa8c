# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the table in docs/reference/compatibility.md from what scripts/test_blender_versions.sh found.

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
    "5.0": "PyPI, module `bpy`",
    "5.2": "Debian unstable, in a chroot",
}
MARKED = re.compile(r"(<!-- versions begin -->\n).*?(<!-- versions end -->)", re.DOTALL)


def status(folder, step):
    """ "yes", "**no**", or "" where the step was not run."""
    path = folder / f"{step}.status"
    if not path.is_file():
        return ""
    return "yes" if path.read_text().strip() == "0" else "**no**"


def tests(folder):
    """Whether the tests passed, by their last line."""
    log = folder / "suite.log"
    counts = (
        re.findall(r"Blender .*: (\d+) passed, (\d+) failed, (\d+) skipped", log.read_text())
        if log.is_file()
        else []
    )
    if not counts:
        return "**did not run**"
    passed, failed, _ = counts[-1]
    if failed != "0":
        return f"**{failed} failed**"
    return "passed" if passed != "0" else "**did not run**"


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
        status(folder, "window") or "-",
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
    head += ["installed", "first use", "without module", "tests", "window"]
    folders = {version: Path(results) / version for version in SOURCES}
    rows = [row(version, folder) for version, folder in folders.items() if folder.is_dir()]
    lines = ["| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *rows]]
    table = "\n".join(lines) + "\n" + compiled(folders["5.2"])
    text = Path(page).read_text(encoding="utf-8")
    Path(page).write_text(MARKED.sub(lambda found: found[1] + table + found[2], text), encoding="utf-8")
    print(f"Wrote {page}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
