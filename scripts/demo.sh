#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The whole way once: installs, builds, and makes a model of the sample Haut-Barr in background
# Blender. Prints the table of volumes and leaves model.blend, model.png, model.npz, model.vtu and
# report.json.
#
#   scripts/demo.sh [FOLDER]       FOLDER: where the files go (default: demo in the repository)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if (($# > 1)); then
    echo "usage: demo.sh [FOLDER]" >&2
    exit 2
fi
folder=${1:-$root/demo}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

"$root/scripts/install_dependencies.sh" blender
"$root/scripts/build.sh" /usr/bin/python3 # the interpreter inside Debian's Blender

blender -b --factory-startup --python-exit-code 1 -P "$root/build_model.py" -- \
    "$root/blend_samples/haut_barr/project.toml" \
    --blend "$folder/model.blend" --render "$folder/model.png" \
    --export "$folder/model.npz" --export "$folder/model.vtu" --report "$folder/report.json"
echo "The model is in $folder"
