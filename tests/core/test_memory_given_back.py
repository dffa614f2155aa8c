# SPDX-License-Identifier: GPL-3.0-or-later
"""What a build has taken is the system's again when it fails or is cancelled."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

MEGABYTE = 1 << 20

# In a process of its own: no other test's memory, and a peak that is the build's.
BUILD = """
import json, resource, sys, threading
sys.path[:0] = sys.argv[1:3]
from benchmarks.made_stacks import StackSpec
from benchmarks.process import resident
from realmodel.core import Cancelled, InputRefused, Project, Rock, Surface, build

def project(quads, base):
    surfaces = [Surface(f"S{k}", *surface) for k, surface in enumerate(StackSpec(8, quads).make())]
    return Project("p", [Rock("r", surfaces, base_elevation=base)])

build(project(4, None))  # what the first build leaves behind for all later ones is there now
# large enough that the tens of megabytes which allocators keep for their threads are a small share
given = project(200, 1.0 if sys.argv[3] == "refused" else None)  # base_elevation is looked at last of all
before = resident()
calls = []
try:
    late = sys.argv[3] == "cancelled"
    build(given, progress=lambda share, _: calls.append(share), cancel=lambda: late and calls[-1] > 0.6)
    how = "built"
except Cancelled:
    how = "cancelled"
except InputRefused:
    how = "refused"
for thread in threading.enumerate():
    if thread is not threading.current_thread():
        thread.join()
peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"how": how, "kept": resident() - before, "taken": peak - before}))
"""


@pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="resident memory is read from /proc")
@pytest.mark.parametrize("how", ["cancelled", "refused"])
def test_memory_is_given_back(how):
    folders = [str(ROOT / "addon"), str(ROOT / "scripts")]
    done = subprocess.run(
        [sys.executable, "-c", BUILD, *folders, how], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["how"] == how
    assert found["taken"] > 300 * MEGABYTE, "enough to measure"
    assert found["kept"] < 0.2 * found["taken"]
