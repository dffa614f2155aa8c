// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// Processes on lines through the plan, each sampled at equal steps.
struct Lines {
    std::span<const std::array<double, 2>> directions;  ///< along line l a position p is at p . d
    std::span<const double> starts;                     ///< where the first sample of each line is
    std::span<const double> values;                     ///< all samples of line 0, then of line 1
    double step = 1;                                    ///< between samples
};

/// The sum over all lines of the linearly interpolated sample at each node: the last step of
/// the turning bands method (Matheron 1973; Chiles and Delfiner 2012, section 7.4). Beyond its
/// ends a line keeps its first and last value.
/// @return  the same bytes for any number of threads
/// @throws InputError kind "option" where lengths disagree or the step is not positive,
///         "not_finite"; Cancelled
std::vector<double> line_sums(std::span<const std::array<double, 2>> nodes, const Lines& lines,
                              const Execution& execution = {});

}  // namespace realmodel::interpolation
