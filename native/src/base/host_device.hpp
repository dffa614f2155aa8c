// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Of functions that nvcc compiles for a GPU, too (native/cuda); to other compilers it means
/// nothing.
#ifdef __CUDACC__
#define REALMODEL_HOST_DEVICE __host__ __device__
#else
#define REALMODEL_HOST_DEVICE
#endif
