#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes what users install, from one set of native modules, one for each platform and version of Python:
#
#   dist/realmodel-VERSION-PLATFORM.zip             for Blender 3.4 to 5.2
#   dist/realmodel-VERSION-PLATFORM-extension.zip   for Blender's extension platform, which wants wheels (docs/dev/releasing.md)
#   dist/realmodel-VERSION-cp3xx-*.whl              for pip, CPython 3.11 to 3.14
#
# on Linux x86-64, Windows x64 and macOS with Apple's processors. The headers of the Pythons come from
# scripts/python_headers.sh; those for Windows and macOS go to build/windows and build/macos (scripts/cross_tools.sh).
# The same sources give the same bytes.
#
#   scripts/package.sh [--platform NAME]... [--pythons "3.11 3.12 3.13 3.14"] [--skip-missing] [--into FOLDER]
#     --platform      linux-x64, windows-x64 or macos-arm64 (default: all)
#     --pythons       the versions to compile for
#     --skip-missing  leave out a version whose headers cannot be had, and say so, instead of failing
#     --into FOLDER   default: dist
#     --help          prints this text
#
# What takes how long, in times of a first scripts/build.sh: linux-x64 takes the core and the module of this
# machine's Python from build/release, where scripts/build.sh made them, and compiles the bindings for each other
# version: 0.1 each. windows-x64 and macos-arm64 have compilers of their own, so they compile the core, too,
# once for all versions: 1, and 0.1 for each version; first they fetch and build their tools and libraries. What
# is compiled stays in build/, and the second time takes seconds.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

platforms=() pythons="3.11 3.12 3.13 3.14" skip_missing="" into=$root/dist
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
            echo 'usage: package.sh [--platform linux-x64|windows-x64|macos-arm64]... [--pythons "3.11 3.12 3.13 3.14"] [--skip-missing] [--into FOLDER]' >&2
            exit 2
            ;;
    esac
    shift
done
((${#platforms[@]} > 0)) || platforms=(linux-x64 windows-x64 macos-arm64)
if [[ $(uname -sm) != "Linux x86_64" ]]; then
    echo "package.sh: zips and wheels are made on Linux x86-64; this is $(uname -sm)" >&2
    exit 1
fi

declare -A tag_of=([linux-x64]=_x86_64 [windows-x64]=win_amd64 [macos-arm64]=_arm64)
# The interpreter of this machine.
python=/usr/bin/python3
[[ -x $python ]] || python=$(command -v python3)
version_here=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')

# These fill modules, configured (REALMODEL_PACKAGED_PYTHONS) and missing.
linux_x64() {
    # Builds the core, which is the same for all, and the module for the interpreter of this machine.
    "$root/scripts/build.sh" "$python"
    local version suffix headers
    for version in $pythons; do
        suffix=cpython-${version/./}-x86_64-linux-gnu.so
        if [[ $version == "$version_here" ]]; then
            modules+=("$root/addon/realmodel/_native.$suffix")
            continue
        fi
        if ! headers=$("$root/scripts/python_headers.sh" "$version"); then
            missing+=("$version")
            continue
        fi
        configured+="$suffix=$headers;"
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
    "$root/scripts/python_environment.sh" "$root/build/packaging" "$root/scripts/requirements/packaging.txt" "$python"
    "$root/build/packaging/bin/python" "$root/scripts/packaging/make_wheels.py" "$platform" "$into" "${modules[@]}"
    version=$(<"$root/VERSION")
    in_blender=() wheels=() # no Blender has Python 3.12
    for module in "${modules[@]}"; do
        if [[ $module =~ _native\.(cpython-|cp)(3[0-9]+)- && ${BASH_REMATCH[2]} != 312 ]]; then
            in_blender+=("$module")
            wheels+=("$into/realmodel-$version-cp${BASH_REMATCH[2]}"-*"${tag_of[$platform]}.whl")
        fi
    done
    "$root/build/packaging/bin/python" "$root/scripts/packaging/make_zip.py" "$platform" "$into" "${in_blender[@]}"
    "$root/build/packaging/bin/python" "$root/scripts/packaging/make_zip.py" "$platform" "$into" "${wheels[@]}"
done
