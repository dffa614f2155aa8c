#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the zips that users install: dist/realmodel-VERSION-PLATFORM.zip, for Blender 3.4 to 5.2 on
# Linux x86-64, on Windows x64 and on macOS with Apple's processors. Each holds one native module for each version
# of Python that a Blender comes with. The headers that these need are taken from Debian, whichever release has
# them, and kept in ${XDG_CACHE_HOME:-~/.cache}/realmodel; those for Windows and macOS in build/windows and
# build/macos (scripts/cross_tools.sh). The same sources give the same bytes.
#
#   scripts/package.sh [--platform NAME]... [--pythons "3.11 3.13 3.14"] [--skip-missing] [--into FOLDER]
#     --platform      linux-x64, windows-x64 or macos-arm64 (default: all)
#     --pythons       the versions to compile for
#     --skip-missing  leave out a version whose headers cannot be had, and say so, instead of failing
#     --into FOLDER   default: dist
#     --help          prints this text
#
# What takes how long, in times of a first scripts/build.sh: linux-x64 takes the core and the module of this
# machine's Python from build/release, where scripts/build.sh made them, and compiles the bindings for each other
# version: 0.2 each. windows-x64 and macos-arm64 have compilers of their own, so they compile the core, too,
# once for all versions: 1, and 0.2 for each version; first they fetch and build their tools and libraries. What
# is compiled stays in build/, and the second time takes seconds.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/realmodel

platforms=() pythons="3.11 3.13 3.14" skip_missing="" into=$root/dist
while (($# > 0)); do
    case $1 in
        --platform)
            case ${2-} in
                linux-x64 | windows-x64 | macos-arm64) platforms+=("$2") && shift ;;
                *)
                    echo "package.sh: --platform needs linux-x64, windows-x64 or macos-arm64" >&2
                    exit 2
                    ;;
            esac
            ;;
        --pythons) pythons=${2:?package.sh: --pythons needs versions} && shift ;;
        --skip-missing) skip_missing=yes ;;
        -h | --help)
            sed -n '3,/^set -/{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
            exit
            ;;
        --into) into=${2:?package.sh: --into needs a folder} && shift ;;
        *)
            echo 'usage: package.sh [--platform linux-x64|windows-x64|macos-arm64]... [--pythons "3.11 3.13 3.14"] [--skip-missing] [--into FOLDER]' >&2
            exit 2
            ;;
    esac
    shift
done
((${#platforms[@]} > 0)) || platforms=(linux-x64 windows-x64 macos-arm64)
if [[ $(uname -sm) != "Linux x86_64" ]]; then
    echo "package.sh: the zips are made on Linux x86-64; this is $(uname -sm)" >&2
    exit 1
fi

# The interpreter of this machine.
python=/usr/bin/python3
[[ -x $python ]] || python=$(command -v python3)
version_here=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')

# These fill modules, configured (REALMODEL_PACKAGED_PYTHONS) and missing.
linux_x64() {
    # Builds the core, which is the same for all, and the module for the interpreter of this machine.
    "$root/scripts/build.sh" "$python"
    # The oldest release of Debian that has a version of Python.
    local -A suite_of=([3.11]=bookworm [3.13]=trixie [3.14]=sid)
    local version suffix include headers
    for version in $pythons; do
        suffix=cpython-${version/./}-x86_64-linux-gnu.so
        if [[ $version == "$version_here" ]]; then
            modules+=("$root/addon/realmodel/_native.$suffix")
            continue
        fi
        if [[ -z ${suite_of[$version]-} ]]; then
            echo "package.sh: it is not known which release of Debian has Python $version" >&2
            exit 2
        fi
        if [[ -f /usr/include/python$version/Python.h && -f /usr/include/x86_64-linux-gnu/python$version/pyconfig.h ]]; then
            include=/usr/include
        else
            headers=$cache/python$version-headers
            include=$headers/usr/include
            if ! "$root/scripts/foreign_packages.sh" "${suite_of[$version]}" "$headers" "libpython$version-dev"; then
                missing+=("$version")
                continue
            fi
        fi
        configured+="$suffix=$include/python$version:$include;"
        modules+=("$root/build/release/packaged_modules/_native.$suffix")
    done
}

for_another_system() { # PLATFORM
    "$root/scripts/cross_tools.sh" "$1"
    "$root/scripts/python_environment.sh" "$root/build/tools" "$root/scripts/requirements/build.txt" "$python"
    "$root/scripts/vendor_packages.sh" "$root/build/tools/bin/python"
    local version suffix folder
    for version in $pythons; do
        if ! "$root/scripts/cross_tools.sh" "$1" "$version"; then
            missing+=("$version")
            continue
        fi
        folder=$root/build/${1%-*}/python$version
        case $1 in
            windows-x64)
                suffix=cp${version/./}-win_amd64.pyd
                configured+="$suffix=$folder/include:$folder/libpython${version/./}.dll.a;"
                ;;
            macos-arm64)
                suffix=cpython-${version/./}-darwin.so
                configured+="$suffix=$folder/include;"
                ;;
        esac
        modules+=("$root/build/$1/packaged_modules/_native.$suffix")
    done
}

for platform in "${platforms[@]}"; do
    modules=() configured="" missing=()
    case $platform in
        linux-x64) preset=release && linux_x64 ;;
        *) preset=$platform && for_another_system "$platform" ;;
    esac
    if ((${#missing[@]} > 0)); then
        if [[ -z $skip_missing ]]; then
            echo "package.sh: the headers of Python ${missing[*]} cannot be had (reason above)" >&2
            exit 1
        fi
        echo "SKIPPED modules for Python ${missing[*]}, whose headers cannot be had (reason above)"
    fi
    if ((${#modules[@]} == 0)); then
        echo "package.sh: there is no module to put into the zip" >&2
        exit 1
    fi
    if [[ -n $configured ]]; then
        without_tests=()
        [[ $preset == release ]] || without_tests=(-DREALMODEL_BUILD_TESTS=OFF) # they need GoogleTest for there
        (cd "$root" && cmake --preset "$preset" "-DREALMODEL_PACKAGED_PYTHONS=${configured%;}" "${without_tests[@]}" --log-level=WARNING)
        cmake --build "$root/build/$preset" --target packaged_modules -j "$("$root/scripts/build_jobs.sh")"
    fi
    "$root/build/tools/bin/python" "$root/scripts/packaging/make_zip.py" "$platform" "$into" "${modules[@]}"
done
