#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the documents as a site that can be searched, in build/site; a warning is an error. Needs nothing that is
# compiled: what Python prints is in the documents, where the tests compare it.
#
#   scripts/site.sh [PYTHON]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/python_environment.sh build/venv-site scripts/requirements/site.txt "${1:-python3}"
# Sphinx looks through all folders of its sources: it gets the repository's own files alone.
sources=build/site_source
rm -rf "$sources" build/site build/site_doctrees
mkdir -p "$sources"
git ls-files -z --cached --others --exclude-standard |
    tar --create --null --no-recursion --ignore-failed-read --files-from - | tar --extract --directory "$sources"
cp docs/site/index.md "$sources"
build/venv-site/bin/python -m sphinx -b html -c docs/site -d build/site_doctrees -W --keep-going -q -j auto \
    "$sources" build/site
echo "build/site/index.html"
