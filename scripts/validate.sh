#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures RealModel beside truths and other programs, and writes docs/validation.json, docs/validation.md,
# its figures, and the values that other documents cite. Some twenty minutes on a quiet machine, hours on a busy
# one. Needs the real data in ../shared/data. A part that was measured is kept in build/validation: a run that
# was interrupted goes on.
#
#   scripts/validate.sh               the parts that are missing
#   scripts/validate.sh PART...       these again: near_flat rough folded folds moureze claudius methods wells
#                                     exact solvers calibration
#   scripts/validate.sh --again       all again
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=/usr/bin/python3

"$root/scripts/install_dependencies.sh" build solvers
"$root/scripts/build.sh" "$python"
"$root/scripts/python_environment.sh" "$root/build/venv-validation" "$root/scripts/requirements/validation.txt" "$python"
# one thread each: the times of all programs are those of one processor
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
cd "$root/scripts"
exec "$root/build/venv-validation/bin/python" -m validation "$@"
