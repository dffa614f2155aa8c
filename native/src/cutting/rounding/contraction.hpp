// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cutting/rounding/rounded_parts.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// Nodes that become others, and what the parts around them become by it.
class Contraction {
public:
    /// @param may_fold  whether two polygons of a part that are the same but face each other cancel
    Contraction(RoundedParts& parts, bool may_fold);

    /// Of polygons of a part: how often they use an edge beyond twice, how many there are, and
    /// where.
    struct Shape {
        std::size_t touches = 0, count = 0;
        spatial::Box box;
    };
    /// A polygon of a part as contractions leave it: nodes from `begin` on.
    struct Face {
        std::uint32_t hash;
        std::size_t begin, size;
        int winding;
    };
    /// What shape() uses again.
    struct Scratch {
        std::vector<Face> faces;
        std::vector<NodeId> nodes, sorted;  ///< of all, the latter of each in order
        std::vector<std::uint8_t> is_repeated;
        std::vector<std::uint64_t> uses;  ///< of edges, as numbers: these are sorted sooner
    };
    /// What some of the polygons of a part are like. None where a polygon passes a node twice, or
    /// two have the same nodes.
    std::optional<Shape> shape(std::span<const std::int32_t> pieces, std::int32_t part,
                               Scratch& scratch) const;
    /// The same of a whole part, which stays closed.
    std::optional<Shape> shape(std::int32_t part, Scratch& scratch) const;
    /// Whether a whole part has an extent, or vanishes where its polygons may cancel.
    bool is_sound(const Shape& shape, std::int32_t part) const;
    /// Makes it so: polygons that vanish are no more.
    void apply();

    std::vector<NodeId> becomes;  ///< of nodes

private:
    void add_contracted(std::size_t piece, std::vector<NodeId>& nodes) const;

    RoundedParts& parts_;
    bool may_fold_;
};

}  // namespace realmodel::cutting
