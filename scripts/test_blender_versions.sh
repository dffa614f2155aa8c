#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the zip as a user does in every Blender that can be had here, makes a model with it, runs the
# tests of tests/blender on what was in the zip, and those of tests/gui where this Blender has a window (under
# Xvfb), and writes the table in docs/reference/compatibility.md.
#
#   Blender 3.4    Debian 12's own
#   Blender 4.3    Debian 13's, in a folder entered with chroot
#   Blender 4.5    the module bpy of PyPI
#   Blender 5.0    the module bpy of PyPI
#   Blender 5.2    Debian unstable's, in a folder entered with chroot
#
# The folders are made once and kept in ${XDG_CACHE_HOME:-~/.cache}/realmodel (4 GB). Needs root, for chroot.
#
#   scripts/test_blender_versions.sh [--zip FILE] [--native] [3.4|4.3|4.5|5.0|5.2]...     (default: all)
#     --zip FILE    this zip, instead of one made by scripts/package.sh
#     --native      with 5.2 also compile the native part and its tests with unstable's compiler and
#                   libraries, and run them (half an hour)
#
# shellcheck disable=SC2317  # functions are called by name
set -uo pipefail # and not -e: a version that fails does not keep the others from being tried
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/realmodel
results=$root/build/blender_versions
declare -A module_of=([4.5]=$root/build/venv-bpy [5.0]=$root/build/venv-bpy-5.0) # their Pythons

zip="" native="" versions=()
while (($# > 0)); do
    case $1 in
        --zip) zip=$(realpath "${2:?test_blender_versions.sh: --zip needs a file}") && shift ;;
        --native) native=yes ;;
        3.4 | 4.3 | 4.5 | 5.0 | 5.2) versions+=("$1") ;;
        *)
            echo "usage: test_blender_versions.sh [--zip FILE] [--native] [3.4|4.3|4.5|5.0|5.2]..." >&2
            exit 2
            ;;
    esac
    shift
done
((${#versions[@]} > 0)) || versions=(3.4 4.3 4.5 5.0 5.2)
if ((EUID != 0)); then
    echo "test_blender_versions.sh: only root may enter another system with chroot; run it as root" >&2
    exit 1
fi

wants() { [[ " ${versions[*]} " == *" $1 "* ]]; }

groups=()
wants 3.4 && groups+=(blender)
{ wants 3.4 || wants 4.3 || wants 5.2; } && groups+=(gui)
{ wants 4.5 || wants 5.0; } && groups+=(bpy)
{ wants 4.3 || wants 5.2; } && groups+=(versions)
"$root/scripts/install_dependencies.sh" build "${groups[@]}" || exit 1
if [[ -z $zip ]]; then
    "$root/scripts/package.sh" --platform linux-x64 --skip-missing || exit 1
    zip=$root/dist/realmodel-$(<"$root/VERSION")-linux-x64.zip
fi

# What is tried is what was in the zip: the tests stand beside it as they do in the repository.
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir -p "$stage/tree/addon" "$stage/users/nobody"
(cd "$root" && cp -R --parents VERSION build_model.py blend_samples tests/blender tests/gui tests/package tests/data "$stage/tree")
/usr/bin/python3 -m zipfile -e "$zip" "$stage/tree/addon" || exit 1
find "$stage/tree" -name __pycache__ -prune -exec rm -rf {} +
cp "$zip" "$stage/realmodel.zip"

# Commands run where a version of Blender lives; $stage is /stage there.
in_debian() { # SUITE COMMAND...
    "$root/scripts/debian_chroot.sh" run "$cache/debian-$1" --bind "$stage:/stage" \
        --bind "$root:/repository" "${@:2}"
}

background() { # VERSION USER SCRIPT ARGUMENT...: a script in this Blender, as the user whose home is users/USER
    local version=$1 user=$2 script=$3 limit=(timeout --kill-after=10 30m)
    local home=/stage/users/$user
    shift 3
    local blender=(blender -b --python-exit-code 1 -P "/stage/tree/$script" -- "$@")
    case $version in
        3.4 | 4.5 | 5.0)
            # Here /stage is another path.
            home=$stage/users/$user
            blender=("${blender[@]//\/stage\//$stage/}")
            [[ $version == 3.4 ]] || blender=("${module_of[$version]}/bin/python" "$stage/tree/$script" "${@//\/stage\//$stage/}")
            (cd "$stage" && env -u XDG_CONFIG_HOME -u BLENDER_USER_SCRIPTS HOME="$home" "${limit[@]}" "${blender[@]}")
            ;;
        4.3) in_debian trixie env HOME="$home" "${limit[@]}" "${blender[@]}" ;;
        5.2) in_debian sid env HOME="$home" "${limit[@]}" "${blender[@]}" ;;
    esac
}

prepare() { # VERSION
    local packages=(blender python3-numpy libegl1 libgl1 libglx-mesa0 libgl1-mesa-dri)
    case $1 in
        3.4) [[ $(blender --version) == "Blender 3.4"* ]] || echo "SKIPPED this system's Blender is another" ;;
        4.3) "$root/scripts/debian_chroot.sh" make trixie "$cache/debian-trixie" "${packages[@]}" ;;
        4.5) "$root/scripts/python_environment.sh" "${module_of[4.5]}" "$root/scripts/requirements/bpy.txt" /usr/bin/python3 ;;
        5.0) "$root/scripts/python_environment.sh" "${module_of[5.0]}" "$root/scripts/requirements/bpy-5.0.txt" /usr/bin/python3 ;;
        5.2)
            # Blender's own scripts want two packages more there than it depends on.
            "$root/scripts/debian_chroot.sh" make sid "$cache/debian-sid" "${packages[@]}" python3-cattr python3-requests
            ;;
    esac
}

validate() { # VERSION
    local suite=trixie
    [[ $1 == 5.2 ]] && suite=sid
    in_debian "$suite" env HOME="/stage/users/$1" blender --command extension validate /stage/realmodel.zip
}

install_zip() { # VERSION
    local suite=trixie
    [[ $1 == 5.2 ]] && suite=sid
    case $1 in
        3.4 | 4.5 | 5.0) background "$1" "$1" tests/package/as_user/install.py /stage/realmodel.zip ;;
        *) in_debian "$suite" env HOME="/stage/users/$1" blender --command extension install-file -r user_default -e /stage/realmodel.zip ;;
    esac
}

walk() { background "$1" "$1" tests/package/as_user/walk.py "/stage/users/$1/walk"; } # VERSION

suite() { background "$1" nobody tests/blender/run.py; } # VERSION: by a user who has not installed it

window() { # VERSION: what a person does in its window, under Xvfb, drawn by the processor
    local version=$1 home=/stage/users/nobody folder=$stage/users/$1/window
    local blender=(blender --factory-startup --enable-event-simulate --window-geometry 0 0 1280 800)
    [[ $version != 5.2 ]] || blender+=(--gpu-backend opengl)
    blender+=(-P /stage/tree/tests/gui/run.py -- "/stage/users/$version/window")
    mkdir -p "$folder"
    local entered=("$root/scripts/debian_chroot.sh" run "$cache/debian-trixie" --bind "$stage:/stage")
    case $version in
        3.4) entered=() home=$stage/users/nobody blender=("${blender[@]//\/stage\//$stage/}") ;;
        5.2) entered[2]=$cache/debian-sid ;;
    esac
    # shellcheck disable=SC2016  # it is the shell of xvfb-run that knows the display
    xvfb-run -a -s "-screen 0 1280x800x24 -ac -fbdir $folder" bash -c 'n=$1 && shift
        exec "${@:1:n}" env DISPLAY="$DISPLAY" "${@:n + 1}"' window "${#entered[@]}" "${entered[@]}" \
        HOME="$home" XDG_RUNTIME_DIR=/tmp LIBGL_ALWAYS_SOFTWARE=1 timeout --kill-after=10 30m "${blender[@]}"
}

without_native() { # VERSION
    find "$stage/users/$1" -path '*/realmodel/_native*' -delete
    background "$1" "$1" tests/package/as_user/without_native.py
}

compile() { # VERSION
    local packages=(g++ cmake ninja-build python3-dev pybind11-dev libcgal-dev libeigen3-dev libnanoflann-dev libgmp-dev libgtest-dev)
    "$root/scripts/debian_chroot.sh" make sid "$cache/debian-sid" "${packages[@]}" || return 1
    mkdir -p "$cache/build-sid"
    # shellcheck disable=SC2016  # it is the shell in there that fills in these variables
    "$root/scripts/debian_chroot.sh" run "$cache/debian-sid" --bind "$root:/repository" --bind "$cache/build-sid:/build" bash -c '
        g++ --version | head -n 1
        include=$(python3 -c "import sysconfig; print(sysconfig.get_path(\"include\"))")
        cmake -S /repository -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release --log-level=WARNING \
            "-DREALMODEL_PACKAGED_PYTHONS=sid.so=$include" &&
            cmake --build /build -j "$1" --target realmodel_tests stack_fuzzer build_digests packaged_modules &&
            ctest --test-dir /build -j 2 --output-on-failure' compile "$("$root/scripts/build_jobs.sh")"
}

failed=0
step() { # VERSION NAME COMMAND...: runs it, keeps its output, notes how it went
    local version=$1 name=$2 log=$results/$1/$2.log status=0
    shift 2
    "$@" "$version" </dev/null >"$log" 2>&1 || status=$?
    echo "$status" >"$results/$version/$name.status"
    if ((status == 0)); then
        echo "  $name: passed"
    else
        echo "  $name: FAILED, exit status $status; its output is in $log:"
        tail -n 15 "$log" | sed 's/^/    /'
        ((failed += 1))
    fi
    return "$status"
}

for version in "${versions[@]}"; do
    echo "Blender $version"
    rm -rf "${results:?}/$version"
    mkdir -p "$results/$version" "$stage/users/$version/walk"
    step "$version" prepare prepare || continue
    if grep -q ^SKIPPED "$results/$version/prepare.log"; then
        cat "$results/$version/prepare.log"
        rm -rf "${results:?}/$version"
        continue
    fi
    if [[ $version == 4.3 || $version == 5.2 ]]; then step "$version" validate validate; fi
    if step "$version" install install_zip; then
        step "$version" walk walk
        cp "$stage/users/$version/walk/"*.{json,png} "$results/$version/" 2>/dev/null
        step "$version" without_native without_native
    fi
    step "$version" suite suite
    if [[ $version == 3.4 || $version == 4.3 || $version == 5.2 ]]; then
        step "$version" window window
        cp "$stage/users/$version/window/contact_sheet.png" "$results/$version/" 2>/dev/null
    fi
    if [[ $version == 5.2 && -n $native ]]; then step "$version" compile compile; fi
done
/usr/bin/python3 "$root/scripts/packaging/compatibility_page.py" "$results" "$root/docs/reference/compatibility.md" || exit 1
((failed == 0))
