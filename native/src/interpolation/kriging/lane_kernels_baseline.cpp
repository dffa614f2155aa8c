// SPDX-License-Identifier: GPL-3.0-or-later
// With the registers that every processor has.
#define LANES_NAME baseline
#define LANES_TEXT "baseline"
#define LANES_WIDTH 2
#include "interpolation/kriging/lane_kernels.inl"
