// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"
#include "interpolation/neighbors/data_search.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {

/// What all ways of kriging need: the data, the nodes and room for the estimates.
struct KrigingTask {
    const LinearData& data;
    const spatial::NearestPoints& tree;
    const Covariance& covariance;
    const KrigingOptions& options;
    std::span<const Position> nodes;  ///< without any each point is left out and estimated instead
    bool leaves_out;
    double sill;
    const Execution& execution;
    Kriged& out;

    std::size_t count() const { return leaves_out ? data.point_count() : nodes.size(); }
    /// In local coordinates.
    Position node(std::size_t i) const {
        return leaves_out ? data.position(static_cast<std::int32_t>(i))
                          : data.points().to_local(nodes[i]);
    }
    std::int32_t left_out(std::size_t i) const {
        return leaves_out ? static_cast<std::int32_t>(i) : NeighborSearch::kNobody;
    }
    std::int32_t sheet(std::size_t i) const {
        return leaves_out ? data.sheet(static_cast<std::int32_t>(i)) : options.sheets.asked;
    }
    /// The point of a sheet at a position, if there is one among the nearest points; else kNobody.
    std::int32_t point_there(std::span<const spatial::Neighbor> nearest, std::int32_t sheet) const {
        for (const spatial::Neighbor& near : nearest) {
            if (near.squared_distance > 0 || !data.is_point(near.point)) break;
            if (data.sheet(near.point) == sheet) return near.point;
        }
        return NeighborSearch::kNobody;
    }
    void set(std::size_t node, const Estimate& estimate) const {
        out.z[node] = estimate.value;
        out.variance[node] = estimate.variance * sill;
    }
};

/// A single point that is left out: nothing is known of its value.
inline Estimate unknown(double value) {
    return {value, std::numeric_limits<double>::infinity()};
}

}  // namespace realmodel::interpolation
