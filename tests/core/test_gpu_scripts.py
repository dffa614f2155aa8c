# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/check_gpu.sh and the step `cuda` of scripts/test.sh: the table, and the limits of kernels."""

import subprocess
import sys

from conftest import ROOT

sys.path.insert(0, str(ROOT / "scripts"))

import check_kernels
from benchmarks import gpu

LIMITS = {"Renumber": (16, 0, 0), "KrigeNode": (64, 0, 0), "CUB": (255, 49152, 16)}
PREFIX = "_ZN9realmodel4cuda41_GLOBAL__N__f3c9c51f_9_device_cu_5a51239a"
KRIGE = f"{PREFIX}10run_blocksINS0_9KrigeNodeEEEvT_"
RENUMBER = f"{PREFIX}8run_eachINS0_8RenumberEEEvmT_"
SORT = "_ZN3cub21CUB_300001_SM_900_9006detail10radix_sort29DeviceRadixSortOnesweepKernelE"


def said(name, registers, spilled=0, shared=""):
    return (
        f"ptxas info    : Compiling entry function '{name}' for 'sm_90'\n"
        f"ptxas info    : Function properties for {name}\n"
        f"    0 bytes stack frame, {spilled} bytes spill stores, {spilled} bytes spill loads\n"
        f"ptxas info    : Used {registers} registers, used 1 barriers{shared}, 352 bytes cmem[0]\n"
    )


def test_kernels_within_their_limits_pass():
    log = said(RENUMBER, 16) + said(KRIGE, 56) + said(SORT, 79, 4, ", 47104 bytes smem")
    assert list(check_kernels.failures(log, LIMITS)) == []
    assert [(kind, taken) for _, kind, taken in check_kernels.kernels(log)] == [
        ("sm_90", (16, 0, 0)),
        ("sm_90", (56, 0, 0)),
        ("sm_90", (79, 47104, 4)),
    ]


def test_each_limit_is_checked():
    log = said(RENUMBER, 17, 8) + said(KRIGE, 56, shared=", 1024 bytes smem") + said(SORT, 79)
    assert list(check_kernels.failures(log, LIMITS)) == [
        "Renumber (sm_90): 17 registers, at most 16 are allowed",
        "Renumber (sm_90): 8 bytes spilled, at most 0 are allowed",
        "KrigeNode (sm_90): 1024 bytes of shared memory, at most 0 are allowed",
    ]


def test_kernels_need_limits_and_limits_kernels():
    other = f"{PREFIX}8run_eachINS0_11RenumberAllEEEvmT_"
    wrong = list(check_kernels.failures(said(other, 8) + said(SORT, 8), LIMITS))
    assert wrong == [
        f"{other} (sm_90): no limits in limits.txt",
        "Renumber: the log has no such kernel",
        "KrigeNode: the log has no such kernel",
    ]


def test_the_file_of_limits_is_read():
    limits = check_kernels.read_limits(check_kernels.LIMITS.read_text(encoding="utf-8"))
    assert limits.keys() > LIMITS.keys()
    assert all(len(numbers) == len(check_kernels.QUANTITIES) for numbers in limits.values())


def test_fused_operations_are_found():
    assert check_kernels.fused("mul.rn.f64 %fd1, %fd2, %fd3;\nfma.rn.f32 %f1, %f2, %f3, %f4;\n") == []
    (wrong,) = check_kernels.fused("fma.rn.f64 %fd1, %fd2, %fd3, %fd4;\n")
    assert "-fmad=false" in wrong


def test_the_table_has_what_was_measured(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n<!-- {gpu.PART} begins -->\nnot measured\n<!-- {gpu.PART} ends -->\nafter\n")
    gpu.write(page, "H200, driver 1", ["merge 1000000 1.25 0.05 0.03 yes", "krige 1000000 1.5 - - -"])
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("after\n") and "not measured" not in text
    assert "| merge 1,000,000 vertices, 6 corners each | 1.25 | 0.05 | 0.03 | 0.02 | **25.0** | yes |" in text
    assert "| krige 1,000,000 nodes from 16 points each | 1.50 | - | - | - | - | - |" in text
    assert "GPU: H200, driver 1." in text


def test_without_a_gpu_the_script_says_so_and_writes_nothing(tmp_path):
    page = tmp_path / "page.md"
    for folder, program in (("no_driver", "exit 9"), ("no_gpu", "exit 0")):
        (tmp_path / folder).mkdir()
        played = tmp_path / folder / "nvidia-smi"
        played.write_text(f"#!/bin/sh\n{program}\n")
        played.chmod(0o755)
        ran = subprocess.run(
            [ROOT / "scripts" / "check_gpu.sh", page],
            env={"PATH": f"{played.parent}:/usr/bin:/bin"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert ran.returncode == 77
        assert "nothing was measured" in ran.stderr
        assert not page.exists()
