#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian packages that RealModel needs and this machine lacks; with nothing missing it
# does nothing. docs/dev/dependencies.md says what each is for.
#
#   scripts/install_dependencies.sh [build|blender|bpy|test|tidy|benchmark|heights|clang|tsan|gui|versions|solvers|windows|wine|macos]...      (default: build)
set -euo pipefail

# A package, or package=command where the command in any version on PATH does as well.
build=(g++ cmake=cmake ninja-build=ninja python3 python3-dev python3-venv python3-numpy pybind11-dev
    libcgal-dev libeigen3-dev libnanoflann-dev libgmp-dev libgtest-dev)
blender=(blender=blender python3-numpy libegl1)
bpy=(libegl1 libgl1 libice6 libsm6 libx11-6 libxfixes3 libxi6 libxkbcommon0 libxrender1 libxxf86vm1)
test=(clang-format=clang-format shellcheck=shellcheck git=git)
tidy=(clang-tidy=clang-tidy)
versions=(debootstrap)
solvers=(openfoam=checkMesh calculix-ccx=ccx libopm-simulators-bin=flow libegl1 chromium=chromium poppler-utils=pdfinfo)
benchmark=(libmpfr-dev blender=blender python3-numpy)
heights=(gmt=gmt r-cran-gstat)
clang=(clang=clang++ libomp-dev)
tsan=(clang=clang++ libclang-rt-dev libomp-dev)
windows=(g++-mingw-w64-x86-64-posix m4 make googletest libcgal-dev libnanoflann-dev)
wine=(wine64 wine xvfb=Xvfb xauth=xauth)
macos=(make m4 libcgal-dev libnanoflann-dev llvm=llvm-objdump)
gui=(xvfb=Xvfb xauth=xauth blender=blender python3-numpy libegl1)

is_present() { # PACKAGE[=COMMAND]
    if [[ $1 == *=* ]] && command -v "${1#*=}" >/dev/null; then
        return 0
    fi
    [[ $(dpkg-query -W -f='${db:Status-Abbrev}' "${1%%=*}" 2>/dev/null) == ii* ]]
}

if (($# == 0)); then
    set -- build
fi
wanted=()
for group in "$@"; do
    case $group in
        build) wanted+=("${build[@]}") ;;
        blender) wanted+=("${blender[@]}") ;;
        bpy) wanted+=("${bpy[@]}") ;;
        test) wanted+=("${test[@]}") ;;
        tidy) wanted+=("${tidy[@]}") ;;
        benchmark) wanted+=("${benchmark[@]}") ;;
        heights) wanted+=("${heights[@]}") ;;
        clang) wanted+=("${clang[@]}") ;;
        tsan) wanted+=("${tsan[@]}") ;;
        gui) wanted+=("${gui[@]}") ;;
        versions) wanted+=("${versions[@]}") ;;
        solvers) wanted+=("${solvers[@]}") ;;
        windows) wanted+=("${windows[@]}") ;;
        wine) wanted+=("${wine[@]}") ;;
        macos) wanted+=("${macos[@]}") ;;
        *)
            echo "install_dependencies.sh: no group '$group'; there are build, blender, bpy, test, tidy, benchmark, heights, clang, tsan, gui, versions, solvers, windows, wine, macos" >&2
            exit 2
            ;;
    esac
done

if ! command -v apt-get >/dev/null; then
    echo "install_dependencies.sh: this is not Debian; what its packages ${wanted[*]%%=*} hold is taken as installed" >&2
    exit 0
fi

missing=()
for package in "${wanted[@]}"; do
    is_present "$package" || missing+=("${package%%=*}")
done
if ((${#missing[@]} == 0)); then
    exit 0
fi

as_root=()
if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
        echo "install_dependencies.sh: neither root nor sudo; as root run: apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "Installing Debian packages: ${missing[*]}"
apt=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
"${as_root[@]}" "${apt[@]}" update
"${as_root[@]}" "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
