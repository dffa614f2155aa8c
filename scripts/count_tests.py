# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the tests in what a test run left behind.

    python3 count_tests.py REPORT      prints "PASSED FAILED SKIPPED", then a line for each test that failed

REPORT is a JUnit file (`.xml`, from ctest and pytest) or the recorded output of tests/blender/run.py (any
other ending). Where nothing can be counted the exit status is 1.
"""

import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

Counts = tuple[int, int, int]


def read_junit(text: str) -> tuple[Counts, list[str]]:
    cases = list(ElementTree.fromstring(text).iter("testcase"))
    failed = []
    for case in cases:
        fault = case.find("failure")
        if fault is None:
            fault = case.find("error")
        if fault is not None:
            why = (fault.get("message") or "").strip().splitlines()
            failed.append(f"{case.get('classname')} {case.get('name')}: {why[0] if why else ''}")
    skipped = sum(1 for case in cases if case.find("skipped") is not None)
    return (len(cases) - len(failed) - skipped, len(failed), skipped), failed


def read_output(text: str) -> tuple[Counts, list[str]]:
    summaries = re.findall(r"\b(\d+) passed, (\d+) failed, (\d+) skipped", text)
    if not summaries:
        raise ValueError("no line 'N passed, N failed, N skipped' in it")
    passed, failed, skipped = map(int, summaries[-1])
    return (passed, failed, skipped), re.findall(r"^(?:FAIL|ERROR|FAILED): (.*)$", text, re.MULTILINE)


def main(arguments: list[str]) -> int:
    if len(arguments) != 1:
        print("usage: count_tests.py REPORT", file=sys.stderr)
        return 2
    report = Path(arguments[0])
    try:
        text = report.read_text(encoding="utf-8", errors="replace")
        counts, failed = read_junit(text) if report.suffix == ".xml" else read_output(text)
    except (OSError, ValueError, ElementTree.ParseError) as error:
        print(f"count_tests.py: {report}: {error}", file=sys.stderr)
        return 1
    print(*counts)
    for test in failed:
        print(test)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
