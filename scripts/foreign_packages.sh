#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Unpacks packages of any suite of Debian into a folder, without installing anything: neither the
# system's packages nor its list of sources change, and root is not needed. A folder that is there
# is left as it is.
#
# With --source it is the original source of a package, without Debian's patches.
#
#   scripts/foreign_packages.sh SUITE FOLDER PACKAGE...       e.g. trixie ~/headers libpython3.13-dev
#   scripts/foreign_packages.sh --source SUITE FOLDER PACKAGE
#   scripts/foreign_packages.sh --mirror                      the address that Debian's packages come from here
set -euo pipefail

fail() {
    echo "foreign_packages.sh: $1" >&2
    exit 1
}

command -v apt-get >/dev/null || fail "this is not Debian: there is no apt-get"
# Also where the sources list other archives than Debian's own; and where no list was ever fetched.
# shellcheck disable=SC2016  # the names in the format are those of apt
mirror=$(apt-get indextargets --format '$(LABEL) $(REPO_URI)' 'Created-By: Packages' | awk '$1 == "Debian" {print $2; exit}')
[[ -n $mirror ]] || mirror=$(apt-get --print-uris update | sed -n "s|^'\(.*/debian/*\)/dists/.*|\1|p" | head -n 1)
[[ -n $mirror ]] || fail "the sources of apt name no archive of Debian"
if [[ ${1-} == --mirror ]]; then
    echo "$mirror"
    exit 0
fi
kind=deb
if [[ ${1-} == --source ]]; then
    kind=deb-src
    shift
fi
if (($# < 3)); then
    echo "usage: foreign_packages.sh [--source] SUITE FOLDER PACKAGE... | --mirror" >&2
    exit 2
fi
suite=$1 folder=$2
shift 2
[[ ! -d $folder ]] || exit 0

mkdir -p "$(dirname "$folder")"
work=$(mktemp -d "$folder.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{lists/partial,archives/partial,unpacked}
: >"$work/status"
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
signed_by=
[[ ! -f $keyring ]] || signed_by="[signed-by=$keyring] "
echo "$kind $signed_by$mirror $suite main" >"$work/sources.list"
apt=(apt-get -qq -o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=-
    -o "Dir::State::Lists=$work/lists" -o "Dir::State::status=$work/status" -o "Dir::Cache=$work"
    -o Acquire::Languages=none -o Acquire::Retries=3
    -o Acquire::Check-Valid-Until=false # a mirror that stands still is as good for headers
    -o APT::Sandbox::User="$(id -un)")
"${apt[@]}" update || fail "the list of packages of $suite cannot be had from $mirror"
if [[ $kind == deb-src ]]; then
    (cd "$work/archives" && "${apt[@]}" source --download-only --tar-only "$1") || fail "$suite has no source package $1"
    tar --extract --file "$(echo "$work"/archives/*.orig.tar.*z)" --strip-components=1 --directory "$work/unpacked"
else
    (cd "$work/archives" && "${apt[@]}" download "$@") || fail "$suite has no such packages: $*"
    for package in "$work"/archives/*.deb; do
        dpkg-deb --extract "$package" "$work/unpacked"
    done
fi
mv "$work/unpacked" "$folder"
