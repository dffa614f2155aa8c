// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "realmodel/base/progress.hpp"

namespace realmodel {

/// Sorts numbers that are finite by their bits, digit by digit: a few passes over all of them, in
/// one thread; can be cancelled between these. -0 becomes 0.
void sort_doubles(std::vector<double>& values, const Progress* progress);

}  // namespace realmodel
