// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/errors.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/triangle_view.hpp"

namespace realmodel::booleans {

/// Edges along which two surfaces meet, one after another (Mei 2014, section 4.3).
enum class LoopKind : std::uint8_t {
    kOpen,        ///< ends in two vertices; elsewhere each has two intersection edges
    kHardClosed,  ///< every vertex has two intersection edges
    kSoftClosed,  ///< begins and ends in one vertex, which has more than two
};

struct IntersectionLoop {
    LoopKind kind;
    std::vector<std::int32_t> vertices;  ///< of a closed loop the first is not repeated
};

/// A part of a surface that no loop divides.
struct SubSurface {
    std::int32_t source;                  ///< 0: of the first surface, 1: of the second
    std::vector<std::int32_t> triangles;  ///< of the refinement
    std::vector<std::int32_t> loops;      ///< that bound it
    bool is_public;                       ///< whether it is between two sub-blocks
};

/// A bounded part of space that surfaces enclose and none of them divides.
struct SubBlock {
    std::vector<std::array<std::int32_t, 3>> triangles;  ///< closed, seen from outside
    std::array<bool, 2> is_in;  ///< whether it is inside of the first, of the second surface
};

enum class Operation : std::uint8_t { kUnion, kIntersection, kDifference, kReverseDifference };

/// Two surfaces divided along one another: their common refinement, and what it consists of.
struct Refinement {
    std::vector<double> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;  ///< turned as those that they are part of
    std::vector<std::uint8_t> source;                    ///< of each triangle: 0 or 1
    std::vector<std::int32_t> source_triangle;           ///< the input's triangle it is part of
    std::vector<IntersectionLoop> loops;
    std::vector<SubSurface> sub_surfaces;
    std::vector<SubBlock> sub_blocks;
    std::array<bool, 2> is_closed{};  ///< whether the surfaces are boundaries of solids

    /// The boundary of what an operation on two solids leaves, seen from outside.
    /// @throws InputError kind not_closed (surface: which) where one of them is no solid
    std::vector<std::array<std::int32_t, 3>> boundary(Operation operation) const;
    double volume(const SubBlock& block) const;

    /// Of each triangle, whether it is inside of the first and of the second surface just below it
    /// (where it is seen clockwise from), and just above. Of triangles that coincide the first
    /// counts.
    std::vector<std::array<std::array<bool, 2>, 2>> is_in;
    std::vector<std::int32_t> coinciding;  ///< of each triangle the first that coincides with it
};

/// Intersects two surfaces, open or closed, of any number of parts, which may cross themselves.
/// What is inside of a closed surface is where its winding number is not zero. Decisions are exact
/// on the input; new vertices are rounded to doubles once, and what rounding makes cross is divided
/// again, so that the triangles of the result meet in common edges and vertices only. The same for
/// any number of threads.
///
/// @throws InputError kinds not_finite, bad_index (surface: which; items: the vertex or triangle),
///         no_triangles (surface: which), too_large, too_close (rounding does not settle);
///         Cancelled
Refinement intersect(const TriangleView& first, const TriangleView& second,
                     const Execution& execution = {});

}  // namespace realmodel::booleans
