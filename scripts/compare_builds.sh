#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the native part in several ways and compares what each makes of a fixed set of stacks, meshes
# and interpolations: the bytes must be the same for either compiler, with and without optimisation,
# and for any number of threads.
#
#   scripts/compare_builds.sh [WAY]...      (default: release dev clang)
#     release   g++, optimised: what users run
#     dev       g++, not optimised, with assertions
#     clang     clang++, optimised
#     asan      clang++, little optimised, under AddressSanitizer and UndefinedBehaviorSanitizer
# The exit status is 1 where bytes differ.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

ways=("$@")
((${#ways[@]} > 0)) || ways=(release dev clang)
groups=(build)
[[ " ${ways[*]} " == *" clang "* ]] && groups+=(clang)
[[ " ${ways[*]} " == *" asan "* ]] && groups+=(tsan)
scripts/install_dependencies.sh "${groups[@]}"

folder=$root/build/digests
mkdir -p "$folder"
rm -f "$folder"/*.txt

for way in "${ways[@]}"; do
    case $way in
        release | dev | asan | clang) ;;
        *)
            echo "compare_builds.sh: no way '$way'; there are release, dev, clang, asan" >&2
            exit 2
            ;;
    esac
    cmake --preset "$way" --log-level=WARNING
    cmake --build "build/$way" --target build_digests -j 2
    for threads in 1 2 5; do
        "build/$way/native/build_digests" "$threads" >"$folder/$way, $threads threads.txt"
    done
done

status=0 first="$folder/${ways[0]}, 1 threads.txt"
for file in "$folder"/*.txt; do
    if ! cmp -s "$first" "$file"; then
        echo "differs: $(basename "$first" .txt) | $(basename "$file" .txt)"
        diff "$first" "$file" | head -n 20 || true
        status=1
    fi
done
((status != 0)) || echo "$(wc -l <"$first") results, the same bytes: $(cd "$folder" && printf '%s; ' *.txt | sed 's/\.txt//g; s/; $//')"
exit "$status"
