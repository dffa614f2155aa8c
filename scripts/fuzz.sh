#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Hunts for stacks of surfaces that the builder gets wrong, for as long as asked. Findings are made
# small and lie in build/findings; copied to tests/data/stacks, the tests judge them from then on.
#
#   scripts/fuzz.sh SECONDS [SEED] [--coverage | --python | --booleans | --structures | --folds | --allocations]
#     SEED         a whole number; the stacks of a seed are always the same (default: the time)
#     --coverage   guided by what the stacks reach in the code: clang++'s libFuzzer, under
#                  AddressSanitizer and UndefinedBehaviorSanitizer
#     --python     the tests' own generators and judge, which also asks the closed form at places
#                  taken at random; slower
#     --booleans   pairs of surfaces that are intersected; findings belong in tests/data/booleans
#     --structures models with faults and bodies; findings belong in tests/data/structures
#     --folds      models with series of folds; findings belong in tests/data/folds
#     --allocations  small builds of each kind while allocations fail; it says which
# The exit status is 1 where something was found.
#
# shellcheck disable=SC2317  # functions are called by name
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

usage() {
    echo "usage: fuzz.sh SECONDS [SEED] [--coverage | --python | --booleans | --structures | --folds | --allocations]" >&2
    exit 2
}
way=native numbers=()
while (($# > 0)); do
    case $1 in
        --coverage | --python | --booleans | --structures | --folds | --allocations) way=${1#--} ;;
        *[!0-9]* | '') usage ;;
        *) numbers+=("$1") ;;
    esac
    shift
done
((${#numbers[@]} == 1 || ${#numbers[@]} == 2)) || usage
seconds=${numbers[0]} seed=${numbers[1]:-$(date +%s)}

findings=$root/build/findings
mkdir -p "$findings"
processors=$(nproc)

# Calls COMMAND SEED for every processor, each with a seed of its own. 1 where one of them fails.
on_all_processors() { # COMMAND
    local i status=0 running=()
    for ((i = 0; i < processors; ++i)); do
        "$1" $((seed + i)) &
        running+=($!)
    done
    for i in "${running[@]}"; do wait "$i" || status=1; done
    return "$status"
}

native() { # SEED
    build/release/native/stack_fuzzer --seconds "$seconds" --seed "$1" \
        --corpus tests/data/stacks --into "$findings"
}

booleans() { # SEED
    build/release/native/boolean_fuzzer --seconds "$seconds" --seed "$1" \
        --corpus tests/data/booleans --into "$findings"
}

allocations() { # SEED
    build/release/native/allocation_fuzzer --seconds "$seconds" --seed $((1000 * $1))
}

python() { # SEED
    PYTHONPATH=addon build/venv/bin/python -m tests.core.stacks.hunt "$seconds" "$1" --into "$findings"
}

structures() { # SEED
    PYTHONPATH=addon build/venv/bin/python -m tests.core.faulted.hunt "$seconds" "$1" \
        --every "$processors" --into "$findings"
}

folds() { # SEED
    PYTHONPATH=addon build/venv/bin/python -m tests.core.faulted.hunt "$seconds" "$1" \
        --every "$processors" --into "$findings" --folds
}

coverage() { # SEED
    mkdir -p build/reached
    REALMODEL_FUZZ_CORPUS=tests/data/stacks REALMODEL_FUZZ_INTO=$findings \
        build/fuzz/native/coverage_fuzzer -seed="$1" -max_total_time="$seconds" -max_len=4096 -len_control=0 \
        -timeout=60 -rss_limit_mb=4096 -verbosity=0 -print_final_stats=1 \
        -artifact_prefix="$findings/" build/reached
}

case $way in
    native | booleans | allocations)
        scripts/install_dependencies.sh build
        cmake --preset release --log-level=WARNING
        cmake --build build/release --target stack_fuzzer boolean_fuzzer allocation_fuzzer -j 2
        ;;
    python | structures | folds)
        scripts/build.sh /usr/bin/python3
        scripts/python_environment.sh build/venv scripts/requirements/test.txt /usr/bin/python3
        ;;
    coverage)
        scripts/install_dependencies.sh build tsan
        cmake --preset fuzz --log-level=WARNING
        cmake --build build/fuzz --target coverage_fuzzer stack_fuzzer -j 2
        ;;
esac
echo "Fuzzing for $seconds s on $processors processors, seeds from $seed; findings go to $findings"
status=0
on_all_processors "$way" || status=1
if ((status != 0)); then
    echo "Something was found: see above, and the .json files in $findings"
fi
exit "$status"
