// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with -mavx2 where there is such a thing (native/CMakeLists.txt), run where the processor
// has it.
#ifdef __AVX2__
#define LANES_NAME avx2
#define LANES_TEXT "avx2"
#define LANES_WIDTH 4
#include "interpolation/kriging/lane_kernels.inl"
#endif
