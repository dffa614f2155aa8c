#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the optional module for NVIDIA's GPUs, tests it on the GPU of this machine, and measures it beside two threads
# of the processor: in at most eight minutes. The table goes into docs/dev/performance.md. Where there is no nvcc, what
# another machine has built in build/cuda and addon/realmodel is used.
#
#   scripts/check_gpu.sh [--cpu] [PAGE]
#     --cpu   only the processor's times of the smallest sizes, without a GPU: to try this script
#     PAGE    the page to write into (default: docs/dev/performance.md)
#
# The exit status is 77 where there is no GPU: nothing is written then.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
seconds=480
benchmark=build/cuda/native/device_benchmark

only_cpu=()
sizes=(merge:1000000 krige:1000000 merge:10000000 krige:10000000 merge:100000000)
gpu=none
if [[ ${1-} == --cpu ]]; then
    only_cpu=(cpu)
    sizes=(merge:100000 krige:100000)
    shift
elif gpu=$(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null | head -n 1) && [[ -n $gpu ]]; then
    gpu=${gpu/, /, driver }
else
    echo "check_gpu.sh: no GPU: nvidia-smi finds none here; nothing was measured, and the page stays as it is" >&2
    exit 77
fi
page=${1-docs/dev/performance.md}

if ((${#only_cpu[@]} > 0)); then
    benchmark=build/release/native/device_benchmark
    cmake --build build/release --target device_benchmark -j "$(scripts/build_jobs.sh)"
elif command -v nvcc >/dev/null; then
    scripts/build.sh --cuda
    cmake --build build/cuda --target device_benchmark -j "$(scripts/build_jobs.sh)"
elif [[ ! -x $benchmark ]]; then
    echo "check_gpu.sh: neither nvcc nor $benchmark is here" >&2
    exit 1
fi

failed=0
if ((${#only_cpu[@]} == 0)); then
    if python3 -c 'import numpy, pytest' 2>/dev/null; then # models of Python, with the same bytes
        PYTHONPATH=addon timeout 120 python3 -m pytest -q tests/core/test_device.py || failed=1
    else
        echo "check_gpu.sh: tests/core/test_device.py is left out: this Python has no NumPy or pytest" >&2
    fi
fi
lines=()
for size in "${sizes[@]}"; do
    what=${size%:*} count=${size#*:}
    line="$what $count - - - -"
    if ((SECONDS + 20 > seconds)); then
        echo "check_gpu.sh: $what $count is left out: no time is left" >&2
    else
        line=$(timeout "$((seconds - SECONDS))" "$benchmark" "$what" "$count" "${only_cpu[@]}") || failed=1
        line=${line:-$what $count - - - -}
        [[ $line != *NO ]] || failed=1
    fi
    echo "$line"
    lines+=("$line")
done
printf '%s\n' "${lines[@]}" | PYTHONPATH=scripts python3 -m benchmarks.gpu "$page" "$gpu"
echo "Written: $page, in $SECONDS s"
exit "$failed"
