#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures RealModel beside its peers in one run and writes docs/dev/performance.md. On a quiet machine the
# whole run takes about half an hour and up to 12 GB. Peers that are missing are SKIPPED, and why.
#
#   scripts/benchmark.sh              all sizes; writes the page
#   scripts/benchmark.sh --quick      small sizes, each once, as a look; the page is left as it is
#   scripts/benchmark.sh --only stacks|watch|blender|memory|heights|meshing|booleans|structures|files|tiles, --memory GB, --write F.md, --help
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=/usr/bin/python3

# Whether one of these parts is to be measured: all are where none is named.
wanted() {
    [[ " ${asked[*]} " != *" --only "* ]] && return
    local part
    for part; do [[ " ${asked[*]} " == *" --only $part "* ]] && return; done
    return 1
}
asked=("$@")

"$root/scripts/install_dependencies.sh" build benchmark
"$root/scripts/build.sh" "$python"
environment=$root/build/benchmark_environment
runs=$environment/bin/python
if ! "$root/scripts/python_environment.sh" "$environment" "$root/scripts/requirements/benchmark.txt" "$python"; then
    echo "benchmark.sh: manifold3d could not be fetched; measuring without it" >&2
    runs=$python
fi
if wanted stacks && ! { (cd "$root" && cmake --preset release -DREALMODEL_BUILD_BENCHMARKS=ON --log-level=WARNING) &&
    cmake --build "$root/build/release" --target cgal_corefinement; }; then
    echo "benchmark.sh: the program of CGAL's corefinement could not be built; measuring without it" >&2
fi
peers=$root/build/heights_environment
if ! wanted heights; then
    :
elif "$root/scripts/python_environment.sh" "$peers" "$root/scripts/requirements/benchmark_heights.txt" "$python"; then
    export REALMODEL_HEIGHTS_PYTHON=$peers/bin/python
else
    echo "benchmark.sh: SciPy and PyKrige could not be installed; measuring without them" >&2
fi
peers=$root/build/meshing_environment
if ! wanted meshing; then
    :
elif "$root/scripts/python_environment.sh" "$peers" "$root/scripts/requirements/benchmark_meshing.txt" "$python"; then
    export REALMODEL_MESHING_PYTHON=$peers/bin/python
else
    echo "benchmark.sh: Triangle, Gmsh and earcut could not be installed; measuring without them" >&2
fi
peers=$root/build/booleans_environment
if ! wanted booleans; then
    :
elif "$root/scripts/python_environment.sh" "$peers" "$root/scripts/requirements/benchmark_booleans.txt" "$python"; then
    export REALMODEL_BOOLEANS_PYTHON=$peers/bin/python
    geogram=("$peers"/lib/python*/site-packages)
    c++ -O2 -std=c++17 -fopenmp -I "${geogram[0]}/include/geogram1" "$root/scripts/benchmarks/geogram_arrangement.cpp" \
        "${geogram[0]}/lib64/libgeogram.a" "${geogram[0]}"/geogram.libs/libtbb* "-Wl,-rpath,${geogram[0]}/geogram.libs" \
        -ldl -o "$peers/geogram_arrangement" ||
        echo "benchmark.sh: the program of geogram could not be built; measuring without it" >&2
else
    echo "benchmark.sh: trueform and geogram could not be installed; measuring without them" >&2
fi
if wanted blender memory &&
    ! { "$root/scripts/install_dependencies.sh" bpy &&
        "$root/scripts/python_environment.sh" "$root/build/venv-bpy" "$root/scripts/requirements/bpy.txt" "$python"; }; then
    echo "benchmark.sh: the module bpy could not be installed; measuring without it" >&2
fi
if wanted heights && ! "$root/scripts/install_dependencies.sh" heights; then
    echo "benchmark.sh: GMT and gstat could not be installed; measuring without them" >&2
fi
cd "$root/scripts"
PYTHONPATH="$root/addon:$root/scripts" exec "$runs" -m benchmarks "$@"
