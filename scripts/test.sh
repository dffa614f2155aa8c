#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what the tests need, builds, and runs every test. The last line is
#   N passed, N failed, N skipped
# (a check that is no test, such as the format, counts as one failed where it fails); the exit status is
# 1 if anything failed. What each step printed is kept in build/test. Steps that use one processor run beside
# one another, and what they printed is shown when they have ended.
#
#   scripts/test.sh [--quick] [--only STEP]...
#     --quick       without the sanitizer build, and without the comparison of builds
#     --only STEP   only this step, and the build it needs:
#                   format ruff types shellcheck sizes site native cuda (compiled
#                   where nvcc is) core blender gui (a window under Xvfb) walk (random
#                   steps in it, random_walk.sh) bpy package asan builds; and three that are not run unless asked
#                   for: tidy tsan odr (check_odr.sh). Asked for
#                   alone, builds compares clang++'s optimised code too
#
# shellcheck disable=SC2317  # the functions are called by name, through step
set -uo pipefail # and not -e: one step that fails does not keep the others from running
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 1

all_steps=(format ruff types shellcheck sizes site native cuda core blender gui walk bpy package asan builds)
steps=("${all_steps[@]}")
only=()
while (($# > 0)); do
    case $1 in
        --quick) steps=(format ruff types shellcheck sizes site native cuda core blender gui walk bpy package) ;;
        --only)
            case ${2-} in
                format | ruff | types | shellcheck | sizes | site | native | cuda | core | blender | gui | walk | bpy | package | asan | builds | tidy | tsan | odr) only+=("$2") ;;
                *)
                    echo "test.sh: --only needs a step: ${all_steps[*]} tidy tsan odr" >&2
                    exit 2
                    ;;
            esac
            shift
            ;;
        *)
            echo "usage: test.sh [--quick] [--only STEP]..." >&2
            exit 2
            ;;
    esac
    shift
done
((${#only[@]} > 0)) && steps=("${only[@]}")
wants() { # STEP...
    local step
    for step in "$@"; do [[ " ${steps[*]} " == *" $step "* ]] && return 0; done
    return 1
}

logs=$root/build/test
mkdir -p "$logs"
unset PYTHONDONTWRITEBYTECODE # hundreds of interpreters would compile all modules again
# Steps are beside one another: threads that have nothing to do must not spin. The add-on sees to that itself but
# where OpenMP is loaded before it, as in Debian's Blender; the C++ tests do not.
export OMP_WAIT_POLICY=passive
# The interpreter inside Debian's Blender; the tests of the core run on the same version.
python=/usr/bin/python3
[[ -x $python ]] || python=$(command -v python3)
venv=$root/build/venv
venv_bpy=$root/build/venv-bpy

passed=0 failed=0 skipped=0 not_run=() failures=()
declare -A ended=() # the exit status of each step

count() { # NAME REPORT: adds its tests to the sums, and what failed to the list
    local counts p f s test
    if ! counts=$("$python" scripts/count_tests.py "$2"); then
        return 1
    fi
    read -r p f s <<<"$counts"
    ((passed += p, failed += f, skipped += s))
    while read -r test; do failures+=("$1: $test"); done < <(tail -n +2 <<<"$counts")
    echo "     $p passed, $f failed, $s skipped"
}

step() { # NAME COMMAND...: runs it and shows what it prints
    local name=$1 start=$SECONDS status=0
    shift
    echo "==== $name"
    [[ -z ${counted[$name]-} ]] || rm -f "${counted[$name]}"
    "$@" </dev/null > >(tee "$logs/$name.log") 2>&1 || status=$?
    wait "$!" # until tee has written all of it
    end_of "$name" "$status" $((SECONDS - start))
}

beside() { # [NAME FUNCTION]...: several steps, one on each processor; each is shown when it has ended
    if (($# == 2)); then
        step "$@" # shown while it runs
        return
    fi
    local -A running=() begun=()
    local pid status
    while (($# > 0 || ${#running[@]} > 0)); do
        if (($# > 0 && ${#running[@]} < $(nproc))); then
            [[ -z ${counted[$1]-} ]] || rm -f "${counted[$1]}"
            "$2" </dev/null >"$logs/$1.log" 2>&1 &
            running[$!]=$1 begun[$!]=$SECONDS
            shift 2
            continue
        fi
        status=0
        wait -n -p pid "${!running[@]}" || status=$?
        echo "==== ${running[$pid]}"
        cat "$logs/${running[$pid]}.log"
        end_of "${running[$pid]}" "$status" $((SECONDS - begun[$pid]))
        unset "running[$pid]"
    done
}
trap 'kill 0' INT # what runs in the background hears no Ctrl-C

end_of() { # NAME STATUS SECONDS: says how it ended, and counts it as failed if no test of its did
    local name=$1 status=$2 failed_before=$failed log=$logs/$1.log
    if [[ -n ${counted[$name]-} ]]; then
        count "$name" "${counted[$name]}" || ((status != 0)) || status=1
    fi
    if ((status != 0 && failed == failed_before)); then
        ((failed += 1))
        failures+=("$name: exit status $status; its output is in $log, and ends with"$'\n'"$(tail -n 5 "$log" | cut -c 1-200)")
    fi
    ended[$name]=$status
    if ((status == 0)); then
        echo "---- $name: $3 s"
    else
        echo "---- $name: FAILED, exit status $status, $3 s; its output is in $log"
    fi
}
declare -A counted=(
    [native]=$logs/release.xml [asan]=$logs/asan.xml [tsan]=$logs/tsan.xml [core]=$logs/core.xml
    [blender]=$logs/blender.log [gui]=$logs/gui.log [walk]=$logs/walk.log [bpy]=$logs/bpy.log [package]=$logs/package.xml)

skip() { # NAME WHY
    echo "==== $1"
    echo "SKIPPED $2"
    not_run+=("$1")
}

finish() {
    echo
    ((${#not_run[@]} == 0)) || echo "Not run: ${not_run[*]}"
    echo "All steps: $SECONDS s"
    ((${#failures[@]} == 0)) || printf 'FAILED %s\n' "${failures[@]}"
    local summary="$passed passed, $failed failed"
    ((skipped == 0)) || summary+=", $skipped skipped"
    echo "$summary"
    exit $((failed > 0))
}

install() { scripts/install_dependencies.sh build; }

install_more() { # what compiling does not need
    local groups=()
    wants format shellcheck && groups+=(test)
    wants core && groups+=(solvers)
    wants blender package && groups+=(blender)
    wants gui walk && groups+=(gui)
    wants bpy && groups+=(bpy)
    wants asan && groups+=(tsan)
    wants builds && groups+=(clang)
    wants tidy && groups+=(tidy)
    wants tsan && groups+=(tsan)
    ((${#groups[@]} == 0)) || scripts/install_dependencies.sh "${groups[@]}"
}

install_environment() { scripts/python_environment.sh "$venv" scripts/requirements/test.txt "$python"; }

install_bpy() { scripts/python_environment.sh "$venv_bpy" scripts/requirements/bpy.txt "$python"; }

build() { scripts/build.sh "$python"; }

cpp_files() { git ls-files -z --cached --others --exclude-standard '*.cpp' '*.hpp'; }

check_format() { cpp_files | xargs -0 clang-format --dry-run -Werror; }

check_ruff() { "$venv/bin/ruff" check . && "$venv/bin/ruff" format --check .; }

check_types() { "$venv/bin/mypy"; } # of core and distributed: pyproject.toml

check_site() { scripts/site.sh "$python"; } # no document that is lost, no link that leads nowhere

check_sizes() { "$python" scripts/check_sizes.py; } # no folder has outgrown its ceiling

check_shell() { shellcheck scripts/*.sh .ci/run; }

test_native() { # PRESET: it is configured
    GLIBC_TUNABLES=glibc.malloc.hugetlb=1 cmake --build "build/$1" -j 2 && # large pages: a tenth of clang++'s time
        ctest --preset "$1" -j 2 --output-junit "$logs/$1.xml" | grep -Ev '^ +Start +[0-9]+:'
}

test_sanitized() { cmake --preset "$1" --log-level=WARNING && test_native "$1"; }

check_cuda() { # compiled for two architectures: there is no GPU here to run it on
    local objects=build/cuda/native/cuda/CMakeFiles log=$logs/kernels.log
    cmake --preset cuda "-DPython_EXECUTABLE=$python" --log-level=WARNING || return
    rm -f "$objects"/realmodel_cuda.dir/device.cu.o # so that the compiler says again what each kernel takes
    cmake --build build/cuda --target realmodel_cuda realmodel_ptx _native_cuda -j 2 >"$log" 2>&1 || {
        cat "$log"
        return 1
    }
    "$python" scripts/check_kernels.py "$log" "$objects"/realmodel_ptx.dir/device.ptx
}

test_asan() { test_sanitized asan; }

check_tidy() {
    cmake --preset dev --log-level=WARNING &&
        git ls-files -z 'native/src/*.cpp' | xargs -0 -n 1 -P 2 clang-tidy --quiet -p build/dev --warnings-as-errors='*'
}

# A shell that starts this script in the background has it ignore Ctrl-C, which some tests send.
in_time() { timeout --kill-after=10 "$1" env --default-signal=INT "${@:2}"; } # LIMIT COMMAND...

test_core() { # on all processors; a test that hangs fails after ten minutes, and the others go on
    in_time 60m "$venv/bin/python" -m pytest tests/core --numprocesses "$(nproc)" --dist worksteal --timeout 600 \
        --junitxml="$logs/core.xml"
}

test_blender() { in_time 25m blender -b --factory-startup --python-exit-code 1 -P tests/blender/run.py; }

# A window without a screen, drawn in software; its screenshots are kept in build/gui.
test_gui() {
    mkdir -p build/gui
    in_time 25m xvfb-run -a -s "-screen 0 1280x800x24 -fbdir build/gui" blender --factory-startup \
        --enable-event-simulate --window-geometry 0 0 1280 800 -P tests/gui/run.py
}

test_walk() { in_time 25m scripts/random_walk.sh; }

test_bpy() { in_time 25m "$venv_bpy/bin/python" tests/blender/run.py; }

test_package() { # zip and wheels of the modules that can be made here, and the sources, installed as a user does
    in_time 15m scripts/package.sh --platform linux-x64 --skip-missing &&
        in_time 20m "$venv/bin/python" -m pytest tests/package --junitxml="$logs/package.xml"
}

step install install
((ended[install] == 0)) || finish
needed=()
wants native cuda core blender gui walk bpy && needed+=(build build)
needed+=(install-more install_more environment install_environment)
if wants bpy; then
    if "$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then
        needed+=(bpy-install install_bpy)
    else
        skip bpy "bpy 4.5 exists for Python 3.11 only; $python is $("$python" --version)"
    fi
fi
beside "${needed[@]}"
((ended[install-more] == 0 && ended[environment] == 0 && ${ended[build]-0} == 0)) || finish
wants native && step native test_native release
wants core && step core test_core
# What uses one processor, the longest first.
alone=()
wants blender && alone+=(blender test_blender)
((${ended[bpy-install]-1} != 0)) || alone+=(bpy test_bpy)
wants gui && alone+=(gui test_gui)
wants walk && alone+=(walk test_walk)
wants package && alone+=(package test_package)
if wants cuda; then
    if command -v nvcc >/dev/null; then
        alone+=(cuda check_cuda)
    else
        skip cuda "there is no nvcc here, and the tests do not install it"
    fi
fi
wants types && alone+=(types check_types)
wants site && alone+=(site check_site)
wants ruff && alone+=(ruff check_ruff)
wants format && alone+=(format check_format)
wants shellcheck && alone+=(shellcheck check_shell)
wants sizes && alone+=(sizes check_sizes)
wants asan && alone+=(asan test_asan) # uses all processors; begins when the first one has nothing else to do
beside "${alone[@]}"
if wants builds; then
    if command -v clang++ >/dev/null; then
        # the sanitizer build is clang++'s already
        ways=(release asan)
        ((${#only[@]} > 0)) && ways+=(clang)
        step builds scripts/compare_builds.sh "${ways[@]}"
    else
        skip builds "there is no clang++ here, and it could not be installed"
    fi
fi
wants tidy && step tidy check_tidy
wants tsan && step tsan test_sanitized tsan
wants odr && step odr scripts/check_odr.sh
finish
