#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints where the headers of a version of Python for Linux x86-64 are, as folders with colons between: this system's,
# or those of the oldest release of Debian that has it, kept in ${XDG_CACHE_HOME:-~/.cache}/realmodel, or, for a version
# that no release of Debian has, those of an interpreter that is here (python3.12 on PATH, or pyenv's).
#
#   scripts/python_headers.sh VERSION      e.g. 3.12
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
version=${1:?usage: python_headers.sh VERSION}
declare -A suite_of=([3.11]=bookworm [3.13]=trixie [3.14]=sid)

if [[ -f /usr/include/python$version/Python.h && -f /usr/include/x86_64-linux-gnu/python$version/pyconfig.h ]]; then
    echo "/usr/include/python$version:/usr/include"
    exit 0
fi
if [[ -n ${suite_of[$version]-} ]]; then
    headers=${XDG_CACHE_HOME:-$HOME/.cache}/realmodel/python$version-headers
    "$root/scripts/foreign_packages.sh" "${suite_of[$version]}" "$headers" "libpython$version-dev" >&2
    echo "$headers/usr/include/python$version:$headers/usr/include"
    exit 0
fi
for python in "python$version" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python; do
    include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))' 2>/dev/null) || continue
    if [[ -f $include/Python.h && -f $include/pyconfig.h ]]; then
        echo "$include"
        exit 0
    fi
done
echo "python_headers.sh: no release of Debian has Python $version, and no interpreter of it with headers is here" >&2
exit 1
