#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Another release of Debian in a folder, for programs that this one does not have. Needs root.
#
#   scripts/debian_chroot.sh make SUITE FOLDER PACKAGE...
#       Debian SUITE with these packages; in a folder that is there, only what is missing is installed.
#   scripts/debian_chroot.sh run FOLDER [--bind OUTSIDE:INSIDE]... COMMAND...
#       Runs a command in it, as root, with folders of this system where they are wanted.
#
# What is mounted is mounted for this process and its children only, so that nothing stays mounted
# however it ends.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

fail() {
    echo "debian_chroot.sh: $1" >&2
    exit "${2-1}"
}

usage() {
    fail "usage: debian_chroot.sh make SUITE FOLDER PACKAGE... | run FOLDER [--bind OUTSIDE:INSIDE]... COMMAND..." 2
}

((EUID == 0)) || fail "only root may enter another system with chroot"
if [[ ${REALMODEL_OWN_MOUNTS-} != yes ]]; then
    REALMODEL_OWN_MOUNTS=yes exec unshare --mount --propagation private "${BASH_SOURCE[0]}" "$@"
fi
unset REALMODEL_OWN_MOUNTS

mount_system() { # FOLDER
    mount -t proc proc "$1/proc"
    mount --rbind /sys "$1/sys"
    mount --rbind /dev "$1/dev"
}

enter() { # FOLDER COMMAND...: with nothing of this system's environment but the way to the network
    local folder=$1 kept=()
    shift
    local name
    for name in http_proxy https_proxy no_proxy; do
        [[ -z ${!name-} ]] || kept+=("$name=${!name}")
    done
    env -i "${kept[@]}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
        HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$folder" "$@"
}

make() { # SUITE FOLDER PACKAGE...
    local suite=$1 folder=$2 unfinished=$2.unfinished package missing=()
    shift 2
    if [[ ! -d $folder ]]; then
        command -v debootstrap >/dev/null || fail "debootstrap is missing: scripts/install_dependencies.sh versions"
        rm -rf --one-file-system "$unfinished"
        mkdir -p "$(dirname "$folder")"
        debootstrap --variant=minbase "$suite" "$unfinished" "$("$here/foreign_packages.sh" --mirror)" ||
            fail "Debian $suite cannot be had (reason above)"
        # No service of the other system is ever started.
        printf '#!/bin/sh\nexit 101\n' >"$unfinished/usr/sbin/policy-rc.d"
        chmod +x "$unfinished/usr/sbin/policy-rc.d"
        ln -sf /proc/self/mounts "$unfinished/etc/mtab"
        mv "$unfinished" "$folder"
    fi
    for package in "$@"; do
        # shellcheck disable=SC2016  # the field's name is dpkg's
        [[ $(chroot "$folder" dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null) == ii* ]] ||
            missing+=("$package")
    done
    ((${#missing[@]} > 0)) || return 0
    mount_system "$folder"
    cp --dereference /etc/resolv.conf /etc/hosts "$folder/etc/"
    local apt=(apt-get -qq -o Acquire::Retries=3 -o Acquire::Check-Valid-Until=false -o Acquire::Languages=none)
    enter "$folder" "${apt[@]}" update
    enter "$folder" "${apt[@]}" -o DPkg::Options::=--force-unsafe-io install -y --no-install-recommends "${missing[@]}" ||
        fail "$suite: these packages cannot be installed: ${missing[*]}"
    enter "$folder" apt-get clean
}

run() { # FOLDER [--bind OUTSIDE:INSIDE]... COMMAND...
    local folder=$1 outside inside
    shift
    [[ -d $folder ]] || fail "$folder is not there: debian_chroot.sh make"
    mount_system "$folder"
    while [[ ${1-} == --bind ]]; do
        outside=${2%%:*} inside=$folder/${2#*:}
        mkdir -p "$inside"
        mount --bind "$outside" "$inside"
        shift 2
    done
    enter "$folder" "$@"
}

case ${1-} in
    make)
        (($# >= 3)) || usage
        make "${@:2}"
        ;;
    run)
        (($# >= 3)) || usage
        run "${@:2}"
        ;;
    *) usage ;;
esac
