// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/drift_basis.hpp"
#include "interpolation/neighbors/nearest_of_some.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// Positions rotated and stretched so that their plain distances are those under an anisotropy.
class IsotropicSpace {
public:
    explicit IsotropicSpace(const Anisotropy& anisotropy);
    PlanPosition operator()(const PlanPosition& local) const {
        const auto& [x, y] = local;
        return {sin_ * x + cos_ * y, stretch_ * (cos_ * x - sin_ * y)};
    }

private:
    double sin_, cos_, stretch_;
};

/// The points that a variogram is fitted to, which stay where they are: they may be more than the
/// memory holds.
class ManyPoints {
public:
    /// @param points    they must outlive this object
    /// @param are_apart no two lie at one position, and all are finite: nothing is looked for
    /// @param most      of points that are kept in memory
    /// @throws InputError as prepare_points
    explicit ManyPoints(std::span<const std::array<double, 3>> points, bool are_apart = false,
                        std::size_t most = kMostInMemory);
    ManyPoints(const ManyPoints&) = delete;
    ManyPoints& operator=(const ManyPoints&) = delete;

    std::size_t size() const { return points_.size(); }
    PlanPosition local(std::size_t i) const {
        return {points_[i][0] - points_[0][0], points_[i][1] - points_[0][1]};
    }
    double value(std::size_t i) const;
    /// From now on values are what the polynomial leaves that fits them, or a fixed, even subset of
    /// many of them, best.
    void take_drift_out(Drift drift);

    /// nearest_of_some of them, with distances in a space.
    std::vector<spatial::Neighbor> nearest(const IsotropicSpace& space,
                                           std::span<const std::int32_t> asked, std::size_t count,
                                           const Execution& execution) const;
    /// Of the box around them.
    double diagonal(const IsotropicSpace& space) const;
    double largest_value() const;

    /// Numbers of points, ascending, each once, among them those of `near`: of few points all.
    std::vector<std::int32_t> subset_with(std::span<const spatial::Neighbor> near) const;
    /// Some points, in the order of their numbers here.
    DataPoints some(std::span<const std::int32_t> numbers) const;

private:
    struct Trend {
        DriftFrame frame;
        DriftBasis basis;
        DriftBasis::Coefficients coefficients;
    };
    std::vector<std::array<double, 3>> distinct_;  // where points were repeated
    std::span<const std::array<double, 3>> points_;
    std::size_t most_;
    std::optional<Trend> trend_;
};

/// Where a number is among numbers that ManyPoints::subset_with gave of `size` points.
std::int32_t index_among(std::span<const std::int32_t> numbers, std::size_t size,
                         std::int32_t number);

/// How far others should be from a point that is left out, so that it is predicted from as far as
/// the places between the points are, where points are clustered: contacts along the lines of a
/// map, picks along sections. Twice the spacing that so many points would have evenly in their
/// convex hull; 0 where they are not clustered. They are where the mean distance to the nearest
/// other is below half of that expected of random ones (Clark and Evans 1954, "Distance to nearest
/// neighbor as a measure of spatial relationships in populations", Ecology 35). Errors at the
/// distances of predictions: Mila et al. 2022, "Nearest neighbour distance matching leave-one-out
/// cross-validation", Methods in Ecology and Evolution 13.
/// @throws Cancelled
double buffer_of_clusters(const ManyPoints& points, const Execution& execution);

}  // namespace realmodel::interpolation
