#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the zip that users install: dist/realmodel-VERSION-linux-x64.zip, for Blender 3.4 to 5.2 on
# Linux x86-64. It holds one native module for each version of Python that a Blender comes with; the
# headers that these need are taken from Debian, whichever release has them, and kept in
# ${XDG_CACHE_HOME:-~/.cache}/realmodel. The same sources give the same bytes.
#
#   scripts/package.sh [--pythons "3.11 3.13 3.14"] [--skip-missing] [--into FOLDER]
#     --pythons       the versions to compile for
#     --skip-missing  leave out a version whose headers cannot be had, and say so, instead of failing
#     --into FOLDER   default: dist
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/realmodel

pythons="3.11 3.13 3.14" skip_missing="" into=$root/dist
while (($# > 0)); do
    case $1 in
        --pythons) pythons=${2:?package.sh: --pythons needs versions} && shift ;;
        --skip-missing) skip_missing=yes ;;
        --into) into=${2:?package.sh: --into needs a folder} && shift ;;
        *)
            echo 'usage: package.sh [--pythons "3.11 3.13 3.14"] [--skip-missing] [--into FOLDER]' >&2
            exit 2
            ;;
    esac
    shift
done
if [[ $(uname -sm) != "Linux x86_64" ]]; then
    echo "package.sh: the zip is for Linux x86-64; this is $(uname -sm)" >&2
    exit 1
fi

# Builds the core, which is the same for all, and the module for the interpreter of this machine.
python=/usr/bin/python3
[[ -x $python ]] || python=$(command -v python3)
"$root/scripts/build.sh" "$python"
version_here=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')

# The oldest release of Debian that has a version of Python.
declare -A suite_of=([3.11]=bookworm [3.13]=trixie [3.14]=sid)
modules=() configured="" missing=()
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
    (cd "$root" && cmake --preset release "-DREALMODEL_PACKAGED_PYTHONS=${configured%;}" --log-level=WARNING)
    cmake --build "$root/build/release" --target packaged_modules -j "$("$root/scripts/build_jobs.sh")"
fi
"$root/build/tools/bin/python" "$root/scripts/packaging/make_zip.py" "$into" "${modules[@]}"
