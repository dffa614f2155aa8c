#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a virtual environment that holds exactly what a list of pinned packages names, or leaves the
# one that is there if it was made from the same list for the same interpreter.
#
#   scripts/python_environment.sh FOLDER REQUIREMENTS PYTHON
set -euo pipefail

if (($# != 3)); then
    echo "usage: python_environment.sh FOLDER REQUIREMENTS PYTHON" >&2
    exit 2
fi
folder=$1 requirements=$2 python=$3

made_from="$("$python" -c 'import sys; print(sys.executable, sys.version)') $(sha256sum <"$requirements")"
if [[ -f $folder/made_from && $(<"$folder/made_from") == "$made_from" && -x $folder/bin/python ]]; then
    exit 0
fi
rm -rf "$folder"
"$python" -m venv "$folder"
"$folder/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps -r "$requirements"
echo "$made_from" >"$folder/made_from"
