#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Looks for errors of memory, undefined behavior and races: the C++ tests, the stacks of the corpus and
# made ones, under AddressSanitizer with UndefinedBehaviorSanitizer and under ThreadSanitizer
# (clang++, whose OpenMP archer explains to the latter). Every step ends in time.
#
#   scripts/sanitize.sh [asan|tsan]... [--seconds S] [--seed K]
#     asan, tsan    only these
#     --seconds S   made stacks for so long under each (default 120)
#     --seed K      which ones (default: the time)
# The exit status is 1 where something was found.
set -uo pipefail # and not -e: one step that fails does not keep the others from running
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 1

presets=() seconds=120 seed=$(date +%s)
while (($# > 0)); do
    case $1 in
        asan | tsan) presets+=("$1") ;;
        --seconds | --seed)
            if [[ ! ${2-} =~ ^[0-9]+$ ]]; then
                echo "sanitize.sh: $1 needs a whole number" >&2
                exit 2
            fi
            [[ $1 == --seconds ]] && seconds=$2 || seed=$2
            shift
            ;;
        *)
            echo "usage: sanitize.sh [asan|tsan]... [--seconds S] [--seed K]" >&2
            exit 2
            ;;
    esac
    shift
done
((${#presets[@]} > 0)) || presets=(asan tsan)

status=0
step() { # LIMIT WHAT COMMAND...
    local limit=$1 what=$2 start=$SECONDS
    shift 2
    echo "==== $what"
    if timeout --kill-after=10 "$limit" "$@"; then
        echo "---- $what: $((SECONDS - start)) s"
    else
        echo "---- $what: FAILED, $((SECONDS - start)) s"
        status=1
    fi
}

findings=$root/build/findings
mkdir -p "$findings"
scripts/install_dependencies.sh build tsan || exit 1

for preset in "${presets[@]}"; do
    step 1m "$preset: configure" cmake --preset "$preset" --log-level=WARNING
    step 45m "$preset: build" cmake --build "build/$preset" -j 2
    step 20m "$preset: tests" ctest --preset "$preset" -j 2
    environment=()
    if [[ $preset == tsan ]]; then
        # as ctest sets them: archer reports OpenMP's synchronization
        archer=$(sed -n 's/^ARCHER_LIBRARY:FILEPATH=//p' build/tsan/CMakeCache.txt)
        environment=("OMP_TOOL_LIBRARIES=$archer" "TSAN_OPTIONS=ignore_noninstrumented_modules=1 halt_on_error=1")
    fi
    step $((seconds + 300)) "$preset: made stacks, seed $seed" env "${environment[@]}" \
        "build/$preset/native/stack_fuzzer" --seconds "$seconds" --seed "$seed" --threads 2,4 \
        --patience 280 --corpus tests/data/stacks --into "$findings"
done
((status == 0)) && echo "Nothing was found." || echo "Something was found: see above, and $findings"
exit "$status"
