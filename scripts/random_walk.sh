#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Random steps in a window under Xvfb (tests/gui/random_walk.py): of this system's Blender and, where it is there, of
# the newest, Debian unstable's, in the folder that scripts/test_blender_versions.sh 5.2 makes. The last line is
#   N passed, N failed, N skipped
#
#   scripts/random_walk.sh [STEPS [SEED]]       (default: 200 steps, seed 1)
#
# REALMODEL_NEWEST is the folder of the newest Blender, if it is another one.
set -uo pipefail # and not -e: a walk that fails does not keep the other from being made
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
steps=${1-200} seed=${2-1}
newest=${REALMODEL_NEWEST-${XDG_CACHE_HOME:-$HOME/.cache}/realmodel/debian-sid}
blender=(blender --factory-startup --enable-event-simulate --window-geometry 0 0 800 600)
passed=0 failed=0 skipped=0

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT

walk() { # FOLDER COMMAND...: in a screen of its own; FOLDER keeps what Blender wrote
    local folder=$1 status=0
    shift
    mkdir -p "$folder"
    # shellcheck disable=SC2016  # it is the shell of xvfb-run that knows the display
    xvfb-run -a -s "-screen 0 800x600x24 -ac" bash -c 'exec "${@/DISPLAY_OF_XVFB/$DISPLAY}"' walk "$@" || status=$?
    if ((status == 0)); then
        ((passed += 1))
    else
        ((failed += 1))
        echo "FAILED: exit status $status; the last lines of $folder/walk.log:"
        tail -n 20 "$folder/walk.log"
    fi
}

skip() {
    echo "SKIPPED the walk in the newest Blender: $1"
    ((skipped += 1))
}

module_of_newest() { # VERSION: compiles the module for a version of Python, into the add-on in $stage
    local suffix=cpython-${1/./}-x86_64-linux-gnu.so headers
    headers=$("$root/scripts/python_headers.sh" "$1") || return 1
    (cd "$root" && cmake --preset release -B build/newest -DREALMODEL_BUILD_TESTS=OFF \
        "-DREALMODEL_PACKAGED_PYTHONS=$suffix=$headers" --log-level=WARNING) &&
        cmake --build "$root/build/newest" --target packaged_modules -j "$("$root/scripts/build_jobs.sh")" >&2 &&
        cp "$root/build/newest/packaged_modules/_native.$suffix" "$stage/addon/realmodel"
}

walk "$root/build/gui/walk" "${blender[@]}" -P "$root/tests/gui/random_walk.py" -- "$root/build/gui/walk" "$steps" "$seed"
if [[ ! -d $newest ]]; then
    skip "$newest is not there; as root, scripts/test_blender_versions.sh 5.2 makes it"
elif ((EUID != 0)); then
    skip "only root may enter $newest"
else
    (cd "$root" && cp -R --parents addon tests/gui blend_samples VERSION "$stage")
    pythons=("$newest"/usr/lib/python3.[0-9]*)
    if module_of_newest "${pythons[-1]##*python}"; then
        walk "$stage/walk" "$root/scripts/debian_chroot.sh" run "$newest" --bind "$stage:/stage" \
            env DISPLAY=DISPLAY_OF_XVFB HOME=/stage XDG_RUNTIME_DIR=/tmp LIBGL_ALWAYS_SOFTWARE=1 \
            "${blender[@]}" --gpu-backend opengl -P /stage/tests/gui/random_walk.py -- /stage/walk "$steps" "$seed"
    else
        skip "the module for its Python cannot be compiled (reason above)"
    fi
fi
echo "$passed passed, $failed failed, $skipped skipped"
((failed == 0))
