// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/lane_kernels.hpp"

#include <vector>

namespace realmodel::interpolation {

namespace avx512 {
extern const LaneKernels kernels;
}
namespace avx2 {
extern const LaneKernels kernels;
}
namespace baseline {
extern const LaneKernels kernels;
}

std::span<const LaneKernels> lane_kernels() {
    static const std::vector<LaneKernels> usable = [] {
        std::vector<LaneKernels> found;
#ifdef REALMODEL_WIDE_LANES
        if (__builtin_cpu_supports("avx512f")) found.push_back(avx512::kernels);
        if (__builtin_cpu_supports("avx2")) found.push_back(avx2::kernels);
#endif
        found.push_back(baseline::kernels);
        return found;
    }();
    return usable;
}

}  // namespace realmodel::interpolation
