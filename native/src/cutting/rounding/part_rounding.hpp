// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::cutting {

/// Makes sound parts of a model's cells.
///
/// Nodes that came to lie in one position become one, and polygons between them vanish, wherever
/// the parts around stay closed and keep an extent. Others get positions beside it, parts and
/// upright walls without extent are given one, all by single units in the last place; nodes on the
/// flat base stay on it, and those on walls move up or down before they move aside. Last, polygons
/// that are no longer convex are divided.
/// @param touches  whether parts below, above may use an edge more than twice
void round_parts(RoundedParts&& parts, const std::array<bool, 2>& touches);

// The passes, which joined models share (structures/joined_rounding.hpp).

/// Takes away parts of which two polygons are left that lie on each other: what is beyond the one
/// meets what is beyond the other. So are two parts that have nothing around them but each other.
void drop_hollow(RoundedParts& parts);

/// A cutter that runs along the base but for rounding is taken to run along it: so do its nodes.
void level_base(RoundedParts& parts);

/// New nodes that came to lie where a vertex of the model or an earlier new node is become that one
/// where all parts around stay sound: closed, with polygons that pass no node twice, none of them
/// twice there, and an extent.
/// @param may_fold  whether two polygons of a part that are the same but face each other cancel
void join_coincident(RoundedParts& parts, const std::array<bool, 2>& touches, bool may_fold);

/// Moves new nodes that are still where another is to the nearest free position beside it.
void separate_coincident_nodes(RoundedParts& parts);

/// Gives parts without thickness on an axis, and walls without extent in plan, one unit of it.
void widen_flat_parts(RoundedParts& parts);

/// Where two polygons of a half are the same and face each other from outside of it, nothing is
/// between them: they become one between their parts, or none in one part.
/// @return of pieces, not 0: another of its half is the same and faces the same way, of parts that
///         overlap
std::vector<std::uint8_t> merge_coincident_faces(RoundedParts& parts);

/// Triangulates polygons that rounding has bent, walls that have no extent in plan still, and
/// polygons that are there already, about a node of their own: an edge between two others may be
/// one already. Where this node would not see all of a polygon, the same is done with its convex
/// parts, between two of which there is such a node, too. What is known of nodes and parts is not
/// updated.
/// @param is_bent_too  more that are to be divided, of at least four corners; nullptr: none
void triangulate_nonplanar(RoundedParts& parts, std::span<const std::uint8_t> is_doubled,
                           bool (*is_bent_too)(std::span<const Position> corners) = nullptr);

/// Parts that lost all of their polygons to others are no more.
void drop_empty(RoundedParts& parts);

}  // namespace realmodel::cutting
