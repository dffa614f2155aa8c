// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::structures {

/// Makes sound parts of the cells of several models, as cutting::round_parts() does of one.
///
/// What two models have in common was rounded in each by itself: nodes, too, become one whose edge
/// is as short as rounding. So polygons may come to lie on each other, which cancel, and parts may
/// come to touch themselves, which are set apart.
/// @param parts  are_joined
/// @param least_rounding  how coarse rounding is at least
void round_joined_parts(cutting::RoundedParts&& parts, const std::array<bool, 2>& touches,
                        double least_rounding);

// The passes that joining has beside those of cutting (cutting/rounding/part_rounding.hpp).

/// Parts that are narrower than rounding all along become one with a part of their block beside
/// them that nothing but such slivers parts from them.
void merge_needles(cutting::RoundedParts& parts, double least_rounding);

/// Contracts edges of new nodes that are as short as rounding, one after another, where no part
/// comes to touch itself for it. Parts that only rounding keeps open vanish.
void join_short_edges(cutting::RoundedParts& parts, double least_rounding);

/// Of polygons that are the same, those that face each other within one part cancel: what is left
/// is between the others. Takes away parts that are hollow then.
void cancel_facing(cutting::RoundedParts& parts);

/// Where parts use an edge more than twice, polygons that lead round other parts there get a node
/// of their own on it.
void set_touching_apart(cutting::RoundedParts& parts);

}  // namespace realmodel::structures
