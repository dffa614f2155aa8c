// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "random_source.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Changes a stack in one way: a vertex onto an edge or a vertex of another surface, or an ulp
/// aside; a surface onto another's plane; a patch of one surface into another; holes, steps,
/// needles, another scale of heights, another place in the world, rules, region, base, order of the
/// surfaces.
void mutate(RandomSource& random, StackCase& stack);

/// Surfaces of `other` among those of `stack`, in its own place or fitted to it.
void cross_over(RandomSource& random, StackCase& stack, const StackCase& other);

/// Case `number` of the endless sequence that a seed stands for: stacks of all families, their
/// mutations and crossovers, and those of the corpus.
StackCase case_number(std::uint64_t seed, std::uint64_t number,
                      const std::vector<StackCase>& corpus);

/// The case that a source of choices stands for.
StackCase make_case(RandomSource& random, const std::vector<StackCase>& corpus);

}  // namespace realmodel::fuzz
