#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what building needs, builds RealModel in release and leaves the Python module for one
# interpreter in addon/realmodel, beside those for others: PYTHONPATH=addon finds it. The packages that
# travel with the add-on come into addon/realmodel/vendor.
#
#   scripts/build.sh [--cuda] [PYTHON]      PYTHON: an interpreter, 3.11 or newer (default: python3)
#
# --cuda: the optional module for NVIDIA's GPUs, too, which needs nvcc (docs/dev/gpu.md).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

cuda=false
if [[ ${1-} == --cuda ]]; then
    cuda=true
    shift
fi
if (($# > 1)); then
    echo "usage: build.sh [--cuda] [PYTHON]" >&2
    exit 2
fi
"$root/scripts/install_dependencies.sh" build

asked=${1:-python3}
if ! python=$("$asked" -c 'import sys; print(sys.executable)'); then
    echo "build.sh: '$asked' is not a Python interpreter that runs here" >&2
    exit 1
fi
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "build.sh: $python is $("$python" --version); RealModel needs Python 3.11 or newer" >&2
    exit 1
fi

# pybind11 is headers only, so one copy serves every interpreter. It is kept by Debian's python3,
# which is sure to have venv once the packages are there.
keeper=/usr/bin/python3
[[ -x $keeper ]] || keeper=$python
if ! "$root/scripts/python_environment.sh" "$root/build/tools" "$root/scripts/requirements/build.txt" "$keeper"; then
    echo "build.sh: pybind11 could not be fetched; building with the system's (the module may then need NumPy 1)" >&2
fi

if ! "$root/scripts/vendor_packages.sh" "$root/build/tools/bin/python"; then
    echo "build.sh: pyshp, tifffile, openpyxl and pydyf could not be fetched; shapefiles, GeoTIFF and .xlsx will not be read, and no PDF written" >&2
fi

# What was found for another interpreter must not stay in the cache.
(cd "$root" && cmake --preset release -U 'Python*' -U '_Python*' -U 'pybind11*' \
    "-DPython_EXECUTABLE=$python" --log-level=WARNING)
cmake --build "$root/build/release" --target _native -j "$("$root/scripts/build_jobs.sh")"

if $cuda; then
    if ! command -v nvcc >/dev/null; then
        echo "build.sh: --cuda needs nvcc of the CUDA toolkit, which is not on PATH" >&2
        exit 1
    fi
    (cd "$root" && cmake --preset cuda -U 'Python*' -U '_Python*' -U 'pybind11*' \
        "-DPython_EXECUTABLE=$python" --log-level=WARNING)
    cmake --build "$root/build/cuda" --target _native_cuda -j "$("$root/scripts/build_jobs.sh")"
    cp "$root"/build/cuda/cuda/_native_cuda* "$root/addon/realmodel/"
fi

if ! PYTHONPATH="$root/addon" "$python" -c 'import realmodel._native'; then
    echo "build.sh: the module was built but $python cannot load it (reason above)" >&2
    exit 1
fi
echo "Built $(cd "$root" && ls addon/realmodel/_native"$("$python" -c \
    'import sysconfig; print(sysconfig.get_config_var("EXT_SUFFIX"))')") for $python"
if ! "$python" -c 'import importlib.util, sys; sys.exit(importlib.util.find_spec("numpy") is None)'; then
    echo "$python has no NumPy, which realmodel.core needs: $python -m pip install numpy" >&2
fi
