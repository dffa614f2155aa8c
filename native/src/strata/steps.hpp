// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// Shares of the work that are done when a step ends, measured on stacks of ten surfaces.
inline constexpr double kBordersDone = 0.02, kInputDone = 0.05, kOverlayDone = 0.65;

/// Begins a step of the work, counted as `share` of it.
/// @throws Cancelled
inline void begin_step(Progress* progress, double start, double share, const char* text) {
    if (progress == nullptr) return;
    progress->check();
    progress->begin(start, start + share, text);
}

}  // namespace realmodel::strata
