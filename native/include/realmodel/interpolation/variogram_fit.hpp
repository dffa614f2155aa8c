// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/drift.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// Means over classes of pairs of points by distance: gamma of a class is half the mean squared
/// difference of the values, lag the mean distance (Matheron 1962).
struct ExperimentalVariogram {
    std::vector<double> lags;
    std::vector<double> gamma;
    std::vector<std::int64_t> pairs;
};

/// The experimental semivariogram of points (x, y, z) out to half the diagonal of their extent.
/// Classes are narrow where points are near each other and widen with distance. Of many points a
/// fixed subset is taken: up to 2000 for far pairs, and of up to 20,000 all near pairs. Distances
/// are measured with the anisotropy, in units of the longest range.
ExperimentalVariogram experimental_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& anisotropy);

struct FitOptions {
    Drift drift = Drift::kConstant;
    int neighbors = 32;             ///< from which points that are left out are predicted, 1 .. 64
    bool finds_anisotropy = false;  ///< instead of taking the one that is given
    bool are_apart = false;         ///< no two points lie at one position, and all are finite
    Dips dips{};                    ///< their baseline is the mean spacing of points and dips
    bool has_bounds = false;        ///< bounds of heights are known, which hold beside the points
    double error = 0;  ///< mean variance of the errors of the heights: the nugget is no less
};

struct FittedVariogram {
    Variogram variogram;
    ExperimentalVariogram experimental;
};

/// Fits a variogram to points. Each model, with and without a nugget, is fitted to the experimental
/// values by weighted least squares (weights pairs / lag^2: Chiles and Delfiner 2012,
/// section 2.6.2, as gstat does). Around these fits further nuggets, ranges and a second, rougher
/// structure (an exponential one, or one of a quarter of the range) are tried, each with the sill
/// that fits best. Of all candidates the one is chosen with which kriging predicts points that are
/// left out one by one best from their nearest others (root mean square error, errors beyond twenty
/// deviations counted as twenty): 4000 points from 16 others search, and up to 10,000 points from
/// all the neighbors choose among the best eight. Of clustered points the others nearer than twice
/// their even spacing are left out, too: near each other they may follow something else, such as
/// the ground along the lines of a map, and would hide how far off the rest is. Among equally good
/// ones, within 0.2 percent, the one without a second structure, then the one that fits the
/// experimental values best. Then ranges and sill are scaled until 95 % of those errors lie within
/// two kriging deviations: variances are honest. Constant values, or fewer than three points, give
/// a spherical model whose sill is tiny or that of the points.
///
/// With finds_anisotropy ratio and azimuth are searched in the same way, from 30 points on that
/// spread in two directions; one is accepted where it lowers the mean square of the errors by 3 %
/// and by two standard errors, and the rest is fitted again under it.
///
/// Few contacts of a surface that dips and bounds describe as well show too little by their pairs,
/// and by those that are left out: where fits_by_likelihood, the variogram is the one with which
/// points and dips are most likely (restricted maximum likelihood).
///
/// Heights with errors, such as those of contacts along the lines of a map, must not be taken for
/// exact: then the variogram is the likeliest of those whose nugget is no less than the variance of
/// the errors.
///
/// With a drift all this is done with the residuals of the polynomial that fits best, or that fits
/// a fixed subset of more than 20,000 points best.
///
/// Points that are apart may lie in a file: of many only those that are compared, and their
/// nearest, are copied.
///
/// The same bytes for any number of threads.
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "too_large",
///         "anisotropy", "option"
/// @throws Cancelled
FittedVariogram fit_variogram(std::span<const std::array<double, 3>> points,
                              const Anisotropy& anisotropy, const FitOptions& options = {},
                              const Execution& execution = {});

/// Whether the variogram of so many points is found by likelihood: with bounds of fewer than 30
/// points, with dips of fewer than 150, with an error of their heights always.
constexpr bool fits_by_likelihood(std::size_t points, bool has_dips, bool has_bounds,
                                  double error) {
    return error > 0 || points < (has_dips ? 150U : has_bounds ? 30U : 0U);
}

/// A variogram that points and dips allow, with the sill 1. density: the logarithm of how likely
/// they are with it, whatever sill and drift are. squares: of what variogram and drift do not
/// explain, of `free` degrees of freedom: divided by a chi-square number of these they give a sill.
struct LikelyVariogram {
    Variogram variogram;
    double density, squares;
    std::size_t free;
};

/// Of all models, ranges and nuggets on a grid (Bayesian kriging: Kitanidis 1986, "Parameter
/// uncertainty in estimation of spatial functions", Water Resources Research 22; Handcock and Stein
/// 1993). Of many points a fixed, even subset counts.
/// @return none where the data are too few
/// @throws InputError as fit_variogram; Cancelled
std::vector<LikelyVariogram> likely_variograms(std::span<const std::array<double, 3>> points,
                                               const Anisotropy& anisotropy,
                                               const FitOptions& options = {},
                                               const Execution& execution = {});

/// What is known of one surface. Its dips' baseline is the mean spacing of its points and dips.
struct SurfaceData {
    std::span<const std::array<double, 3>> points;
    Dips dips{};
};

/// Variograms of surfaces of which heights vary alike, as conformable ones do, but which are not
/// estimated together: their model, range, anisotropy and share of nugget are those with which the
/// data of all are most likely, each surface taken by itself; the sill is each surface's own, where
/// its data show one. Of many points of a surface an even subset counts.
/// @return none where there are none, or the data are too few
/// @throws InputError as fit_variogram; Cancelled
std::vector<FittedVariogram> fit_alike(std::span<const SurfaceData> surfaces,
                                       const Anisotropy& anisotropy, const FitOptions& options = {},
                                       const Execution& execution = {});

}  // namespace realmodel::interpolation
