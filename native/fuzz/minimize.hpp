// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "stack_case.hpp"

namespace realmodel::fuzz {

/// A smaller stack that fails too, found by greedy steps: fewer rock masses, surfaces and
/// triangles, no region, base or rules where they do not matter, rounder numbers.
/// @param fails  whether a stack shows the same defect; asked at most `steps` times
StackCase minimized(StackCase stack, const std::function<bool(const StackCase&)>& fails,
                    std::size_t steps);

}  // namespace realmodel::fuzz
