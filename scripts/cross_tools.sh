#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs a compiler for another system (mingw-w64; for macOS clang from PyPI's ziglang) and fills build/windows or
# build/macos, where the preset of PLATFORM looks for what is not of the compiler: the headers of CGAL, Boost, MPFR and
# nanoflann, which are the same for all systems, and GMP, which Debian does not have for them, compiled from Debian's source.
# What is there is left as it is.
#
#   scripts/cross_tools.sh PLATFORM [VERSION...]   PLATFORM: windows-x64 or macos-arm64
#                                                  VERSION: e.g. 3.11, of Python; what modules for it need goes to
#                                                  build/windows/python3.11 or build/macos/python3.11
#                                                  (scripts/python_headers.sh). tests: GoogleTest, for Windows
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
platform=${1-}
shift || true
tools=$root/build/${platform%-*}
jobs=$("$root/scripts/build_jobs.sh")

case $platform in
    windows-x64)
        "$root/scripts/install_dependencies.sh" build windows
        for_gmp=(--host=x86_64-w64-mingw32 CC=x86_64-w64-mingw32-gcc-posix CXX=x86_64-w64-mingw32-g++-posix)
        ;;
    macos-arm64)
        "$root/scripts/install_dependencies.sh" build macos
        "$root/scripts/python_environment.sh" "$tools/zig" "$root/scripts/requirements/macos.txt" /usr/bin/python3
        # Named as what they do, since ccache and CMake go by names.
        mkdir -p "$tools/bin"
        zig=$(echo "$tools"/zig/lib/python3*/site-packages/ziglang/zig)
        while read -r name command; do
            printf '#!/bin/sh\nexec %q %s "$@"\n' "$zig" "$command" >"$tools/bin/$name.part"
            chmod +x "$tools/bin/$name.part"
            cmp -s "$tools/bin/$name.part" "$tools/bin/$name" || cp -p "$tools/bin/$name.part" "$tools/bin/$name"
            rm "$tools/bin/$name.part"
        done <<'END'
clang cc -target aarch64-macos.11.0
clang++ c++ -target aarch64-macos.11.0
ar ar
ranlib ranlib
END
        # Its assembler is for other tools.
        for_gmp=(--host=aarch64-apple-darwin --disable-assembly CC_FOR_BUILD=gcc "CC=$tools/bin/clang" "CXX=$tools/bin/clang++"
            "CFLAGS=-O2 -fvisibility=hidden" "CXXFLAGS=-O2 -fvisibility=hidden" "AR=$tools/bin/ar" "RANLIB=$tools/bin/ranlib")
        ;;
    *)
        echo "usage: cross_tools.sh windows-x64|macos-arm64 [VERSION|tests]..." >&2
        exit 2
        ;;
esac
mkdir -p "$tools/root/include"
# Links, since /usr/include itself must not be searched.
for name in boost CGAL mpfr.h nanoflann.hpp; do
    ln -sfn "/usr/include/$name" "$tools/root/include/$name"
done

gmp() {
    "$root/scripts/foreign_packages.sh" --source bookworm "$tools/gmp" gmp
    cd "$tools/gmp"
    mkdir -p doc # Debian leaves it out, as its license is not free; the configuration wants it
    printf 'all install:\n' >doc/Makefile.in
    ./configure --build="$(gcc -dumpmachine)" "${for_gmp[@]}" \
        --enable-cxx --enable-static --disable-shared --prefix="$tools/root" --quiet >configure.log 2>&1
    make --silent -j "$jobs" >make.log 2>&1
    make --silent install >install.log 2>&1
}
[[ -f $tools/root/lib/libgmpxx.a ]] || (gmp) || {
    echo "cross_tools.sh: GMP cannot be compiled; see the logs in $tools/gmp" >&2
    exit 1
}

# The headers of Python are the same for all systems but for the configuration.
python() { # VERSION
    local version=$1 headers folder=$tools/python$1
    headers=$("$root/scripts/python_headers.sh" "$version") || return 1
    rm -rf "$folder.part"
    mkdir "$folder.part"
    cp -R "${headers%%:*}" "$folder.part/include"
    "configuration_of_${platform%-*}" "$version" "${headers##*:}" "$folder.part" || return 1
    mv "$folder.part" "$folder"
}

# That of 3.13 does for the others: what it says of this compiler and these processors has not changed, and it is the
# first that knows mingw-w64. The library of names is made from the headers, so that it takes no Python for Windows.
configuration_of_windows() { # VERSION HEADERS FOLDER
    local folder=$3 name=python${1/./}
    "$root/scripts/foreign_packages.sh" --source trixie "$tools/python-source" python3.13 || return 1
    cp "$tools/python-source/PC/pyconfig.h.in" "$folder/include/pyconfig.h"
    {
        echo "LIBRARY $name.dll"
        echo EXPORTS
        find "$folder/include" -name '*.h' -exec cat {} + |
            perl -0777 -ne 'while (/PyAPI_(FUNC|DATA)\s*\([^()]*\)\s*(?:\(\*)?\s*(_*Py\w+)/g) {
                print $2, $1 eq "DATA" ? " DATA" : "", "\n" }' | sort -u
    } >"$folder/$name.def"
    x86_64-w64-mingw32-dlltool --input-def "$folder/$name.def" --output-lib "$folder/lib$name.dll.a"
}

# Of what Linux's says the headers ask for what is the same on macOS, and for sizes, which pymacconfig.h puts right.
# Debian's is one that includes that of the processor.
configuration_of_macos() { # VERSION HEADERS FOLDER
    [[ ! -f $2/x86_64-linux-gnu/python$1/pyconfig.h ]] || cp "$2/x86_64-linux-gnu/python$1/pyconfig.h" "$3/include/pyconfig.h"
    echo '#define _DARWIN_C_SOURCE 1' >>"$3/include/pyconfig.h"
}

google_test() {
    cmake -S /usr/src/googletest -B "$tools/googletest" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_GMOCK=OFF \
        -DCMAKE_TOOLCHAIN_FILE="$root/native/cmake/$platform.cmake" -DCMAKE_INSTALL_PREFIX="$tools/root" --log-level=ERROR
    cmake --build "$tools/googletest" -j "$jobs" --target install >"$tools/googletest.log" 2>&1
}

for wanted in "$@"; do
    case $wanted in
        tests) [[ -f $tools/root/lib/libgtest.a ]] || google_test ;;
        *)
            [[ -d $tools/python$wanted ]] || python "$wanted" || {
                echo "cross_tools.sh: the headers of Python $wanted for $platform cannot be had (reason above)" >&2
                exit 1
            }
            ;;
    esac
done
