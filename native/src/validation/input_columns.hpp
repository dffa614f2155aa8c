// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "validation/probes.hpp"

namespace realmodel::validation {

/// The triangles of the input above and below each probe.
class InputColumns {
public:
    InputColumns(const ModelInput& input, const Probes& probes, const PlanRounding& rounding,
                 const Execution& execution);

    std::size_t surface_count() const { return surfaces_; }
    /// The triangle of a surface (counted through all rock masses) there, -1 where it has none or
    /// the region leaves it out.
    std::int32_t triangle(std::size_t probe, std::size_t surface) const {
        return triangle_[probe * surfaces_ + surface];
    }
    /// Whether an edge of the input passes too close to be sure on which side a probe lies.
    bool near_edge(std::size_t probe) const { return near_edge_[probe] != 0; }

private:
    std::size_t surfaces_ = 0;
    std::vector<std::int32_t> triangle_;
    std::vector<std::uint8_t> near_edge_;
};

}  // namespace realmodel::validation
