// SPDX-License-Identifier: GPL-3.0-or-later
// Points left out one by one and told by kriging from their nearest others. Private.
#pragma once

#include <span>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/drift.hpp"

namespace realmodel {
class Progress;
}

namespace realmodel::interpolation {

/// Errors, told less true, and their variances in units of the sill.
struct LeftOutErrors {
    std::vector<double> errors, variances;
};

/// A fixed, even part of some points with the nearest others of each: one search for any number of
/// variograms.
class LeftOutPoints {
public:
    /// @param neighbours  1 .. 64; fewer where there are not so many others
    /// @param most        points that are left out, where there are so many
    LeftOutPoints(const DataPoints& data, std::size_t neighbours, std::size_t most, int threads,
                  Progress* progress);

    std::size_t neighbours() const { return neighbours_; }

    /// By ordinary kriging. The same bytes for any number of threads.
    LeftOutErrors told_by(const Covariance& covariance) const;

    /// With a drift; slower.
    LeftOutErrors told_by(const Covariance& covariance, Drift drift) const;

private:
    const DataPoints& data_;
    std::size_t neighbours_;
    int threads_;
    Progress* progress_;
    std::vector<std::int32_t> left_out_;  // numbers of points, in the order of a curve
    std::vector<std::int32_t> others_;    // neighbours_ of each, nearest first
};

}  // namespace realmodel::interpolation
