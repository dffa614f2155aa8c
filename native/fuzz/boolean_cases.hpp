// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "random_source.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Case `number` of the endless sequence that a seed stands for: two surfaces, as those of a stack
/// with one rock mass, so that they are written, read and made small in the same way. One in four
/// is a change of one of the corpus.
StackCase boolean_case(std::uint64_t seed, std::uint64_t number,
                       const std::vector<StackCase>& corpus);

}  // namespace realmodel::fuzz
