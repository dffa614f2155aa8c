#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Looks for two types, functions or variables of one name (C++'s one definition rule): the native part and
# the fuzzer are compiled for link-time optimization by g++, and all objects are linked into one, which
# compares what they define. Nothing is run.
#
#   scripts/check_odr.sh
# The exit status is 1 where something was found.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if (($# > 0)); then
    echo "usage: check_odr.sh" >&2
    exit 2
fi
cd "$root"
scripts/install_dependencies.sh build
cmake --preset odr --log-level=WARNING
cmake --build build/odr --target realmodel realmodel_fuzzing -j "$(scripts/build_jobs.sh)"

mapfile -d '' -t objects < <(find build/odr/native/CMakeFiles/realmodel{,_fuzzing}.dir -name '*.o' -print0)
# One partition: divided, g++ 12 fails with an internal error.
if ! g++ -r -flto -flto-partition=one -flinker-output=nolto-rel -Wodr -Wlto-type-mismatch -Werror \
    "${objects[@]}" -o build/odr/all.o; then
    echo "check_odr.sh: something is defined in two ways, see above" >&2
    exit 1
fi
echo "${#objects[@]} objects, no name defined in two ways"
