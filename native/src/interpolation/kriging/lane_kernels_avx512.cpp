// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with -mavx512f where there is such a thing (native/CMakeLists.txt), run where the
// processor has it.
#ifdef __AVX512F__
#define LANES_NAME avx512
#define LANES_TEXT "avx512"
#define LANES_WIDTH 8
#include "interpolation/kriging/lane_kernels.inl"
#endif
