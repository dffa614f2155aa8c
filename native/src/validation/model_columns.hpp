// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "validation/probes.hpp"

namespace realmodel::validation {

/// Where the vertical line through a probe meets a face.
struct Crossing {
    std::int32_t probe, face;
    std::int32_t below, above;  ///< cells, -1 outside
    double height;
};

/// What the model has on the vertical lines through all probes.
class ModelColumns {
public:
    ModelColumns(const ComplexView& model, const Probes& probes, const PlanRounding& rounding,
                 const Execution& execution);

    /// In the order of their faces.
    std::span<const Crossing> of_probe(std::size_t probe) const { return crossings_[probe]; }
    /// Whether an edge of the model passes too close to a probe to be sure on which side it lies.
    bool near_edge(std::size_t probe) const { return near_edge_[probe] != 0; }
    /// Whether another edge passes so close to a wall that the probes beside it may lie beyond.
    bool coincident(std::size_t wall) const { return coincident_[wall] != 0; }

private:
    Buckets<Crossing> crossings_;
    std::vector<std::uint8_t> near_edge_, coincident_;
};

}  // namespace realmodel::validation
