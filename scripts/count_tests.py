# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the tests in what a test run left behind.

    python3 count_tests.py REPORT      prints "PASSED FAILED SKIPPED"

REPORT is a JUnit file (`.xml`, from ctest and pytest) or the recorded output of tests/blender/run.py (any
other ending). Where nothing can be counted the exit status is 1.
"""

import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def count_junit(text: str) -> tuple[int, int, int]:
    cases = list(ElementTree.fromstring(text).iter("testcase"))
    failed = sum(1 for case in cases if case.find("failure") is not None or case.find("error") is not None)
    skipped = sum(1 for case in cases if case.find("skipped") is not None)
    return len(cases) - failed - skipped, failed, skipped


def count_output(text: str) -> tuple[int, int, int]:
    summaries = re.findall(r"\b(\d+) passed, (\d+) failed, (\d+) skipped", text)
    if not summaries:
        raise ValueError("no line 'N passed, N failed, N skipped' in it")
    passed, failed, skipped = map(int, summaries[-1])
    return passed, failed, skipped


def main(arguments: list[str]) -> int:
    if len(arguments) != 1:
        print("usage: count_tests.py REPORT", file=sys.stderr)
        return 2
    report = Path(arguments[0])
    try:
        text = report.read_text(encoding="utf-8", errors="replace")
        counts = count_junit(text) if report.suffix == ".xml" else count_output(text)
    except (OSError, ValueError, ElementTree.ParseError) as error:
        print(f"count_tests.py: {report}: {error}", file=sys.stderr)
        return 1
    print(*counts)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
