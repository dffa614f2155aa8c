#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints how many compilers may run at once here: one a core, and 2 GB for each, which CGAL takes.
set -euo pipefail
jobs=$(nproc)
memory_jobs=$(awk '/MemAvailable/ {print int($2 / 2e6)}' /proc/meminfo)
((memory_jobs < jobs)) && jobs=$memory_jobs
((jobs < 1)) && jobs=1
echo "$jobs"
