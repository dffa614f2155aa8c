# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/benchmark.sh measures: made stacks, RealModel, its peers, and the page they end on."""
