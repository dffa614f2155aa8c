// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/neighborhood.hpp"

namespace realmodel::interpolation {

struct ThinPlateOptions {
    /// Added to the diagonal where distances are measured in the points' mean spacing; 0: points
    /// are met exactly.
    double smoothing = 0;
    Neighborhood neighborhood;  ///< a spline of all points is solved once
    /// The unit of distances; 0: the points' mean spacing. A subset of the points gives heights of
    /// the whole with that of the whole.
    double spacing = 0;
    Dips dips{};
};

/// The side of a square as large as each point's share of the box of all; 1 where this is none.
/// @param are_apart  no two points lie at one position, and all are finite: nothing is looked for
/// @throws InputError as thin_plate for points
double mean_spacing(std::span<const std::array<double, 3>> points, bool are_apart = false);

/// Thin plate splines (Duchon 1977; Wahba 1990, "Spline models for observational data",
/// section 2.4): sum w_i r_i^2 log r_i + a + b x + c y, the surface that bends least through the
/// points or, with smoothing, near them. A node on a point gets its value where there is no
/// smoothing. Points in one line have no slope across it.
/// Dips are met as closely as the ends of their baselines say, whatever the smoothing: differences
/// of heights are functionals like these (Wahba 1990, section 1.3).
///
/// @param points  x, y, z; repeated points count once
/// @param nodes   x, y
/// @return        z of each node; the same for any number of threads
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "option", "too_large"
/// @throws Cancelled
std::vector<double> thin_plate(std::span<const std::array<double, 3>> points,
                               std::span<const std::array<double, 2>> nodes,
                               const ThinPlateOptions& options, const Execution& execution = {});

/// Splines through the nearest of some of many points, then of others: one index serves all.
class SplinesOfSome {
public:
    /// @param points  x, y, z; several may be at one position
    /// @throws InputError kind "no_points", "not_finite", "too_large"
    explicit SplinesOfSome(std::span<const std::array<double, 3>> points);
    ~SplinesOfSome();

    std::size_t size() const;

    /// As thin_plate gives them from the points that count, those at one position as one with their
    /// mean height.
    /// @param counts  of each point, not 0 where it does
    /// @param neighbors  at most, of each node
    /// @return  z of each node with the first smoothing, then with each other one
    /// @throws InputError kind "no_points", "not_finite"
    /// @throws Cancelled
    std::vector<double> heights(std::span<const std::uint8_t> counts,
                                std::span<const std::array<double, 2>> nodes,
                                std::span<const double> smoothings, std::size_t neighbors,
                                const Execution& execution = {}) const;

private:
    struct Index;
    std::unique_ptr<const Index> index_;
};

}  // namespace realmodel::interpolation
