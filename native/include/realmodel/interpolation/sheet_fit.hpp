// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/sheets.hpp"
#include "realmodel/interpolation/variogram.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// What sheets have in common.
struct FittedSheets {
    Variogram variogram;  ///< of the field that they share
    double thickness;  ///< the variance of each thickness between two of them, in units of its sill
    std::vector<double> constants;       ///< what each lies above the first point; 0 without points
    ExperimentalVariogram experimental;  ///< of one point at each position, less its constant
    std::size_t points = 0;              ///< so many counted
};

/// The most points of all sheets together that fit_sheets takes; of more it takes an even subset,
/// as the time grows with their cube.
inline constexpr std::size_t kMostPointsOfSheets = 150;

/// The variogram of the field that sheets share, the variance of the thicknesses between
/// them, which have the same shape and range, and what they lie apart, with which all points and
/// dips together are most likely (restricted maximum likelihood: each sheet has a constant that is
/// not known). The search is that of fit_variogram for few points. Where thicknesses do not vary,
/// the variogram is the likeliest one of all sheets as one surface.
/// @param sheets   of points and dips, of which no two lie at one position; only the number of its
///                 variances counts
/// @param fixed_variogram  a variogram that is not to be changed
/// @return none where there is none, or the data are too few
/// @throws InputError as fit_variogram; Cancelled
std::optional<FittedSheets> fit_sheets(std::span<const std::array<double, 3>> points,
                                       const Sheets& sheets, const Anisotropy& anisotropy,
                                       const FitOptions& options,
                                       const std::optional<Variogram>& fixed_variogram = {},
                                       const Execution& execution = {});

}  // namespace realmodel::interpolation
