#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Puts the packages of scripts/requirements/vendor.txt into addon/realmodel/vendor, with their licences,
# or leaves them where they are there already. They need no compiler: one copy serves every interpreter.
#
#   scripts/vendor_packages.sh [PYTHON]      PYTHON: an interpreter that has pip (default: python3)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=${1:-python3}
requirements=$root/scripts/requirements/vendor.txt
folder=$root/addon/realmodel/vendor

made_from=$(sha256sum <"$requirements")
if [[ -f $folder/made_from && $(<"$folder/made_from") == "$made_from" ]]; then
    exit 0
fi
# Whole or not at all: what is interrupted leaves the old folder, or none.
new=$(mktemp -d "$root/addon/realmodel/vendor.XXXXXX")
trap 'rm -rf "$new"' EXIT
"$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-compile --only-binary :all: \
    --target "$new" -r "$requirements"
rm -rf "${new:?}/bin"
echo "$made_from" >"$new/made_from"
chmod 755 "$new"
rm -rf "$folder"
mv "$new" "$folder"
