#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs mingw-w64 and fills build/windows/root, where the preset windows-x64 looks for what is not of the
# compiler: the headers of CGAL, Boost, MPFR and nanoflann, which are the same for all systems, and GMP, which Debian
# does not have for mingw-w64, compiled from Debian's source. What is there is left as it is.
#
#   scripts/windows_tools.sh [VERSION...]      VERSION: e.g. 3.11, of Python; its headers and a library of its
#                                              names go to build/windows/python3.11, through
#                                              ${XDG_CACHE_HOME:-~/.cache}/realmodel. tests: GoogleTest
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
windows=$root/build/windows
cache=${XDG_CACHE_HOME:-$HOME/.cache}/realmodel
compiler=x86_64-w64-mingw32

"$root/scripts/install_dependencies.sh" build windows
mkdir -p "$windows/root/include"
# Links, since /usr/include itself must not be searched.
for name in boost CGAL mpfr.h nanoflann.hpp; do
    ln -sfn "/usr/include/$name" "$windows/root/include/$name"
done

gmp() {
    "$root/scripts/foreign_packages.sh" --source bookworm "$windows/gmp" gmp
    cd "$windows/gmp"
    mkdir -p doc # Debian leaves it out, as its license is not free; the configuration wants it
    printf 'all install:\n' >doc/Makefile.in
    ./configure --build="$(gcc -dumpmachine)" --host="$compiler" CC="$compiler-gcc-posix" CXX="$compiler-g++-posix" \
        --enable-cxx --enable-static --disable-shared --prefix="$windows/root" --quiet >configure.log
    make --silent -j "$("$root/scripts/build_jobs.sh")" >make.log 2>&1
    make --silent install >install.log 2>&1
}
[[ -f $windows/root/lib/libgmpxx.a ]] || (gmp) || {
    echo "windows_tools.sh: GMP cannot be compiled; see the logs in $windows/gmp" >&2
    exit 1
}

python() { # VERSION
    # The oldest release of Debian that has it.
    local -A suite_of=([3.11]=bookworm [3.13]=trixie [3.14]=sid)
    local version=$1 headers=$cache/python$1-headers folder=$windows/python$1 name=python${1/./}
    if [[ -z ${suite_of[$version]-} ]]; then
        echo "windows_tools.sh: it is not known which release of Debian has Python $version" >&2
        return 2
    fi
    # The headers are the same for all systems but for the configuration. That of 3.13 does for the others: what
    # it says of this compiler and these processors has not changed, and it is the first that knows mingw-w64.
    "$root/scripts/foreign_packages.sh" "${suite_of[$version]}" "$headers" "libpython$version-dev" || return 1
    "$root/scripts/foreign_packages.sh" --source trixie "$windows/python-source" python3.13 || return 1
    rm -rf "$folder.part"
    mkdir "$folder.part"
    cp -R "$headers/usr/include/python$version" "$folder.part/include"
    cp "$windows/python-source/PC/pyconfig.h.in" "$folder.part/include/pyconfig.h"
    # The library of names is made from the headers, so that it takes no Python for Windows.
    {
        echo "LIBRARY $name.dll"
        echo EXPORTS
        find "$folder.part/include" -name '*.h' -exec cat {} + |
            perl -0777 -ne 'while (/PyAPI_(FUNC|DATA)\s*\([^()]*\)\s*(?:\(\*)?\s*(_*Py\w+)/g) {
                print $2, $1 eq "DATA" ? " DATA" : "", "\n" }' | sort -u
    } >"$folder.part/$name.def"
    "$compiler-dlltool" --input-def "$folder.part/$name.def" --output-lib "$folder.part/lib$name.dll.a"
    mv "$folder.part" "$folder"
}

google_test() {
    cmake -S /usr/src/googletest -B "$windows/googletest" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_GMOCK=OFF \
        -DCMAKE_TOOLCHAIN_FILE="$root/native/cmake/windows-x64.cmake" -DCMAKE_INSTALL_PREFIX="$windows/root" --log-level=ERROR
    cmake --build "$windows/googletest" -j "$("$root/scripts/build_jobs.sh")" --target install >"$windows/googletest.log" 2>&1
}

for wanted in "$@"; do
    case $wanted in
        tests) [[ -f $windows/root/lib/libgtest.a ]] || google_test ;;
        *)
            [[ -d $windows/python$wanted ]] || python "$wanted" || {
                echo "windows_tools.sh: the headers of Python $wanted for Windows cannot be had (reason above)" >&2
                exit 1
            }
            ;;
    esac
done
