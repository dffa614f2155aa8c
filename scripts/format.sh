#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Brings the C++ and Python files into the form that scripts/test.sh asks for.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

scripts/install_dependencies.sh build test
scripts/python_environment.sh build/venv scripts/requirements/test.txt /usr/bin/python3
git ls-files -z --cached --others --exclude-standard '*.cpp' '*.hpp' | xargs -0 clang-format -i
build/venv/bin/ruff check --fix .
build/venv/bin/ruff format .
